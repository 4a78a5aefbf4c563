/* protocol/pack.h and the choice to pack in outbox.h. */
#include "unit.h"

#include "protocol/outbox.h"

#include "base/result.h"

static void fill(struct unit_random *r, uint8_t *bytes, size_t len, unsigned kinds)
{
	for (size_t i = 0; i < len; i++)
		bytes[i] = (uint8_t)(unit_random_u32(r) % kinds);
}

static void round_trips(void **state)
{
	struct unit_random r = unit_random_start("round_trips");
	static uint8_t plain[FDP_MESSAGE_MAX], back[FDP_MESSAGE_MAX];
	struct fdp_packer *packer;

	(void)state;
	assert_int_equal(fdp_packer_create(&packer), GR_OK);
	for (int round = 0; round < 300; round++) {
		const size_t len = 1 + unit_random_u32(&r) % (round % 10 ? 3000 : FDP_MESSAGE_MAX);
		const uint8_t *packed;
		size_t packed_len;
		uint8_t *exact, *out;

		fill(&r, plain, len, 1 + (unsigned)(round % 5) * 60);
		if (fdp_pack(packer, plain, len, &packed, &packed_len))
			continue;
		assert_true(packed_len < len);
		exact = unit_copy(packed, packed_len);
		out = unit_copy(back, len);
		assert_int_equal(fdp_unpack(exact, packed_len, out, len), GR_OK);
		assert_memory_equal(out, plain, len);
		/* Neither a byte more nor a byte less than was said. */
		assert_int_equal(fdp_unpack(exact, packed_len, out, len - 1), GR_ERR_FORMAT);
		free(out);
		out = unit_copy(back, len + 1 <= sizeof back ? len + 1 : len);
		if (len + 1 <= sizeof back)
			assert_int_equal(fdp_unpack(exact, packed_len, out, len + 1), GR_ERR_FORMAT);
		free(out);
		free(exact);
	}
	fill(&r, plain, sizeof plain, 256);
	assert_int_equal(fdp_pack(packer, plain, sizeof plain, &(const uint8_t *){ NULL },
				  &(size_t){ 0 }), GR_NOTHING);
	assert_int_equal(fdp_pack(packer, plain, sizeof plain + 1, &(const uint8_t *){ NULL },
				  &(size_t){ 0 }), GR_ERR_RANGE);
	assert_int_equal(fdp_pack(packer, plain, 0, &(const uint8_t *){ NULL }, &(size_t){ 0 }),
			 GR_ERR_RANGE);
	fdp_packer_destroy(&packer);
	assert_null(packer);
}

/* Hostile bytes: never more than the room, which an exact-size heap block shows. */
static void hostile(void **state)
{
	struct unit_random r = unit_random_start("hostile");
	static uint8_t plain[4096];
	struct fdp_packer *packer;
	const uint8_t *packed;
	size_t packed_len;

	(void)state;
	assert_int_equal(fdp_packer_create(&packer), GR_OK);
	fill(&r, plain, sizeof plain, 3);
	assert_int_equal(fdp_pack(packer, plain, sizeof plain, &packed, &packed_len), GR_OK);
	for (size_t n = 0; n < packed_len; n++) {
		uint8_t *exact = unit_copy(packed, n), *out = unit_copy(plain, sizeof plain);

		assert_int_equal(fdp_unpack(exact, n, out, sizeof plain), GR_ERR_FORMAT);
		free(out);
		free(exact);
	}
	for (int round = 0; round < 20000; round++) {
		const size_t room = 1 + unit_random_u32(&r) % 300;
		uint8_t *exact = unit_copy(packed, packed_len < 400 ? packed_len : 400);
		uint8_t *out = unit_copy(plain, room);

		for (unsigned k = 1 + unit_random_u32(&r) % 4; k; k--)
			exact[unit_random_u32(&r) % (packed_len < 400 ? packed_len : 400)] =
				(uint8_t)unit_random_u32(&r);
		fdp_unpack(exact, packed_len < 400 ? packed_len : 400, out, room);
		free(out);
		free(exact);
	}
	fdp_packer_destroy(&packer);
}

static size_t sent, sent_bytes;

static void count_send(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	(void)ctx;
	(void)to;
	(void)bytes;
	sent++;
	sent_bytes += len;
}

/* Packed only where that saves a datagram. */
static void when_it_pays(void **state)
{
	static const uint8_t key[FDP_KEY_BYTES];
	static struct fdp_letter letter;
	struct unit_random r = unit_random_start("when_it_pays");
	struct fdp_counters counters = { 0 };
	struct fdp_outbox out = {
		.cluster_key = key, .key = key, .session = 1, .datagram_max = 1472, .fan_out = 1,
		.counters = &counters, .send = count_send,
	};

	(void)state;
	assert_int_equal(fdp_outbox_init(&out), GR_OK);
	memset(letter.bytes, 0, 1408);
	fdp_outbox_letter(&out, &letter, FDP_DELTA, 1, 1408);
	assert_false(letter.packed); /* one datagram either way */
	assert_int_equal(letter.count, 1);
	memset(letter.bytes, 0, 1409);
	fdp_outbox_letter(&out, &letter, FDP_DELTA, 1, 1409);
	assert_true(letter.packed);
	assert_int_equal(letter.count, 1);
	fill(&r, letter.bytes, 60000, 256);
	fdp_outbox_letter(&out, &letter, FDP_DELTA, 1, 60000);
	assert_false(letter.packed);
	assert_int_equal(counters.packed, 1);
	fdp_outbox_post(&out, 0, &letter);
	assert_int_equal(sent, 43);
	assert_int_equal(sent_bytes, 60000 + 43 * FDP_HEADER_BYTES);
	assert_int_equal(counters.datagrams_out, 43);
	assert_int_equal(counters.bytes_out, sent_bytes);
	fdp_outbox_finish(&out);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(round_trips), cmocka_unit_test(hostile),
		cmocka_unit_test(when_it_pays),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
