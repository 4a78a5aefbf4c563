/*
 * One wall in operation: receive the state, draw, say READY, swap when told.
 * Opening and loading is node_main.c's.
 *
 * One thread does all: it owns the GL context, and serves the socket between
 * short waits for the GPU. The states of a picture: wanted (its state is
 * applied) -> drawing (submitted) -> ready (the GPU has finished, our slice of
 * a shared light and READY are sent) -> swapped. A newer frame replaces a wanted one; a frame that is
 * being drawn is finished first, and is not reported when a newer one waits.
 * A swap may have a time: it is waited for, which is the frame's own wait.
 *
 * Without a master the last picture stays and the node asks to join, for ever.
 * No allocation after node_create but for saved pictures, and when the node
 * takes the room's plan of the light.
 */
#ifndef GROTTO_DAEMON_NODE_H
#define GROTTO_DAEMON_NODE_H

#include "base/log.h"
#include "daemon/dropped.h"
#include "daemon/faults.h"
#include "daemon/histogram.h"
#include "daemon/loop.h"
#include "daemon/node_plan.h"
#include "daemon/node_share.h"
#include "daemon/node_swap.h"
#include "daemon/notify.h"
#include "daemon/pictures.h"
#include "daemon/socket.h"
#include "protocol/node.h"
#include "renderer/renderer.h"

struct node_params {
	const struct layout *layout;
	size_t index; /* of this node */
	const struct scene_file *scene_file;
	struct fdp_contents contents;
	uint8_t key[FDP_KEY_BYTES];
	bool window;    /* the target is a window, which must be answered */
	bool input;     /* what is done there goes to the master */
	bool once;      /* end when the master ends or refuses */
	int swap_log;   /* a line of each swap is written there; -1: nowhere */
	uint64_t every; /* save pictures of frames that this divides; 0: the last alone */
};

struct node_counts {
	uint64_t applied, drawn, swapped;
	uint64_t dropped; /* applied, but a newer frame came before it was ready */
	uint64_t scheduled; /* swapped at a time that was set; the others when told */
	uint64_t invalid; /* applied, but not drawable: values that make no sense together */
	uint64_t mismatches, joined, lost, refused;
	int64_t first_cpu_ns, last_cpu_ns; /* this process' time on processors at the first and the last swap */
};

struct node {
	struct node_params params;
	struct loop *loop;
	struct net *net;
	struct faults *faults; /* NULL: the layout allows none */
	struct target *target;
	struct renderer *renderer; /* NULL: gone, and the node is to end */
	struct pictures *pictures; /* NULL: none are saved */
	struct fdp_node *fdp;
	struct node_share share;
	struct node_plan plan;
	struct node_swap swap;
	struct notify notify;
	struct render_frame next_frame, frame; /* what is wanted; what is or was drawn */
	struct node_counts counts;
	uint64_t state_frame, state_hash; /* of the last state applied */
	uint64_t drawn_hash, drawn_session; /* of the state that is or was drawn */

	/* Frame numbers, 0 for none. drawn: whose picture the target holds. */
	uint64_t wanted, drawing, drawn, ready, swapped, saved;
	bool picture;             /* the drawn frame has one (its eyes see the wall) */
	int64_t wanted_ns, drawing_ns; /* when the state of that frame was applied */
	uint64_t due;             /* frame that is to be swapped at due_ns; 0: none */
	int64_t due_ns;
	struct histogram swap_off; /* us from the time that was set to the picture's being shown */
	int64_t swap_ns;          /* of a swap that is not yet reported; 0: none */
	uint64_t report;          /* frame of that swap */
	bool master_gone;         /* left, refused, or lost: nothing will come */
	int64_t lost_ns;          /* since when nothing is heard from it; 0: it is, or none was there */
	int64_t left_ns;          /* when the master left, while another may come in its place; 0: not so */
	bool orphan;              /* the wall is to show what it shows without a master */
	int status;               /* enum gr_exit, when the loop stops */

	int tick_timer, second_timer, window_timer;
	uint64_t logged_swapped;
	struct dropped bad;
	struct gr_log_limit refused_limit, invalid_limit, mismatch_limit, send_limit;
	uint64_t seen_send_failed;
};

/* All but params is borrowed. On failure the log says why. */
int node_create(struct node **out, struct loop *loop, struct net *net, struct target *target,
		struct renderer *renderer, struct pictures *pictures,
		const struct node_params *params);
/* Before node_run. Borrowed. */
void node_use_faults(struct node *node, struct faults *faults);
/*
 * Serves until the loop is stopped, or until the room has another plan of the
 * light than this node (node->plan.wanted is not 0, and the renderer is to be
 * made anew for it). enum gr_exit.
 */
int node_run(struct node *node);
/*
 * The renderer is another, which may have another plan: node->plan.wanted has
 * been tried. NULL: there is none. GR_OK; GR_ERR_NOMEM, GR_ERR_RANGE.
 */
int node_take_renderer(struct node *node, struct renderer *renderer);
/* LEAVE, and the last picture. */
void node_leave(struct node *node);
void node_destroy(struct node **node);

/* The report at the end: one JSON object. Reads the light field back. */
int node_write_json(const struct node *node, uint64_t pictures_saved, char *text, size_t size,
		    size_t *out_len);

#endif
