/* A whole cluster on a fake clock: one master, up to 64 nodes, a bad network. */
#include "cluster_sim.h"

#include "base/result.h"

static void run_lossless(size_t nodes, bool multicast, size_t datagram_max)
{
	const uint64_t frames = 200;
	struct fdp_counters c;
	struct sim s;

	sim_init(&s, nodes, 7);
	s.multicast = multicast;
	s.datagram_max = datagram_max;
	s.lamps = true;
	s.jitter_ns = 0; /* nothing overtakes, so that nothing looks lost */
	sim_start_all(&s);
	sim_assemble(&s);
	assert_int_equal(s.joined, nodes);
	sim_run_frames(&s, frames);
	sim_assert_all_swapped(&s, frames);
	assert_int_equal(s.late + s.evicted + s.left, 0);
	fdp_master_counters(s.master, &c);
	assert_int_equal(c.repairs, 0);
	assert_int_equal(c.bad_auth + c.bad_format + c.bad_replay + c.bad_session, 0);
	printf("# lossless, %zu nodes, %s, datagrams of %zu: %.1f datagrams and %.0f bytes out a frame\n",
	       nodes, multicast ? "multicast" : "unicast", datagram_max,
	       (double)c.datagrams_out / (double)frames, (double)c.bytes_out / (double)frames);
	sim_finish(&s);
}

static void lossless(void **state)
{
	static const size_t counts[] = { 1, 4, 10, 64 };

	(void)state;
	for (size_t i = 0; i < 4; i++) {
		run_lossless(counts[i], true, 1472);
		run_lossless(counts[i], false, 1472);
	}
	run_lossless(4, true, FDP_DATAGRAM_MIN);
	run_lossless(4, false, FDP_DATAGRAM_MIN);
}

/*
 * What a frame costs on the wire: all that a node hears, and says, in UDP payload.
 * The bounds are for what it hears.
 */
static void run_bytes(const char *what, size_t nodes, bool still, double most)
{
	const uint64_t frames = 1200;
	struct fdp_counters before, out, in = { 0 };
	double heard;
	struct sim s;

	sim_init(&s, nodes, 7);
	s.still = still;
	s.wand = !still;
	sim_start_all(&s);
	sim_assemble(&s);
	sim_run_frames(&s, 600); /* all know their clocks by now */
	fdp_master_counters(s.master, &before);
	sim_run_frames(&s, frames);
	fdp_master_counters(s.master, &out);
	in.bytes_in = out.bytes_in - before.bytes_in;
	heard = (double)(out.bytes_out - before.bytes_out) / (double)frames;
	printf("# bytes a frame, %s, %zu nodes: %.1f to all, %.1f from each\n", what, nodes, heard,
	       (double)in.bytes_in / (double)frames / (double)nodes);
	assert_true(heard <= most);
	sim_assert_in_step(&s);
	sim_finish(&s);
}

static void bytes(void **state)
{
	(void)state;
	run_bytes("nothing moves", 4, true, 200);
	run_bytes("head and wand move", 4, false, 270);
	run_bytes("nothing moves", 10, true, 235);
	run_bytes("head and wand move", 10, false, 300);
}

/* Loss, reordering and duplication: nothing differs, nobody is left out, few frames are late. */
static void run_lossy(size_t nodes, double loss, bool multicast, size_t datagram_max, uint64_t seed)
{
	const uint64_t frames = getenv("GROTTO_LONG") ? 6000 : 300;
	uint64_t applied = 0, swaps = 0;
	struct fdp_counters c;
	struct sim s;

	sim_init(&s, nodes, seed);
	s.multicast = multicast;
	s.datagram_max = datagram_max;
	s.lamps = true;
	s.loss = loss;
	s.duplicate = 0.01;
	s.jitter_ns = 200000; /* four times the delay: datagrams overtake each other */
	s.evict_frames = 10;
	sim_start_all(&s);
	sim_assemble(&s);
	sim_run_frames(&s, frames);
	s.loss = 0;
	s.jitter_ns = 0;
	sim_run_frames(&s, 2);
	sim_assert_in_step(&s);
	assert_int_equal(s.evicted, 0);
	for (size_t i = 0; i < nodes; i++) {
		applied += s.nodes[i].frames;
		swaps += s.nodes[i].swaps;
	}
	fdp_master_counters(s.master, &c);
	printf("# loss %.0f %%, %zu nodes, %s, datagrams of %zu: delivery p50 %.3f p99 %.3f max %.3f ms; "
	       "applied %.4f, swapped %.4f of all; %llu barriers missed; %.2f repairs and "
	       "%.1f datagrams out a frame\n",
	       loss * 100, nodes, multicast ? "multicast" : "unicast", datagram_max,
	       (double)sim_delivery_quantile(&s, 0.5) * 1e-6,
	       (double)sim_delivery_quantile(&s, 0.99) * 1e-6,
	       (double)sim_delivery_quantile(&s, 1) * 1e-6,
	       (double)applied / (double)((frames + 2) * nodes),
	       (double)swaps / (double)((frames + 2) * nodes), (unsigned long long)s.late,
	       (double)c.repairs / (double)frames, (double)c.datagrams_out / (double)frames);
	assert_true((double)applied >= 0.98 * (double)((frames + 2) * nodes));
	/* A loss costs round trips, not a probe interval; nothing takes a frame at 120 Hz. */
	assert_true(sim_delivery_quantile(&s, 0.99) < 700000);
	assert_true(sim_delivery_quantile(&s, 1) < 8 * SIM_MS);
	sim_finish(&s);
}

static void lossy(void **state)
{
	const uint64_t seed = sim_seed_of("lossy");
	static const double losses[] = { 0, 0.01, 0.05 };

	(void)state;
	for (size_t i = 0; i < 3; i++) {
		run_lossy(1, losses[i], true, 1472, seed);
		run_lossy(4, losses[i], true, 1472, seed);
		run_lossy(4, losses[i], false, 1472, seed);
		run_lossy(4, losses[i], true, FDP_DATAGRAM_MIN, seed);
		run_lossy(4, losses[i], false, FDP_DATAGRAM_MIN, seed);
		run_lossy(10, losses[i], true, 1472, seed);
		run_lossy(64, losses[i], true, 1472, seed);
	}
}

/* The room goes on within evict_frames frames; a restart is back at a frame boundary. */
static void dead_node(void **state)
{
	int64_t before;
	uint64_t joined;
	struct sim s;

	(void)state;
	sim_start_running(&s, 4);
	sim_kill_node(&s, 2);
	before = s.now_ns;
	sim_run_frames(&s, 3);
	assert_int_equal(s.late, 3);
	assert_int_equal(s.evicted, 1);
	assert_int_equal(sim_peer(&s, 2).state, FDP_PEER_DEAD);
	assert_int_equal(fdp_master_live(s.master), 3);
	assert_true(s.now_ns - before <= 3 * SIM_DEADLINE_NS + SIM_PERIOD_NS + 2 * SIM_MS);
	before = s.now_ns;
	sim_run_frames(&s, 60);
	assert_true(s.now_ns - before <= 61 * SIM_PERIOD_NS);
	assert_int_equal(s.late, 3);
	joined = s.joined;
	s.nodes[2].frames = s.nodes[2].swaps = 0;
	sim_start_node(&s, 2);
	sim_run_frames(&s, 60);
	assert_int_equal(s.joined, joined + 1);
	sim_assert_in_step(&s);
	/* From the join on, not one frame is missed. */
	assert_int_equal(s.nodes[2].frames, s.nodes[2].swaps);
	assert_true(s.nodes[2].frames >= 55);
	assert_int_equal(s.late, 3);
	for (int i = 0; i < 4; i++)
		assert_int_equal(s.nodes[i].last_frame, s.frame);
	sim_finish(&s);
}

/* A node that comes back before anybody missed it: the old one goes, the new one joins. */
static void quick_restart(void **state)
{
	struct sim s;

	(void)state;
	sim_start_running(&s, 4);
	s.running = true;
	sim_run_ns(&s, 5 * SIM_MS);
	sim_kill_node(&s, 1);
	s.nodes[1].frames = s.nodes[1].swaps = 0;
	sim_start_node(&s, 1);
	sim_run_frames(&s, 20);
	assert_int_equal(s.late + s.evicted, 0);
	assert_int_equal(s.left, 1);
	assert_int_equal(s.joined, 5);
	sim_assert_in_step(&s);
	assert_int_equal(s.nodes[1].frames, s.nodes[1].swaps);
	sim_finish(&s);
}

static void partition(void **state)
{
	struct sim s;

	(void)state;
	sim_start_running(&s, 4);
	/* Shorter than the patience of the room: one frame late, no new join. */
	s.nodes[3].cut = true;
	sim_run_frames(&s, 1);
	s.nodes[3].cut = false;
	sim_run_frames(&s, 5);
	assert_int_equal(s.late, 1);
	assert_int_equal(s.joined, 4);
	sim_assert_in_step(&s);
	/* Longer: left out; it finds that by itself when it hears the master again. */
	s.nodes[3].cut = true;
	sim_run_frames(&s, 10);
	assert_int_equal(s.evicted, 1);
	assert_int_equal(sim_peer(&s, 3).state, FDP_PEER_DEAD);
	s.nodes[3].cut = false;
	sim_run_frames(&s, 20);
	assert_int_equal(s.joined, 5);
	assert_int_equal(s.nodes[3].lost, 1);
	sim_assert_in_step(&s);
	/* Everybody cut off: the master goes on alone, all come back. */
	for (int i = 0; i < 4; i++)
		s.nodes[i].cut = true;
	sim_run_frames(&s, 150);
	assert_int_equal(fdp_master_live(s.master), 0);
	for (int i = 0; i < 4; i++)
		s.nodes[i].cut = false;
	sim_run_frames(&s, 40);
	sim_assert_in_step(&s);
	sim_finish(&s);
}

static void unicast_eviction_is_noticed(void **state)
{
	struct sim s;

	(void)state;
	sim_init(&s, 3, 3);
	s.multicast = false;
	sim_start_all(&s);
	sim_assemble(&s);
	sim_run_frames(&s, 5);
	s.nodes[0].cut = true;
	sim_run_frames(&s, 6);
	s.nodes[0].cut = false;
	sim_run_frames(&s, 30);
	assert_int_equal(s.evicted, 1);
	sim_assert_in_step(&s);
	sim_finish(&s);
}

static void master_restart(void **state)
{
	int64_t before;
	struct sim s;

	(void)state;
	sim_start_running(&s, 4);
	sim_kill_master(&s);
	sim_run_ns(&s, 100 * SIM_MS);
	sim_start_master(&s);
	before = s.now_ns;
	s.running = false;
	sim_assemble(&s);
	printf("# master restarted: all four joined after %.1f ms\n", (double)(s.now_ns - before) * 1e-6);
	assert_true(s.now_ns - before < 500 * SIM_MS);
	for (int i = 0; i < 4; i++)
		s.nodes[i].frames = s.nodes[i].swaps = 0;
	sim_run_frames(&s, 50);
	sim_assert_all_swapped(&s, 50);
	/* Gone for longer than the nodes' patience. */
	sim_kill_master(&s);
	sim_run_ns(&s, 5000 * SIM_MS);
	for (int i = 0; i < 4; i++) {
		assert_int_equal(s.nodes[i].lost, 1);
		assert_int_equal(fdp_node_status(s.nodes[i].node), FDP_NODE_ASKING);
	}
	sim_start_master(&s);
	sim_assemble(&s);
	sim_run_frames(&s, 5);
	sim_assert_in_step(&s);
	sim_finish(&s);
}

static void nodes_before_master(void **state)
{
	struct sim s;

	(void)state;
	sim_init(&s, 3, 5);
	for (int i = 0; i < 3; i++)
		sim_start_node(&s, i);
	sim_run_ns(&s, 3000 * SIM_MS);
	sim_start_master(&s);
	sim_assemble(&s);
	/* A pause before the first frame: everybody stays. */
	sim_run_ns(&s, 10000 * SIM_MS);
	assert_int_equal(fdp_master_present(s.master), 3);
	sim_run_frames(&s, 30);
	sim_assert_all_swapped(&s, 30);
	/* And in the middle. */
	sim_run_ns(&s, 10000 * SIM_MS);
	sim_run_frames(&s, 30);
	sim_assert_all_swapped(&s, 60);
	sim_finish(&s);
}

/* One datagram in three is lost: everybody gets in all the same, and soon. */
static void joining_in_loss(void **state)
{
	const uint64_t seed = sim_seed_of("joining in loss");
	int64_t worst = 0;

	(void)state;
	for (uint64_t round = 0; round < 50; round++) {
		int64_t before;
		struct sim s;

		sim_init(&s, 4, seed + round);
		s.loss = 1.0 / 3;
		s.datagram_max = round & 1 ? FDP_DATAGRAM_MIN : 1472;
		before = s.now_ns;
		sim_start_all(&s);
		sim_assemble(&s);
		worst = s.now_ns - before > worst ? s.now_ns - before : worst;
		s.loss = 0;
		sim_run_frames(&s, 3);
		sim_assert_all_swapped(&s, 3);
		sim_finish(&s);
	}
	printf("# four nodes, a third of all datagrams lost: joined within %.0f ms in 50 runs\n",
	       (double)worst * 1e-6);
}

/* A snapshot that was of no use, or whose ACK was lost, is of use when it comes again. */
static bool lose_first_acks(struct sim *s, int to, uint8_t *bytes, size_t len)
{
	unsigned *left = s->tamper_ctx;

	(void)len;
	if (to != -1 || bytes[5] != FDP_ACK || !*left)
		return true;
	--*left;
	return false;
}

static void lost_snapshot_ack(void **state)
{
	unsigned left = 3;
	struct sim s;
	int64_t before;

	(void)state;
	sim_init(&s, 1, 4);
	s.tamper = lose_first_acks;
	s.tamper_ctx = &left;
	before = s.now_ns;
	sim_start_all(&s);
	sim_assemble(&s);
	assert_int_equal(left, 0);
	assert_true(s.now_ns - before < 4 * SIM_DEADLINE_NS / 8 + SIM_MS); /* a probe interval each */
	sim_finish(&s);
}

static void leaving(void **state)
{
	struct sim s;

	(void)state;
	sim_start_running(&s, 3);
	fdp_node_leave(s.nodes[1].node, s.now_ns);
	sim_kill_node(&s, 1);
	sim_run_frames(&s, 5);
	assert_int_equal(s.left, 1);
	assert_int_equal(s.late + s.evicted, 0);
	assert_int_equal(sim_peer(&s, 1).state, FDP_PEER_ABSENT);
	assert_int_equal(fdp_master_live(s.master), 2);
	fdp_master_leave(s.master, s.now_ns);
	sim_run_ns(&s, SIM_MS);
	assert_int_equal(s.nodes[0].left, 1);
	assert_int_equal(fdp_node_status(s.nodes[0].node), FDP_NODE_ASKING);
	sim_finish(&s);
}

/* A node that is too slow marks itself late, and is left out; a patient room keeps it. */
static void slow_node(void **state)
{
	int64_t before;
	struct sim s;

	(void)state;
	sim_start_running(&s, 4);
	s.nodes[0].render_ns = 40 * SIM_MS;
	sim_run_frames(&s, 4);
	assert_int_equal(s.evicted, 1);
	sim_finish(&s);

	sim_init(&s, 4, 11);
	s.evict_frames = 1000;
	sim_start_all(&s);
	sim_assemble(&s);
	s.nodes[0].render_ns = 20 * SIM_MS; /* slower than the pace, within the deadline */
	before = s.now_ns;
	sim_run_frames(&s, 50);
	sim_assert_all_swapped(&s, 50);
	assert_true(s.now_ns - before >= 50 * 20 * SIM_MS);
	s.nodes[0].render_ns = 40 * SIM_MS;
	sim_run_frames(&s, 20);
	assert_int_equal(s.late, 20);
	assert_int_equal(sim_peer(&s, 0).state, FDP_PEER_LATE);
	assert_int_equal(s.nodes[1].swaps, 70);
	s.nodes[0].render_ns = 0;
	sim_run_frames(&s, 2);
	sim_assert_in_step(&s);
	sim_finish(&s);
}

/* Nodes come and go, datagrams get lost, the master too: the room always finds together. */
static void storm(void **state)
{
	const uint64_t seed = sim_seed_of("storm");
	const unsigned rounds = getenv("GROTTO_LONG") ? 200 : 12;

	(void)state;
	for (unsigned round = 0; round < rounds; round++) {
		const size_t nodes = 2 + round % 7;
		struct sim s;

		sim_init(&s, nodes, seed + round);
		s.loss = 0.03;
		s.duplicate = 0.02;
		s.jitter_ns = 300000;
		s.multicast = round & 1;
		s.lamps = true;
		s.datagram_max = round & 2 ? FDP_DATAGRAM_MIN : 1472;
		sim_start_all(&s);
		for (int step = 0; step < 30; step++) {
			struct sim_node *n = &s.nodes[unit_random_u32(&s.random) % nodes];
			const uint32_t what = unit_random_u32(&s.random) % 10;

			sim_run_frames(&s, 1 + unit_random_u32(&s.random) % 8);
			if (what < 4 && n->node)
				sim_kill_node(&s, n->index);
			else if (what < 8 && !n->node && n->sim)
				sim_start_node(&s, n->index);
			else if (what == 8)
				n->cut = !n->cut;
			else if (what == 9 && unit_random_u32(&s.random) % 3 == 0) {
				sim_kill_master(&s);
				sim_start_master(&s);
			}
		}
		s.loss = s.duplicate = 0;
		for (size_t i = 0; i < nodes; i++) {
			s.nodes[i].cut = false;
			if (!s.nodes[i].node)
				sim_start_node(&s, (int)i);
		}
		sim_run_ns(&s, 1000 * SIM_MS);
		sim_run_frames(&s, 60);
		for (size_t i = 0; i < nodes; i++)
			assert_int_equal(s.nodes[i].last_swap, s.frame);
		sim_assert_in_step(&s);
		sim_finish(&s);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lossless),
		cmocka_unit_test(bytes),
		cmocka_unit_test(lossy),
		cmocka_unit_test(dead_node),
		cmocka_unit_test(quick_restart),
		cmocka_unit_test(partition),
		cmocka_unit_test(unicast_eviction_is_noticed),
		cmocka_unit_test(master_restart),
		cmocka_unit_test(nodes_before_master),
		cmocka_unit_test(joining_in_loss),
		cmocka_unit_test(lost_snapshot_ack),
		cmocka_unit_test(leaving),
		cmocka_unit_test(slow_node),
		cmocka_unit_test(storm),
	};

	if (getenv("GROTTO_TEST_FILTER"))
		cmocka_set_test_filter(getenv("GROTTO_TEST_FILTER"));
	return cmocka_run_group_tests(tests, NULL, NULL);
}
