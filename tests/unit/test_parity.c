/* protocol/parity.h and what a reassembly makes of it: what is healed, what is asked for. */
#include "unit.h"

#include "protocol/fragment.h"
#include "protocol/loss.h"
#include "protocol/parity.h"

/* A message with its parity, as a sender has it. */
struct sent {
	size_t len, chunk;
	unsigned count, parity;
	uint64_t number;
	uint8_t *bytes, *parity_bytes; /* bytes padded */
};

static struct sent make_sent(struct unit_random *r, size_t len, size_t datagram_max, unsigned parity)
{
	struct sent s = { .len = len, .chunk = datagram_max - FDP_HEADER_BYTES,
			  .count = fdp_fragment_count(len, datagram_max), .parity = parity, .number = 1 };

	s.bytes = calloc(s.count, s.chunk);
	s.parity_bytes = malloc(parity * s.chunk + 1);
	assert_non_null(s.bytes);
	assert_non_null(s.parity_bytes);
	for (size_t i = 0; i < len; i++)
		s.bytes[i] = (uint8_t)unit_random_u32(r);
	if (parity)
		fdp_parity_make(s.bytes, s.chunk, s.count, parity, s.parity_bytes);
	return s;
}

static void free_sent(struct sent *s)
{
	free(s->bytes);
	free(s->parity_bytes);
}

static struct fdp_header header_of(const struct sent *s, unsigned i)
{
	const size_t at = s->chunk * i, left = i < s->count ? s->len - at : s->chunk;

	return (struct fdp_header){
		.kind = FDP_DELTA, .payload_len = (uint16_t)(left < s->chunk ? left : s->chunk),
		.index = (uint16_t)i, .count = (uint16_t)s->count, .parity = (uint16_t)s->parity,
		.message = s->number, .message_len = (uint32_t)s->len, .plain_len = (uint32_t)s->len,
	};
}

static enum fdp_fragment_result add(struct fdp_reassembly *r, const struct sent *s, unsigned i)
{
	const struct fdp_header h = header_of(s, i);
	uint8_t *exact = unit_copy(i < s->count ? s->bytes + i * s->chunk
						: s->parity_bytes + (i - s->count) * s->chunk, h.payload_len);
	const enum fdp_fragment_result result = fdp_reassembly_add(r, &h, exact);

	free(exact);
	return result;
}

static unsigned gap(struct fdp_reassembly *r, const struct sent *s, unsigned i, uint8_t *bitmap)
{
	const struct fdp_header h = header_of(s, i);

	return fdp_reassembly_gap(r, &h, bitmap);
}

/* Of count + parity parts, in any order and each twice, the first count make it whole, no fewer. */
static void any_of_them(void **state)
{
	struct unit_random r = unit_random_start("any of them");
	static struct fdp_reassembly re;
	unsigned long healed = 0;

	(void)state;
	for (int round = 0; round < 600; round++) {
		const size_t max = FDP_DATAGRAM_MIN + unit_random_u32(&r) % (round % 5 ? 1200 : 30000);
		const size_t chunk = max - FDP_HEADER_BYTES;
		/* Also lengths at the very edge of a fragment. */
		const size_t len = round % 3 ? chunk + 1 + unit_random_u32(&r) % (FDP_MESSAGE_MAX - chunk)
					     : chunk * (2 + unit_random_u32(&r) % (FDP_MESSAGE_MAX / chunk - 1));
		const unsigned most = fdp_parity_most(fdp_fragment_count(len, max));
		struct sent s = make_sent(&r, len, max, round % 7 ? 1 + unit_random_u32(&r) % most : most);
		unsigned order[FDP_PARTS_MAX];

		assert_true(s.count >= 2 && s.parity * s.chunk <= FDP_MESSAGE_MAX);
		memset(re.bytes, 0xee, sizeof re.bytes); /* what was there before is no part of it */
		fdp_reassembly_reset(&re);
		unit_shuffle(&r, order, s.count + s.parity);
		for (unsigned i = 0; i < s.count + s.parity; i++) {
			uint8_t bitmap[FDP_BITMAP_BYTES];

			assert_int_equal(add(&re, &s, order[i]),
					 i + 1 < s.count ? FDP_FRAGMENT_PART :
					 i + 1 == s.count ? FDP_FRAGMENT_WHOLE : FDP_FRAGMENT_AGAIN);
			assert_int_equal(add(&re, &s, order[i]), FDP_FRAGMENT_AGAIN);
			assert_int_equal(fdp_reassembly_missing(&re, re.count, bitmap),
					 i + 1 < s.count ? s.count - i - 1 : 0);
		}
		healed += re.healed;
		assert_int_equal(fdp_reassembly_lost(&re), 0);
		assert_memory_equal(re.bytes, s.bytes, s.len);
		free_sent(&s);
	}
	assert_true(healed > 600);
	printf("# 600 messages, %lu fragments healed\n", healed);
}

/* Sent in order, some lost: up to `parity` are healed and nothing is asked for; of more, what is short. */
static void in_order(struct unit_random *r, const struct sent *s, unsigned lose, bool burst)
{
	static struct fdp_reassembly re;
	bool lost[FDP_PARTS_MAX] = { false };
	const unsigned parts = s->count + s->parity;
	unsigned asked = 0, have = 0, order[FDP_PARTS_MAX];
	const unsigned from = unit_random_u32(r) % (parts - lose + 1);
	bool whole = false;

	unit_shuffle(r, order, parts);
	for (unsigned i = 0; i < lose; i++)
		lost[burst ? from + i : order[i]] = true;
	fdp_reassembly_reset(&re);
	for (unsigned i = 0, seen_lost = 0; i < parts; i++) {
		uint8_t bitmap[FDP_BITMAP_BYTES];
		unsigned n;

		if (lost[i]) {
			seen_lost++;
			continue;
		}
		have++;
		whole = add(&re, s, i) == FDP_FRAGMENT_WHOLE || whole;
		assert_int_equal(whole, have >= s->count);
		n = whole ? 0 : gap(&re, s, i, bitmap);
		/* As soon as the arrival of this one shows that parity will not do, and never twice. */
		asked += n;
		for (unsigned k = 0; n && k < s->count; k++)
			assert_true(!fdp_bit(bitmap, k) || lost[k]);
		if (!whole)
			assert_int_equal(asked, seen_lost > s->parity ? seen_lost - s->parity : 0);
	}
	assert_int_equal(whole, lose <= s->parity);
	if (whole) {
		assert_int_equal(asked, 0);
		assert_memory_equal(re.bytes, s->bytes, s->len);
		return;
	}
	/* With as many of the missing ones as it lacks, whichever, it is whole. */
	for (unsigned i = 0; i < s->count && !whole; i++)
		if (lost[order[i] % s->count])
			whole = add(&re, s, order[i] % s->count) == FDP_FRAGMENT_WHOLE;
	for (unsigned i = 0; i < s->count && !whole; i++)
		if (lost[i])
			whole = add(&re, s, i) == FDP_FRAGMENT_WHOLE;
	assert_true(whole);
	assert_memory_equal(re.bytes, s->bytes, s->len);
}

static void losses(void **state)
{
	struct unit_random r = unit_random_start("losses");
	const int rounds = getenv("GROTTO_LONG") ? 4000 : 250;
	unsigned long patterns = 0;

	(void)state;
	for (int round = 0; round < rounds; round++) {
		const size_t max = FDP_DATAGRAM_MIN + unit_random_u32(&r) % 1200;
		const size_t len = max + unit_random_u32(&r) % (FDP_MESSAGE_MAX - max);
		const unsigned count = fdp_fragment_count(len, max);
		struct sent s = make_sent(&r, len, max, unit_random_u32(&r) % (fdp_parity_most(count) + 1));

		for (unsigned lose = 0; lose <= s.parity + 3 && lose < s.count + s.parity; lose++) {
			in_order(&r, &s, lose, false);
			in_order(&r, &s, lose, true);
			patterns += 2;
		}
		free_sent(&s);
	}
	printf("# %lu loss patterns of %d messages\n", patterns, rounds);
}

/* Every loss pattern there is, of small messages. */
static void every_pattern(void **state)
{
	struct unit_random r = { 7 };
	static struct fdp_reassembly re;

	(void)state;
	for (unsigned count = 2; count <= 7; count++) {
		for (unsigned parity = 1; parity <= fdp_parity_most(count); parity++) {
			struct sent s = make_sent(&r, count * 20 - 3, FDP_HEADER_BYTES + 20, parity);

			for (unsigned came = 0; came < 1u << (count + parity); came++) {
				bool whole = false;

				fdp_reassembly_reset(&re);
				for (unsigned i = 0; i < count + parity; i++)
					if (came >> i & 1)
						whole = add(&re, &s, i) == FDP_FRAGMENT_WHOLE || whole;
				assert_int_equal(whole, (unsigned)__builtin_popcount(came) >= count);
				if (whole)
					assert_memory_equal(re.bytes, s.bytes, s.len);
			}
			free_sent(&s);
		}
	}
}

/* What does not go with the others, and what no message can have. */
static void disagreement(void **state)
{
	struct unit_random r = unit_random_start("disagreement");
	static struct fdp_reassembly re;
	struct sent s = make_sent(&r, 5000, FDP_HEADER_BYTES + 1000, 2);
	struct fdp_header h;

	(void)state;
	fdp_reassembly_reset(&re);
	add(&re, &s, 0);
#define BAD(...) do { h = header_of(&s, 5); __VA_ARGS__; \
		assert_int_equal(fdp_reassembly_add(&re, &h, s.bytes), FDP_FRAGMENT_BAD); \
		assert_int_equal(re.have + re.have_parity, 1); } while (0)
	BAD(h.parity = 1);
	BAD(h.parity = 3);
	BAD(h.parity = 0);
	BAD(h.parity = 4);
	BAD(h.index = 7);
	BAD(h.index = UINT16_MAX);
	BAD(h.payload_len = 999);
	BAD(h.payload_len = 1001);
	BAD(h.payload_len = 1249); /* would be right of four fragments */
	BAD(h.message_len = 4999; h.plain_len = 4999);
	BAD(h.count = 4);
	BAD(h.count = 1; h.index = 1);
	BAD(h.message_len = 0; h.plain_len = 0);
#undef BAD
	assert_int_equal(add(&re, &s, 5), FDP_FRAGMENT_PART);
	free_sent(&s);
}

/* Parity that an authentic sender made of something else: wrong bytes, in their place, and no others. */
static void nonsense(void **state)
{
	struct unit_random r = unit_random_start("nonsense");
	static struct fdp_reassembly re;

	(void)state;
	for (int round = 0; round < 200; round++) {
		const unsigned count = 2 + unit_random_u32(&r) % 60;
		struct sent s = make_sent(&r, count * 700 - unit_random_u32(&r) % 699, FDP_HEADER_BYTES + 700,
					  fdp_parity_most(count));
		const unsigned lost = unit_random_u32(&r) % count;

		for (size_t i = 0; i < s.parity * s.chunk; i++)
			s.parity_bytes[i] = (uint8_t)unit_random_u32(&r);
		fdp_reassembly_reset(&re);
		for (unsigned i = 0; i <= count; i++)
			if (i != lost)
				assert_int_equal(add(&re, &s, i), i < count ? FDP_FRAGMENT_PART : FDP_FRAGMENT_WHOLE);
		for (unsigned i = 0; i < count; i++)
			if (i != lost)
				assert_memory_equal(re.bytes + i * s.chunk, s.bytes + i * s.chunk,
						    i + 1 < count ? s.chunk : s.len - i * s.chunk);
		free_sent(&s);
	}
}

/* A fragment that is sent again comes after all parity: what is short is asked for at once. */
static void after_a_repair(void **state)
{
	struct unit_random r = unit_random_start("after a repair");
	static struct fdp_reassembly re;
	struct sent s = make_sent(&r, 10000, FDP_HEADER_BYTES + 1000, 3);
	struct fdp_header h = header_of(&s, 9);
	uint8_t bitmap[FDP_BITMAP_BYTES];

	(void)state;
	fdp_reassembly_reset(&re);
	for (unsigned i = 0; i < 6; i++) {
		add(&re, &s, i);
		assert_int_equal(gap(&re, &s, i, bitmap), 0);
	}
	h.again = true;
	assert_int_equal(fdp_reassembly_add(&re, &h, s.bytes + 9 * s.chunk), FDP_FRAGMENT_PART);
	assert_int_equal(fdp_reassembly_gap(&re, &h, bitmap), 3); /* of six parts that are missing, three would do */
	assert_int_equal(bitmap[0], 0xc0);
	assert_int_equal(bitmap[1], 0x01);
	assert_int_equal(fdp_reassembly_gap(&re, &h, bitmap), 0);
	free_sent(&s);
}

/* Messages of `count` lose as the dice fall; how many of them had lost more than was sent with them. */
static double unhealed(struct unit_random *r, unsigned count, double share, double run, double *out_parity)
{
	const double to_good = 1 / run, to_bad = run > 1 ? share * to_good / (1 - share) : 0;
	struct fdp_loss l = { 0 };
	unsigned long over = 0, parity_all = 0, messages = 0;
	bool bad = false;

	for (int i = 0; i < 4000; i++) {
		const unsigned parity = fdp_loss_parity(&l, count, 0, fdp_parity_most(count));
		unsigned data = 0, all = 0;

		for (unsigned k = 0; k < count + parity; k++) {
			const double dice = unit_random_range(r, 0, 1);
			const bool lost = run > 1 ? (bad = bad ? dice >= to_good : dice < to_bad) : dice < share;

			data += lost && k < count;
			all += lost;
		}
		fdp_loss_take(&l, count, data);
		if (i < 2 * FDP_LOSS_MEMORY)
			continue;
		messages++;
		over += all > parity;
		parity_all += parity;
	}
	*out_parity = (double)parity_all / (double)messages;
	return (double)over / (double)messages;
}

/* What the master sends ahead is what losses ask for, and no more than a share of the message. */
static void measured(void **state)
{
	static const struct { unsigned count; double share, run, most_parity, most_unhealed; } cases[] = {
		{ 3, 0.01, 1, 1.1, 0.003 },  { 3, 0.05, 1, 2.0, 0.005 },
		{ 47, 0.01, 1, 3.3, 0.005 }, { 47, 0.05, 1, 8.6, 0.007 },
		{ 47, 0.05, 4, 19, 0.035 },  { 171, 0.05, 1, 20, 0.006 },
	};
	struct unit_random r = unit_random_start("measured");
	const struct fdp_loss none = { 0 };

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double parity;
		const double over = unhealed(&r, cases[i].count, cases[i].share, cases[i].run, &parity);

		printf("# %u fragments, %g %% lost in runs of %g: %.2f parity fragments, %.4f not healed\n",
		       cases[i].count, cases[i].share * 100, cases[i].run, parity, over);
		assert_true(parity <= cases[i].most_parity);
		assert_true(over <= cases[i].most_unhealed);
	}
	assert_int_equal(fdp_loss_parity(&none, 47, 0, 24), 0);
	assert_int_equal(fdp_loss_parity(&none, 47, FDP_LOSS_ASSUMED, 24), 5);
	assert_int_equal(fdp_parity_most(1), 0);
	assert_int_equal(fdp_parity_most(2), 1);
	assert_int_equal(fdp_parity_most(3), 2);
	assert_int_equal(fdp_parity_most(FDP_FRAGMENTS_MAX), FDP_PARITY_MAX);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(any_of_them), cmocka_unit_test(losses), cmocka_unit_test(every_pattern),
		cmocka_unit_test(disagreement), cmocka_unit_test(nonsense),
		cmocka_unit_test(after_a_repair), cmocka_unit_test(measured),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
