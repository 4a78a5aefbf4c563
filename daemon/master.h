/*
 * The room in operation: frames, barrier, trackers, statistics. Opening and
 * loading is master_main.c's; here is what happens from then on, driven by
 * the loop. No allocation after master_create.
 *
 * A frame begins when its time has come, the frame before has swapped, and
 * enough nodes are there. Real clock: frame times are multiples of the frame
 * period after the start. Frame clock: frame N stands at N / frame_hz seconds
 * whatever the real time, and begins as soon as it may; what is shown is then
 * a function of N alone.
 */
#ifndef GROTTO_DAEMON_MASTER_H
#define GROTTO_DAEMON_MASTER_H

#include "daemon/dropped.h"
#include "daemon/faults.h"
#include "daemon/frame_stats.h"
#include "daemon/live_source.h"
#include "daemon/loop.h"
#include "daemon/notify.h"
#include "daemon/recorder.h"
#include "daemon/replay_source.h"
#include "daemon/socket.h"
#include "protocol/master.h"
#include "protocol/message.h"
#include "protocol/standby.h"

#include "base/log.h"


struct state_keeper;

struct master_params {
	const struct layout *layout;
	const struct scene_file *scene;
	struct fdp_contents contents;
	const char *layout_path, *scene_path; /* absolute, for records; or NULL */
	uint8_t key[FDP_KEY_BYTES];
	uint64_t frames; /* end after so many; 0: for ever */
	unsigned expect; /* nodes that must be live before the first frame, at least 1 */
	bool frame_clock;
	unsigned index; /* of the layout's masters, which this is */
	bool standby;   /* follows at its start, and again when there is a higher epoch */
	/* Where frames come from: one of these, the other NULL. Borrowed. */
	struct live_source *live;
	struct replay_source *replay;
};

struct master {
	struct master_params params;
	struct loop *loop;
	struct net *net;
	struct faults *faults; /* NULL: the layout allows none */
	const struct net_address *from; /* of the datagram that is being handled, or NULL */
	int64_t heard_ns;               /* when it came */
	struct frame_source *source;
	struct fdp_master *fdp;
	struct fdp_standby *standby; /* who rules */
	struct param_state *state;
	struct notify notify;
	struct recorder *recorder; /* NULL: nothing can be recorded */
	struct frame_stats stats;
	struct state_keeper *keeper; /* borrowed; NULL: nothing is left to a successor */
	uint64_t saved_frame;        /* of the last that was left */

	uint64_t session, frame; /* frame: the last begun */
	int64_t start_ns, next_frame_ns;
	int64_t period_ns;
	bool took_over;     /* and has begun no frame since */
	int status;         /* enum gr_exit, when the loop stops */
	bool started;       /* `expect` nodes were there */
	bool restart_light; /* at the next frame */
	int64_t swap_ns;          /* when SWAP was sent last */
	int64_t light_restart_ns; /* when it was last */
	uint64_t members;   /* nodes that joined and have not gone, bit per node */
	uint64_t behind;    /* nodes that missed a barrier and have not caught up */
	int64_t finish_ns;  /* no longer waits for reports than this; 0: not finishing */
	bool left;

	int tick_timer, frame_timer, second_timer;
	uint64_t late, evicted, refused, joined;
	uint64_t takeovers, yielded;
	uint64_t logged_frame;
	int deaf; /* node that keeps the room from multicast (cast = "auto"); -1: none */
	struct dropped bad;
	struct gr_log_limit refused_limit[FDP_MAX_NODES], range_limit, late_limit, way_limit;
	struct gr_log_limit mismatch_limit, send_limit, role_limit;
	uint64_t seen_send_failed;
};

/* net and loop are borrowed. On failure the log says why. */
int master_create(struct master **out, struct loop *loop, struct net *net,
		  const struct master_params *params);
/* From now on what happens can be recorded. The recorder is borrowed. */
void master_use_recorder(struct master *master, struct recorder *recorder);
/* Before the first frame. Borrowed. */
void master_use_faults(struct master *master, struct faults *faults);
/* Begins a recording: as recorder_start. */
int master_record(struct master *master, const char *path, char *why, size_t size);
/*
 * Before the first frame of a live room: goes on from the state that a master left at
 * `path`, if it is this room's and of the last minutes. A file of no use is told of, and left.
 */
void master_resume(struct master *master, const char *path);
/* Borrowed; the state is put into it every second. NULL: no more. */
void master_use_keeper(struct master *master, struct state_keeper *keeper);
/* Puts the present state, if a frame has begun since the last. */
void master_save(struct master *master);
/* Says LEAVE to the nodes, once. */
void master_leave(struct master *master);
void master_destroy(struct master **master);

/* Answers of the control socket; see daemon/control.h. */
void master_answer(void *ctx, char *const *words, int count, char *answer, size_t size);

/* The status document and the report at the end: one JSON object. GR_OK or GR_ERR_RANGE (too small). */
int master_write_json(const struct master *master, int64_t now_ns, char *text, size_t size,
		      size_t *out_len);

#endif
