/* Two clocks on a third: what the estimate says against what is. */
#include "unit.h"

#include "protocol/clock_offset.h"

#include <math.h>

#define NS_PER_MS INT64_C(1000000)
#define NS_PER_S INT64_C(1000000000)

struct world {
	struct unit_random random;
	int64_t t_ns; /* true time */
	double ours_ppm, peer_ppm;
	int64_t ours_ns, peer_ns; /* at t = 0 */
	int64_t delay_ns, asymmetry_ns; /* least one-way delay; the way there takes so much more */
	double jitter_ns;               /* mean of the queue's exponential delay, each way */
	double loss;
	int64_t hold_ns; /* what the peer takes to answer, at most */
	struct fdp_clock clock;
};

static int64_t ours(const struct world *w, int64_t t_ns)
{
	return w->ours_ns + t_ns + llrint(w->ours_ppm * 1e-6 * (double)t_ns);
}

static int64_t peer(const struct world *w, int64_t t_ns)
{
	return w->peer_ns + t_ns + llrint(w->peer_ppm * 1e-6 * (double)t_ns);
}

static int64_t delay(struct world *w, int64_t extra_ns)
{
	const double u = unit_random_range(&w->random, 1e-9, 1);

	return w->delay_ns + extra_ns + llrint(-w->jitter_ns * log(u));
}

static struct fdp_exchange exchange(struct world *w)
{
	const int64_t there = w->t_ns + delay(w, w->asymmetry_ns);
	const int64_t answer = there + llrint(unit_random_range(&w->random, 0, (double)w->hold_ns));
	const int64_t back = answer + delay(w, 0);

	return (struct fdp_exchange){ ours(w, w->t_ns), peer(w, there), peer(w, answer), ours(w, back) };
}

static struct world make_world(struct unit_random *r)
{
	struct world w = {
		.random = { (uint64_t)unit_random_u32(r) << 32 | unit_random_u32(r) },
		.t_ns = 0,
		.ours_ppm = unit_random_range(r, -50, 50),
		.peer_ppm = unit_random_range(r, -50, 50),
		.ours_ns = llrint(unit_random_range(r, 1, 1e6)) * NS_PER_S,
		.peer_ns = llrint(unit_random_range(r, 1, 1e6)) * NS_PER_S,
		.delay_ns = 40000,
		.jitter_ns = 20000,
		.hold_ns = 20 * NS_PER_MS,
	};

	fdp_clock_reset(&w.clock);
	return w;
}

static int64_t error_now(const struct world *w)
{
	const int64_t mine = ours(w, w->t_ns);

	return fdp_clock_to_peer(&w->clock, mine) - peer(w, w->t_ns);
}

static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/* Runs so long; errors between samples too. Each must be inside the stated bound. */
static size_t run(struct world *w, int64_t period_ns, int64_t length_ns, double *errors, size_t room)
{
	const int64_t end_ns = w->t_ns + length_ns;
	size_t n = 0;

	for (; w->t_ns < end_ns; w->t_ns += period_ns) {
		const struct fdp_exchange e = exchange(w);
		struct fdp_clock_estimate estimate;

		fdp_clock_estimate(&w->clock, ours(w, w->t_ns), &estimate);
		if (estimate.known) {
			assert_true(llabs(error_now(w)) <= estimate.error_ns);
			if (n < room)
				errors[n++] = fabs((double)error_now(w)) * 1e-3;
		}
		if (unit_random_range(&w->random, 0, 1) >= w->loss)
			fdp_clock_take(&w->clock, &e);
	}
	return n;
}

struct figures {
	double p50, p99, most;
};

static struct figures figures(double *errors, size_t n)
{
	assert_true(n > 0);
	qsort(errors, n, sizeof *errors, compare);
	return (struct figures){ errors[n / 2], errors[n * 99 / 100], errors[n - 1] };
}

#define ROOM 20000
static double errors[ROOM];

/* Every rate at which the room asks, drifts, jitter and loss: the error in us. */
static void sweep(void **state)
{
	static const struct {
		double hz, jitter_us, loss, p50_us, p99_us;
	} cases[] = {
		{ 60, 5, 0, 0.4, 1.5 },	  { 60, 20, 0, 1, 3 },	  { 60, 20, 0.05, 1, 3 },
		{ 60, 200, 0.05, 8, 35 }, { 24, 20, 0.05, 1.2, 6 }, { 4, 20, 0.05, 4, 25 },
	};
	struct unit_random r = unit_random_start("clock sweep");

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		size_t n = 0, steps = 0;
		struct figures f;

		for (int round = 0; round < 20; round++) {
			struct world w = make_world(&r);

			w.jitter_ns = cases[i].jitter_us * 1e3;
			w.loss = cases[i].loss;
			run(&w, llrint(1e9 / cases[i].hz), 2 * NS_PER_S, errors + n, 0);
			n += run(&w, llrint(1e9 / cases[i].hz), 12 * NS_PER_S, errors + n, ROOM - n);
			steps += w.clock.steps;
		}
		f = figures(errors, n);
		printf("# %g Hz, queues of %g us, %g %% lost: off by p50 %.2f p99 %.2f most %.2f us (%zu estimates)\n",
		       cases[i].hz, cases[i].jitter_us, cases[i].loss * 100, f.p50, f.p99, f.most, n);
		assert_int_equal(steps, 0);
		assert_true(f.p50 <= cases[i].p50_us);
		assert_true(f.p99 <= cases[i].p99_us);
	}
}

/* The skew is found, and the first seconds are honest about not knowing it yet. */
static void skew(void **state)
{
	struct unit_random r = unit_random_start("clock skew");
	double most = 0;

	(void)state;
	for (int round = 0; round < 50; round++) {
		struct world w = make_world(&r);
		struct fdp_clock_estimate estimate;
		double ppm;

		w.ours_ppm = unit_random_range(&r, -100, 100);
		w.peer_ppm = unit_random_range(&r, -100, 100);
		run(&w, 16666667, 10 * NS_PER_S, errors, ROOM);
		fdp_clock_estimate(&w.clock, ours(&w, w.t_ns), &estimate);
		assert_true(estimate.known);
		ppm = ((1 + w.peer_ppm * 1e-6) / (1 + w.ours_ppm * 1e-6) - 1) * 1e6;
		most = fmax(most, fabs(estimate.skew_ppm - ppm));
	}
	printf("# skew of up to 200 ppm after 10 s: off by at most %.2f ppm\n", most);
	assert_true(most < 1);
}

/* Half of what one way takes longer is in the estimate, and in the bound. */
static void asymmetric_ways(void **state)
{
	struct unit_random r = unit_random_start("clock asymmetry");

	(void)state;
	for (int64_t us = 0; us <= 400; us += 100) {
		struct world w = make_world(&r);
		struct figures f;

		w.asymmetry_ns = us * 1000;
		w.jitter_ns = 5000;
		run(&w, 16666667, 2 * NS_PER_S, errors, 0);
		f = figures(errors, run(&w, 16666667, 10 * NS_PER_S, errors, ROOM));
		printf("# one way takes %3lld us longer: off by p50 %.1f us\n", (long long)us, f.p50);
		assert_true(fabs(f.p50 - (double)us / 2) < 2);
	}
}

/* Suspended, either of them: the clock is found anew within the third exchange. */
static void steps(void **state)
{
	struct unit_random r = unit_random_start("clock steps");

	(void)state;
	for (int round = 0; round < 40; round++) {
		struct world w = make_world(&r);
		const int64_t step = llrint(pow(10, unit_random_range(&r, 6, 12)));
		struct fdp_exchange e;

		run(&w, 16666667, 5 * NS_PER_S, errors, ROOM);
		w.peer_ns += round & 1 ? step : -step; /* we slept; the peer did */
		for (int i = 0; i < 2; i++) {
			e = exchange(&w);
			assert_false(fdp_clock_take(&w.clock, &e));
			w.t_ns += 16666667;
		}
		for (int i = 0; i < 2 + FDP_CLOCK_LEAST; i++) {
			e = exchange(&w);
			fdp_clock_take(&w.clock, &e);
			w.t_ns += 16666667;
		}
		assert_int_equal(w.clock.steps, 1);
		assert_true(llabs(error_now(&w)) < 200000);
		run(&w, 16666667, 3 * NS_PER_S, errors, ROOM);
		assert_int_equal(w.clock.steps, 1);
	}
}

/* Late, twice and in any order: an exchange is an exchange. */
static void reordered(void **state)
{
	struct unit_random r = unit_random_start("clock order");
	struct world w = make_world(&r);
	struct fdp_exchange pending[32];
	size_t count = 0;

	(void)state;
	for (int i = 0; i < 1200; i++, w.t_ns += 16666667) {
		if (count < 32)
			pending[count++] = exchange(&w);
		for (int k = 0; k < 2 && count && unit_random_u32(&r) & 1; k++) {
			const size_t pick = unit_random_u32(&r) % count;

			fdp_clock_take(&w.clock, &pending[pick]);
			if (unit_random_u32(&r) % 8)
				pending[pick] = pending[--count];
		}
	}
	printf("# any order: off by %.2f us\n", (double)llabs(error_now(&w)) * 1e-3);
	assert_int_equal(w.clock.steps, 0);
	assert_true(llabs(error_now(&w)) < 10000);
}

/* Stamps are a peer's word: any of them may be anything. */
static void nonsense(void **state)
{
	struct unit_random r = unit_random_start("clock nonsense");
	struct world w = make_world(&r);

	(void)state;
	run(&w, 16666667, 3 * NS_PER_S, errors, ROOM);
	for (int i = 0; i < 200000; i++) {
		struct fdp_exchange e = exchange(&w);
		int64_t *stamp = (int64_t *[]){ &e.left_ns, &e.peer_arrived_ns, &e.peer_left_ns,
						&e.arrived_ns }[unit_random_u32(&r) % 4];
		struct fdp_clock_estimate estimate;

		*stamp ^= (int64_t)((uint64_t)unit_random_u32(&r) << (unit_random_u32(&r) % 64));
		fdp_clock_take(&w.clock, &e);
		fdp_clock_estimate(&w.clock, e.arrived_ns, &estimate);
		assert_true(isfinite(estimate.skew_ppm));
		assert_true(!estimate.known || estimate.error_ns >= 0);
		assert_true(fabs(w.clock.skew) <= 500e-6);
	}
	assert_true(w.clock.refused > 0);
}

/* Nothing known: the same time, and no claim. */
static void unknown(void **state)
{
	struct fdp_clock c = { .taken = 0 };
	struct fdp_clock_estimate estimate;

	(void)state;
	fdp_clock_reset(&c);
	fdp_clock_estimate(&c, 5, &estimate);
	assert_false(estimate.known);
	assert_int_equal(fdp_clock_to_peer(&c, 77), 77);
	assert_int_equal(fdp_clock_to_ours(&c, 77), 77);
}

/* There and back again is where one was, to a nanosecond. */
static void inverse(void **state)
{
	struct unit_random r = unit_random_start("clock inverse");

	(void)state;
	for (int round = 0; round < 20; round++) {
		struct world w = make_world(&r);

		run(&w, 16666667, 4 * NS_PER_S, errors, ROOM);
		for (int i = 0; i < 100; i++) {
			const int64_t at = ours(&w, w.t_ns) + llrint(unit_random_range(&r, -1e9, 1e9));

			assert_true(llabs(fdp_clock_to_ours(&w.clock, fdp_clock_to_peer(&w.clock, at)) -
					  at) <= 2);
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sweep),     cmocka_unit_test(skew),
		cmocka_unit_test(asymmetric_ways), cmocka_unit_test(steps),
		cmocka_unit_test(reordered), cmocka_unit_test(nonsense),
		cmocka_unit_test(unknown),   cmocka_unit_test(inverse),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
