/* Nodes that do not keep up: the rule by itself, and rooms on the fake clock by each policy. */
#include "cluster_sim.h"

#include "protocol/pace.h"

static unsigned feed(struct fdp_pace *pace, const struct fdp_pace_params *p, bool slow, unsigned frames)
{
	unsigned changes = 0;

	for (unsigned i = 0; i < frames; i++)
		changes += fdp_pace_frame(pace, p, slow, 1000 + i);
	return changes;
}

static void complete_params(void **state)
{
	const struct fdp_pace_params none = { 0 }, some = { FDP_SLOW_HALF, 5, 6, 7, 8 };
	struct fdp_pace_params p = fdp_pace_complete(&none, 33);

	(void)state;
	assert_int_equal(p.policy, FDP_SLOW_EVICT);
	assert_int_equal(p.limit_ns, 33);
	assert_int_equal(p.frames, FDP_PACE_FRAMES);
	assert_int_equal(p.wait_most_ns, FDP_PACE_WAIT_NS);
	assert_int_equal(p.rejoin_most_ns, FDP_PACE_REJOIN_NS);
	p = fdp_pace_complete(&some, 33);
	assert_int_equal(p.policy, some.policy);
	assert_int_equal(p.limit_ns, some.limit_ns);
	assert_int_equal(p.frames, some.frames);
	assert_int_equal(p.wait_most_ns, some.wait_most_ns);
	assert_int_equal(p.rejoin_most_ns, some.rejoin_most_ns);
}

/* Slow in half of the frames is not slow; in more than half it is, after exactly so many. */
static void counts(void **state)
{
	const struct fdp_pace_params p = { FDP_SLOW_WAIT, 1, 10, 1, 1 };
	struct fdp_pace pace = { 0 };

	(void)state;
	for (int i = 0; i < 1000; i++)
		assert_int_equal(feed(&pace, &p, i % 2 == 0, 1), 0);
	assert_int_equal(feed(&pace, &p, true, 9), 0);
	assert_int_equal(feed(&pace, &p, false, 1), 0);
	assert_int_equal(feed(&pace, &p, true, 1), 0);
	assert_true(fdp_pace_frame(&pace, &p, true, 77));
	assert_int_equal(pace.state, FDP_PACE_SLOW);
	assert_int_equal(pace.since_ns, 77);
	/* Two of three in time: ten more of those than of the others. */
	for (int i = 0; i < 26; i++)
		assert_int_equal(feed(&pace, &p, i % 3 == 0, 1), 0);
	assert_int_equal(feed(&pace, &p, false, 1), 1);
	assert_int_equal(pace.state, FDP_PACE_IN_STEP);
}

/* Who falls back soon is asked for twice as much each time, up to 16 times; who did well is not. */
static void relapses(void **state)
{
	const struct fdp_pace_params p = { FDP_SLOW_HALF, 1, 10, 1, 1 };
	struct fdp_pace pace = { 0 };

	(void)state;
	for (unsigned i = 0; i < 8; i++) {
		const unsigned asked = 10u << (i < 4 ? i : 4);

		assert_int_equal(feed(&pace, &p, true, 10), 1);
		assert_int_equal(pace.state, FDP_PACE_HALF);
		assert_int_equal(feed(&pace, &p, false, asked - 1), 0);
		assert_int_equal(feed(&pace, &p, false, 1), 1);
		assert_int_equal(pace.state, FDP_PACE_IN_STEP);
	}
	assert_int_equal(feed(&pace, &p, false, 8 * 160), 0);
	assert_int_equal(feed(&pace, &p, true, 10), 1);
	assert_int_equal(feed(&pace, &p, false, 10), 1);
}

/* The first time at once, then 1, 2, 4, 8 s and so on, and never longer than the most. */
static void out_for(void **state)
{
	const struct fdp_pace_params p = { FDP_SLOW_EVICT, 1, 1, 1, 10 * INT64_C(1000000000) };
	static const int64_t s[] = { 0, 1, 2, 4, 8, 10, 10, 10 };
	struct fdp_pace pace = { 0 };

	(void)state;
	for (unsigned i = 0; i < sizeof s / sizeof *s; i++) {
		const int64_t now = (int64_t)(i + 1) * 1000, until = now + s[i] * INT64_C(1000000000);

		assert_true(fdp_pace_frame(&pace, &p, true, now));
		assert_int_equal(pace.state, FDP_PACE_EVICTED);
		assert_false(fdp_pace_frame(&pace, &p, false, now));
		assert_int_equal(pace.out_until_ns, until);
		assert_true(!s[i] || !fdp_pace_may_join(&pace, until - 1));
		assert_true(fdp_pace_may_join(&pace, until));
		fdp_pace_join(&pace, until);
		assert_int_equal(pace.state, FDP_PACE_IN_STEP);
		assert_true(fdp_pace_may_join(&pace, 0));
	}
}

/* Too many barriers missed: half the rate is tried once, then there is nothing left. */
static void too_late(void **state)
{
	const struct fdp_pace_params half = { FDP_SLOW_HALF, 1, 10, 1, 1 }, wait = { FDP_SLOW_WAIT, 1, 10, 1, 1 };
	struct fdp_pace pace = { 0 };

	(void)state;
	assert_true(fdp_pace_too_late(&pace, &half, 5));
	assert_int_equal(pace.state, FDP_PACE_HALF);
	assert_false(fdp_pace_too_late(&pace, &half, 6));
	assert_int_equal(pace.state, FDP_PACE_EVICTED);
	pace = (struct fdp_pace){ 0 };
	assert_false(fdp_pace_too_late(&pace, &wait, 5));
	assert_int_equal(pace.state, FDP_PACE_EVICTED);
	assert_int_equal(fdp_pace_may_join(&pace, 5), true);
}

/* Four walls in step; from now on the first takes so long to draw. */
static void slow_room(struct sim *s, enum fdp_slow policy, int64_t limit_ns, int64_t render_ns)
{
	sim_init(s, 4, 11);
	s->pace = (struct fdp_pace_params){ .policy = policy, .limit_ns = limit_ns, .frames = 20 };
	s->jitter_ns = 0;
	for (int i = 1; i < 4; i++)
		s->nodes[i].render_ns = 5 * SIM_MS;
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, 20);
	sim_assert_all_swapped(s, 20);
	s->nodes[0].render_ns = render_ns;
}

static void wait_for_slow(void **state)
{
	int64_t before;
	struct sim s;

	(void)state;
	/* Past the deadline of 33 ms, each frame: nobody is late, the room has its pace. */
	slow_room(&s, FDP_SLOW_WAIT, 0, 50 * SIM_MS);
	before = s.now_ns;
	sim_run_frames(&s, 19);
	assert_int_equal(s.paced[FDP_PACE_SLOW], 0);
	sim_run_frames(&s, 21);
	assert_true(s.now_ns - before >= 40 * 50 * SIM_MS);
	assert_true(s.now_ns - before <= 40 * 51 * SIM_MS + 4 * SIM_MS);
	assert_int_equal(s.late + s.evicted, 0);
	assert_int_equal(s.paced[FDP_PACE_SLOW], 1);
	assert_int_equal(sim_peer(&s, 0).pace, FDP_PACE_SLOW);
	assert_true(sim_peer(&s, 0).pace_since_ns > before);
	assert_int_equal(sim_peer(&s, 1).pace, FDP_PACE_IN_STEP);
	sim_assert_all_swapped(&s, 60);
	/* It keeps up again: full pace at once, and told after as many frames. */
	s.nodes[0].render_ns = 5 * SIM_MS;
	before = s.now_ns;
	sim_run_frames(&s, 19);
	assert_int_equal(s.paced[FDP_PACE_IN_STEP], 0);
	sim_run_frames(&s, 1);
	assert_int_equal(s.paced[FDP_PACE_IN_STEP], 1);
	assert_true(s.now_ns - before <= 20 * SIM_PERIOD_NS + 4 * SIM_MS);
	sim_assert_all_swapped(&s, 80);
	/* One that dies in mid-frame is waited for as long once, then as any dead one. */
	s.running = true;
	sim_run_ns(&s, 2 * SIM_MS);
	sim_kill_node(&s, 0);
	before = s.now_ns;
	sim_run_frames(&s, 3);
	assert_int_equal(s.evicted, 1);
	assert_true(s.now_ns - before <= FDP_PACE_WAIT_NS + 2 * SIM_DEADLINE_NS + SIM_PERIOD_NS);
	/* One that draws for ever: as long in each frame, and out after three. */
	sim_start_node(&s, 0);
	sim_run_frames(&s, 20);
	assert_int_equal(fdp_master_live(s.master), 4);
	s.nodes[0].render_ns = 100000 * SIM_MS;
	sim_run_frames(&s, 4);
	assert_int_equal(s.evicted, 2);
	sim_finish(&s);
}

/* Bounded: where it takes longer than the room waits at most, it is late. */
static void waits_no_longer(void **state)
{
	int64_t before;
	struct sim s;

	(void)state;
	slow_room(&s, FDP_SLOW_WAIT, 0, 90 * SIM_MS);
	s.master->pace.wait_most_ns = 80 * SIM_MS;
	before = s.now_ns;
	sim_run_frames(&s, 3);
	assert_in_range(s.now_ns - before, 3 * 80 * SIM_MS, 3 * 80 * SIM_MS + SIM_PERIOD_NS + 2 * SIM_MS);
	assert_int_equal(s.late, 3);
	assert_int_equal(s.evicted, 1);
	sim_finish(&s);
}

/* 20 ms a picture: the others have theirs each 16.7 ms, it has each second, of the right state. */
static void half_rate(void **state)
{
	struct fdp_counters before_out, out;
	uint64_t shown[2];
	int64_t before;
	struct sim s;

	(void)state;
	slow_room(&s, FDP_SLOW_HALF, SIM_PERIOD_NS, 20 * SIM_MS);
	before = s.now_ns;
	sim_run_frames(&s, 19);
	assert_int_equal(s.paced[FDP_PACE_HALF], 0);
	assert_true(s.now_ns - before >= 19 * 20 * SIM_MS); /* within the deadline: all wait for it */
	sim_run_frames(&s, 1);
	assert_int_equal(s.paced[FDP_PACE_HALF], 1);
	assert_int_equal(sim_peer(&s, 0).pace, FDP_PACE_HALF);
	sim_run_frames(&s, 2); /* the pair under way */
	shown[0] = s.nodes[0].swaps;
	shown[1] = s.nodes[1].swaps;
	before = s.now_ns;
	fdp_master_counters(s.master, &before_out);
	sim_run_frames(&s, 200);
	assert_true(s.now_ns - before <= 200 * SIM_PERIOD_NS + 2 * SIM_MS);
	assert_int_equal(s.nodes[1].swaps - shown[1], 200);
	assert_int_equal(s.nodes[0].swaps - shown[0], 100);
	assert_int_equal(s.late + s.evicted + s.left, 0);
	assert_int_equal(fdp_master_every_frame(s.master), 0xe);
	sim_assert_in_step(&s); /* it holds every frame's state */
	/* No snapshot, no repair, no question more than in step: the base is as near. */
	fdp_master_counters(s.master, &out);
	printf("# half rate: %.2f datagrams out a frame, %llu repairs\n",
	       (double)(out.datagrams_out - before_out.datagrams_out) / 200,
	       (unsigned long long)(out.repairs - before_out.repairs));
	assert_int_equal(out.repairs, before_out.repairs);
	assert_int_equal(out.datagrams_out - before_out.datagrams_out, 2 * 200);
	/* It keeps up again: 20 of its own frames, then every one. */
	s.nodes[0].render_ns = 5 * SIM_MS;
	sim_run_frames(&s, 39);
	assert_int_equal(s.paced[FDP_PACE_IN_STEP], 0);
	sim_run_frames(&s, 3);
	assert_int_equal(s.paced[FDP_PACE_IN_STEP], 1);
	shown[0] = s.nodes[0].swaps;
	sim_run_frames(&s, 50);
	assert_int_equal(s.nodes[0].swaps - shown[0], 50);
	assert_int_equal(fdp_master_every_frame(s.master), 0xf);
	assert_int_equal(s.late + s.evicted + s.left, 0);
	sim_assert_in_step(&s);
	sim_finish(&s);
}

/* What is too slow for half the rate costs the others a deadline every second frame at most, and goes. */
static void too_slow_for_half(void **state)
{
	int64_t before;
	struct sim s;

	(void)state;
	slow_room(&s, FDP_SLOW_HALF, SIM_PERIOD_NS, 45 * SIM_MS); /* two frames take 33, with the deadline 50 */
	before = s.now_ns;
	sim_run_frames(&s, 4); /* over the deadline: three in a row are enough */
	assert_int_equal(s.paced[FDP_PACE_HALF], 1);
	assert_int_equal(s.late, 3);
	sim_run_frames(&s, 40);
	assert_int_equal(s.late, 3); /* 45 ms are within a frame and a deadline */
	assert_int_equal(s.evicted, 0);
	s.nodes[0].render_ns = 60 * SIM_MS;
	before = s.now_ns;
	sim_run_frames(&s, 8);
	assert_int_equal(s.paced[FDP_PACE_EVICTED], 1);
	assert_int_equal(s.evicted, 1);
	assert_int_equal(s.late, 6);
	assert_true(s.now_ns - before <= 3 * (SIM_PERIOD_NS + SIM_DEADLINE_NS) + 5 * SIM_PERIOD_NS);
	sim_finish(&s);
}

/* Two at half the rate and datagrams lost: no state differs, nobody is left out. */
static void half_rate_in_loss(void **state)
{
	const uint64_t seed = sim_seed_of("half rate in loss");
	uint64_t shown[4];
	struct sim s;

	(void)state;
	for (uint64_t round = 0; round < 10; round++) {
		slow_room(&s, FDP_SLOW_HALF, SIM_PERIOD_NS, 20 * SIM_MS);
		s.random.state += seed + 2 * round;
		s.nodes[2].render_ns = 22 * SIM_MS;
		s.loss = 0.05;
		s.jitter_ns = 300000;
		s.duplicate = 0.02;
		s.multicast = true;
		sim_run_frames(&s, 60);
		assert_int_equal(fdp_master_every_frame(s.master), 0xa);
		for (int i = 0; i < 4; i++)
			shown[i] = s.nodes[i].swaps;
		sim_run_frames(&s, 400);
		for (int i = 0; i < 4; i++)
			/* one more: that of the frame before may come after the count */
			assert_in_range(s.nodes[i].swaps - shown[i], i % 2 ? 392 : 192, i % 2 ? 401 : 201);
		assert_int_equal(s.evicted + s.left, 0);
		s.loss = s.duplicate = 0;
		sim_run_frames(&s, 4);
		for (int i = 0; i < 4; i++)
			assert_int_equal(fdp_node_hash(s.nodes[i].node), fdp_master_hash(s.master));
		assert_int_equal(s.mismatches, 0);
		sim_finish(&s);
	}
}

/* At half the rate a node may die, leave, come back, lose its master: as any other. */
static void half_rate_comes_and_goes(void **state)
{
	struct sim s;

	(void)state;
	slow_room(&s, FDP_SLOW_HALF, SIM_PERIOD_NS, 20 * SIM_MS);
	sim_run_frames(&s, 30);
	assert_int_equal(sim_peer(&s, 0).pace, FDP_PACE_HALF);
	for (int i = 0; i < 6; i++) {
		/* At different moments of a pair. */
		s.running = true;
		sim_run_ns(&s, (1 + i * 7) * SIM_MS);
		sim_kill_node(&s, 0);
		sim_start_node(&s, 0);
		sim_run_frames(&s, 30);
		assert_int_equal(fdp_master_live(s.master), 4);
	}
	assert_int_equal(s.evicted, 0);
	sim_kill_node(&s, 0);
	sim_run_frames(&s, 8);
	assert_int_equal(s.evicted, 1);
	assert_int_equal(fdp_master_live(s.master), 3);
	sim_start_node(&s, 0);
	s.nodes[0].render_ns = 5 * SIM_MS;
	sim_run_frames(&s, 20);
	sim_assert_in_step(&s);
	assert_int_equal(sim_peer(&s, 0).pace, FDP_PACE_IN_STEP);
	sim_kill_master(&s);
	sim_start_master(&s);
	sim_assemble(&s);
	sim_run_frames(&s, 20);
	sim_assert_in_step(&s);
	sim_finish(&s);
}

/* Slow in two of three frames: never three late in a row, and yet out; longer out each time. */
static void evicted_for_slowness(void **state)
{
	uint64_t frames = 0;
	int64_t out_ns = 0;
	struct sim s;

	(void)state;
	slow_room(&s, FDP_SLOW_EVICT, SIM_PERIOD_NS, 0);
	while (!s.paced[FDP_PACE_EVICTED]) {
		s.nodes[0].render_ns = (frames++ % 3 ? 25 : 5) * SIM_MS;
		sim_run_frames(&s, 1);
		assert_true(frames < 100);
	}
	/* Each three frames count up one; the first that gets to twenty. */
	assert_in_range(frames, 3 * 18, 3 * 20);
	assert_int_equal(s.late, 0);
	assert_int_equal(s.evicted, 1);
	/* Back at once, and out for a second after the next time, then for two. */
	s.nodes[0].render_ns = 25 * SIM_MS;
	for (unsigned i = 0; i < 3; i++) {
		const uint64_t out = s.paced[FDP_PACE_EVICTED];
		const int64_t before = s.now_ns;

		while (s.joined < 4 + 1 + i)
			sim_run_frames(&s, 1);
		/* Seen at a frame's end; a node asks every 200 ms. */
		assert_in_range(s.now_ns - before, out_ns ? out_ns - 2 * SIM_PERIOD_NS : 0, out_ns + 250 * SIM_MS);
		while (s.paced[FDP_PACE_EVICTED] == out)
			sim_run_frames(&s, 1);
		out_ns = out_ns ? 2 * out_ns : FDP_PACE_OUT_NS;
		assert_true(sim_peer(&s, 0).out_until_ns > s.now_ns);
	}
	/* Cured, it comes back and stays. */
	s.nodes[0].render_ns = 5 * SIM_MS;
	sim_run_ns(&s, 5000 * SIM_MS);
	sim_run_frames(&s, 100);
	assert_int_equal(sim_peer(&s, 0).pace, FDP_PACE_IN_STEP);
	sim_assert_in_step(&s);
	sim_finish(&s);
}

/* A dead node is no slow one: out after three frames by every policy, and back at once. */
static void dead_is_not_slow(void **state)
{
	static const enum fdp_slow policies[] = { FDP_SLOW_EVICT, FDP_SLOW_WAIT, FDP_SLOW_HALF };

	(void)state;
	for (int i = 0; i < 3; i++) {
		struct sim s;
		int64_t before;

		slow_room(&s, policies[i], 0, 5 * SIM_MS);
		for (int k = 0; k < 4; k++) {
			const uint64_t joined = s.joined;

			sim_kill_node(&s, 0);
			before = s.now_ns;
			sim_run_frames(&s, 3);
			assert_true(s.now_ns - before <= 3 * SIM_DEADLINE_NS + SIM_PERIOD_NS + 2 * SIM_MS);
			assert_int_equal(s.evicted, k + 1);
			assert_int_equal(sim_peer(&s, 0).pace, FDP_PACE_IN_STEP);
			sim_start_node(&s, 0);
			sim_run_frames(&s, 20);
			assert_int_equal(s.joined, joined + 1);
		}
		assert_int_equal(s.paced[0] + s.paced[1] + s.paced[2] + s.paced[3], 0);
		sim_assert_in_step(&s);
		sim_finish(&s);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(complete_params),
		cmocka_unit_test(counts),
		cmocka_unit_test(relapses),
		cmocka_unit_test(out_for),
		cmocka_unit_test(too_late),
		cmocka_unit_test(wait_for_slow),
		cmocka_unit_test(waits_no_longer),
		cmocka_unit_test(half_rate),
		cmocka_unit_test(too_slow_for_half),
		cmocka_unit_test(half_rate_in_loss),
		cmocka_unit_test(half_rate_comes_and_goes),
		cmocka_unit_test(evicted_for_slowness),
		cmocka_unit_test(dead_is_not_slow),
	};

	if (getenv("GROTTO_TEST_FILTER"))
		cmocka_set_test_filter(getenv("GROTTO_TEST_FILTER"));
	return cmocka_run_group_tests(tests, NULL, NULL);
}
