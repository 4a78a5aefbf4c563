/* protocol/pack.h and the choice to pack in outbox.h. */
#include "unit.h"

#include "protocol/outbox.h"

#include "protocol/params.h"

#include "base/clock.h"
#include "base/result.h"

#include <math.h>

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

/* A visitor who walks a circle and looks about; four lamps of 16 that swing. */
static void walk(struct param_state *state, uint64_t frame, bool lamps)
{
	const double t = (double)frame / 60;
	const float head[3] = { (float)sin(t * 0.7), 1.7f + 0.02f * (float)sin(t * 6), (float)cos(t * 0.7) };
	const float look[4] = { 0, (float)sin(t * 0.35), 0, (float)cos(t * 0.35) };
	const float wand[3] = { head[0] + 0.3f, 1.2f, head[2] - 0.2f };
	const uint64_t ns = frame * 16666667;
	float at[48] = { 0 };

	for (int i = 0; i < 12; i++)
		at[i] = (float)sin(t + i) * 2;
	assert_true(param_set(state, PARAM_FRAME_TIME, &ns, frame) >= 0);
	assert_true(param_set(state, PARAM_HEAD_POSITION, head, frame) >= 0);
	assert_true(param_set(state, PARAM_HEAD_ROTATION, look, frame) >= 0);
	assert_true(param_set(state, PARAM_WAND_POSITION, wand, frame) >= 0);
	assert_true(param_set(state, PARAM_WAND_ROTATION, look, frame) >= 0);
	if (lamps)
		assert_true(param_set(state, PARAM_LAMP_POSITION, at, frame) >= 0);
}

/*
 * The states that there are, as they go: what LZO makes of them, alone and after XOR
 * with the one before, and what it takes.
 */
static void states(void **state)
{
	static const struct { const char *name; bool lamps, whole; } cases[] = {
		{ "delta, head and wand", false, false }, { "delta, lamps too", true, false },
		{ "snapshot, lamps too", true, true },
	};
	static uint8_t now[FDP_MESSAGE_MAX], last[FDP_MESSAGE_MAX], differs[FDP_MESSAGE_MAX];
	struct fdp_packer *packer;

	(void)state;
	assert_int_equal(fdp_packer_create(&packer), GR_OK);
	for (size_t k = 0; k < 3; k++) {
		struct param_state *params;
		size_t plain = 0, alone = 0, after = 0;
		int64_t took_ns = 0;

		assert_int_equal(param_state_create(&params), GR_OK);
		for (uint64_t frame = 1; frame <= 600; frame++) {
			const uint8_t *bytes;
			size_t packed;
			int64_t from_ns;
			long len;

			walk(params, frame, cases[k].lamps);
			len = param_delta_encode(params, cases[k].whole ? 0 : frame - 1, now, sizeof now);
			assert_true(len > 0);
			for (long i = 0; i < len; i++)
				differs[i] = now[i] ^ last[i];
			memcpy(last, now, (size_t)len);
			plain += (size_t)len;
			from_ns = gr_clock_now(&gr_clock_monotonic);
			packed = (size_t)len;
			fdp_pack(packer, now, (size_t)len, &bytes, &packed);
			took_ns += gr_clock_now(&gr_clock_monotonic) - from_ns;
			alone += packed;
			packed = (size_t)len;
			fdp_pack(packer, differs, (size_t)len, &bytes, &packed);
			after += packed;
			/* One datagram either way, so packing it saves nothing: it is not tried. */
			assert_true((size_t)len <= 1472 - FDP_HEADER_BYTES);
		}
		printf("# %s: %.0f bytes; LZO %.2f, after XOR %.2f of them; %.1f us\n", cases[k].name,
		       (double)plain / 600, (double)alone / (double)plain, (double)after / (double)plain,
		       (double)took_ns * 1e-3 / 600);
		param_state_destroy(&params);
	}
	fdp_packer_destroy(&packer);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(round_trips), cmocka_unit_test(hostile),
		cmocka_unit_test(when_it_pays), cmocka_unit_test(states),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
