/*
 * States of many datagrams in bad weather, on the fake clock at 1 Gbit/s: does each reach
 * every node inside its frame, when, and at what price, with parity and without? Built for
 * states of 4 KB and of 64 KB.
 */
#include "cluster_sim.h"

#include "base/result.h"

#define HZ120_NS INT64_C(8333333)
#define BYTE_NS 8 /* at 1 Gbit/s */
#define JITTER_NS 3000 /* less than a datagram takes on that: none overtakes another */
#define LONG_STATE (BALLAST_WORDS > 4000)

struct weather {
	const char *name;
	double loss;           /* of each datagram by itself */
	double share, run;     /* lost in runs of so many on average; share 0: none */
	bool by_day;           /* only in long runs */
};

static const struct weather fair = { "nothing", 0, 0, 0, false };
static const struct weather weathers[] = {
	{ "1 %", 0.01, 0, 0, LONG_STATE },
	{ "5 %", 0.05, 0, 0, false },
	{ "1 % in runs of 4", 0, 0.01, 4, true },
	{ "5 % in runs of 4", 0, 0.05, 4, false },
};
/* What Linux gives a node whose system allows no more than it does by itself: a state of 64 KB and its repairs. */
#define RECEIVE_BYTES 425984

struct outcome {
	double p50_ms, p99_ms, most_ms, in_frame, bytes, repairs, parity, parity_bytes;
};

static void set_ballast(struct sim *s, uint64_t frame)
{
	static uint32_t words[BALLAST_WORDS];

	for (size_t i = 0; i < BALLAST_WORDS; i++)
		words[i] = unit_random_u32(&s->random); /* does not pack */
	assert_true(param_set(s->state, PARAM_BALLAST, words, frame) >= 0);
}

static void set_weather(struct sim *s, const struct weather *w)
{
	s->loss = w->loss;
	s->bursts = (struct sim_bursts){ 0 };
	if (w->share > 0)
		s->bursts = (struct sim_bursts){
			.to_good = 1 / w->run, .to_bad = w->share / (1 - w->share) / w->run, .lost = 1,
		};
}

static double quantile_ms(struct sim *s, double q)
{
	return (double)sim_delivery_quantile(s, q) * 1e-6;
}

static struct outcome run(const struct weather *w, size_t nodes, bool multicast, enum fdp_parity parity,
			  uint64_t seed)
{
	const uint64_t frames = getenv("GROTTO_LONG") ? 6000 : LONG_STATE ? 150 : 400;
	static struct sim s; /* too large for a stack */
	struct fdp_counters before, after;
	struct outcome o = { 0 };
	uint64_t late;
	size_t inside = 0;

	sim_init(&s, nodes, seed);
	s.multicast = multicast;
	s.parity = parity;
	s.byte_ns = BYTE_NS;
	s.jitter_ns = JITTER_NS;
	s.evict_frames = 10;
	s.more_state = set_ballast;
	s.receive_bytes = RECEIVE_BYTES;
	sim_start_all(&s);
	sim_assemble(&s);
	set_weather(&s, w);
	sim_run_frames(&s, 100); /* the losses are known by now */
	s.delivery_count = 0;
	fdp_master_counters(s.master, &before);
	sim_run_frames(&s, frames);
	fdp_master_counters(s.master, &after);
	for (size_t i = 0; i < s.delivery_count; i++)
		inside += s.delivery_ns[i] < HZ120_NS;
	o = (struct outcome){
		.p50_ms = quantile_ms(&s, 0.5), .p99_ms = quantile_ms(&s, 0.99), .most_ms = quantile_ms(&s, 1),
		.in_frame = (double)inside / (double)(frames * nodes),
		.bytes = (double)(after.bytes_out - before.bytes_out) / (double)frames,
		.repairs = (double)(after.repairs - before.repairs) / (double)frames,
		.parity = (double)(after.parity - before.parity) / (double)frames / (multicast ? 1 : (double)nodes),
		.parity_bytes = (double)(after.parity_bytes - before.parity_bytes) / (double)frames,
	};
	/* Nobody was left out, and no node ever held anything else than the master said. */
	assert_int_equal(s.evicted, 0);
	set_weather(&s, &fair);
	sim_run_frames(&s, 2);
	sim_assert_in_step(&s);
	late = s.late;
	sim_finish(&s);
	printf("# %d bytes, %zu nodes, %s, lost %s, parity %s: p50 %.3f p99 %.3f worst %.3f ms; in the frame "
	       "%.5f; %.0f bytes, %.2f repairs, %.2f parity fragments a frame; %llu barriers missed\n", BALLAST_WORDS * 4 + 200, nodes,
	       multicast ? "multicast" : "unicast", w->name, parity == FDP_PARITY_OFF ? "off" : "auto", o.p50_ms,
	       o.p99_ms, o.most_ms, o.in_frame, o.bytes, o.repairs, o.parity, (unsigned long long)late);
	return o;
}

/* Of a few hundred frames every one, to every node, at 120 Hz; what parity is for it does. */
static void in_the_frame(void **state)
{
	const uint64_t seed = getenv("GROTTO_TEST_SEED") ? sim_seed_of("in the frame") : 1;

	(void)state;
	for (int multicast = 1; multicast >= 0; multicast--) {
		for (size_t k = 0; k < sizeof weathers / sizeof *weathers; k++) {
			const struct weather *w = &weathers[k];
			struct outcome off, with;

			if (w->by_day && !getenv("GROTTO_LONG"))
				continue;
			off = run(w, 4, multicast, FDP_PARITY_OFF, seed);
			with = run(w, 4, multicast, FDP_PARITY_AUTO, seed);
			assert_true(with.in_frame >= (w->share > 0 ? 0.99 : 1));
			assert_true(off.parity == 0 && with.parity > 0);
			assert_true(with.parity_bytes <= 0.5 * with.bytes);
			if (w->share > 0)
				continue;
			/* Most of what parity leaves to repair of a short state are acknowledgements. */
			assert_true(with.repairs < (LONG_STATE ? 0.2 : 0.85) * off.repairs);
			if (LONG_STATE)
				assert_true(with.p99_ms < 1.25 * with.p50_ms);
		}
	}
}

/* While nothing is lost parity costs nothing; who acknowledges later than usual is asked, no more. */
static void fair_weather(void **state)
{
	(void)state;
	for (int multicast = 1; multicast >= 0; multicast--) {
		const struct outcome o = run(&fair, 4, multicast, FDP_PARITY_AUTO, 3);

		assert_true(o.in_frame >= 1);
		assert_true(o.parity == 0);
		assert_true(o.repairs < 0.1);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(in_the_frame), cmocka_unit_test(fair_weather) };

	return cmocka_run_group_tests(tests, NULL, NULL);
}
