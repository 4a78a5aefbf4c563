#include "tests/unit/unit.h"

#include "base/cursor.h"
#include "base/diag.h"
#include "base/log.h"
#include "base/plain.h"
#include "base/pose.h"
#include "base/result.h"

#include <math.h>
#include <string.h>

static void test_cursor_round_trip(void **state)
{
	uint8_t bytes[64];
	struct gr_writer w = gr_writer(bytes, sizeof bytes);
	struct gr_reader r;

	(void)state;
	gr_write_u8(&w, 0xfe);
	gr_write_u16(&w, 0xbeef);
	gr_write_u32(&w, 0xdeadbeef);
	gr_write_u64(&w, UINT64_C(0x0123456789abcdef));
	gr_write_f32(&w, -0.0f);
	assert_true(w.ok);
	assert_int_equal(w.len, 1 + 2 + 4 + 8 + 4);
	assert_int_equal(bytes[1], 0xef); /* little endian */
	r = gr_reader(bytes, w.len);
	assert_int_equal(gr_read_u8(&r), 0xfe);
	assert_int_equal(gr_read_u16(&r), 0xbeef);
	assert_int_equal(gr_read_u32(&r), 0xdeadbeef);
	assert_true(gr_read_u64(&r) == UINT64_C(0x0123456789abcdef));
	assert_true(signbit(gr_read_f32(&r)));
	assert_true(gr_reader_done(&r));
}

/* One form of each number, of either sign; every other one is refused. */
static void test_cursor_varint(void **state)
{
	static const struct { size_t len; uint8_t bytes[11]; } bad[] = {
		{ 0, { 0 } }, { 1, { 0x80 } }, { 2, { 0x80, 0 } }, { 3, { 0xff, 0x80, 0 } },
		{ 10, { 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 2 } },
		{ 11, { 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 1 } },
	};

	(void)state;
	for (unsigned bit = 0; bit <= 64; bit++) {
		for (uint64_t off = 0; off < 3; off++) {
			const uint64_t v = (bit < 64 ? UINT64_C(1) << bit : 0) + off - 1;
			uint8_t bytes[GR_VARINT_MOST];
			struct gr_writer w = gr_writer(bytes, sizeof bytes);
			struct gr_reader r;

			gr_write_varint(&w, v);
			assert_true(w.ok);
			r = gr_reader(bytes, w.len);
			assert_true(gr_read_varint(&r) == v);
			assert_true(gr_reader_done(&r));
			assert_true(gr_zigzag(gr_unzigzag(v)) == v);
		}
	}
	assert_int_equal(gr_zigzag(-1), 1);
	assert_int_equal(gr_zigzag(1), 2);
	assert_true(gr_unzigzag(UINT64_MAX) == INT64_MIN);
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct gr_reader r = gr_reader(bad[i].bytes, bad[i].len);

		assert_int_equal(gr_read_varint(&r), 0);
		assert_false(r.ok);
	}
}

static void test_cursor_every_short_length(void **state)
{
	uint8_t bytes[15];

	(void)state;
	memset(bytes, 0xff, sizeof bytes);
	for (size_t len = 0; len < sizeof bytes; len++) {
		uint8_t *copy = unit_copy(bytes, len);
		struct gr_reader r = gr_reader(copy, len);
		struct gr_writer w = gr_writer(copy, len);

		gr_write_u8(&w, 1);
		gr_write_u16(&w, 1);
		gr_write_u32(&w, 1);
		gr_write_u64(&w, 1);
		assert_false(w.ok);
		gr_read_u8(&r);
		gr_read_u16(&r);
		gr_read_u32(&r);
		gr_read_u64(&r);
		assert_false(r.ok);
		assert_int_equal(gr_read_u8(&r), 0); /* failure is sticky */
		assert_false(gr_reader_done(&r));
		free(copy);
	}
}

static void test_pose_algebra(void **state)
{
	struct unit_random random = unit_random_start("pose algebra");

	(void)state;
	for (int i = 0; i < 1000; i++) {
		struct gr_pose a, b, ab, inverse, one;
		vec3 p, q, r;

		for (int k = 0; k < 3; k++) {
			a.p[k] = (float)unit_random_range(&random, -10, 10);
			b.p[k] = (float)unit_random_range(&random, -10, 10);
			p[k] = (float)unit_random_range(&random, -10, 10);
		}
		for (int k = 0; k < 4; k++) {
			a.q[k] = (float)unit_random_range(&random, -1, 1);
			b.q[k] = (float)unit_random_range(&random, -1, 1);
		}
		glm_quat_normalize(a.q);
		glm_quat_normalize(b.q);
		gr_pose_mul(&a, &b, &ab);
		assert_true(gr_pose_valid(&ab));
		gr_pose_point(&b, p, q);
		gr_pose_point(&a, q, q);
		gr_pose_point(&ab, p, r);
		assert_true(glm_vec3_distance(q, r) < 1e-4f);
		gr_pose_inverse(&a, &inverse);
		gr_pose_mul(&a, &inverse, &one);
		assert_true(glm_vec3_norm(one.p) < 1e-4f);
		assert_true(fabsf(fabsf(one.q[3]) - 1.0f) < 1e-5f);
	}
}

static void test_pose_valid(void **state)
{
	struct gr_pose pose = GR_POSE_IDENTITY;

	(void)state;
	assert_true(gr_pose_valid(&pose));
	pose.p[1] = NAN;
	assert_false(gr_pose_valid(&pose));
	pose.p[1] = INFINITY;
	assert_false(gr_pose_valid(&pose));
	pose = GR_POSE_IDENTITY;
	pose.q[3] = 0;
	assert_false(gr_pose_valid(&pose));
	pose.q[0] = NAN;
	assert_false(gr_pose_valid(&pose));
}

static void test_log_limit(void **state)
{
	struct gr_log_limit limit = { 0 };
	uint64_t count = 0;
	const int64_t minute = INT64_C(60000000000);

	(void)state;
	assert_true(gr_log_limit(&limit, 5, &count));
	assert_int_equal(count, 1);
	for (int i = 0; i < 1000; i++)
		assert_false(gr_log_limit(&limit, 6 + i, &count));
	assert_true(gr_log_limit(&limit, 5 + minute, &count));
	assert_int_equal(count, 1001);
	assert_int_equal(limit.total, 1002);
}

static void test_diag(void **state)
{
	struct gr_diag diag = { 0 };

	(void)state;
	gr_diag_add(&diag, GR_DIAG_ERROR, "a.cave", 7, "walls.[0].pixels", "is %d, must be %d", 0, 1);
	gr_diag_add(&diag, GR_DIAG_NOTE, NULL, 0, NULL, "fine");
	assert_int_equal(diag.errors, 1);
	assert_int_equal(diag.warnings, 0);
	assert_string_equal(diag.items[0].text, "a.cave:7: walls.[0].pixels: is 0, must be 1");
	assert_string_equal(diag.items[1].text, "fine");
	gr_diag_finish(&diag);
	assert_int_equal(diag.count, 0);
}

static void test_result_names(void **state)
{
	(void)state;
	for (int r = GR_ERR_MISMATCH; r <= GR_NOTHING; r++)
		assert_string_not_equal(gr_result_name(r), "unknown result");
	assert_string_equal(gr_result_name(-1000), "unknown result");
}

static void plain(const char *expected, double value, int digits)
{
	struct gr_plain said = gr_plain(value, digits);

	assert_string_equal(said.text, expected);
}

static void test_plain_numbers(void **state)
{
	(void)state;
	plain("110", 110, 2);
	plain("120", 115.1, 2);
	plain("1073741824", 1073741824, 15);
	plain("1000000000", 1e9, 15);
	plain("0.00021", 0.000214, 2);
	plain("12.5", 12.5, 4);
	plain("13", 12.5001, 2);
	plain("8", 8, 3);
	plain("-0.5", -0.5, 15);
	plain("0", 0, 3);
	plain("1e+16", 1e16, 3);
	plain("1.3e-12", 1.3e-12, 2);
	plain("nan", (double)NAN, 3);
	plain("-inf", -(double)INFINITY, 3);
	assert_string_equal(gr_plain_percent(1.1).text, "110 %");
	assert_string_equal(gr_plain_percent(0.0312).text, "3.1 %");
	assert_string_equal(gr_plain_percent(0.00042).text, "0.042 %");
	assert_string_equal(gr_plain_percent(1e300).text, "1e+302 %");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_cursor_round_trip),
		cmocka_unit_test(test_plain_numbers),
		cmocka_unit_test(test_cursor_varint),
		cmocka_unit_test(test_cursor_every_short_length),
		cmocka_unit_test(test_pose_algebra),
		cmocka_unit_test(test_pose_valid),
		cmocka_unit_test(test_log_limit),
		cmocka_unit_test(test_diag),
		cmocka_unit_test(test_result_names),
	};
	return cmocka_run_group_tests_name("base", tests, NULL, NULL);
}
