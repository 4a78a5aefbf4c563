/* The Hydra's decoder: every byte, every length, hemispheres, counters. */
#include "tests/unit/unit.h"

#include "base/result.h"
#include "tests/unit/hydra_bytes.h"
#include "tracking/hydra.h"

/* The first report of R. Pavlik's capture: both wands docked. */
static const uint8_t captured[HYDRA_BYTES] = {
	1,   0,	 52,  0,   2,	0,   1,	  99,  47,  0, 191, 255, 204, 255, 223, 222, 124, 121,
	33,  7,	 51,  234, 128, 0,   0,	  0,   0,   0, 2,   99,	 214, 255, 188, 255, 202, 255,
	204, 38, 168, 134, 105, 244, 176, 251, 128, 0, 0,   0,	 0,   0,   255, 141,
};

static void a_captured_report(void **state)
{
	struct track_hydra_report r;

	(void)state;
	assert_int_equal(hydra_crc((const uint8_t *)"123456789", 9), 0xE5CC);
	assert_int_equal(track_hydra_decode(captured, sizeof captured, &r), GR_OK);
	assert_int_equal(r.wands[0].sequence, 99);
	assert_int_equal(r.wands[0].place_mm[0], 47);
	assert_int_equal(r.wands[0].place_mm[1], -65);
	assert_int_equal(r.wands[0].place_mm[2], -52);
	assert_int_equal(r.wands[0].turn[0], -8481);
	assert_int_equal(r.wands[0].turn[1], 31100);
	assert_int_equal(r.wands[0].turn[2], 1825);
	assert_int_equal(r.wands[0].turn[3], -5581);
	assert_int_equal(r.wands[0].buttons, 0x80);
	assert_int_equal(r.wands[1].place_mm[0], -42);
	assert_int_equal(r.wands[1].turn[0], 9932);
	assert_int_equal(r.wands[1].turn[1], -31064);
	assert_int_equal(r.wands[1].trigger, 0);
}

/* Each field by itself, with a value that no other has. */
static void every_field_is_where_it_is(void **state)
{
	uint8_t bytes[HYDRA_BYTES];
	struct track_hydra_report r;

	(void)state;
	hydra_make(bytes, 0, 0, 0, 0);
	for (int wand = 0; wand < 2; wand++) {
		uint8_t *w = bytes + 6 + 22 * wand;

		w[1] = (uint8_t)(10 + wand);
		for (int i = 0; i < 7; i++)
			hydra_put(w, 2 + 2 * (size_t)i, -30000 + 1000 * i + 100 * wand);
		w[16] = (uint8_t)(0xA5 + wand);
		hydra_put(w, 17, 12345 + wand);
		hydra_put(w, 19, -12345 - wand);
		w[21] = (uint8_t)(200 + wand);
	}
	hydra_seal(bytes);
	assert_int_equal(track_hydra_decode(bytes, sizeof bytes, &r), GR_OK);
	for (int wand = 0; wand < 2; wand++) {
		const struct track_hydra_wand *w = &r.wands[wand];

		assert_int_equal(w->sequence, 10 + wand);
		for (int i = 0; i < 3; i++)
			assert_int_equal(w->place_mm[i], -30000 + 1000 * i + 100 * wand);
		for (int i = 0; i < 4; i++)
			assert_int_equal(w->turn[i], -27000 + 1000 * i + 100 * wand);
		assert_int_equal(w->buttons, 0xA5 + wand);
		assert_int_equal(w->stick[0], 12345 + wand);
		assert_int_equal(w->stick[1], -12345 - wand);
		assert_int_equal(w->trigger, 200 + wand);
	}
}

static void any_length_but_52_is_refused(void **state)
{
	struct track_hydra_report r, untouched;

	(void)state;
	memset(&r, 0x5a, sizeof r);
	untouched = r;
	for (size_t len = 0; len <= HYDRA_BYTES + 1; len++) {
		uint8_t *copy = unit_copy(captured, len < HYDRA_BYTES ? len : HYDRA_BYTES);

		if (len != HYDRA_BYTES)
			assert_int_equal(track_hydra_decode(copy, len, &r), -TRACK_FAULT_LENGTH);
		free(copy);
	}
	assert_memory_equal(&r, &untouched, sizeof r);
}

static void any_flipped_bit_is_found(void **state)
{
	uint8_t bytes[HYDRA_BYTES];
	struct track_hydra_report r;

	(void)state;
	for (size_t bit = 0; bit < 8 * HYDRA_BYTES; bit++) {
		memcpy(bytes, captured, sizeof bytes);
		bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
		assert_int_equal(track_hydra_decode(bytes, sizeof bytes, &r),
				 -TRACK_FAULT_CHECKSUM);
	}
}

static void constants_are_looked_at(void **state)
{
	static const size_t constant[] = { 0, 1, 2, 3, 4, 5, 6, 28 };
	uint8_t bytes[HYDRA_BYTES];
	struct track_hydra_report r;

	(void)state;
	for (size_t i = 0; i < sizeof constant / sizeof *constant; i++)
		for (int add = 1; add < 256; add++) {
			memcpy(bytes, captured, sizeof bytes);
			bytes[constant[i]] = (uint8_t)(bytes[constant[i]] + add);
			hydra_seal(bytes);
			assert_int_equal(track_hydra_decode(bytes, sizeof bytes, &r),
					 -TRACK_FAULT_FORMAT);
		}
}

static void the_mode_switch_is_as_other_drivers_send_it(void **state)
{
	uint8_t feature[TRACK_HYDRA_FEATURE_BYTES];

	(void)state;
	for (int motion = 0; motion < 2; motion++) {
		track_hydra_mode(motion, feature);
		for (int i = 0; i < TRACK_HYDRA_FEATURE_BYTES; i++)
			assert_int_equal(feature[i], i == 6    ? 1
						     : i == 8  ? 4
						     : i == 9  ? (motion ? 3 : 0)
						     : i == 89 ? (motion ? 6 : 5)
							       : 0);
	}
}

/* ---- the common form ---- */

static void decode(const uint8_t bytes[HYDRA_BYTES], struct track_hydra_report *out)
{
	assert_int_equal(track_hydra_decode(bytes, HYDRA_BYTES, out), GR_OK);
}

static void assert_place(const struct track_report *r, float x, float y, float z)
{
	assert_true(fabsf(r->T_base_sensor.p[0] - x) < 1e-6f);
	assert_true(fabsf(r->T_base_sensor.p[1] - y) < 1e-6f);
	assert_true(fabsf(r->T_base_sensor.p[2] - z) < 1e-6f);
}

static void axes_are_those_of_the_house(void **state)
{
	struct track_hydra_state s = { 0 };
	struct track_hydra_report raw;
	struct track_report out[2];
	uint8_t bytes[HYDRA_BYTES];

	(void)state;
	/* 100 mm to each side, 200 towards the user, 300 above the base: z points down. */
	hydra_make(bytes, 1, 100, 200, -300);
	decode(bytes, &raw);
	assert_int_equal(track_hydra_reports(&s, &raw, GR_NS_PER_S, out), 0);
	assert_place(&out[0], -0.1f, 0.3f, 0.2f);
	assert_place(&out[1], 0.1f, 0.3f, 0.2f);
	for (unsigned i = 0; i < 2; i++) {
		assert_int_equal(out[i].sensor, i);
		assert_int_equal(out[i].device_ns, 4 * GR_NS_PER_MS);
		assert_int_equal(out[i].axis_count, 3);
	}
}

/* The change of axes is a turn: of determinant 1, and the same for both parts of a pose. */
static void a_turn_stays_a_turn(void **state)
{
	struct track_hydra_state s = { 0 };
	struct track_hydra_report raw;
	struct track_report out[2];
	uint8_t bytes[HYDRA_BYTES];
	const float axis[3][3] = { { 1, 0, 0 }, { 0, 0, -1 }, { 0, 1, 0 } };

	(void)state;
	hydra_make(bytes, 1, 100, 0, -300);
	decode(bytes, &raw);
	for (int i = 0; i < 3; i++) {
		/* A quarter turn about the device's own i-th axis, and where it points here. */
		memset(raw.wands[1].turn, 0, sizeof raw.wands[1].turn);
		raw.wands[1].turn[0] = raw.wands[1].turn[i + 1] = 23170;
		track_hydra_reports(&s, &raw, GR_NS_PER_S, out);
		for (int k = 0; k < 3; k++)
			assert_true(fabsf(out[1].T_base_sensor.q[k] - axis[i][k] * 0.70709f) <
				    1e-3f);
		assert_true(fabsf(out[1].T_base_sensor.q[3] - 0.70709f) < 1e-3f);
	}
}

static void buttons_sticks_and_trigger(void **state)
{
	/* bumper, 1, 2, 3, 4, start, stick */
	static const uint8_t bit[] = { 0x01, 0x04, 0x08, 0x02, 0x10, 0x20, 0x40 };
	struct track_hydra_state s = { 0 };
	struct track_hydra_report raw;
	struct track_report out[2];

	(void)state;
	decode(captured, &raw);
	for (unsigned i = 0; i < sizeof bit; i++) {
		raw.wands[0].buttons = (uint8_t)(0x80 | bit[i]);
		track_hydra_reports(&s, &raw, GR_NS_PER_S, out);
		assert_int_equal(out[0].buttons, 1u << i);
		assert_int_equal(out[1].buttons, 0);
	}
	raw.wands[1].stick[0] = -32768;
	raw.wands[1].stick[1] = 16384;
	raw.wands[1].trigger = 255;
	track_hydra_reports(&s, &raw, GR_NS_PER_S, out);
	assert_true(out[1].axes[0] == -1.0f && out[1].axes[1] == 0.5f && out[1].axes[2] == 1.0f);
	assert_true(out[0].axes[0] == 0 && out[0].axes[2] == 0);
}

/* Round the base and under it: at every flip the device turns all coordinates round. */
static void hemispheres_are_followed(void **state)
{
	struct track_hydra_state s = { 0 };
	struct track_report out[2];
	uint8_t bytes[HYDRA_BYTES];
	int flips = 0;

	(void)state;
	for (int i = 0; i < 1000; i++) {
		const double t = i * 0.012;
		const int x = (int)lround(300 * cos(t)) + 350, y = (int)lround(200 * sin(2 * t));
		const int z = (int)lround(-250 * cos(t));
		/* Below the base it says the place opposite. */
		const int sign = z > 0 ? -1 : 1;
		struct track_hydra_report raw;

		flips += i && (z > 0) != ((int)lround(-250 * cos((i - 1) * 0.012)) > 0);
		hydra_make(bytes, (uint8_t)i, sign * x, sign * y, sign * z);
		decode(bytes, &raw);
		track_hydra_reports(&s, &raw, i * 4 * GR_NS_PER_MS, out);
		assert_place(&out[1], 0.001f * (float)x, 0.001f * (float)-z, 0.001f * (float)y);
		assert_true(out[0].T_base_sensor.p[0] < 0);
	}
	assert_int_equal(flips, 4);
}

static void a_docked_wand_is_on_its_side(void **state)
{
	struct track_hydra_state s = { 0 };
	struct track_hydra_report raw;
	struct track_report out[2];
	uint8_t bytes[HYDRA_BYTES];

	(void)state;
	decode(captured, &raw); /* says +47 mm of the left one */
	track_hydra_reports(&s, &raw, 0, out);
	assert_place(&out[0], -0.047f, -0.052f, 0.065f);
	assert_place(&out[1], 0.042f, -0.054f, 0.068f);
	/* On no side: above the base. */
	s = (struct track_hydra_state){ 0 };
	hydra_make(bytes, 1, 5, 100, 200);
	decode(bytes, &raw);
	track_hydra_reports(&s, &raw, 0, out);
	assert_place(&out[1], -0.005f, 0.2f, -0.1f);
}

static void sequences_wrap_and_gaps_are_counted(void **state)
{
	struct track_hydra_state s = { 0 };
	struct track_hydra_report raw;
	struct track_report out[2];
	uint64_t missed = 0, sent = 0;
	int64_t last_ns = -1;

	(void)state;
	decode(captured, &raw);
	for (uint64_t n = 0; n < 3000; n++) {
		/* Two are lost in 100; once 1.5 s, more than the counter holds. */
		if (n % 100 == 40 || n % 100 == 41 || (n >= 1000 && n < 1375))
			continue;
		raw.wands[0].sequence = raw.wands[1].sequence = (uint8_t)(n + 99);
		missed += track_hydra_reports(&s, &raw, (int64_t)n * 4 * GR_NS_PER_MS, out);
		sent++;
		assert_true(out[0].device_ns > last_ns);
		last_ns = out[0].device_ns;
		assert_int_equal(out[0].device_ns, out[1].device_ns);
	}
	assert_int_equal(sent + missed, 3000);
	assert_int_equal(last_ns, (2999 + 99) * 4 * GR_NS_PER_MS);
}

/* Eight arrive at once after a stall of 32 ms: none is missing. */
static void a_burst_is_no_gap(void **state)
{
	struct track_hydra_state s = { 0 };
	struct track_hydra_report raw;
	struct track_report out[2];

	(void)state;
	decode(captured, &raw);
	for (int n = 0; n < 800; n++) {
		raw.wands[0].sequence = raw.wands[1].sequence = (uint8_t)n;
		assert_int_equal(track_hydra_reports(&s, &raw, (n / 8 * 8 + 8) * 4 * GR_NS_PER_MS,
						     out),
				 0);
		assert_int_equal(out[1].device_ns, n * 4 * GR_NS_PER_MS);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_captured_report),
		cmocka_unit_test(every_field_is_where_it_is),
		cmocka_unit_test(any_length_but_52_is_refused),
		cmocka_unit_test(any_flipped_bit_is_found),
		cmocka_unit_test(constants_are_looked_at),
		cmocka_unit_test(the_mode_switch_is_as_other_drivers_send_it),
		cmocka_unit_test(axes_are_those_of_the_house),
		cmocka_unit_test(a_turn_stays_a_turn),
		cmocka_unit_test(buttons_sticks_and_trigger),
		cmocka_unit_test(hemispheres_are_followed),
		cmocka_unit_test(a_docked_wand_is_on_its_side),
		cmocka_unit_test(sequences_wrap_and_gaps_are_counted),
		cmocka_unit_test(a_burst_is_no_gap),
	};

	return cmocka_run_group_tests_name("hydra_decode", tests, NULL, NULL);
}
