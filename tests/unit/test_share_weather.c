/* The light that nodes share out, while datagrams get lost and overtake, and nodes come and go. */
#include "share_room.h"

static struct fdp_share_counts node_counts(const struct share_room *room)
{
	struct fdp_share_counts sum = { 0 };

	for (size_t i = 0; i < room->sim.node_count; i++) {
		struct fdp_share_counts c;

		fdp_node_share(room->sim.nodes[i].node, &c);
		sum.sent += c.sent;
		sum.bytes_sent += c.bytes_sent;
		sum.received += c.received;
		sum.late += c.late;
		sum.lost += c.lost;
		sum.asked += c.asked;
		sum.repairs += c.repairs;
	}
	return sum;
}

static void run_weather(size_t nodes, size_t bytes, bool multicast, double loss, bool rough)
{
	const uint64_t frames = getenv("GROTTO_LONG") ? 3000 : nodes > 10 ? 40 : 150;
	struct fdp_share_counts c, master;
	struct fdp_counters wire;
	uint64_t due = 0, on_time = 0;
	struct share_room room;
	struct sim *s = &room.sim;

	share_room_init(&room, nodes, bytes, 5);
	s->multicast = multicast;
	s->jitter_ns = rough ? 200000 : 0;
	s->loss = loss;
	s->duplicate = rough ? 0.01 : 0;
	s->evict_frames = 10;
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, frames);
	for (size_t i = 0; i < nodes; i++) {
		due += room.lights[i].due;
		on_time += room.lights[i].on_time;
	}
	c = node_counts(&room);
	fdp_master_share(s->master, &master);
	fdp_master_counters(s->master, &wire);
	printf("# %zu nodes, %zu bytes of light, %s, loss %.0f %%%s: %.4f in time; late %llu, lost %llu "
	       "of %llu; slices %.0f bytes in and %.0f out a frame, repairs %.2f pieces; %llu barriers missed\n",
	       nodes, bytes, multicast ? "multicast" : "unicast", loss * 100,
	       rough ? ", overtaking" : "", due ? (double)on_time / (double)due : 0,
	       (unsigned long long)c.late, (unsigned long long)c.lost,
	       (unsigned long long)(c.sent * (nodes - 1)), (double)c.bytes_sent / (double)frames,
	       (double)master.bytes_sent / (double)frames,
	       (double)(master.repairs + c.repairs) / (double)frames, (unsigned long long)s->late);
	if (!loss && !rough) {
		assert_int_equal(on_time, due);
		assert_int_equal(c.late + c.lost + c.asked + master.asked, 0);
		assert_int_equal(c.sent, frames * nodes);
	}
	assert_true((double)on_time >= (loss > 0.02 ? 0.98 : loss > 0 ? 0.99 : 1) * (double)due);
	assert_int_equal(s->evicted + s->mismatches, 0);
	/* The light comes to rest, in the same weather: everybody ends with the same. */
	room.still_after = s->frame;
	sim_run_frames(s, 60);
	share_room_assert_same(&room);
	sim_finish(s);
}

static void weather(void **state)
{
	(void)state;
	for (int rough = 0; rough < 2; rough++) {
		run_weather(2, 17000, true, 0, rough);
		run_weather(4, 17000, true, 0, rough);
		run_weather(4, 17000, false, 0, rough);
		run_weather(10, 50000, true, 0, rough);
		run_weather(64, 50000, true, 0, rough);
	}
	run_weather(4, 17000, true, 0.01, false);
	run_weather(4, 17000, true, 0.05, false);
	run_weather(4, 17000, false, 0.05, false);
	run_weather(4, 17000, true, 0.01, true);
	run_weather(4, 17000, false, 0.01, true);
	run_weather(4, 17000, true, 0.05, true);
	run_weather(4, 17000, false, 0.05, true);
	run_weather(4, 400000, false, 0.01, true);
	run_weather(10, 50000, true, 0.05, true);
}

/* Nodes come and go while datagrams get lost: all end with the same light. */
static void storm(void **state)
{
	struct unit_random seeds = unit_random_start("share storm");
	const uint64_t seed = unit_random_u32(&seeds);
	const unsigned rounds = getenv("GROTTO_LONG") ? 200 : 12;

	(void)state;
	for (unsigned round = 0; round < rounds; round++) {
		const size_t nodes = 2 + round % 6;
		struct share_room room;
		struct sim *s = &room.sim;

		share_room_init(&room, nodes, 9000, seed + round);
		s->loss = 0.03;
		s->duplicate = 0.02;
		s->jitter_ns = 300000;
		s->multicast = round & 1;
		s->datagram_max = round & 2 ? FDP_DATAGRAM_MIN : 1472;
		sim_start_all(s);
		for (int step = 0; step < 20; step++) {
			struct sim_node *n = &s->nodes[unit_random_u32(&s->random) % nodes];
			const uint32_t what = unit_random_u32(&s->random) % 10;

			sim_run_frames(s, 1 + unit_random_u32(&s->random) % 8);
			if (what < 4 && n->node) {
				sim_kill_node(s, n->index);
				memset(&room.lights[n->index], 0, sizeof *room.lights);
			} else if (what < 8 && !n->node) {
				sim_start_node(s, n->index);
			} else if (what == 8) {
				n->cut = !n->cut;
			} else if (what == 9) {
				sim_kill_master(s);
				sim_start_master(s);
				memset(room.made, 0, sizeof room.made);
			}
		}
		for (size_t i = 0; i < nodes; i++) {
			s->nodes[i].cut = false;
			if (!s->nodes[i].node)
				sim_start_node(s, (int)i);
		}
		s->loss = s->duplicate = 0;
		sim_run_ns(s, 1000 * SIM_MS);
		sim_run_frames(s, 60);
		s->loss = 0.03;
		sim_run_frames(s, 10);
		room.still_after = s->frame;
		sim_run_frames(s, 60);
		share_room_assert_same(&room);
		sim_finish(s);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(weather),
		cmocka_unit_test(storm),
	};

	if (getenv("GROTTO_TEST_FILTER"))
		cmocka_set_test_filter(getenv("GROTTO_TEST_FILTER"));
	return cmocka_run_group_tests(tests, NULL, NULL);
}
