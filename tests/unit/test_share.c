/* The light that nodes share out: at rest, over deaths, after losses, and beside the frames. */
#include "share_room.h"

/* Nothing is sent of a light that rests; the words about it are those of the frames. */
static void still_room(void **state)
{
	struct fdp_counters before, after, plain_before, plain_after;
	struct share_room room, plain;
	struct fdp_share_counts c, again;

	(void)state;
	share_room_init(&room, 4, 17000, 3);
	room.sim.jitter_ns = 0; /* nothing overtakes, so that nothing looks lost */
	sim_start_all(&room.sim);
	sim_assemble(&room.sim);
	sim_run_frames(&room.sim, 10);
	room.still_after = room.sim.frame;
	sim_run_frames(&room.sim, 80);
	share_room_assert_same(&room);
	fdp_master_share(room.sim.master, &c);
	fdp_master_counters(room.sim.master, &before);
	sim_run_frames(&room.sim, 100);
	fdp_master_share(room.sim.master, &again);
	fdp_master_counters(room.sim.master, &after);
	assert_int_equal(c.bytes_sent, again.bytes_sent);
	assert_int_equal(c.asked + c.repairs, again.asked + again.repairs);

	/* The same room with nothing to share. */
	share_room_init(&plain, 4, 17000, 3);
	plain.sim.share_bytes = 0;
	plain.sim.jitter_ns = 0;
	plain.sim.begin_light = plain.sim.light_done = NULL;
	sim_start_all(&plain.sim);
	sim_assemble(&plain.sim);
	sim_run_frames(&plain.sim, 90);
	fdp_master_counters(plain.sim.master, &plain_before);
	sim_run_frames(&plain.sim, 100);
	fdp_master_counters(plain.sim.master, &plain_after);
	printf("# a still room of 4: master out %.1f bytes a frame shared, %.1f unshared\n",
	       (double)(after.bytes_out - before.bytes_out) / 100,
	       (double)(plain_after.bytes_out - plain_before.bytes_out) / 100);
	assert_true(after.bytes_out - before.bytes_out <=
		    plain_after.bytes_out - plain_before.bytes_out + 100 * 4);
	sim_finish(&room.sim);
	sim_finish(&plain.sim);
}

/* A dead node's part goes to the others; when it is back it has one again. */
static void dies_and_returns(void **state)
{
	struct fdp_share_counts c;
	struct share_room room;
	struct sim *s = &room.sim;

	(void)state;
	share_room_init(&room, 4, 17000, 11);
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, 20);
	assert_int_equal(fdp_master_share(s->master, &c), 4);
	sim_kill_node(s, 1);
	sim_run_frames(s, 10);
	assert_int_equal(s->evicted, 1);
	assert_int_equal(fdp_master_share(s->master, &c), 3);
	assert_int_equal(room.lights[0].count, 3);
	assert_int_equal(room.lights[2].index, 1);
	assert_int_equal(room.lights[3].index, 2);
	memset(&room.lights[1], 0, sizeof room.lights[1]);
	sim_start_node(s, 1);
	sim_run_frames(s, 60);
	assert_int_equal(fdp_master_share(s->master, &c), 4);
	room.still_after = s->frame;
	sim_run_frames(s, 5);
	share_room_assert_same(&room);
	/* Alone, nothing is sent. */
	for (int i = 1; i < 4; i++)
		sim_kill_node(s, i);
	sim_run_frames(s, 10);
	assert_int_equal(fdp_master_share(s->master, &c), 1);
	assert_int_equal(room.lights[0].count, 1);
	sim_finish(s);
}

/* One node hears nothing of the last slices; it is told, and asks. */
struct deaf {
	int to;
	enum fdp_kind kind;
	unsigned done;
};

static bool deaf_to_slices(struct sim *s, int to, uint8_t *bytes, size_t len)
{
	struct deaf *deaf = s->tamper_ctx;

	(void)len;
	if (to != deaf->to || bytes[5] != deaf->kind)
		return true;
	deaf->done++;
	return false;
}

static void run_deaf(int to)
{
	struct deaf deaf = { .to = to, .kind = FDP_SLICE };
	struct fdp_share_counts c;
	struct share_room room;
	struct sim *s = &room.sim;

	share_room_init(&room, 3, 3000, 17);
	room.still_after = 20;
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, 19);
	s->tamper = deaf_to_slices;
	s->tamper_ctx = &deaf;
	sim_run_frames(s, 3);
	assert_true(deaf.done > 0);
	if (to >= 0) {
		assert_int_not_equal(room.lights[to].now[0], 20);
		fdp_node_share(s->nodes[to].node, &c);
		assert_int_equal(c.late, 2);
	}
	s->tamper = NULL;
	sim_run_frames(s, 3); /* at the latest: what was asked for is asked for again */
	share_room_assert_same(&room);
	sim_finish(s);
}

static void the_last_is_not_lost(void **state)
{
	(void)state;
	run_deaf(1);
	run_deaf(-1); /* on the way to the master */
}

/*
 * A node that has nothing of a light of 8 MiB asks for it beside the frames, on a
 * link of 1 Gbit/s: no frame's delta waits for more than a burst of it, and no wall is
 * late. Sent as fast as it is asked for it would stop the room.
 */
static uint64_t run_bulk(bool paced)
{
	struct deaf deaf = { .to = 1, .kind = FDP_SLICE };
	struct share_room room;
	struct sim *s = &room.sim;
	double worst;
	int64_t begun_ns;
	uint64_t late;

	share_room_init(&room, 4, FDP_SHARE_MAX, 17);
	if (!paced)
		s->receive_bytes = UINT32_MAX; /* as if there were no window, nor a limit */
	room.still_after = 2;
	s->multicast = false;
	sim_start_all(s);
	sim_assemble(s);
	if (!paced) {
		s->master->bulk_tick_bytes = SIZE_MAX;
		s->master->bulk_node = s->master->bulk_all = (struct fdp_rate){ UINT32_MAX, UINT32_MAX };
	}
	s->tamper = deaf_to_slices;
	s->tamper_ctx = &deaf;
	sim_run_frames(s, 12);
	s->byte_ns = 8;
	s->delivery_count = 0;
	s->tamper = NULL;
	begun_ns = s->now_ns;
	for (int frames = 0; room.lights[1].now[0] != room.made[0] || room.lights[1].now[2] != room.made[2] ||
			     room.lights[1].now[3] != room.made[3]; frames++) {
		assert_true(frames < 300);
		sim_run_frames(s, 1);
	}
	worst = (double)sim_delivery_quantile(s, 1) * 1e-6;
	late = s->late;
	printf("# 6 MiB of light to one of 4 nodes beside the frames, 1 Gbit/s, %s: whole in %.0f ms, deltas under way "
	       "for at most %.2f ms, %llu barriers missed\n", paced ? "paced" : "all at once",
	       (double)(s->now_ns - begun_ns) * 1e-6, worst, (unsigned long long)late);
	if (paced) {
		assert_true(worst < 0.3); /* FDP_BULK_TICK_BYTES take 0.14 */
		assert_true(s->now_ns - begun_ns < 1000 * SIM_MS);
	}
	share_room_assert_same(&room);
	sim_finish(s);
	return late;
}

static void bulk_is_paced(void **state)
{
	(void)state;
	assert_true(run_bulk(false) > 0);
	assert_int_equal(run_bulk(true), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(still_room),
		cmocka_unit_test(dies_and_returns),
		cmocka_unit_test(the_last_is_not_lost),
		cmocka_unit_test(bulk_is_paced),
	};

	if (getenv("GROTTO_TEST_FILTER"))
		cmocka_set_test_filter(getenv("GROTTO_TEST_FILTER"));
	return cmocka_run_group_tests(tests, NULL, NULL);
}
