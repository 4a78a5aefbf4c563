#include "share_room.h"

#include "base/cursor.h"
#include "base/result.h"

#define LIGHT_HEAD 12

static struct share_room *room_of(struct sim_node *n)
{
	return (struct share_room *)n->sim; /* its first member */
}

static uint8_t light_byte(uint64_t frame, unsigned index, size_t at)
{
	return (uint8_t)(frame * 151 + index * 31 + at * 7 + (at >> 8));
}

static size_t light_make(uint8_t *bytes, size_t all, uint64_t frame, unsigned index, unsigned count)
{
	struct gr_writer w = gr_writer(bytes, LIGHT_HEAD);
	const size_t len = all / count < LIGHT_HEAD + 1 ? LIGHT_HEAD + 1 : all / count;

	gr_write_u64(&w, frame);
	gr_write_u16(&w, (uint16_t)index);
	gr_write_u16(&w, (uint16_t)count);
	for (size_t i = LIGHT_HEAD; i < len; i++)
		bytes[i] = light_byte(frame, index, i);
	return len;
}

/* What is put is what that node made, whole, of our division, and in order. */
static void put(void *ctx, const uint8_t *bytes, size_t len)
{
	struct sim_node *n = ctx;
	struct share_room *room = room_of(n);
	struct share_light *light = &room->lights[n->index];
	struct gr_reader r = gr_reader(bytes, len);
	const uint64_t frame = gr_read_u64(&r);
	const unsigned index = gr_read_u16(&r), count = gr_read_u16(&r);

	assert_true(r.ok);
	assert_int_equal(count, light->count);
	assert_int_not_equal(index, light->index);
	assert_int_equal(len, room->bytes / count < LIGHT_HEAD + 1 ? LIGHT_HEAD + 1 : room->bytes / count);
	assert_true(frame > light->next[index]);
	for (size_t i = LIGHT_HEAD; i < len; i++)
		assert_int_equal(bytes[i], light_byte(frame, index, i));
	light->next[index] = frame;
}

static void begin_light(struct sim_node *n, uint64_t frame)
{
	struct share_room *room = room_of(n);
	struct share_light *light = &room->lights[n->index];
	unsigned index, count;

	assert_true(fdp_node_division(n->node, &index, &count));
	if (index != light->index || count != light->count || light->fresh ||
	    n->node->shared_since == frame) {
		memset(light->next, 0, sizeof light->next);
		light->index = index;
		light->count = count;
		light->fresh = true;
		light->restarts++;
	}
	fdp_node_slices(n->node, frame, put, n);
	memcpy(light->now, light->next, sizeof light->now);
	for (unsigned i = 0; i < count; i++) {
		/* Made in the frame before: it is due now. */
		if (i == index || room->made[i] + 1 != frame || frame <= n->node->shared_since)
			continue;
		light->due++;
		light->on_time += light->now[i] + 1 == frame;
	}
}

static void light_done(struct sim_node *n, uint64_t frame)
{
	static uint8_t bytes[FDP_SHARE_MAX];
	struct share_room *room = room_of(n);
	struct share_light *light = &room->lights[n->index];
	size_t len;
	int result;

	if (!light->fresh && frame > room->still_after)
		return;
	len = light_make(bytes, room->bytes, frame, light->index, light->count);
	result = fdp_node_slice(n->node, frame, bytes, len, n->sim->now_ns);
	if (light->count == 1 || result == GR_NOTHING)
		return;
	assert_int_equal(result, GR_OK);
	light->fresh = false;
	light->next[light->index] = room->made[light->index] = frame;
}

void share_room_init(struct share_room *room, size_t nodes, size_t bytes, uint64_t seed)
{
	memset(room, 0, sizeof *room);
	sim_init(&room->sim, nodes, seed);
	room->bytes = bytes;
	room->still_after = UINT64_MAX;
	room->sim.receive_bytes = 8 << 20; /* as a daemon has it, where the system gives so much */
	room->sim.share_bytes = bytes < 2048 ? 4096 : bytes;
	room->sim.begin_light = begin_light;
	room->sim.light_done = light_done;
}

void share_room_assert_same(struct share_room *room)
{
	const struct share_light *first = &room->lights[0];

	for (size_t i = 0; i < room->sim.node_count; i++) {
		assert_int_equal(room->lights[i].count, first->count);
		assert_memory_equal(room->lights[i].now, first->now, sizeof first->now);
	}
	for (unsigned i = 0; i < first->count; i++) {
		assert_true(first->now[i] > 0);
		assert_int_equal(first->now[i], room->made[i]);
	}
}
