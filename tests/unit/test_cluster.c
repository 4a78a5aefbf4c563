/* A whole cluster on a fake clock: one master, up to 64 nodes, a bad network. */
#include "cluster_sim.h"

static void assert_all_swapped(struct sim *s, uint64_t frames)
{
	for (size_t i = 0; i < s->node_count; i++) {
		assert_int_equal(s->nodes[i].frames, frames);
		assert_int_equal(s->nodes[i].swaps, frames);
		assert_int_equal(sim_peer(s, (int)i).swapped, frames);
		assert_int_equal(sim_peer(s, (int)i).state, FDP_PEER_LIVE);
		assert_int_equal(fdp_node_hash(s->nodes[i].node), fdp_master_hash(s->master));
	}
}

static void run_lossless(size_t nodes, bool multicast, size_t datagram_max)
{
	const uint64_t frames = 200;
	struct fdp_counters c;
	struct sim s;

	sim_init(&s, nodes, 7);
	s.multicast = multicast;
	s.datagram_max = datagram_max;
	s.lamps = true;
	sim_start_all(&s);
	sim_assemble(&s);
	assert_int_equal(s.joined, nodes);
	sim_run_frames(&s, frames);
	assert_all_swapped(&s, frames);
	assert_int_equal(s.late + s.evicted + s.mismatches + s.left, 0);
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lossless),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
