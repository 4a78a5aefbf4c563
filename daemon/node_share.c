#include "daemon/node_share.h"

#include "base/result.h"
#include "renderer/gi/plan.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A JOIN's hundredths; what is more than they hold is said to be that. */
static uint16_t hundredths(double value)
{
	return (uint16_t)fmin(fmax(round(100 * value), 0), UINT16_MAX);
}

void node_share_plan(const struct renderer *renderer, uint64_t *out_plan, uint16_t *out_cost,
		     uint16_t *out_error)
{
	const struct gi_plan *plan = renderer ? renderer_plan(renderer) : NULL;

	*out_plan = plan ? plan->code : 0;
	*out_cost = plan ? hundredths(plan->update_ms) : 0;
	*out_error = plan ? hundredths(100 * plan->error) : 0;
}

int node_share_init(struct node_share *share, struct renderer *renderer,
		    const struct scene_file *scene, size_t nodes)
{
	size_t room;

	*share = (struct node_share){ 0 };
	if (scene->gi.share != SCENE_SHARE_CLUSTER || nodes < 2)
		return GR_OK;
	room = renderer_share_bytes(renderer, (unsigned)nodes);
	if (room == 0) {
		gr_warning("gi.share = \"cluster\" has no effect: the light of this scene is not shared "
			   "out, each node computes all of it");
		return GR_OK;
	}
	if (room > FDP_SHARE_MAX) {
		gr_warning("gi.share = \"cluster\" has no effect: %zu bytes of light a frame are more "
			   "than the %u that are sent; a larger gi.surfels.spacing_m makes fewer",
			   room, FDP_SHARE_MAX);
		return GR_OK;
	}
	share->size = room / 2;
	share->bytes = malloc(share->size);
	if (!share->bytes)
		return GR_ERR_NOMEM;
	share->renderer = renderer;
	share->room = room;
	gr_info("the light is shared out: at most %zu bytes a frame, all nodes together", room);
	return GR_OK;
}

void node_share_finish(struct node_share *share)
{
	free(share->bytes);
	*share = (struct node_share){ 0 };
}

static void put(void *ctx, const uint8_t *bytes, size_t len)
{
	struct node_share *share = ctx;
	uint64_t times;
	int r = renderer_share_put(share->renderer, bytes, len);

	if (r >= 0)
		return;
	share->refused++;
	if (gr_log_limit(&share->refused_limit, share->now_ns, &times))
		gr_error("a slice of the light of another node is none of ours: %s (%" PRIu64
			 " since the last line)", gr_result_name(r), times);
}

void node_share_begin(struct node_share *share, struct fdp_node *fdp, uint64_t frame,
		      int64_t now_ns)
{
	unsigned index, count;
	int r;

	if (!share->renderer)
		return;
	share->now_ns = now_ns;
	if (!fdp_node_division(fdp, &index, &count)) {
		index = 0;
		count = 1;
	}
	if (index != share->index || count != share->count) {
		r = renderer_share_set(share->renderer, index, count);
		if (r < 0)
			gr_error("slice %u of %u of the light cannot be computed here: %s", index + 1, count,
				 gr_result_name(r));
		else
			gr_info("computes slice %u of %u of the light", index + 1, count);
		share->index = index;
		share->count = count;
	}
	fdp_node_slices(fdp, frame, put, share);
}

void node_share_end(struct node_share *share, struct fdp_node *fdp, uint64_t frame, int64_t now_ns)
{
	uint64_t times;
	size_t len;
	int r;

	if (!share->renderer || share->count < 2)
		return;
	r = renderer_share_take(share->renderer, share->bytes, share->size, &len);
	if (r == GR_OK)
		r = fdp_node_slice(fdp, frame, share->bytes, len, now_ns);
	if (r < 0 && gr_log_limit(&share->unsent_limit, now_ns, &times))
		gr_error("this node's slice of the light of frame %" PRIu64 " is not sent: %s (%" PRIu64
			 " since the last line)", frame, gr_result_name(r), times);
}
