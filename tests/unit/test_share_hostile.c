/* The light that nodes share out: its bodies to the byte, and lies of a key holder. */
#include "share_room.h"

#include "base/result.h"

/* A key holder lies: nothing of it reaches another node's light, nobody is disturbed. */
static uint16_t say_slice(struct share_room *room, struct fdp_piece piece, size_t len, int node)
{
	static uint8_t bytes[4096];
	struct fdp_node *n = room->sim.nodes[node].node;
	struct fdp_header h = {
		.version = FDP_VERSION, .kind = FDP_SLICE, .sender = (uint16_t)node,
		.payload_len = (uint16_t)(FDP_PIECE_HEAD + len), .count = 1,
		.session = n->out.session, .sequence = ++n->out.sequence,
		.message = ++n->out.message, .message_len = (uint32_t)(FDP_PIECE_HEAD + len),
		.plain_len = (uint32_t)(FDP_PIECE_HEAD + len),
	};
	struct fdp_counters before, after;
	struct fdp_share_counts shared_before, shared_after;
	uint8_t *exact;
	int r;

	memset(bytes, 0x5a, sizeof bytes);
	fdp_piece_encode(&piece, bytes + FDP_HEADER_BYTES, FDP_PIECE_HEAD);
	fdp_wire_seal(&h, n->key_to_master, bytes);
	fdp_master_counters(room->sim.master, &before);
	fdp_master_share(room->sim.master, &shared_before);
	exact = unit_copy(bytes, FDP_HEADER_BYTES + h.payload_len);
	r = fdp_master_receive(room->sim.master, exact, FDP_HEADER_BYTES + h.payload_len,
			       room->sim.now_ns, NULL);
	fdp_master_counters(room->sim.master, &after);
	fdp_master_share(room->sim.master, &shared_after);
	assert_int_equal(shared_before.bytes_sent, shared_after.bytes_sent);
	/* Sent once more it is a replay, whatever it says. */
	assert_int_equal(fdp_master_receive(room->sim.master, exact, FDP_HEADER_BYTES + h.payload_len,
					    room->sim.now_ns, NULL),
			 room->sim.master->share.room ? GR_ERR_REPLAY : GR_ERR_FORMAT);
	free(exact);
	assert_int_equal(r < 0, after.bad_format > before.bad_format);
	return (uint16_t)(after.bad_format - before.bad_format);
}

static void hostile(void **state)
{
	struct fdp_piece p, good;
	struct share_room room;
	struct sim *s = &room.sim;

	(void)state;
	share_room_init(&room, 4, 4000, 23);
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, 20);
	good = (struct fdp_piece){ .since = s->master->share.since, .frame = s->frame, .index = 2,
				   .count = 4, .chunk = 100, .len = 100 };
#define BAD(bad, size, ...) do { p = good; __VA_ARGS__; \
		assert_int_equal(say_slice(&room, p, size, 2), bad); } while (0)
	BAD(1, 100, p.index = 1);            /* another's slice */
	BAD(1, 100, p.index = 4);
	BAD(1, 100, p.count = 3);            /* another division of the same name */
	BAD(1, 100, p.count = 65);
	BAD(1, 100, p.since = s->frame);     /* a division that is not */
	BAD(1, 100, p.since = 0);
	BAD(1, 100, p.frame = s->frame + 1); /* not begun */
	BAD(1, 100, p.frame = UINT64_MAX);
	BAD(1, 100, p.chunk = 0);
	BAD(1, 100, p.len = 0);
	BAD(1, 100, p.len = 99);
	BAD(1, 99, (void)0);
	BAD(1, 100, p.len = 101);            /* not that of the slice that came whole */
	BAD(1, 100, p.len = 1100; p.at = 1000); /* longer than a quarter of what there is room for */
	BAD(1, 100, p.len = UINT32_MAX);
	BAD(1, 100, p.at = 100);
	BAD(1, 50, p.at = 50);
	BAD(1, 1, p.chunk = 1; p.len = 10000); /* more pieces than can be counted */
	BAD(0, 100, p.frame = good.since + 1; p.since = good.since); /* two newer ones are known */
	if (good.since > 1)
		BAD(0, 100, p.since = good.since - 1); /* a division gone by */
#undef BAD
	sim_run_frames(s, 20);
	room.still_after = s->frame;
	sim_run_frames(s, 5);
	share_room_assert_same(&room);
	assert_int_equal(s->late + s->evicted + s->mismatches, 0);
	sim_finish(s);
}

/* A master without a shared light takes none. */
static void not_shared(void **state)
{
	struct fdp_share_counts c;
	unsigned index, count;
	struct share_room room;
	struct sim *s = &room.sim;

	(void)state;
	share_room_init(&room, 2, 4000, 29);
	s->begin_light = s->light_done = NULL;
	s->share_bytes = 0;
	sim_start_master(s);
	s->share_bytes = 4096;
	for (int i = 0; i < 2; i++)
		sim_start_node(s, i);
	sim_assemble(s);
	sim_run_frames(s, 5);
	assert_false(fdp_node_division(s->nodes[0].node, &index, &count));
	assert_int_equal(fdp_node_slice(s->nodes[0].node, s->frame, (const uint8_t *)"x", 1, s->now_ns),
			 GR_NOTHING);
	assert_int_equal(say_slice(&room, (struct fdp_piece){ 1, 1, 0, 2, 10, 10, 0 }, 10, 0), 1);
	assert_int_equal(fdp_master_share(s->master, &c), 0);
	assert_int_equal(c.received, 0);
	sim_finish(s);
}

/* Every length of both bodies; whatever is taken is written again as it was. */
static void bodies(void **state)
{
	const struct fdp_piece piece = { 5, 9, 1, 4, 10, 35, 30 };
	const struct fdp_lack lack = { 5, 9, 1, 11, 3, { 0xff, 0x07 } };
	struct unit_random r = unit_random_start("share bodies");
	uint8_t bytes[FDP_PIECE_HEAD + 16] = { 0 }, again[FDP_BODY_MAX];
	struct fdp_piece piece_out;
	struct fdp_lack lack_out;
	size_t len;

	(void)state;
	assert_int_equal(fdp_piece_encode(&piece, bytes, FDP_PIECE_HEAD - 1), 0);
	assert_int_equal(fdp_piece_encode(&piece, bytes, sizeof bytes), FDP_PIECE_HEAD);
	assert_memory_equal(bytes, "\5\0\0\0\0\0\0\0\11\0\0\0\0\0\0\0\1\0\4\0\12\0\0\0\43\0\0\0\36\0\0\0", 32);
	for (size_t n = 0; n <= sizeof bytes; n++) {
		uint8_t *exact = unit_copy(bytes, n);

		assert_int_equal(fdp_piece_decode(exact, n, &piece_out),
				 n == FDP_PIECE_HEAD + 5 ? GR_OK : GR_ERR_FORMAT);
		free(exact);
	}
	for (int i = 0; i < 20000; i++) {
		fdp_piece_encode(&piece, bytes, sizeof bytes);
		bytes[unit_random_u32(&r) % FDP_PIECE_HEAD] = (uint8_t)unit_random_u32(&r);
		if (fdp_piece_decode(bytes, FDP_PIECE_HEAD + 5, &piece_out))
			continue;
		assert_int_equal(fdp_piece_encode(&piece_out, again, sizeof again), FDP_PIECE_HEAD);
		assert_memory_equal(bytes, again, FDP_PIECE_HEAD);
	}
	len = fdp_lack_encode(&lack, bytes, sizeof bytes);
	assert_int_equal(len, 26);
	for (size_t n = 0; n < sizeof bytes; n++) {
		uint8_t *exact = unit_copy(bytes, n);

		assert_int_equal(fdp_lack_decode(exact, n, &lack_out), n == len ? GR_OK : GR_ERR_FORMAT);
		assert_int_equal(fdp_lack_encode(&lack, again, n < len ? n : len), n < len ? 0 : len);
		free(exact);
	}
	for (int i = 0; i < 20000; i++) {
		fdp_lack_encode(&lack, bytes, sizeof bytes);
		bytes[unit_random_u32(&r) % len] = (uint8_t)unit_random_u32(&r);
		if (fdp_lack_decode(bytes, len, &lack_out))
			continue;
		assert_int_equal(fdp_lack_encode(&lack_out, again, sizeof again), len);
		assert_memory_equal(bytes, again, len);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bodies),
		cmocka_unit_test(hostile),
		cmocka_unit_test(not_shared),
	};

	if (getenv("GROTTO_TEST_FILTER"))
		cmocka_set_test_filter(getenv("GROTTO_TEST_FILTER"));
	return cmocka_run_group_tests(tests, NULL, NULL);
}
