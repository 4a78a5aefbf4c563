/* Several masters on a fake clock: takeover, fencing, partitions, and who lies about epochs. */
#include "masters_sim.h"

#include "base/result.h"

#define RUNS_LONG 1000

static int runs(int usual)
{
	return getenv("GROTTO_LONG") ? RUNS_LONG : usual;
}

static uint64_t seed_of(const char *name)
{
	struct unit_random r = unit_random_start(name);

	return unit_random_u32(&r);
}

static void assert_one_room(const struct room *r, int ruler)
{
	assert_int_equal(room_ruler(r), ruler);
	assert_int_equal(room_driven(r, (unsigned)ruler), ROOM_NODES);
	for (int i = 0; i < ROOM_NODES; i++)
		assert_true(r->now_ns - r->nodes[i].shown_ns < 4 * ROOM_PERIOD_NS);
}

/* From the death of who rules to the first picture of who takes over, in frames. */
static double take_over(uint64_t seed, double loss, int *missing)
{
	struct room r;
	struct unit_random when = { 2 * seed + 1 };
	uint64_t frame;
	double frames;
	int64_t died_ns;

	room_start(&r, seed, 20);
	r.loss = loss;
	room_run(&r, (int64_t)((double)ROOM_PERIOD_NS * unit_random_range(&when, 0, 3)));
	died_ns = r.now_ns;
	frame = r.masters[0].frame;
	room_kill_master(&r, 0);
	r.watched_session = fdp_session_after(0) | UINT32_MAX; /* any of the next epoch */
	r.first_swap_ns = 0;
	room_run(&r, 300 * ROOM_MS);
	r.loss = 0;
	room_run(&r, 200 * ROOM_MS);
	assert_true(r.first_swap_ns > died_ns);
	frames = (double)(r.first_swap_ns - died_ns) / (double)ROOM_PERIOD_NS;
	if (!loss) {
		assert_one_room(&r, 1);
		assert_int_equal(r.masters[1].taken, 1);
		assert_int_equal(r.masters[2].taken + r.masters[2].called, 0);
		assert_int_equal(fdp_standby_follows(r.masters[2].standby), 1);
	}
	/* The state went on: not from the defaults, and from no frame that was shown before. */
	for (unsigned k = 1; k < ROOM_MASTERS; k++)
		if (r.masters[k].taken)
			assert_true(r.masters[k].frame > frame);
	for (int i = 0; i < ROOM_NODES; i++)
		*missing += r.nodes[i].lost > 0;
	room_finish(&r);
	return frames;
}

static void run_takeovers(double loss, double most)
{
	const uint64_t seed = seed_of("takeover");
	const int count = runs(100);
	double worst = 0, sum = 0;
	int missing = 0, late = 0;

	for (int i = 0; i < count; i++) {
		const double frames = take_over(seed + (uint64_t)i, loss, &missing);

		worst = frames > worst ? frames : worst;
		sum += frames;
		late += frames > ROOM_TAKEOVER;
	}
	printf("# takeover, loss %.0f %%: %.2f frames of 60 Hz in the mean, %.2f at most, %d of %d over %d; "
	       "%d nodes waited for their time-out\n",
	       100 * loss, sum / count, worst, late, count, ROOM_TAKEOVER, missing);
	assert_true(worst <= most);
	if (!loss)
		assert_int_equal(missing, 0);
}

static void takes_over(void **state)
{
	(void)state;
	run_takeovers(0, ROOM_TAKEOVER);
	run_takeovers(0.01, ROOM_TAKEOVER);
	run_takeovers(0.05, ROOM_TAKEOVER);
}

/* What it goes on from is to the bit what was followed. */
static void same_state(void **state)
{
	struct room r;
	uint64_t frame, hash;

	(void)state;
	room_start(&r, 3, 30);
	for (frame = r.masters[0].frame; r.masters[0].frame == frame;)
		room_run(&r, ROOM_MS / 10);
	hash = param_state_hash(r.masters[0].state, 0);
	frame = r.masters[0].frame;
	room_run(&r, 3 * ROOM_MS); /* the delta has arrived, the next frame has not begun */
	assert_int_equal(r.masters[0].frame, frame);
	for (unsigned k = 1; k < ROOM_MASTERS; k++) {
		uint64_t followed;

		assert_int_equal(param_state_hash(fdp_standby_state(r.masters[k].standby, &followed, NULL), 0), hash);
		assert_int_equal(followed, frame);
	}
	room_kill_master(&r, 0);
	room_run(&r, 500 * ROOM_MS);
	assert_one_room(&r, 1);
	/* What the new one has not set since is the old one's. */
	assert_int_equal(param_version(r.masters[1].state, PARAM_FRAME_TIME), r.masters[1].frame);
	room_finish(&r);
}

/* A standby that hears nobody, while the nodes have their master: calls in vain, and returns. */
static void cut_off(void **state)
{
	struct room r;

	(void)state;
	room_start(&r, 5, 20);
	room_cut(&r, ROOM_NODES, ROOM_NODES + 1, true);
	room_run(&r, 5000 * ROOM_MS);
	assert_one_room(&r, 0);
	assert_int_equal(r.masters[1].called, 1);
	assert_int_equal(r.masters[1].taken, 0);
	assert_int_equal(fdp_standby_role(r.masters[1].standby), FDP_ROLE_CALLS);
	for (int i = 0; i < ROOM_NODES; i++)
		assert_int_equal(r.nodes[i].joined, 1);
	room_cut(&r, ROOM_NODES, ROOM_NODES + 1, false);
	room_run(&r, 1000 * ROOM_MS);
	assert_one_room(&r, 0);
	assert_int_equal(fdp_standby_role(r.masters[1].standby), FDP_ROLE_FOLLOWS);
	assert_int_equal(fdp_standby_follows(r.masters[1].standby), 0);
	assert_int_equal(r.masters[0].yielded + r.masters[0].renewed, 0);
	for (int i = 0; i < ROOM_NODES; i++)
		assert_int_equal(r.nodes[i].joined, 1);
	room_finish(&r);
}

/* One that was stopped and goes on finds a higher session, drives nobody, and follows. */
static void comes_back(void **state)
{
	struct room r;
	uint64_t swaps;

	(void)state;
	room_start(&r, 6, 20);
	r.masters[0].hangs = true;
	room_run(&r, 2000 * ROOM_MS);
	assert_int_equal(room_driven(&r, 1), ROOM_NODES);
	r.masters[0].hangs = false;
	swaps = r.nodes[0].swaps;
	room_run(&r, 1000 * ROOM_MS);
	assert_one_room(&r, 1);
	assert_int_equal(r.masters[0].yielded, 1);
	assert_int_equal(fdp_standby_follows(r.masters[0].standby), 1);
	/* Nobody has missed a frame by its return. */
	assert_true(r.nodes[0].swaps >= swaps + 58);
	for (int i = 0; i < ROOM_NODES; i++)
		assert_int_equal(r.nodes[i].joined, 2);
	/* And it takes over in its turn. */
	room_kill_master(&r, 1);
	room_run(&r, 500 * ROOM_MS);
	assert_one_room(&r, 0);
	room_finish(&r);
}

/* A master that starts anew, not as a standby, while another rules: yields at once, drives nobody. */
static void starts_anew(void **state)
{
	struct room r;

	(void)state;
	room_start(&r, 7, 20);
	room_kill_master(&r, 0);
	room_run(&r, 500 * ROOM_MS);
	room_start_master(&r, 0, false);
	room_run(&r, 500 * ROOM_MS);
	assert_one_room(&r, 1);
	assert_int_equal(r.masters[0].yielded, 1);
	assert_int_equal(r.masters[0].frame, 0);
	for (int i = 0; i < ROOM_NODES; i++)
		assert_int_equal(r.nodes[i].joined, 2);
	room_finish(&r);
}

/* The same, but stopped while it listened, and for longer than that: it has what waited to look at first. */
static void stopped_while_it_listens(void **state)
{
	(void)state;
	for (int after_us = 0; after_us < 5000; after_us += 50) {
		struct room r;

		room_start(&r, 8, 20);
		room_kill_master(&r, 0);
		room_run(&r, 500 * ROOM_MS);
		room_start_master(&r, 0, false);
		room_run(&r, after_us * (ROOM_MS / 1000));
		r.masters[0].hangs = true;
		room_run(&r, 1500 * ROOM_MS);
		r.masters[0].hangs = false;
		room_run(&r, 500 * ROOM_MS); /* asserts that no tick is followed by one at once */
		assert_one_room(&r, 1);
		assert_int_equal(r.masters[0].yielded, 1);
		room_finish(&r);
	}
}

/*
 * A ruler that stutters loses the room to who followed it, not to one that starts anew at that
 * very time and knows nothing.
 */
static void stutters(void **state)
{
	struct room r;

	(void)state;
	room_start(&r, 12, 20);
	room_kill_master(&r, 2);
	r.masters[0].hangs = true;
	room_run(&r, 60 * ROOM_MS);
	room_start_master(&r, 2, false);
	room_run(&r, 30 * ROOM_MS);
	r.masters[0].hangs = false;
	room_run(&r, 2000 * ROOM_MS);
	assert_true(room_ruler(&r) == 0 || room_ruler(&r) == 1);
	assert_one_room(&r, room_ruler(&r));
	assert_int_equal(r.masters[2].renewed, 0);
	room_finish(&r);
}

/* All masters die; one that knows nothing starts: nodes tell it what it must be above. */
static void all_masters_die(void **state)
{
	struct room r;

	(void)state;
	for (unsigned again = 0; again < 2; again++) {
		room_start(&r, 8 + again, 20);
		for (unsigned k = 0; k < ROOM_MASTERS; k++) {
			room_kill_master(&r, k);
			room_run(&r, 400 * ROOM_MS);
		}
		room_start_master(&r, 2 * again, again);
		room_run(&r, 4000 * ROOM_MS);
		assert_one_room(&r, (int)(2 * again));
		assert_true(fdp_master_session(r.masters[2 * again].fdp) >> 32 >= 2);
		room_finish(&r);
	}
}

static void cut_in_two(struct room *r, unsigned with_first, bool cut)
{
	/* Master 0 and the nodes of the set on one side, all else on the other. */
	for (int a = 0; a < ROOM_ENDS; a++)
		for (int b = 0; b < a; b++) {
			const bool x = a < ROOM_NODES ? with_first >> a & 1 : a == ROOM_NODES;
			const bool y = b < ROOM_NODES ? with_first >> b & 1 : b == ROOM_NODES;

			if (x != y)
				room_cut(r, a, b, cut);
		}
}

/* Each wall has one master throughout (the simulation looks at every swap), and then all have one. */
static void partition(void **state)
{
	(void)state;
	for (unsigned set = 0; set < 1u << ROOM_NODES; set++) {
		const int first = __builtin_popcount(set);
		struct room r;

		room_start(&r, 20 + set, 20);
		cut_in_two(&r, set, true);
		room_run(&r, 3000 * ROOM_MS);
		assert_int_equal(room_driven(&r, 0), first);
		if (first < ROOM_NODES)
			assert_int_equal(room_driven(&r, 1), ROOM_NODES - first);
		for (int i = 0; i < ROOM_NODES; i++)
			assert_true(r.now_ns - r.nodes[i].shown_ns < 4 * ROOM_PERIOD_NS);
		cut_in_two(&r, set, false);
		room_run(&r, 3000 * ROOM_MS);
		assert_one_room(&r, first < ROOM_NODES ? 1 : 0);
		for (unsigned k = 0; k < ROOM_MASTERS; k++)
			assert_int_equal(fdp_standby_role(r.masters[k].standby),
					 (int)k == room_ruler(&r) ? FDP_ROLE_RULES : FDP_ROLE_FOLLOWS);
		room_finish(&r);
	}
}

/* Both standbys lose both the master and each other: whoever the nodes choose, one stays. */
static void two_standbys(void **state)
{
	const uint64_t seed = seed_of("two standbys");

	(void)state;
	for (int i = 0; i < 30; i++) {
		struct room r;

		room_start(&r, seed + (uint64_t)i, 20);
		room_cut(&r, ROOM_NODES + 1, ROOM_NODES + 2, true);
		room_cut(&r, 0, ROOM_NODES + 1, true);
		room_cut(&r, 1, ROOM_NODES + 1, i & 1);
		room_cut(&r, 3, ROOM_NODES + 2, true);
		room_kill_master(&r, 0);
		room_run(&r, 2000 * ROOM_MS);
		assert_int_equal(room_rulers(&r), 2);
		memset(r.cut, 0, sizeof r.cut);
		room_run(&r, 2000 * ROOM_MS);
		assert_true(room_ruler(&r) > 0);
		assert_one_room(&r, room_ruler(&r));
		room_finish(&r);
	}
}

/* LEAVE: the standby does not wait for the silence. */
static void master_leaves(void **state)
{
	struct room r;
	int64_t before;

	(void)state;
	room_start(&r, 9, 20);
	before = r.now_ns;
	r.watched_session = fdp_master_session(r.masters[0].fdp);
	r.first_swap_ns = 0;
	fdp_master_leave(r.masters[0].fdp, r.now_ns);
	room_kill_master(&r, 0);
	room_run(&r, 500 * ROOM_MS);
	assert_one_room(&r, 1);
	printf("# takeover after LEAVE: %.2f frames\n", (double)(r.first_swap_ns - before) / (double)ROOM_PERIOD_NS);
	assert_true(r.first_swap_ns - before < ROOM_TAKEOVER * ROOM_PERIOD_NS);
	room_finish(&r);
}

static size_t forge(uint8_t *bytes, unsigned master, enum fdp_kind kind, uint64_t session, bool keyed)
{
	const uint8_t good[FDP_KEY_BYTES] = { 1, 2, 3 }, bad[FDP_KEY_BYTES] = { 9 };
	struct fdp_header h = {
		.version = FDP_VERSION, .kind = kind, .sender = fdp_master_sender(master), .count = 1,
		.session = session, .sequence = 1, .message = 1,
	};

	if (kind == FDP_BEACON) {
		h.payload_len = (uint16_t)fdp_beacon_encode(bytes + FDP_HEADER_BYTES, FDP_BODY_MAX);
	} else {
		struct fdp_welcome w = { .first_sequence = 1, .deadline_us = 1, .probe_us = 1 };

		h.payload_len = (uint16_t)fdp_welcome_encode(&w, bytes + FDP_HEADER_BYTES, FDP_BODY_MAX);
	}
	h.message_len = h.plain_len = h.payload_len;
	fdp_wire_seal(&h, keyed ? good : bad, bytes);
	return (size_t)FDP_HEADER_BYTES + h.payload_len;
}

/*
 * Datagrams that claim an epoch: without the key, and with it, as a recording of
 * a life before could be. Nothing moves, for nobody behind them answers.
 */
static void claims(void **state)
{
	static const enum fdp_kind kinds[] = { FDP_BEACON, FDP_WELCOME };
	uint8_t bytes[FDP_DATAGRAM_MIN];
	uint64_t session, swaps;
	struct room r;

	(void)state;
	room_start(&r, 10, 20);
	session = fdp_master_session(r.masters[0].fdp);
	swaps = r.nodes[0].swaps;
	for (int i = 0; i < 600; i++) {
		const uint64_t claim = i % 3 == 0 ? UINT64_MAX : i % 3 == 1 ? session + 1 : session - 1;
		const size_t len = forge(bytes, (unsigned)i % FDP_MAX_MASTERS, kinds[i & 1], claim, i & 2);

		for (int to = 0; to < ROOM_ENDS; to++)
			room_inject(&r, to, bytes, len);
		room_run(&r, 5 * ROOM_MS);
	}
	assert_one_room(&r, 0);
	assert_int_equal(fdp_master_session(r.masters[0].fdp), session);
	assert_int_equal(r.masters[0].yielded + r.masters[0].renewed, 0);
	assert_true(r.nodes[0].swaps >= swaps + 175);
	for (unsigned k = 1; k < ROOM_MASTERS; k++) {
		assert_int_equal(r.masters[k].called, 0);
		assert_int_equal(fdp_standby_follows(r.masters[k].standby), 0);
	}
	/* Nor do they hold a takeover up. */
	room_kill_master(&r, 0);
	for (int i = 0; i < 60; i++) {
		const size_t len = forge(bytes, 0, FDP_BEACON, session - (uint64_t)(i & 1), true);

		for (int to = 0; to < ROOM_ENDS; to++)
			room_inject(&r, to, bytes, len);
		room_run(&r, 5 * ROOM_MS);
	}
	assert_one_room(&r, 1);
	room_finish(&r);
}

/*
 * Recordings of a life before, when epochs had come further: whoever throws them in holds no key,
 * and holds no takeover up.
 */
static void old_calls(void **state)
{
	uint8_t bytes[FDP_DATAGRAM_MIN];
	struct room r;

	(void)state;
	for (unsigned sender = 0; sender < ROOM_MASTERS; sender++) {
		int64_t before;

		room_start(&r, 12 + sender, 20);
		before = r.now_ns;
		r.watched_session = fdp_master_session(r.masters[0].fdp);
		r.first_swap_ns = 0;
		room_kill_master(&r, 0);
		for (int i = 0; i < 1000; i++) {
			const size_t len = forge(bytes, sender, FDP_BEACON, r.watched_session + (UINT64_C(50) << 32), true);

			for (int to = 0; to < ROOM_NODES; to++)
				room_inject(&r, to, bytes, len);
			room_run(&r, ROOM_MS);
		}
		room_run(&r, 3000 * ROOM_MS);
		printf("# old calls of master %u: takeover after %.2f frames\n", sender,
		       (double)(r.first_swap_ns - before) / (double)ROOM_PERIOD_NS);
		assert_one_room(&r, 1);
		assert_true(r.first_swap_ns - before < ROOM_TAKEOVER * ROOM_PERIOD_NS);
		room_finish(&r);
	}
}

/* The active master dies when a standby has just found it again, and has no state of it yet. */
static void dies_before_the_snapshot(void **state)
{
	struct room r;
	uint64_t frame;

	(void)state;
	room_start(&r, 15, 20);
	room_kill_master(&r, 2);
	room_cut(&r, ROOM_NODES, ROOM_NODES + 1, true);
	room_run(&r, 3000 * ROOM_MS);
	assert_int_equal(fdp_standby_follows(r.masters[1].standby), -1);
	room_cut(&r, ROOM_NODES, ROOM_NODES + 1, false);
	for (int i = 0; i < 100000 && fdp_standby_follows(r.masters[1].standby) < 0; i++)
		room_run(&r, ROOM_MS / 50);
	assert_int_equal(fdp_standby_follows(r.masters[1].standby), 0);
	frame = r.masters[0].frame;
	room_kill_master(&r, 0);
	room_run(&r, 1000 * ROOM_MS);
	assert_int_equal(room_ruler(&r), 1);
	printf("# died in frame %llu, a second later frame %llu\n", (unsigned long long)frame,
	       (unsigned long long)r.masters[1].frame);
	assert_true(r.masters[1].frame < frame + 120);
	room_finish(&r);
}

/* Deaths, hangs, cuts and returns at random, with loss; then all is mended. */
static void turmoil(void **state)
{
	const uint64_t seed = seed_of("turmoil");
	const int count = runs(20);
	uint64_t taken = 0, yielded = 0, renewed = 0, swaps = 0;

	(void)state;
	for (int i = 0; i < count; i++) {
		struct room r;

		room_start(&r, seed + (uint64_t)i, 10);
		r.loss = i % 2 ? 0.02 : 0;
		for (int step = 0; step < 30; step++) {
			const unsigned what = unit_random_u32(&r.random) % 8;
			const unsigned k = unit_random_u32(&r.random) % ROOM_MASTERS;
			const int a = (int)(unit_random_u32(&r.random) % ROOM_ENDS);
			const int b = (int)(unit_random_u32(&r.random) % ROOM_ENDS);
			struct room_master *m = &r.masters[k];

			taken += m->taken, yielded += m->yielded, renewed += m->renewed;
			m->taken = m->yielded = m->renewed = 0;
			if (what == 0 && m->fdp)
				room_kill_master(&r, k);
			else if (what <= 2 && !m->fdp)
				room_start_master(&r, k, unit_random_u32(&r.random) & 1);
			else if (what <= 4)
				m->hangs = !m->hangs;
			else if (what <= 6 && a != b)
				room_cut(&r, a, b, !r.cut[a][b]);
			room_run(&r, (int64_t)(unit_random_u32(&r.random) % 600) * ROOM_MS);
		}
		memset(r.cut, 0, sizeof r.cut);
		r.loss = 0;
		for (unsigned k = 0; k < ROOM_MASTERS; k++) {
			r.masters[k].hangs = false;
			if (!r.masters[k].fdp)
				room_start_master(&r, k, true);
		}
		room_run(&r, 8000 * ROOM_MS);
		assert_true(room_ruler(&r) >= 0);
		assert_one_room(&r, room_ruler(&r));
		for (int n = 0; n < ROOM_NODES; n++)
			swaps += r.nodes[n].swaps;
		room_finish(&r);
	}
	printf("# turmoil: %d rooms, %llu takeovers, %llu yielded, %llu rose above; %llu pictures, none out of order\n",
	       count, (unsigned long long)taken, (unsigned long long)yielded, (unsigned long long)renewed,
	       (unsigned long long)swaps);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(takes_over),	   cmocka_unit_test(same_state),
		cmocka_unit_test(cut_off),	   cmocka_unit_test(comes_back),
		cmocka_unit_test(starts_anew),	   cmocka_unit_test(stutters),
		cmocka_unit_test(stopped_while_it_listens),
		cmocka_unit_test(all_masters_die),
		cmocka_unit_test(partition),	   cmocka_unit_test(two_standbys),
		cmocka_unit_test(master_leaves),   cmocka_unit_test(claims),
		cmocka_unit_test(dies_before_the_snapshot),
		cmocka_unit_test(old_calls),
		cmocka_unit_test(turmoil),
	};

	if (getenv("GROTTO_TEST_FILTER"))
		cmocka_set_test_filter(getenv("GROTTO_TEST_FILTER"));
	return cmocka_run_group_tests(tests, NULL, NULL);
}
