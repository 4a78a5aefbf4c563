/*
 * How a node swaps: chosen at its start from the layout and from what the
 * driver has, and told in the log. And what its wall shows without a master.
 */
#ifndef GROTTO_DAEMON_NODE_SWAP_H
#define GROTTO_DAEMON_NODE_SWAP_H

#include "config/layout.h"
#include "renderer/gl/target.h"

struct node_swap {
	struct target *target;
	enum layout_swap_mode mode;
	enum layout_orphan orphan;
	bool hardware; /* the driver's barrier: joined while there is a master */
	bool joined;
	bool orphaned; /* the wall shows what it shows without a master */
};

/*
 * GR_OK; GR_ERR_CONFIG where the layout asks for the driver's barrier by name
 * and there is none, after a line in the log. Not joined yet.
 */
int node_swap_init(struct node_swap *swap, struct target *target, const struct layout_swap *layout);
/* There is a master: the driver's barrier holds from the next swap on. */
void node_swap_begin(struct node_swap *swap);
/*
 * There is none, or it has left this node out: no other wall may wait for this one.
 * True when another picture is shown now than the last.
 */
bool node_swap_orphan(struct node_swap *swap);

#endif
