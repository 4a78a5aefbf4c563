/* What all machines of a room must have alike, part by part. */
#include "config/canonical.h"
#include "config/layout.h"

#include <string.h>

static void wall_item(struct canonical_items *items, const struct layout *layout, size_t i)
{
	const struct layout_wall *wall = &layout->walls[i];
	struct canonical *c = canonical_item(items, "walls[%zu] (%s)", i, wall->name);

	canonical_string(c, wall->name);
	canonical_floats(c, wall->lower_left, 3);
	canonical_floats(c, wall->lower_right, 3);
	canonical_floats(c, wall->upper_left, 3);
	canonical_u64(c, (uint64_t)wall->pixels[0]);
	canonical_u64(c, (uint64_t)wall->pixels[1]);
}

static void node_item(struct canonical_items *items, const struct layout *layout, size_t i)
{
	const struct layout_node *node = &layout->nodes[i];
	struct canonical *c;
	size_t first = i; /* of its wall: they stand together */

	while (first && layout->nodes[first - 1].wall == node->wall)
		first--;
	c = canonical_item(items, "walls[%zu].nodes[%zu] (%s)", node->wall, i - first, node->name);
	canonical_string(c, node->name);
	canonical_u64(c, node->wall);
	canonical_floats(c, node->part, 4);
	canonical_string(c, node->address);
	canonical_u64(c, node->port);
	canonical_u64(c, node->eyes);
}

static void network_items(struct canonical_items *items, const struct layout_network *network)
{
	canonical_u64(canonical_item(items, "network.cast"), network->cast);
	canonical_string(canonical_item(items, "network.master_address"), network->master_address);
	canonical_u64(canonical_item(items, "network.master_port"), network->master_port);
	canonical_string(canonical_item(items, "network.group"), network->group);
	canonical_u64(canonical_item(items, "network.group_port"), network->group_port);
	canonical_u64(canonical_item(items, "network.ttl"), (uint64_t)network->ttl);
	canonical_u64(canonical_item(items, "network.loop"), network->loop);
	canonical_u64(canonical_item(items, "network.mtu"), (uint64_t)network->mtu);
}

/* Of rooms that have any: others are what they were. */
static void standby_items(struct canonical_items *items, const struct layout *layout)
{
	struct canonical *c;

	if (!layout->standby_count)
		return;
	c = canonical_item(items, "standby");
	for (size_t i = 0; i < layout->standby_count; i++) {
		canonical_string(c, layout->standby[i].address);
		canonical_u64(c, layout->standby[i].port);
	}
	canonical_u64(canonical_item(items, "rates.takeover_frames"),
		      (uint64_t)layout->rates.takeover_frames);
}

static void rate_items(struct canonical_items *items, const struct layout_rates *rates)
{
	canonical_floats(canonical_item(items, "rates.frame_hz"), &rates->frame_hz, 1);
	canonical_u64(canonical_item(items, "rates.barrier_deadline_ms"),
		      (uint64_t)rates->barrier_deadline_ns);
	canonical_u64(canonical_item(items, "rates.evict_frames"), (uint64_t)rates->evict_frames);
	canonical_u64(canonical_item(items, "rates.display_latency_ms"),
		      (uint64_t)rates->display_latency_ns);
}

size_t layout_items(const struct layout *layout, struct gr_item *items, size_t room, uint8_t hash[32])
{
	struct canonical_items c = canonical_items_start("grotto layout 2", items, room);
	struct canonical *part;

	canonical_u64(canonical_item(&c, "the number of walls"), layout->wall_count);
	for (size_t i = 0; i < layout->wall_count; i++)
		wall_item(&c, layout, i);
	canonical_u64(canonical_item(&c, "the number of nodes"), layout->node_count);
	for (size_t i = 0; i < layout->node_count; i++)
		node_item(&c, layout, i);
	network_items(&c, &layout->network);
	standby_items(&c, layout);
	rate_items(&c, &layout->rates);
	canonical_floats(canonical_item(&c, "eye_separation_m"), &layout->eye_separation_m, 1);
	part = canonical_item(&c, "start");
	canonical_floats(part, layout->start_head.p, 3);
	canonical_floats(part, layout->start_head_angles, 3);
	canonical_floats(part, layout->start_wand.p, 3);
	canonical_floats(part, layout->start_wand_angles, 3);
	part = canonical_item(&c, "room");
	canonical_floats(part, layout->room_min, 3);
	canonical_floats(part, layout->room_max, 3);
	return canonical_items_finish(&c, hash);
}
