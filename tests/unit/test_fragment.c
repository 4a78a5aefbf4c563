/* protocol/fragment.h: cutting, and putting together again in any order. */
#include "unit.h"

#include "protocol/fragment.h"

struct cut {
	size_t len, datagram_max;
	unsigned count;
	uint8_t *bytes;
};

static struct cut make_cut(struct unit_random *r, size_t len, size_t datagram_max)
{
	struct cut c = { len, datagram_max, fdp_fragment_count(len, datagram_max), malloc(len) };

	assert_non_null(c.bytes);
	for (size_t i = 0; i < len; i++)
		c.bytes[i] = (uint8_t)unit_random_u32(r);
	return c;
}

static struct fdp_header header_of(const struct cut *c, unsigned i, uint64_t message)
{
	size_t len;

	fdp_fragment_at(c->len, c->datagram_max, i, &len);
	return (struct fdp_header){
		.kind = FDP_DELTA, .payload_len = (uint16_t)len, .index = (uint16_t)i,
		.count = (uint16_t)c->count, .message = message,
		.message_len = (uint32_t)c->len, .plain_len = (uint32_t)c->len,
	};
}

static enum fdp_fragment_result add(struct fdp_reassembly *r, const struct cut *c, unsigned i,
				    uint64_t message)
{
	const struct fdp_header h = header_of(c, i, message);
	size_t len;
	const size_t at = fdp_fragment_at(c->len, c->datagram_max, i, &len);
	uint8_t *exact = unit_copy(c->bytes + at, len);
	const enum fdp_fragment_result result = fdp_reassembly_add(r, &h, exact);

	free(exact);
	return result;
}

static void any_order(void **state)
{
	struct unit_random r = unit_random_start("any_order");
	static struct fdp_reassembly re;
	uint64_t message = 0;

	(void)state;
	fdp_reassembly_reset(&re);
	for (int round = 0; round < 400; round++) {
		const size_t max = FDP_DATAGRAM_MIN + unit_random_u32(&r) % 1200;
		const size_t chunk = max - FDP_HEADER_BYTES;
		/* Also lengths at the very edge of a fragment. */
		const size_t len = round % 3 ? 1 + unit_random_u32(&r) % FDP_MESSAGE_MAX
					     : chunk * (1 + unit_random_u32(&r) % 20) + (size_t)(round % 2);
		struct cut c = make_cut(&r, len, max);
		unsigned order[FDP_FRAGMENTS_MAX], n = 0;

		assert_true(c.count && c.count <= FDP_FRAGMENTS_MAX);
		message++;
		unit_shuffle(&r, order, c.count);
		for (unsigned i = 0; i < c.count; i++) {
			uint8_t bitmap[FDP_BITMAP_BYTES];

			assert_int_equal(add(&re, &c, order[i], message),
					 i + 1 == c.count ? FDP_FRAGMENT_WHOLE : FDP_FRAGMENT_PART);
			assert_int_equal(add(&re, &c, order[i], message), FDP_FRAGMENT_AGAIN);
			n = fdp_reassembly_missing(&re, re.count, bitmap);
			assert_int_equal(n, c.count - i - 1);
			for (unsigned k = 0; k <= i; k++)
				assert_false(fdp_bit(bitmap, order[k]));
		}
		assert_false(fdp_reassembly_open(&re));
		assert_memory_equal(re.bytes, c.bytes, c.len);
		free(c.bytes);
	}
}

/* A newer message takes the place; the older one's fragments are then dropped. */
static void newer_wins(void **state)
{
	struct unit_random r = unit_random_start("newer_wins");
	static struct fdp_reassembly re;
	struct cut c = make_cut(&r, 5000, 1000);

	(void)state;
	fdp_reassembly_reset(&re);
	assert_int_equal(add(&re, &c, 0, 5), FDP_FRAGMENT_PART);
	assert_int_equal(add(&re, &c, 1, 6), FDP_FRAGMENT_PART);
	assert_int_equal(add(&re, &c, 1, 5), FDP_FRAGMENT_AGAIN);
	assert_int_equal(re.message, 6);
	assert_int_equal(re.have, 1);
	assert_int_equal(add(&re, &c, 0, 0), FDP_FRAGMENT_BAD);
	free(c.bytes);
}

static unsigned gap(struct fdp_reassembly *r, const struct cut *c, unsigned index, uint8_t *bitmap)
{
	const struct fdp_header h = header_of(c, index, 1);

	return fdp_reassembly_gap(r, &h, bitmap);
}

static void gaps(void **state)
{
	struct unit_random r = unit_random_start("gaps");
	static struct fdp_reassembly re;
	struct cut c = make_cut(&r, 10000, 1064); /* ten of 1000 */
	uint8_t bitmap[FDP_BITMAP_BYTES];

	(void)state;
	fdp_reassembly_reset(&re);
	add(&re, &c, 0, 1);
	assert_int_equal(gap(&re, &c, 0, bitmap), 0);
	add(&re, &c, 3, 1);
	assert_int_equal(gap(&re, &c, 3, bitmap), 2); /* 1 and 2, seen at once */
	assert_int_equal(bitmap[0], 0x06);
	add(&re, &c, 4, 1);
	assert_int_equal(gap(&re, &c, 4, bitmap), 0); /* asked for already */
	add(&re, &c, 1, 1);
	assert_int_equal(gap(&re, &c, 1, bitmap), 0);
	add(&re, &c, 9, 1);
	assert_int_equal(gap(&re, &c, 9, bitmap), 4);
	assert_int_equal(fdp_reassembly_missing(&re, re.count, bitmap), 5);
	free(c.bytes);
}

/* Fragments whose headers do not go with the message that is being put together. */
static void disagreement(void **state)
{
	struct unit_random r = unit_random_start("disagreement");
	static struct fdp_reassembly re;
	struct cut c = make_cut(&r, 5000, 1064);
	struct fdp_header h;

	(void)state;
	fdp_reassembly_reset(&re);
	add(&re, &c, 0, 1);
#define BAD(...) do { h = header_of(&c, 1, 1); __VA_ARGS__; \
		assert_int_equal(fdp_reassembly_add(&re, &h, c.bytes), FDP_FRAGMENT_BAD); \
		assert_int_equal(re.have, 1); } while (0)
	BAD(h.message_len++);
	BAD(h.plain_len++);
	BAD(h.packed = true);
	BAD(h.count++);
	BAD(h.payload_len--);
	BAD(h.payload_len = 0);
	BAD(h.index = 5);
	BAD(h.count = 0);
	BAD(h.message_len = 0);
	BAD(h.message_len = FDP_MESSAGE_MAX + 1);
	BAD(h.count = FDP_FRAGMENTS_MAX + 1);
#undef BAD
	assert_int_equal(add(&re, &c, 1, 1), FDP_FRAGMENT_PART);
	free(c.bytes);
}

/* Every header that is let in stays inside the buffer. */
static void bounds(void **state)
{
	struct unit_random r = unit_random_start("bounds");
	unsigned long taken = 0;

	(void)state;
	for (int i = 0; i < 2000000; i++) {
		const struct fdp_header h = {
			.payload_len = (uint16_t)(unit_random_u32(&r) % (i & 1 ? 64 : 65536)),
			.index = (uint16_t)(unit_random_u32(&r) % 8),
			.count = (uint16_t)(unit_random_u32(&r) % (i & 2 ? 8 : 600)),
			.message_len = unit_random_u32(&r) % (i & 1 ? 300 : 70000),
		};
		const size_t chunk = fdp_fragment_chunk(&h);

		if (!chunk)
			continue;
		taken++;
		assert_true(chunk * h.index + h.payload_len <= h.message_len);
		assert_true(h.message_len <= FDP_MESSAGE_MAX && h.count <= FDP_FRAGMENTS_MAX);
		assert_true(h.index + 1 == h.count ? chunk * h.index + h.payload_len == h.message_len
						   : h.payload_len == chunk);
	}
	assert_true(taken > 100);
	assert_int_equal(fdp_fragment_count(FDP_MESSAGE_MAX, FDP_HEADER_BYTES + 342), 192);
	assert_int_equal(fdp_fragment_count(FDP_MESSAGE_MAX, FDP_HEADER_BYTES + 341), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(any_order), cmocka_unit_test(newer_wins), cmocka_unit_test(gaps),
		cmocka_unit_test(disagreement), cmocka_unit_test(bounds),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
