/* The option tables themselves, "did you mean", and the tables in the docs. */
#include "config/config_text.h"
#include "config/layout_options.h"
#include "config/scene_options.h"
#include "config/suggest.h"
#include "tests/unit/unit_config.h"

#include "base/result.h"

#include <math.h>

static void test_distance(void **state)
{
	(void)state;
	assert_int_equal(suggest_distance("pixels", "pixels"), 0);
	assert_int_equal(suggest_distance("pixels", "pixel"), 1);
	assert_int_equal(suggest_distance("pxiels", "pixels"), 1); /* neighbours swapped */
	assert_int_equal(suggest_distance("kitten", "sitting"), 3);
	assert_int_equal(suggest_distance("", "abc"), 3);
	assert_int_equal(suggest_distance("abc", ""), 3);
	assert_int_equal(suggest_distance("Side-By-Side", "side_by_side"), 0);
	/* The longest words that are compared, and one byte more. */
	char a[66], b[66];
	memset(a, 'a', sizeof a);
	memset(b, 'b', sizeof b);
	a[64] = b[64] = '\0';
	assert_int_equal(suggest_distance(a, b), 64);
	a[64] = 'a';
	a[65] = '\0';
	assert_int_equal(suggest_distance(a, b), 65);
}

static const char *suggestion(const char *word, const struct option *table)
{
	struct suggest suggest;

	suggest_start(&suggest, word);
	for (; table->key; table++)
		suggest_offer(&suggest, table->key);
	return suggest_answer(&suggest);
}

static void test_suggestions(void **state)
{
	(void)state;
	assert_string_equal(suggestion("wals", layout_options), "walls");
	assert_string_equal(suggestion("eye_separation", layout_options), "eye_separation_m");
	assert_string_equal(suggestion("tracker", layout_options), "trackers");
	assert_null(suggestion("temperature", layout_options));
	assert_string_equal(suggestion("camera", scene_options), "cameras");
	assert_string_equal(suggestion("far", scene_options), "far_m");
}

static bool numeric(const struct option *option)
{
	return option->type == OPTION_INT || option->type == OPTION_PORT ||
	       option->type == OPTION_U32 || option->type == OPTION_FLOAT ||
	       option->type == OPTION_TIME;
}

static unsigned check_default(const struct option *option)
{
	const char *text = option->standard;
	unsigned count = option->count > 1 ? option->count : 1;

	if (numeric(option)) {
		for (unsigned i = 0; i < count; i++) {
			char *end;
			double value = strtod(text, &end);

			assert_ptr_not_equal(end, text);
			assert_true(value >= option->min && value <= option->max);
			text = end;
		}
		assert_int_equal(*text, '\0');
	} else if (option->type == OPTION_CHOICE) {
		int found = 0;

		for (int i = 0; option->choices[i]; i++)
			found += !strcmp(option->choices[i], text);
		assert_int_equal(found, 1);
	} else if (option->type == OPTION_BOOL) {
		assert_true(!strcmp(text, "true") || !strcmp(text, "false"));
	}
	return 1;
}

/* Every key has help; every default is one that the reader would take; no key is there twice. */
static unsigned check_table(const struct option *table)
{
	unsigned keys = 0;

	for (const struct option *option = table; option->key; option++) {
		keys++;
		assert_true(strlen(option->key) < OPTION_NAME_SIZE);
		assert_true(option->help && strlen(option->help) >= 8);
		assert_null(strchr(option->help, '|'));
		assert_false(option->required && option->standard);
		assert_int_equal(option->type == OPTION_CHOICE, option->choices != NULL);
		if (numeric(option))
			assert_true(option->min < option->max);
		if (option->type == OPTION_BOOL || option->type == OPTION_PORT ||
		    option->type == OPTION_INT || option->type == OPTION_U32 ||
		    option->type == OPTION_TIME)
			assert_true(option->standard || option->required);
		if (option->standard)
			check_default(option);
		for (const struct option *other = table; other < option; other++)
			assert_string_not_equal(option->key, other->key);
		if (option->group)
			keys += check_table(option->group);
	}
	return keys;
}

static void test_tables(void **state)
{
	(void)state;
	printf("# %u keys of a layout, %u of a scene file\n", check_table(layout_options),
	       check_table(scene_options));
}

static void check_docs(const char *path, const struct option *table)
{
	char *text = unit_source_file(path);
	char *made = NULL;
	size_t size;
	FILE *memory = open_memstream(&made, &size);

	assert_non_null(memory);
	options_print_markdown(memory, table);
	fclose(memory);
	if (!strstr(text, made))
		fail_msg("%s does not hold the table that the code has; run \"make docs-options\"", path);
	free(made);
	free(text);
}

static void test_docs(void **state)
{
	(void)state;
	check_docs("docs/layout.md", layout_options);
	check_docs("docs/scene.md", scene_options);
}

static void test_names(void **state)
{
	static const char *const good[] = { "front", "a", "0", "lower-left.2", "A_b",
					    "0123456789012345678901234567890" };
	static const char *const bad[] = { "", "-front", ".front", "_front", "two words", "a/b",
					   "a@b", "a%i", "\xc3\xa4", "a\n",
					   "01234567890123456789012345678901" };

	(void)state;
	for (size_t i = 0; i < sizeof good / sizeof *good; i++)
		assert_true(options_name_fit(good[i]));
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		assert_false(options_name_fit(bad[i]));
}

static void check_text(const char *text, size_t len, const char *start, const char *part)
{
	struct gr_diag diag = { 0 };
	char *copy = (char *)unit_copy(text, len);
	config_t config;

	assert_int_equal(config_text_parse(copy, len, "t", &config, &diag), GR_ERR_CONFIG);
	if (!unit_diag_has(&diag, GR_DIAG_ERROR, start, part)) {
		unit_diag_print(&diag);
		fail_msg("no message \"%s ... %s\"", start, part);
	}
	gr_diag_finish(&diag);
	free(copy);
}

static void test_text(void **state)
{
	static const char nul[] = "a = 1;\nb = \0;\n";
	char *deep = calloc(1, 200001);
	char *path;

	(void)state;
	check_text("@include \"/etc/passwd\"\n", 23, "t:1: @include", "not allowed");
	check_text("a = 1;\n \t@include \"x\"\n", 22, "t:2: @include", "not allowed");
	check_text(nul, sizeof nul - 1, "t:2: ", "NUL byte");
	check_text("a = 1;\nb = [0, 1.5];\n", 21, "t:2: ", "write [0.0, 1.5, 0.0]");
	check_text("a = 1;\nb = ;\n", 13, "t:2: ", "look for a missing");
	check_text("a = 1;\na = 2;\n", 14, "t:2: a: ", "duplicate setting name; give each key once");
	/* Brackets without end must come back as an error, not as a stack overflow. */
	memset(deep, '(', 200000);
	memcpy(deep, "a = ", 4);
	check_text(deep, 200000, "t:1: ", "");
	/* So many keys that comparing each with each would take minutes. */
	for (int i = 0; i < 200000; i += 4)
		memcpy(deep + i, "a=1;", 4);
	check_text(deep, 200000, "t: ", "holds more than 8192 keys");
	free(deep);
	path = config_text_beside("/etc/grotto/room.cave", "cluster.key");
	assert_string_equal(path, "/etc/grotto/cluster.key");
	free(path);
	path = config_text_beside("room.cave", "cluster.key");
	assert_string_equal(path, "cluster.key");
	free(path);
	path = config_text_beside("/etc/grotto/room.cave", "/a/b");
	assert_string_equal(path, "/a/b");
	free(path);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_distance), cmocka_unit_test(test_suggestions),
		cmocka_unit_test(test_tables),	 cmocka_unit_test(test_docs),
		cmocka_unit_test(test_names),	 cmocka_unit_test(test_text),
	};

	return cmocka_run_group_tests_name("options", tests, NULL, NULL);
}
