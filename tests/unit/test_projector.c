/* Projectors that were measured: tables and powers, their inverses, and tables that are none. */
#include "base/diag.h"
#include "base/result.h"
#include "renderer/tone/projector.h"
#include "unit.h"

static int parse(const char *text, struct projector *out, char *why, size_t size)
{
	struct gr_diag diag = { 0 };
	size_t len = strlen(text);
	uint8_t *exact = unit_copy(text, len);
	int r;

	memset(out, 0, sizeof *out);
	r = projector_parse(exact, len, "table.csv", out, &diag);
	free(exact);
	assert_true(r == GR_OK ? diag.count == 0 : r == GR_ERR_CONFIG && diag.count == 1);
	if (r != GR_OK)
		snprintf(why, size, "%s", diag.items[0].text);
	gr_diag_finish(&diag);
	return r;
}

static void tables(void **state)
{
	static const struct {
		const char *text;
		const char *why; /* NULL: taken */
	} cases[] = {
		{ "0,0,0,0\n1,1,1,1", NULL },
		{ "# measured on Monday\n 0 0.01 0.01 0.01\r\n\n0.5, 0.2 0.2\t0.2 # mid\n1 0.9 1 1.1\n", NULL },
		{ "", "the last code is not 1" },
		{ "0 0 0 0\n", "1: the last code is not 1" },
		{ "0.1 0 0 0\n1 1 1 1\n", "1: the first code is not 0" },
		{ "0 0 0 0\n0.5 1 1 1\n0.5 1 1 1\n1 2 2 2\n", "3: the code is not above the one before" },
		{ "0 0 0 0\n0.5 1 1 1\n1 1 0.9 1\n", "3: less light than in the row before" },
		{ "0 -1 0 0\n1 1 1 1\n", "1: light below 0" },
		{ "0 0 0 0.5\n1 1 1 0.5\n", "2: a band has the same light for all codes" },
		{ "0 0 0\n1 1 1 1\n", "1: not four numbers" },
		{ "0 0 0 0 0\n1 1 1 1\n", "1: not four numbers" },
		{ "0 0 nan 0\n1 1 1 1\n", "1: not four numbers" },
		{ "code,red,green,blue\n", "1: not four numbers" },
		{ "0 0 0 0\n2 1 1 1\n", "2: the last code is not 1" },
	};
	static struct projector p;
	char why[300], *many = malloc(64 * 1100), *at = many;

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		int r = parse(cases[i].text, &p, why, sizeof why);

		assert_int_equal(r, cases[i].why ? GR_ERR_CONFIG : GR_OK);
		if (cases[i].why && !strstr(why, cases[i].why))
			fail_msg("\"%s\": %s, not %s", cases[i].text, why, cases[i].why);
	}
	for (int i = 0; i <= PROJECTOR_ROWS_MAX; i++)
		at += sprintf(at, "%g %d %d %d\n", (double)i / PROJECTOR_ROWS_MAX, i, i, i);
	assert_int_equal(parse(many, &p, why, sizeof why), GR_ERR_CONFIG);
	assert_non_null(strstr(why, "too many rows"));
	free(many);
}

/* Code to light and back, and what lies outside. */
static void check_inverse(const struct projector *p)
{
	for (int c = 0; c < 3; c++) {
		assert_true(projector_code(p, c, -1) == 0 && projector_code(p, c, 1e9) == 1);
		assert_true(projector_code(p, c, projector_light(p, c, 0)) == 0);
		assert_true(projector_code(p, c, projector_light(p, c, 1)) == 1);
		for (int i = 1; i < 100; i++) {
			double light = projector_light(p, c, i / 100.0);
			double again = projector_light(p, c, projector_code(p, c, light));

			assert_true(fabs(again - light) < 1e-12 * fmax(light, 1));
		}
	}
}

static void inverses(void **state)
{
	static struct projector table;
	struct projector *power = calloc(1, sizeof *power);
	char why[300];

	(void)state;
	*power = (struct projector){ .black = { 0, 0.01, 0.02 }, .gain = { 0.5, 1, 3 },
				     .gamma = { 1, 2.2, 2.6 } };
	check_inverse(power);
	/* with a plateau: of its codes the first */
	assert_int_equal(parse("0 0 0 0\n0.25 0.1 0.1 0.2\n0.5 0.1 0.3 0.2\n1 1 2 3\n", &table, why,
			       sizeof why), GR_OK);
	check_inverse(&table);
	assert_true(projector_code(&table, 0, 0.1) == 0.25);
	free(power);
}

/* A projector that is the scene's display gets what is encoded for it; and a dimmer wall less. */
static void maps(void **state)
{
	const struct scene_tone tones[] = { { .gamma_display = 2.2f }, { .srgb = true, .gamma_display = 2.2f } };
	static float map[PROJECTOR_MAP][3];
	struct projector *p = calloc(1, sizeof *p);
	double worst = 0;

	(void)state;
	*p = (struct projector){ .gain = { 1, 1, 2 }, .gamma = { (double)2.2f, (double)2.2f, (double)2.2f } };
	projector_map(p, &tones[0], map);
	for (int i = 0; i < PROJECTOR_MAP; i++) {
		double x = (double)i / (PROJECTOR_MAP - 1);

		worst = fmax(worst, fabs((double)map[i][0] - x));
		/* twice as bright: half the light */
		worst = fmax(worst, fabs((double)map[i][2] - x * pow(0.5, 1 / (double)2.2f)));
	}
	assert_true(worst < 1e-6);
	projector_map(p, &tones[1], map);
	assert_true(map[0][0] == 0 && fabsf(map[PROJECTOR_MAP - 1][0] - 1) < 1e-6f);
	for (int i = 1; i < PROJECTOR_MAP; i++)
		assert_true(map[i][0] > map[i - 1][0]);
	free(p);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(tables), cmocka_unit_test(inverses),
					    cmocka_unit_test(maps) };

	return cmocka_run_group_tests(tests, NULL, NULL);
}
