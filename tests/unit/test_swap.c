/*
 * When the walls change their picture: told to, or at a time. Clocks that
 * drift apart, a network that holds things up; measured by true time.
 */
#include "cluster_sim.h"

#include "base/result.h"

#include <math.h>

static uint64_t frames(void)
{
	return getenv("GROTTO_LONG") ? 20000 : 400;
}

static void wind_clocks(struct sim *s)
{
	for (size_t i = 0; i < s->node_count; i++) {
		s->nodes[i].clock_ns = llrint(unit_random_range(&s->random, -9e11, 1e17));
		s->nodes[i].clock_ppm = unit_random_range(&s->random, -100, 100);
	}
}

/* Live, and with clocks that have had time to be found. */
static void start(struct sim *s, size_t nodes, enum fdp_swap swap, bool multicast, uint64_t seed)
{
	sim_init(s, nodes, seed);
	s->swap = swap;
	s->multicast = multicast;
	wind_clocks(s);
	sim_start_all(s);
	sim_assemble(s);
}

static void settle(struct sim *s)
{
	sim_run_frames(s, 100);
	s->spread_count = 0;
	s->scheduled = 0;
}

static uint64_t seed_of(const char *name)
{
	struct unit_random r = unit_random_start(name);

	return unit_random_u32(&r);
}

static uint64_t late_swaps(const struct sim *s)
{
	uint64_t late = 0;

	for (size_t i = 0; i < s->node_count; i++)
		late += sim_peer(s, (int)i).swaps_late;
	return late;
}

struct weather {
	size_t nodes;
	bool multicast;
	int64_t jitter_us;
	double loss;
	double most_us; /* spread with a time to swap at, p99 */
};

static double run_weather(const struct weather *w, enum fdp_swap swap, uint64_t seed)
{
	struct sim s;
	double p50, p99;

	start(&s, w->nodes, swap, w->multicast, seed);
	settle(&s);
	s.jitter_ns = w->jitter_us * 1000;
	s.loss = w->loss;
	s.evict_frames = 20;
	settle(&s);
	sim_run_frames(&s, frames());
	p50 = (double)sim_spread_quantile(&s, 0.5) * 1e-3;
	p99 = (double)sim_spread_quantile(&s, 0.99) * 1e-3;
	printf("# %2zu nodes, %s, queues to %3lld us, %g %% lost, %-9s: spread p50 %7.2f p99 %7.2f us of %zu frames; "
	       "%llu with a time, %llu SWAPs after it\n", w->nodes, w->multicast ? "multicast" : "unicast",
	       (long long)w->jitter_us, w->loss * 100, swap == FDP_SWAP_MESSAGE ? "told" : "at a time", p50,
	       p99, s.spread_count, (unsigned long long)s.scheduled, (unsigned long long)late_swaps(&s));
	assert_true(s.spread_count > frames() * 9 / 10);
	if (swap == FDP_SWAP_MESSAGE)
		assert_int_equal(s.scheduled, 0);
	else
		assert_true(s.scheduled > frames() * 9 / 10);
	sim_finish(&s);
	return p99;
}

static void spread(void **state)
{
	static const struct weather weathers[] = {
		{ 4, true, 20, 0, 5 },	    { 4, false, 20, 0, 5 },   { 10, true, 20, 0, 7 },
		{ 64, true, 20, 0, 15 },    { 4, true, 200, 0, 40 },  { 4, false, 200, 0, 40 },
		{ 10, false, 200, 0, 50 },
	};
	const uint64_t seed = seed_of("spread");

	(void)state;
	for (size_t i = 0; i < sizeof weathers / sizeof *weathers; i++) {
		const double told = run_weather(&weathers[i], FDP_SWAP_MESSAGE, seed);
		const double timed = run_weather(&weathers[i], FDP_SWAP_AUTO, seed);

		assert_true(timed < told);
		assert_true(timed <= weathers[i].most_us);
	}
}

/* A SWAP that is lost is late: its wall swaps as soon as it can, and the rest at their time. */
static void lost_swaps(void **state)
{
	const struct weather w = { 4, false, 20, 0.05, 0 };

	(void)state;
	run_weather(&w, FDP_SWAP_MESSAGE, seed_of("lost swaps"));
	run_weather(&w, FDP_SWAP_AUTO, seed_of("lost swaps"));
}

/* All nodes' clocks are off alike when the ways there are: the walls are together all the same. */
static void slow_way_there(void **state)
{
	struct sim s;

	(void)state;
	start(&s, 4, FDP_SWAP_AUTO, true, seed_of("slow way"));
	s.slow_ns = 300000;
	sim_run_frames(&s, 600); /* the swift ways of the start are out of the window */
	settle(&s);
	sim_run_frames(&s, 200);
	printf("# the way there 300 us longer: spread p99 %.2f us\n",
	       (double)sim_spread_quantile(&s, 0.99) * 1e-3);
	assert_int_equal(s.scheduled, 200);
	assert_true(sim_spread_quantile(&s, 0.99) < 8000);
	sim_finish(&s);
}

/* No clock to rely on: told, all of them. */
static void far_away(void **state)
{
	struct sim s;

	(void)state;
	start(&s, 3, FDP_SWAP_AUTO, true, 5);
	s.delay_ns = 3 * SIM_MS;
	sim_run_frames(&s, 600);
	settle(&s);
	sim_run_frames(&s, 50);
	assert_int_equal(s.scheduled, 0);
	assert_int_equal(s.late, 0);
	sim_finish(&s);
	/* But by name a time is given to all; who cannot rely on it does as told. */
	start(&s, 3, FDP_SWAP_SCHEDULED, true, 5);
	settle(&s);
	sim_run_frames(&s, 50);
	assert_int_equal(s.scheduled, 50);
	sim_finish(&s);
}

/*
 * A machine that slept: its clock stood still. So short that nobody left it
 * out, and so long that it has to join again. And one whose clock leapt, for
 * the master's stood still.
 */
static void a_nap(void **state)
{
	static const int64_t naps_ms[] = { 20, 90, 60000, -20, -900000 };
	struct sim s;

	(void)state;
	for (size_t i = 0; i < sizeof naps_ms / sizeof *naps_ms; i++) {
		start(&s, 4, FDP_SWAP_AUTO, true, seed_of("nap"));
		s.evict_frames = 20;
		settle(&s);
		sim_run_frames(&s, 100);
		s.nodes[1].asleep = naps_ms[i] > 0;
		s.running = true;
		sim_run_ns(&s, naps_ms[i] > 0 ? naps_ms[i] * SIM_MS : 0);
		s.nodes[1].asleep = false;
		s.nodes[1].clock_ns -= naps_ms[i] * SIM_MS;
		sim_run_frames(&s, 20);
		settle(&s);
		sim_run_frames(&s, 100);
		printf("# a nap of %lld ms: left out %llu times, then spread p99 %.2f us\n",
		       (long long)naps_ms[i], (unsigned long long)s.evicted,
		       (double)sim_spread_quantile(&s, 0.99) * 1e-3);
		assert_int_equal(s.scheduled, 100);
		assert_int_equal(s.spread_count, 100);
		assert_true(sim_spread_quantile(&s, 0.99) < 6000);
		sim_finish(&s);
	}
}

/* A joiner has no clock yet: until it has, all are told; the others lose no frame. */
static void a_joiner(void **state)
{
	uint64_t swaps[3];
	struct sim s;

	(void)state;
	start(&s, 3, FDP_SWAP_AUTO, true, seed_of("joiner"));
	settle(&s);
	sim_kill_node(&s, 2);
	sim_run_frames(&s, 30);
	s.scheduled = 0;
	for (int i = 0; i < 2; i++)
		swaps[i] = s.nodes[i].swaps;
	sim_start_node(&s, 2);
	sim_run_frames(&s, 60);
	printf("# a joiner: %llu of 60 frames were told\n", (unsigned long long)(60 - s.scheduled));
	assert_true(s.scheduled >= 40 && s.scheduled < 60);
	for (int i = 0; i < 2; i++)
		assert_int_equal(s.nodes[i].swaps - swaps[i], 60);
	sim_finish(&s);
}

/* What the master says of each clock is what it is. */
static void status(void **state)
{
	struct sim s;
	double most = 0;

	(void)state;
	start(&s, 10, FDP_SWAP_AUTO, true, seed_of("status"));
	sim_run_frames(&s, 600);
	for (size_t i = 0; i < s.node_count; i++) {
		const struct sim_node *n = &s.nodes[i];
		struct fdp_clock_estimate e;
		const int64_t truth = sim_node_time(n) - s.now_ns;

		fdp_master_clock(s.master, i, s.now_ns, &e);
		assert_true(e.known);
		assert_true(llabs(e.offset_ns - truth) <= e.error_ns);
		assert_true(fabs(e.skew_ppm - n->clock_ppm) < 1);
		most = fmax(most, fabs((double)(e.offset_ns - truth)));
	}
	printf("# 10 nodes: offsets off by at most %.2f us\n", most * 1e-3);
	assert_true(most < 5000);
	sim_finish(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(spread),   cmocka_unit_test(lost_swaps),
		cmocka_unit_test(slow_way_there), cmocka_unit_test(far_away),
		cmocka_unit_test(a_nap),    cmocka_unit_test(a_joiner),
		cmocka_unit_test(status),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
