#include "daemon/node_swap.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/pattern.h"

int node_swap_init(struct node_swap *swap, struct target *target, const struct layout_swap *layout)
{
	char why[160] = "";
	int r = GR_ERR_UNSUPPORTED;

	*swap = (struct node_swap){ .target = target, .mode = layout->mode, .orphan = layout->orphan };
	if (swap->mode == LAYOUT_SWAP_MESSAGE || swap->mode == LAYOUT_SWAP_SCHEDULED) {
		gr_info("swaps %s", swap->mode == LAYOUT_SWAP_MESSAGE ? "when told" : "at the master's time");
		return GR_OK;
	}
	r = target_barrier_join(target, why, sizeof why);
	if (r == GR_OK) {
		/* Others must not wait for a node that has no master yet. */
		target_barrier_leave(target);
		swap->hardware = true;
		gr_notice("swaps by the driver's barrier (NV_swap_group)");
		return GR_OK;
	}
	if (swap->mode == LAYOUT_SWAP_HARDWARE) {
		gr_error("swap.mode = \"hardware\": %s; \"auto\" would do without", why);
		return GR_ERR_CONFIG;
	}
	gr_info("no swap by the driver's barrier: %s; at the master's time, or when told", why);
	return GR_OK;
}

void node_swap_begin(struct node_swap *swap)
{
	char why[160];

	swap->orphaned = false;
	if (!swap->hardware || swap->joined)
		return;
	swap->joined = target_barrier_join(swap->target, why, sizeof why) == GR_OK;
	if (!swap->joined)
		gr_warning("the driver's barrier cannot be joined again: %s; swaps when told", why);
}

bool node_swap_orphan(struct node_swap *swap)
{
	if (swap->joined)
		target_barrier_leave(swap->target);
	swap->joined = false;
	if (swap->orphaned || swap->orphan == LAYOUT_ORPHAN_HOLD)
		return false;
	swap->orphaned = true;
	gr_notice("the wall shows %s", swap->orphan == LAYOUT_ORPHAN_TEST ? "a test pattern" : "black");
	pattern_draw(swap->target, swap->orphan == LAYOUT_ORPHAN_TEST ? PATTERN_TEST : PATTERN_BLACK);
	target_swap(swap->target);
	return true;
}
