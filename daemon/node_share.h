/*
 * The node's part of a light that is shared out: between the renderer, which
 * computes a slice of it and takes those of the others, and the protocol,
 * which carries them. With gi.share = "local", a method that shares nothing,
 * or a light too large to be sent in a frame, every call does nothing.
 */
#ifndef GROTTO_DAEMON_NODE_SHARE_H
#define GROTTO_DAEMON_NODE_SHARE_H

#include "base/log.h"
#include "protocol/node.h"
#include "renderer/renderer.h"

struct node_share {
	struct renderer *renderer; /* borrowed; NULL: nothing is shared */
	size_t room;               /* bytes of all slices together */
	uint8_t *bytes;            /* room for our slice */
	size_t size;
	unsigned index, count;     /* as the renderer was told; count 0: not yet */
	uint64_t refused;          /* slices that the renderer would not take */
	int64_t now_ns;            /* of the frame that is begun */
	struct gr_log_limit refused_limit, unsent_limit;
};

/*
 * The plan of the light that a renderer goes by (NULL, or one that has none: 0),
 * and what is expected of it, as struct fdp_join has them.
 */
void node_share_plan(const struct renderer *renderer, uint64_t *out_plan, uint16_t *out_cost,
		     uint16_t *out_error);
/* nodes: of the layout. Logs what is shared, or why nothing is. GR_OK or GR_ERR_NOMEM. */
int node_share_init(struct node_share *share, struct renderer *renderer,
		    const struct scene_file *scene, size_t nodes);
void node_share_finish(struct node_share *share);
/* Before a frame is drawn: which slice is ours in it, and what the others have made. */
void node_share_begin(struct node_share *share, struct fdp_node *fdp, uint64_t frame,
		      int64_t now_ns);
/* The GPU has finished it: our slice goes to all, if it changed. Comes before fdp_node_ready. */
void node_share_end(struct node_share *share, struct fdp_node *fdp, uint64_t frame, int64_t now_ns);

#endif
