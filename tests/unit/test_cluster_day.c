/*
 * A day of a room, on a fake clock: ten walls at 60 Hz, datagrams lost one by one and in
 * bursts, walls that die, come back, are cut off and sleep, masters that are started again.
 * With GROTTO_LONG 24 hours, else ten minutes. Nothing may grow, nothing differ.
 */
#include "cluster_sim.h"

#include <inttypes.h>
#include <malloc.h>

#define WALLS 10
#define HZ 60
#define HOUR_FRAMES (UINT64_C(3600) * HZ)

/* What befell the room. */
struct day {
	struct sim s;
	int64_t well_ns[WALLS]; /* when the wall's trouble ends; 0: it has none */
	uint64_t kills, cuts, naps, masters, frames;
	/* Of masters that are gone. */
	struct fdp_counters gone;
	uint64_t wall_frames, wall_swaps;
	size_t heap; /* bytes in use when the first part was over */
};

static double cpu_s(void)
{
	return (double)clock() / CLOCKS_PER_SEC;
}

/* In use, large blocks with maps of their own too. */
static size_t heap_bytes(void)
{
	const struct mallinfo2 info = mallinfo2();

	return info.uordblks + info.hblkhd;
}

static void add_counters(struct fdp_counters *sum, const struct fdp_master *master)
{
	struct fdp_counters c;

	fdp_master_counters(master, &c);
	sum->datagrams_out += c.datagrams_out;
	sum->bytes_out += c.bytes_out;
	sum->datagrams_in += c.datagrams_in;
	sum->repairs += c.repairs;
	sum->bad_auth += c.bad_auth;
	sum->bad_format += c.bad_format;
	sum->bad_version += c.bad_version;
	sum->bad_short += c.bad_short;
}

static void new_master(struct day *d)
{
	struct sim *s = &d->s;

	add_counters(&d->gone, s->master);
	d->masters++;
	sim_kill_master(s);
	sim_run_ns(s, unit_random_u32(&s->random) % 3000 * SIM_MS);
	sim_start_master(s);
}

static void heal(struct day *d, int i)
{
	struct sim_node *n = &d->s.nodes[i];

	n->cut = n->asleep = false;
	if (!n->node)
		sim_start_node(&d->s, i);
	d->well_ns[i] = 0;
}

/* Deaths twice a minute, cuts twice, a nap every five, another master every fifteen. */
static void trouble(struct day *d, double minutes)
{
	struct sim *s = &d->s;
	const int i = (int)(unit_random_u32(&s->random) % WALLS);
	const double dice = unit_random_range(&s->random, 0, 1);
	const int64_t ms = 20 + unit_random_u32(&s->random) % 6000;

	for (int k = 0; k < WALLS; k++)
		if (d->well_ns[k] && s->now_ns >= d->well_ns[k])
			heal(d, k);
	if (dice >= minutes * (2 + 2 + 0.2 + 1.0 / 15) || d->well_ns[i])
		return;
	d->well_ns[i] = s->now_ns + ms * SIM_MS;
	if (dice < minutes * 2) {
		d->kills++;
		sim_kill_node(s, i);
	} else if (dice < minutes * 4) {
		d->cuts++;
		s->nodes[i].cut = true;
	} else if (dice < minutes * 4.2) {
		d->naps++;
		s->nodes[i].asleep = true;
	} else {
		d->well_ns[i] = 0;
		new_master(d);
	}
}

/* Who is in holds the numbers of its session and incarnation, and no more than these. */
static void check_numbers(const struct day *d)
{
	const struct sim *s = &d->s;

	assert_int_equal(s->master->out.session, s->session);
	for (int i = 0; i < WALLS; i++) {
		const struct fdp_node *node = s->nodes[i].node;

		assert_int_equal(node->out.session, s->session);
		assert_int_equal(node->out.sequence >> FDP_INCARNATION_SHIFT, s->master->peers[i].joins);
		assert_true(s->master->peers[i].window.top <= node->out.sequence);
		assert_true(node->window.top <= s->master->out.sequence);
	}
}

/* By turns: a wire that loses, on which much goes twice, and one that does not. */
static void weather(struct sim *s, bool bad)
{
	s->loss = s->duplicate = s->bursts.to_bad = 0;
	if (!bad)
		return;
	s->loss = 0.005;
	s->duplicate = 0.005;
	s->bursts.to_bad = 0.002;
	s->bursts.to_good = 0.25;
	s->bursts.lost = 1;
}

/* All is well again: within two seconds all walls show the same frame, and nothing is left over. */
static void check_whole(struct day *d)
{
	struct sim *s = &d->s;
	size_t heap;

	for (int i = 0; i < WALLS; i++)
		heal(d, i);
	sim_run_ns(s, 1000 * SIM_MS);
	weather(s, false);
	sim_run_frames(s, 2 * HZ);
	d->frames += 2 * HZ;
	for (int i = 0; i < WALLS; i++)
		assert_int_equal(s->nodes[i].last_swap, s->frame);
	sim_assert_in_step(s);
	check_numbers(d);
	sim_run_ns(s, 100 * SIM_MS);
	assert_true(s->packet_count <= 2 * WALLS);
	heap = heap_bytes();
	if (!d->heap)
		d->heap = heap;
	assert_true(heap <= d->heap + 65536); /* what is under way, and the packets' heap */
}

static void live(struct day *d, uint64_t frames, bool bad)
{
	struct sim *s = &d->s;
	uint64_t left = frames;

	weather(s, bad);
	while (left) {
		const uint64_t some = 1 + unit_random_u32(&s->random) % 60, now = some < left ? some : left;

		sim_run_frames(s, now);
		d->frames += now;
		left -= now;
		trouble(d, (double)now / HZ / 60);
	}
	check_whole(d);
}

static void tell(struct day *d, uint64_t seed)
{
	const struct sim *s = &d->s;
	const struct sim_bursts *b = &s->bursts;
	uint64_t joins = 0, frames = 0, swaps = 0;

	for (int i = 0; i < WALLS; i++) {
		joins += s->nodes[i].joined;
		frames += s->nodes[i].frames;
		swaps += s->nodes[i].swaps;
	}
	add_counters(&d->gone, s->master);
	assert_int_equal(d->gone.bad_auth + d->gone.bad_format + d->gone.bad_version + d->gone.bad_short, 0);
	printf("# %.2f h, %d walls, %d Hz, seed %" PRIu64 ": %" PRIu64 " frames, of %d walls' %.4f applied, "
	       "%.4f shown\n", (double)(s->now_ns - SIM_EPOCH_NS) * 1e-9 / 3600, WALLS, HZ, seed, d->frames,
	       WALLS, (double)frames / (double)(d->frames * WALLS), (double)swaps / (double)(d->frames * WALLS));
	printf("# deaths %" PRIu64 ", cuts %" PRIu64 ", naps %" PRIu64 ", masters %" PRIu64 "; joins %" PRIu64
	       ", barriers missed %" PRIu64 ", left out %" PRIu64 ", left %" PRIu64 ", differed %" PRIu64 "\n",
	       d->kills, d->cuts, d->naps, d->masters + 1, joins, s->late, s->evicted, s->left, s->mismatches);
	printf("# datagrams out %" PRIu64 ", in %" PRIu64 ", fragments repaired %" PRIu64 "; lost in bursts %"
	       PRIu64 " of %" PRIu64 ", %.2f in a row\n", d->gone.datagrams_out, d->gone.datagrams_in,
	       d->gone.repairs, b->losses, b->datagrams, (double)b->losses / (double)b->runs);
	printf("# heap after the first part %zu bytes, at the end %zu; datagrams under way at most %zu; %.0f s "
	       "of processor time\n", d->heap, heap_bytes(), s->packet_most, cpu_s());
}

static void day(void **state)
{
	const uint64_t seed = sim_seed_of("day");
	const bool whole = getenv("GROTTO_LONG") != NULL;
	const uint64_t part = whole ? HOUR_FRAMES : HOUR_FRAMES / 30, parts = whole ? 24 : 5;
	struct day *d = calloc(1, sizeof *d);

	(void)state;
	assert_non_null(d);
	sim_init(&d->s, WALLS, seed);
	d->s.jitter_ns = 200000;
	d->s.untimed = true;
	sim_start_all(&d->s);
	sim_assemble(&d->s);
	for (uint64_t i = 0; i < parts; i++)
		live(d, part, i % 2 == 0);
	tell(d, seed);
	sim_finish(&d->s);
	free(d);
}

/* Bursts are as long and as frequent as they are said to be, and cost as little as single losses. */
static void bursts(void **state)
{
	const uint64_t seed = sim_seed_of("bursts"), frames = getenv("GROTTO_LONG") ? 20000 : 1000;
	uint64_t swaps = 0;
	double rate, row;
	struct sim s;

	(void)state;
	sim_init(&s, 4, seed);
	s.jitter_ns = 200000;
	s.evict_frames = 10;
	sim_start_all(&s);
	sim_assemble(&s);
	s.bursts = (struct sim_bursts){ .to_bad = 0.0132, .to_good = 0.25, .lost = 1 };
	sim_run_frames(&s, frames);
	rate = (double)s.bursts.losses / (double)s.bursts.datagrams;
	row = (double)s.bursts.losses / (double)s.bursts.runs;
	for (int i = 0; i < 4; i++)
		swaps += s.nodes[i].swaps;
	printf("# bursts: %.2f %% of %" PRIu64 " lost, %.2f in a row; delivery p50 %.3f p99 %.3f max %.3f ms; "
	       "shown %.4f, barriers missed %" PRIu64 "\n", rate * 100, s.bursts.datagrams, row,
	       (double)sim_delivery_quantile(&s, 0.5) * 1e-6, (double)sim_delivery_quantile(&s, 0.99) * 1e-6,
	       (double)sim_delivery_quantile(&s, 1) * 1e-6, (double)swaps / (double)(frames * 4), s.late);
	assert_true(rate > 0.04 && rate < 0.06);
	assert_true(row > 3.5 && row < 4.5);
	assert_true(sim_delivery_quantile(&s, 0.99) < SIM_PERIOD_NS / 2); /* a frame at 120 Hz */
	s.bursts.to_bad = 0;
	sim_run_frames(&s, 2);
	sim_assert_in_step(&s);
	assert_int_equal(s.evicted, 0);
	sim_finish(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bursts),
		cmocka_unit_test(day),
	};

	if (getenv("GROTTO_TEST_FILTER"))
		cmocka_set_test_filter(getenv("GROTTO_TEST_FILTER"));
	return cmocka_run_group_tests(tests, NULL, NULL);
}
