/* Numbers, words and lines of text from outside, without locale and with bounds. */
#include "tests/unit/unit.h"

#include "tracking/text.h"

#include <locale.h>

/* The text in exactly as many bytes as it has. */
static double number(const char *text, double most, bool *whole)
{
	uint8_t *copy = unit_copy(text, strlen(text));
	struct track_text t = track_text(copy, strlen(text));
	const double value = track_text_number(&t, most);

	*whole = track_text_done(&t);
	free(copy);
	return value;
}

static void numbers_are_read(void **state)
{
	static const struct {
		const char *text;
		double value;
	} cases[] = {
		{ "0", 0 },
		{ "-0.000", 0 },
		{ "1", 1 },
		{ "+1.5", 1.5 },
		{ "  -187.216", -187.216 },
		{ "\t.5 ", .5 },
		{ "5.", 5 },
		{ "1.000000e+02", 100 },
		{ "1E-2", .01 },
		{ "0e999", 0 },
		{ "1e-999", 0 },
		{ "39596.024831", 39596.024831 },
		{ "0.940508", 0.940508 },
		{ "000000000000000000000000000012.5", 12.5 },
		{ "0.000000000000000000000000000125", 1.25e-28 },
		{ "123456789012345678901234e-21", 123.456789012345678 },
		{ "1e-00000000000000000000000000000000000001", .1 },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		bool whole;
		const double value = number(cases[i].text, 1e6, &whole);

		if (!whole || !(fabs(value - cases[i].value) <= 1e-15 * fabs(cases[i].value)))
			fail_msg("\"%s\" is %.17g", cases[i].text, value);
	}
}

static void what_is_no_number_is_refused(void **state)
{
	static const char *const cases[] = {
		"",	"-",	"+",   ".",	"-.",	  "e5",	   "1e",    "1e+",  "nan",
		"inf",	"-inf", "0x1", "1,5",	"1.5.5",  "--1",   "+-1",   "1 2",  "1e5.5",
		"1001", "1e4",	"1e999", "-1001", "1000.01", "1e99999999999999999999", "\xb2", "1f",
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		bool whole;

		(void)number(cases[i], 1000, &whole);
		if (whole)
			fail_msg("\"%s\" is taken for a number", cases[i]);
	}
}

static void a_locale_with_commas_changes_nothing(void **state)
{
	static const char *const names[] = { "de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE" };
	bool whole, set = false;

	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof names[0] && !set; i++)
		set = setlocale(LC_ALL, names[i]) != NULL;
	if (!set)
		printf("# no locale with commas is installed here\n");
	assert_float_equal(number("1.5", 10, &whole), 1.5, 0);
	assert_true(whole);
	(void)number("1,5", 10, &whole);
	assert_false(whole);
	setlocale(LC_ALL, "C");
}

/* Against the C library, over magnitudes and numbers of digits. */
static void numbers_agree_with_the_library(void **state)
{
	struct unit_random random = unit_random_start("numbers");
	double worst = 0;

	(void)state;
	for (int i = 0; i < 100000; i++) {
		const double value = unit_random_range(&random, -1, 1) *
				     pow(10, unit_random_range(&random, -9, 9));
		char text[64];
		bool whole;
		double read, want;

		snprintf(text, sizeof text, i % 2 ? "%.*f" : "%.*e",
			 (int)(unit_random_u32(&random) % 12), value);
		want = strtod(text, NULL);
		read = number(text, 1e12, &whole);
		assert_true(whole);
		worst = fmax(worst, want == 0 ? fabs(read) : fabs(read / want - 1));
	}
	printf("# farthest from strtod: %.2g of the value\n", worst);
	assert_true(worst <= 3e-16);
}

static void whole_numbers_have_bounds(void **state)
{
	static const struct {
		const char *text;
		uint32_t most;
		bool ok;
	} cases[] = {
		{ "0", 0, true },
		{ " 7", 7, true },
		{ "8", 7, false },
		{ "4294967295", UINT32_MAX, true },
		{ "4294967296", UINT32_MAX, false },
		{ "18446744073709551616", UINT32_MAX, false },
		{ "99999999999999999999999999999999", UINT32_MAX, false },
		{ "-1", UINT32_MAX, false },
		{ "+1", UINT32_MAX, false },
		{ "", UINT32_MAX, false },
		{ "x", UINT32_MAX, false },
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct track_text t = track_text(cases[i].text, strlen(cases[i].text));
		const uint32_t value = track_text_u32(&t, cases[i].most);

		assert_int_equal(track_text_done(&t), cases[i].ok);
		assert_int_equal(value, cases[i].ok ? strtoul(cases[i].text, NULL, 10) : 0);
	}
}

static void lines_end_in_either_way(void **state)
{
	static const char text[] = "one 1\r\n\r\ntwo 2\nthree\r";
	static const char *const want[] = { "one 1", "", "two 2", "three" };
	struct track_text t = track_text(text, sizeof text - 1), line;

	(void)state;
	for (size_t i = 0; i < 4; i++) {
		assert_true(track_text_line(&t, &line));
		assert_int_equal(line.end - line.at, strlen(want[i]));
		assert_memory_equal(line.at, want[i], strlen(want[i]));
	}
	assert_false(track_text_line(&t, &line));
}

static void words_are_whole(void **state)
{
	struct track_text t = track_text("6df2 1", 6);

	(void)state;
	assert_false(track_text_word(&t, "6d"));
	assert_false(track_text_word(&t, "6df"));
	assert_false(track_text_word(&t, "6df2 1x"));
	assert_true(track_text_word(&t, "6df2"));
	assert_int_equal(track_text_u32(&t, 9), 1);
	assert_true(track_text_done(&t));
	/* What failed stays failed. */
	t = track_text("a b", 3);
	track_text_expect(&t, '[');
	assert_false(track_text_word(&t, "a"));
	assert_int_equal(track_text_u32(&t, 9), 0);
	assert_false(track_text_done(&t));
}

static void blocks_close_once(void **state)
{
	struct track_text t = track_text("[1 2 3]x", 8);

	(void)state;
	track_text_expect(&t, '[');
	assert_int_equal(track_text_u32(&t, 9), 1);
	track_text_close(&t);
	assert_true(t.ok && *t.at == 'x');
	t = track_text("1 [2]", 5);
	track_text_close(&t);
	assert_false(t.ok);
	t = track_text("1 2", 3);
	track_text_close(&t);
	assert_false(t.ok);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(numbers_are_read),
		cmocka_unit_test(what_is_no_number_is_refused),
		cmocka_unit_test(a_locale_with_commas_changes_nothing),
		cmocka_unit_test(numbers_agree_with_the_library),
		cmocka_unit_test(whole_numbers_have_bounds),
		cmocka_unit_test(lines_end_in_either_way),
		cmocka_unit_test(words_are_whole),
		cmocka_unit_test(blocks_close_once),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
