/* What is on its way to a node stays below what its socket holds; what does not hurry gives way. */
#include "share_room.h"

#include "base/result.h"
#include "protocol/window.h"

static void counts(void **state)
{
	struct fdp_window w = { .room = 0 };

	(void)state;
	fdp_window_start(&w, 500);
	assert_int_equal(fdp_window_under_way(&w, 500), 0);
	assert_true(fdp_window_fits(&w, 500, UINT32_MAX, false)); /* one at a time always */
	w.own = 100;
	assert_int_equal(fdp_window_under_way(&w, 700), 300);
	assert_true(fdp_window_fits(&w, 700, FDP_WINDOW_UNASKED / 16 * 15 - 300, true));
	assert_false(fdp_window_fits(&w, 700, FDP_WINDOW_UNASKED / 16 * 15 - 299, true));
	w.room = 1600;
	assert_true(fdp_window_fits(&w, 700, 900, false));
	assert_false(fdp_window_fits(&w, 700, 901, false));
	assert_true(fdp_window_fits(&w, 700, 1200, true));
	assert_false(fdp_window_fits(&w, 700, 1201, true));
}

static void takes(void **state)
{
	struct fdp_window w;

	(void)state;
	fdp_window_start(&w, 0);
	w.own = 10;
	fdp_window_mark_frame(&w, 0, 7);
	w.own = 20;
	fdp_window_mark_frame(&w, 0, 7); /* sent again: the first counts */
	fdp_window_mark_time(&w, 5, 1234);
	w.own = 40;
	fdp_window_heard(&w, 6, 0);
	fdp_window_heard(&w, 7 + FDP_WINDOW_MARKS, 99);
	assert_int_equal(fdp_window_under_way(&w, 5), 45);
	fdp_window_heard(&w, 7, 0);
	assert_int_equal(fdp_window_under_way(&w, 5), 35);
	fdp_window_heard(&w, 0, 1234);
	assert_int_equal(fdp_window_under_way(&w, 5), 20);
	fdp_window_heard(&w, 7, 0); /* never back */
	assert_int_equal(fdp_window_under_way(&w, 5), 20);
	for (unsigned i = 1; i <= FDP_WINDOW_MARKS; i++)
		fdp_window_mark_time(&w, 5, i);
	fdp_window_heard(&w, 0, 1234); /* forgotten */
	assert_int_equal(fdp_window_under_way(&w, 5), 20);
	fdp_window_heard(&w, 0, FDP_WINDOW_MARKS);
	assert_int_equal(fdp_window_under_way(&w, 5), 0);
}

static void vitals(void **state)
{
	const struct fdp_vitals v = { 212992, 2, { { "gi", 1200 }, { "a name of 15 ch", UINT32_MAX } } };
	uint8_t bytes[256], again[256];
	struct fdp_vitals out;
	size_t len = fdp_vitals_encode(&v, bytes, sizeof bytes);

	(void)state;
	assert_int_equal(len, 4 + 1 + 2 * 20);
	for (size_t n = 0; n < len; n++) {
		uint8_t *exact = unit_copy(bytes, n);

		assert_int_equal(fdp_vitals_encode(&v, again, n), 0);
		assert_int_equal(fdp_vitals_decode(exact, n, &out), GR_ERR_FORMAT);
		free(exact);
	}
	assert_int_equal(fdp_vitals_decode(bytes, len, &out), GR_OK);
	assert_int_equal(out.receive_bytes, 212992);
	assert_int_equal(out.count, 2);
	assert_string_equal(fdp_vitals_longest(&out)->name, "a name of 15 ch");
	assert_int_equal(fdp_vitals_encode(&out, again, sizeof again), len);
	assert_memory_equal(again, bytes, len);
	assert_int_equal(fdp_vitals_decode(bytes, len + 1, &out), GR_ERR_FORMAT);
	bytes[4] = FDP_VITALS_STAGES + 1;
	assert_int_equal(fdp_vitals_decode(bytes, len, &out), GR_ERR_FORMAT);
	bytes[4] = 2;
	bytes[5 + 3] = 'x'; /* after the name's end */
	assert_int_equal(fdp_vitals_decode(bytes, len, &out), GR_ERR_FORMAT);
	bytes[5 + 3] = 0;
	bytes[5] = 0x1b;
	assert_int_equal(fdp_vitals_decode(bytes, len, &out), GR_ERR_FORMAT);
	out.count = 0;
	assert_null(fdp_vitals_longest(&out));
}

/* Told at once by who has joined, then each second; the master has the last. */
static void vitals_are_told(void **state)
{
	const struct fdp_vitals_stage stages[] = { { "gi", 7000 }, { "shade", 2000 } };
	struct sim s;

	(void)state;
	sim_init(&s, 2, 3);
	s.receive_bytes = 425984;
	sim_start_all(&s);
	sim_assemble(&s);
	sim_run_frames(&s, 2);
	assert_int_equal(sim_peer(&s, 0).vitals.receive_bytes, 425984);
	assert_int_equal(sim_peer(&s, 0).vitals.count, 0);
	fdp_node_stages(s.nodes[0].node, stages, 2);
	sim_run_frames(&s, 65);
	assert_int_equal(sim_peer(&s, 0).vitals.count, 2);
	assert_string_equal(fdp_vitals_longest(&s.master->peers[0].status.vitals)->name, "gi");
	assert_int_equal(sim_peer(&s, 1).vitals.count, 0);
	sim_finish(&s);
}

/* What a socket that nobody reads would have to hold. */
struct socket {
	int node;
	uint64_t held, most;
	bool asleep;
};

static bool hold(struct sim *s, int to, uint8_t *bytes, size_t len)
{
	struct socket *socket = s->tamper_ctx;

	(void)bytes;
	if (to == socket->node && socket->asleep) {
		socket->held += fdp_window_cost(len);
		socket->most = socket->held > socket->most ? socket->held : socket->most;
	}
	return true;
}

/*
 * A wall stops in the middle of a light of which each frame has 1 MiB for it: its
 * socket of 208 KiB is never too small until it is left out, and when it reads again it
 * is in step again. Without the window it would have had to hold several MiB.
 */
static uint64_t run_stuck(bool window)
{
	struct socket socket = { .node = 1 };
	struct share_room room;
	struct sim *s = &room.sim;

	share_room_init(&room, 4, 1 << 20, 5);
	s->multicast = false;
	s->receive_bytes = window ? FDP_WINDOW_UNASKED : UINT32_MAX;
	s->evict_frames = 1000;
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, 70); /* it has told how much it holds */
	s->tamper = hold;
	s->tamper_ctx = &socket;
	socket.asleep = s->nodes[1].asleep = true;
	sim_run_frames(s, 8);
	assert_int_equal(s->evicted, 0);
	socket.asleep = s->nodes[1].asleep = false;
	sim_run_frames(s, 2);
	s->tamper = NULL;
	room.still_after = s->frame;
	sim_run_frames(s, 600);
	assert_int_equal(s->evicted, 0);
	sim_assert_in_step(s);
	share_room_assert_same(&room);
	sim_finish(s);
	return socket.most;
}

static void never_overflows(void **state)
{
	const uint64_t with = run_stuck(true), without = run_stuck(false);

	(void)state;
	printf("# a wall that stops for 8 frames: its socket holds %.0f KiB with the window, %.0f without, of %d\n",
	       (double)with / 1024, (double)without / 1024, FDP_WINDOW_UNASKED / 1024);
	assert_true(with <= FDP_WINDOW_UNASKED);
	assert_true(without > 4 * FDP_WINDOW_UNASKED);
}

/* What hurries passes while there is room, and is withheld, not lost, when there is none. */
static void deltas_are_withheld(void **state)
{
	struct socket socket = { .node = 0 };
	struct sim s;

	(void)state;
	sim_init(&s, 3, 7);
	s.multicast = false;
	s.lamps = true;
	s.evict_frames = 100;
	s.receive_bytes = 16384;
	sim_start_all(&s);
	sim_assemble(&s);
	sim_run_frames(&s, 70);
	sim_assert_in_step(&s);
	s.tamper = hold;
	s.tamper_ctx = &socket;
	socket.asleep = s.nodes[0].asleep = true;
	sim_run_frames(&s, 6);
	assert_false(fdp_master_has_room(s.master, 0, 520, true));
	sim_run_frames(&s, 2);
	printf("# a wall that stops for 8 frames: its socket of 16 KiB holds %.1f KiB\n", (double)socket.most / 1024);
	/* Nothing but the one PROBE of each frame, which its last sixteenth is for. */
	assert_true(socket.most <= 16384 + 8 * fdp_window_cost(FDP_HEADER_BYTES + FDP_BODY_MAX));
	sim_run_frames(&s, 20);
	/* Here what was sent while it slept is gone: it is found by the next frame's PROBE. */
	socket.asleep = s.nodes[0].asleep = false;
	sim_run_frames(&s, 20);
	sim_assert_in_step(&s);
	assert_int_equal(s.nodes[0].last_swap, s.frame);
	sim_finish(&s);
}

/*
 * A wall comes back to a room of ten at 60 Hz on a link of 1 Gbit/s: the light is divided
 * anew, so that all of its 8 MiB goes to each. From then on until the wall has it: deltas,
 * beside those of the same room with nothing beside them.
 */
static double p99_ms(bool multicast, bool bulk, int64_t *out_whole_ns, uint64_t *out_late)
{
	struct share_room room;
	struct sim *s = &room.sim;
	const uint64_t frames = 120;
	int64_t begun_ns;
	bool whole = false;
	double p99;

	share_room_init(&room, 10, FDP_SHARE_MAX, 17);
	room.still_after = 2;
	s->multicast = multicast;
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, 200);
	share_room_assert_same(&room);
	s->byte_ns = 8;
	if (bulk) {
		sim_kill_node(s, 1);
		memset(&room.lights[1], 0, sizeof room.lights[1]);
		sim_run_frames(s, 6); /* it is missed, and left out */
		sim_start_node(s, 1);
	}
	s->delivery_count = s->late = 0;
	begun_ns = s->now_ns;
	for (uint64_t i = 0; bulk ? !whole : i < frames; i++) {
		assert_true(i < 1000);
		sim_run_frames(s, 1);
		whole = room.lights[1].count == 10;
		for (unsigned k = 0; k < 10; k++)
			whole = whole && room.lights[1].now[k] && room.lights[1].now[k] == room.made[k];
	}
	*out_whole_ns = s->now_ns - begun_ns;
	*out_late = s->late;
	p99 = (double)sim_delivery_quantile(s, 0.99) * 1e-6;
	printf("# %s, %s: deltas p50 %.3f p99 %.3f max %.3f ms, %llu late%s", multicast ? "multicast" : "unicast",
	       bulk ? "8 MiB of light to a wall that comes back" : "nothing beside the frames",
	       (double)sim_delivery_quantile(s, 0.5) * 1e-6, p99, (double)sim_delivery_quantile(s, 1) * 1e-6,
	       (unsigned long long)s->late, bulk ? "" : "\n");
	if (bulk)
		printf("; whole after %.0f ms\n", (double)*out_whole_ns * 1e-6);
	sim_assert_in_step(s);
	sim_finish(s);
	return p99;
}

static void bulk_gives_way(void **state)
{
	(void)state;
	for (int multicast = 0; multicast < 2; multicast++) {
		int64_t whole_ns, none_ns;
		uint64_t late, none_late;
		const double without = p99_ms(multicast, false, &none_ns, &none_late);
		const double with = p99_ms(multicast, true, &whole_ns, &late);

		assert_true(with <= 1.05 * without);
		assert_int_equal(late, 0);
		assert_true(whole_ns < (multicast ? 1000 : 3000) * SIM_MS);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(counts),
		cmocka_unit_test(takes),
		cmocka_unit_test(vitals),
		cmocka_unit_test(vitals_are_told),
		cmocka_unit_test(never_overflows),
		cmocka_unit_test(deltas_are_withheld),
		cmocka_unit_test(bulk_gives_way),
	};

	if (getenv("GROTTO_TEST_FILTER"))
		cmocka_set_test_filter(getenv("GROTTO_TEST_FILTER"));
	return cmocka_run_group_tests(tests, NULL, NULL);
}
