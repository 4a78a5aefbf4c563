/* DTrack's lines: every kind of them, every length, and what frames say of lost bodies and time. */
#include "tests/unit/unit.h"

#include "base/result.h"
#include "tracking/dtrack.h"

#define POSE "[1.000 -2.500 3000.0][1 0 0 0 1 0 0 0 1]"
#define TURNED "[0 0 0][1 0 0 0 0 1 0 -1 0]" /* +90 degrees about x */
#define ZEROS "[0.000 0.000 0.000][0 0 0 0 0 0 0 0 0]"

static const char every_line[] =
	"fr 21753\r\n"
	"ts 39596.024831\r\n"
	"ts2 1700000000 24831 4200\r\n"
	"6dcal 4\r\n"
	"6d 1 [0 1.000][326.848 -187.216 109.503][0.940508 0.339238 0.019025 -0.333599 0.932599 "
	"-0.137735 -0.064467 0.123194 0.990286]\r\n"
	"6di 1 [2 3 0.250]" POSE "\r\n"
	"6df 1 [1 1.000 33]" POSE "\r\n"
	"6df2 1 1 [0 1.000 6 2][261.103 116.520 41.085][1 0 0 0 1 0 0 0 1][3 0.50 -0.25]\r\n"
	"6dmt 1 [0 1.000 255]" POSE "\r\n"
	"6dmt2 2 1 [1 1.000 1 1.500]" POSE "[1][0.1 0 0 0.1 0 0.1]\r\n"
	"6dmtr 1 1 [0 1.000]" POSE "\r\n"
	"6dj 1 1 [0 2][0 1.000][1 2 3 0.1 0.2 0.3][1 0 0 0 1 0 0 0 1][7 1.000] " POSE "\r\n"
	"6dcov 1 [0 1 2 3][1 2 3]\r\n"
	"3d 1 [1 1.000][1 2 3]\r\n"
	"glcal 1\r\n"
	"gl 1 [0 1.000 0 1]" POSE "\r\n"
	"something 1 2 3\r\n";

static int decode_bytes(const void *bytes, size_t len, struct track_dtrack_frame *out)
{
	uint8_t *copy = unit_copy(bytes, len);
	const int r = track_dtrack_decode(copy, len, out);

	free(copy);
	return r;
}

static int decode(const char *text, struct track_dtrack_frame *out)
{
	return decode_bytes(text, strlen(text), out);
}

static struct track_dtrack_frame decoded(const char *text)
{
	struct track_dtrack_frame frame;
	const int r = decode(text, &frame);

	if (r != GR_OK)
		fail_msg("%s of %s", track_fault_name((enum track_fault) - r), text);
	return frame;
}

static uint32_t bit(unsigned sensor)
{
	return UINT32_C(1) << sensor;
}

/* ---- lines ---- */

static void every_line_is_read(void **state)
{
	const struct track_dtrack_frame f = decoded(every_line);

	(void)state;
	assert_int_equal(f.number, 21753);
	assert_true(f.has_ts && f.has_ts2);
	assert_int_equal(f.ts_ns, INT64_C(39596024831000));
	assert_int_equal(f.ts2_ns, INT64_C(1700000000024831000));
	assert_int_equal(f.latency_ns, 4200000);
	assert_int_equal(f.listed, UINT32_MAX);
	assert_int_equal(f.present, bit(0) | bit(2) | bit(TRACK_DTRACK_FLYSTICK) |
					    bit(TRACK_DTRACK_FLYSTICK + 1) |
					    bit(TRACK_DTRACK_TOOL) | bit(TRACK_DTRACK_TOOL + 1) |
					    bit(TRACK_DTRACK_JOINT) | bit(TRACK_DTRACK_JOINT + 7));
	assert_int_equal(f.beyond, 0);
	assert_float_equal(f.items[0].place_mm[1], -187.216, 1e-9);
	assert_float_equal(f.items[0].turn[3], -0.333599, 1e-9);
	assert_float_equal(f.items[0].quality, 1, 0);
	assert_false(f.items[0].has_input);
	assert_true(f.items[2].quality < 0);
	assert_float_equal(f.items[TRACK_DTRACK_JOINT].place_mm[2], 3, 0);
	assert_float_equal(f.items[TRACK_DTRACK_JOINT + 7].place_mm[2], 3000, 0);
}

static void flysticks_old_and_new(void **state)
{
	struct track_dtrack_frame f = decoded(every_line);
	const struct track_dtrack_item *old = &f.items[TRACK_DTRACK_FLYSTICK + 1];
	const struct track_dtrack_item *new = &f.items[TRACK_DTRACK_FLYSTICK];

	(void)state;
	/* 33: front button and stick left. */
	assert_true(old->has_input && old->hat);
	assert_int_equal(old->buttons, 1);
	assert_int_equal(old->axis_count, 2);
	assert_float_equal(old->axes[0], -1, 0);
	assert_float_equal(old->axes[1], 0, 0);
	assert_true(new->has_input && !new->hat);
	assert_int_equal(new->buttons, 3);
	assert_int_equal(new->axis_count, 2);
	assert_float_equal(new->axes[0], 0.5, 0);
	assert_float_equal(new->axes[1], -0.25, 0);
	for (unsigned i = 0; i < 4; i++) {
		static const float want[4][2] = { { 0, -1 }, { -1, 0 }, { 0, 1 }, { 1, 0 } };
		char text[128];

		snprintf(text, sizeof text, "fr 1\n6df 1 [0 1 %u]" POSE, 0x10u << i);
		f = decoded(text);
		assert_float_equal(f.items[TRACK_DTRACK_FLYSTICK].axes[0], want[i][0], 0);
		assert_float_equal(f.items[TRACK_DTRACK_FLYSTICK].axes[1], want[i][1], 0);
		assert_int_equal(f.items[TRACK_DTRACK_FLYSTICK].buttons, 0);
	}
	/* No buttons, no values; more than 32 of either; values that are no axes of ours. */
	f = decoded("fr 1\n6df2 3 3 [0 1 0 0]" POSE "[][1 1 33 0]" POSE "[4294967295 1]"
		    "[2 1 1 9]" POSE "[1 0 0 0 0 0 0 0 1 -1]\n");
	assert_int_equal(f.items[TRACK_DTRACK_FLYSTICK].axis_count, 0);
	assert_int_equal(f.items[TRACK_DTRACK_FLYSTICK + 1].buttons, UINT32_MAX);
	assert_int_equal(f.items[TRACK_DTRACK_FLYSTICK + 2].axis_count, TRACK_AXES);
	assert_float_equal(f.items[TRACK_DTRACK_FLYSTICK + 2].axes[7], 1, 0);
	/* Bits beyond the number of buttons mean nothing. */
	f = decoded("fr 1\n6df2 1 1 [0 1 4 0]" POSE "[255]\n");
	assert_int_equal(f.items[TRACK_DTRACK_FLYSTICK].buttons, 15);
}

static void tools_have_buttons(void **state)
{
	const struct track_dtrack_frame f = decoded(every_line);

	(void)state;
	assert_int_equal(f.items[TRACK_DTRACK_TOOL].buttons, 15);
	assert_int_equal(f.items[TRACK_DTRACK_TOOL + 1].buttons, 1);
	assert_true(f.items[TRACK_DTRACK_TOOL + 1].has_input);
}

/* Both lines of the same body: the one that knows more, whichever stands first. */
static void newer_lines_go_before_older_ones(void **state)
{
	static const char *const texts[] = {
		"fr 1\n6d 1 [0 1]" POSE "\n6di 1 [0 0 0]" ZEROS "\n",
		"fr 1\n6di 1 [0 0 0]" ZEROS "\n6d 1 [0 1]" POSE "\n",
	};

	(void)state;
	for (int i = 0; i < 2; i++) {
		const struct track_dtrack_frame f = decoded(texts[i]);

		assert_int_equal(f.present, 1);
		assert_true(f.items[0].lost);
	}
}

static void numbers_beyond_are_counted(void **state)
{
	const struct track_dtrack_frame f = decoded(
		"fr 1\n6d 3 [11 1]" POSE "[12 1]" POSE "[4294967295 1]" POSE "\n6dj 2 2 [1 1][0 1]" POSE
		"[0 1][12 1]" POSE "\n");

	(void)state;
	assert_int_equal(f.present, bit(11));
	assert_int_equal(f.beyond, 4);
}

static void blanks_and_ends_may_differ(void **state)
{
	(void)state;
	decoded("fr 1");
	decoded("fr 1\n6d 0");
	decoded("fr 1\n6d 0 \r\n\r\n\n");
	decoded("fr 1\n6d 1 [0 1] [1 2 3] [1 0 0 0 1 0 0 0 1] \n");
	decoded("fr 1\n6d 1  [ 0  1 ][ 1 2 3 ][1 0 0 0 1 0 0 0 1]\n");
	assert_int_equal(decode_bytes("fr 1\n6d 0\n\0\0", 12, &(struct track_dtrack_frame){ 0 }),
			 GR_OK);
	/* Minus one is "no time" for A.R.T.'s own parser. */
	assert_false(decoded("fr 1\nts -1\n").has_ts);
	assert_true(decoded("fr 1\nts 86400.999999\n").has_ts);
}

static void what_is_no_frame_is_refused(void **state)
{
	static const char *const texts[] = {
		"ts 1\n",
		"\nfr 1\n",
		"fr\n",
		"fr -1\n",
		"fr 4294967296\n",
		"fr 1 2\n",
		"fr 1\nfr 2\n",
		"fr 1\nts x\n",
		"fr 1\nts 86402\n",
		"fr 1\nts 1e999\n",
		"fr 1\nts nan\n",
		"fr 1\nts 1\nts 1\n",
		"fr 1\nts2 1 2\n",
		"fr 1\nts2 1 1000000 2\n",
		"fr 1\nts2 4294967296 1 2\n",
		"fr 1\n6d\n",
		"fr 1\n6d 1\n",
		"fr 1\n6d 4097\n",
		"fr 1\n6d 2 [0 1]" POSE "\n",
		"fr 1\n6d 2 [0 1]" POSE "[0 1]" POSE "\n", /* the same twice */
		"fr 1\n6d 1 [0 1]" POSE "[1 1]" POSE "\n", /* more than it says */
		"fr 1\n6d 0\n6d 0\n",
		"fr 1\n6d 1 [0 1.5]" POSE "\n",
		"fr 1\n6d 1 [0]" POSE "\n",
		"fr 1\n6d 1 [0 1 2]" POSE "\n",
		"fr 1\n6d 1 [0 1][1 2][1 0 0 0 1 0 0 0 1]\n",
		"fr 1\n6d 1 [0 1][1 2 inf][1 0 0 0 1 0 0 0 1]\n",
		"fr 1\n6d 1 [0 1][1 2 1e10][1 0 0 0 1 0 0 0 1]\n",
		"fr 1\n6d 1 [0 1][1 2 3][1 0 0 0 1 0 0 0]\n",
		"fr 1\n6d 1 [0 1][1 2 3][1 0 0 0 1 0 0 0 1 0]\n",
		"fr 1\n6d 1 [0 1][1 2 3][1 0 0 0 1 0 0 0 nan]\n",
		"fr 1\n6di 1 [0 4 0]" POSE "\n",
		"fr 1\n6df 1 [0 1]" POSE "\n",
		"fr 1\n6df2 1 1 [0 1 6 2]" POSE "\n",
		"fr 1\n6df2 1 1 [0 1 6 2]" POSE "[1 0.5]\n",
		"fr 1\n6df2 1 1 [0 1 6 2]" POSE "[1 0.5 1.5]\n",
		"fr 1\n6df2 1 1 [0 1 6 2]" POSE "[1 0.5 0.5 0.5]\n",
		"fr 1\n6df2 1 1 [0 1 4294967295 2]" POSE "[1 0 0]\n",
		"fr 1\n6df2 1 1 [0 1 6 4294967295]" POSE "[1 0 0]\n",
		"fr 1\n6dmt2 1 1 [0 1 1 1]" POSE "[1]\n",
		"fr 1\n6dj 1 1 [0 2][0 1]" POSE "\n",
		"fr 1\n6dj 2 2 [0 1][0 1]" POSE "[0 1][0 1]" POSE "\n",
	};
	struct track_dtrack_frame out, before;

	(void)state;
	memset(&out, 0x5a, sizeof out);
	before = out;
	for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
		if (decode(texts[i], &out) != -TRACK_FAULT_FORMAT)
			fail_msg("taken: %s", texts[i]);
		assert_memory_equal(&out, &before, sizeof out);
	}
	assert_int_equal(decode_bytes("", 0, &out), -TRACK_FAULT_LENGTH);
	assert_int_equal(decode_bytes("\0\0\0", 3, &out), -TRACK_FAULT_LENGTH);
}

/* A datagram that was cut off anywhere is a whole one of fewer lines, or refused. */
static void every_length(void **state)
{
	const size_t whole = strlen(every_line);
	struct track_dtrack_frame f;
	unsigned taken = 0;

	(void)state;
	for (size_t len = 0; len <= whole; len++)
		taken += decode_bytes(every_line, len, &f) == GR_OK;
	printf("# of %zu lengths, %u are frames\n", whole + 1, taken);
	assert_in_range(taken, 17, whole);
}

static void a_datagram_has_a_most(void **state)
{
	uint8_t *bytes = malloc(TRACK_DTRACK_BYTES + 1);
	struct track_dtrack_frame f;

	(void)state;
	memset(bytes, ' ', TRACK_DTRACK_BYTES + 1);
	memcpy(bytes, "fr 1\nx ", 7);
	assert_int_equal(track_dtrack_decode(bytes, TRACK_DTRACK_BYTES, &f), GR_OK);
	assert_int_equal(track_dtrack_decode(bytes, TRACK_DTRACK_BYTES + 1, &f),
			 -TRACK_FAULT_LENGTH);
	free(bytes);
}

/* ---- frames to reports ---- */

#define MS GR_NS_PER_MS
static const struct track_dtrack_setup by_the_manual = { .stick_x_left = true };

struct stream {
	struct track_dtrack_state state;
	struct track_dtrack_setup setup;
	struct track_dtrack_reports out;
};

static int feed(struct stream *s, const char *text, int64_t arrived_ns)
{
	const struct track_dtrack_frame frame = decoded(text);

	return track_dtrack_take(&s->state, &s->setup, &frame, arrived_ns, &s->out);
}

static const struct track_report *report_of(const struct stream *s, unsigned sensor)
{
	for (unsigned i = 0; i < s->out.count; i++)
		if (s->out.reports[i].sensor == sensor)
			return &s->out.reports[i];
	return NULL;
}

static void matrices_are_by_columns(void **state)
{
	struct stream s = { 0 };
	const struct track_report *r;

	(void)state;
	assert_int_equal(feed(&s, "fr 1\n6d 1 [3 1]" TURNED "\n", 0), GR_OK);
	r = report_of(&s, 3);
	assert_non_null(r);
	assert_float_equal(r->T_base_sensor.q[0], sqrt(0.5), 1e-6);
	assert_float_equal(r->T_base_sensor.q[3], sqrt(0.5), 1e-6);
	assert_int_equal(r->has, TRACK_POSITION | TRACK_ORIENTATION | TRACK_QUALITY);
	assert_int_equal(feed(&s, "fr 2\n6d 1 [3 1]" POSE "\n", 0), GR_OK);
	assert_vector(report_of(&s, 3)->T_base_sensor.p, 0.001, -0.0025, 3);
}

/* Any turn comes back as it was, through text of six digits. */
static void every_turn_comes_back(void **state)
{
	struct unit_random random = unit_random_start("turns");
	float worst = 0;

	(void)state;
	for (int i = 0; i < 5000; i++) {
		struct stream s = { 0 };
		char text[400];
		versor q;
		mat3 m;
		float same;

		for (int k = 0; k < 4; k++)
			q[k] = (float)unit_random_range(&random, -1, 1);
		if (glm_vec4_norm(q) < 0.1f)
			continue;
		glm_quat_normalize(q);
		glm_quat_mat3(q, m);
		snprintf(text, sizeof text, "fr 1\n6d 1 [0 1][0 0 0][%f %f %f %f %f %f %f %f %f]\n",
			 (double)m[0][0], (double)m[0][1], (double)m[0][2], (double)m[1][0],
			 (double)m[1][1], (double)m[1][2], (double)m[2][0], (double)m[2][1],
			 (double)m[2][2]);
		assert_int_equal(feed(&s, text, 0), GR_OK);
		assert_int_equal(s.out.count, 1);
		same = fabsf(glm_vec4_dot(q, s.out.reports[0].T_base_sensor.q));
		worst = fmaxf(worst, 1 - same);
	}
	printf("# cosine of half the angle off: 1 - %.2g\n", (double)worst);
	assert_true(worst < 1e-6f);
}

static void a_matrix_that_turns_nothing_is_no_pose(void **state)
{
	static const char *const bad[] = {
		"[2 0 0 0 1 0 0 0 1]",	   "[1 0 0 0 1 0 0 0 -1]", "[1 0 0 1 0 0 0 0 1]",
		"[1 0.1 0 0 1 0 0 0 1]",   "[0 0 0 0 0 0 0 0 1]",  "[0.98 0 0 0 0.98 0 0 0 0.98]",
		"[1 0 0 0 1 0 0.02 0 1]", "[1 0 0 0 1 0.02 0 0 1]",
	};
	struct stream s = { .setup = by_the_manual };

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		char text[256];

		snprintf(text, sizeof text, "fr %zu\n6d 1 [0 1][0 0 0]%s\n6df2 1 1 [0 1 1 0][0 0 0]%s[1]\n",
			 i + 1, bad[i], bad[i]);
		assert_int_equal(feed(&s, text, 0), GR_OK);
		assert_int_equal(s.out.bad_poses, 2);
		/* The Flystick's buttons are right nevertheless. */
		assert_int_equal(s.out.count, 1);
		assert_int_equal(s.out.reports[0].has, TRACK_BUTTONS | TRACK_AXIS_VALUES);
		assert_int_equal(s.out.reports[0].buttons, 1);
	}
}

static void lost_bodies(void **state)
{
	struct stream s = { .setup = by_the_manual };
	const struct track_report *r;

	(void)state;
	/* Never seen: nothing is said of it. */
	feed(&s, "fr 1\n6d 0\n", 0);
	assert_int_equal(s.out.count, 0);
	feed(&s, "fr 2\n6d 1 [0 1]" POSE "\n", 0);
	/* Left out. */
	feed(&s, "fr 3\n6d 0\n", 0);
	assert_int_equal(s.out.count, 1);
	assert_int_equal(s.out.reports[0].has, TRACK_LOST);
	/* No line at all: this output is switched off, and nothing is known. */
	feed(&s, "fr 4\n", 0);
	assert_int_equal(s.out.count, 0);
	/* Back, elsewhere. */
	feed(&s, "fr 5\n6d 1 [0 1][5000 0 0][1 0 0 0 1 0 0 0 1]\n", 0);
	assert_float_equal(report_of(&s, 0)->T_base_sensor.p[0], 5, 1e-6);
	feed(&s, "fr 6\n6di 1 [0 0 0.0]" ZEROS "\n", 0);
	assert_int_equal(report_of(&s, 0)->has, TRACK_LOST);
	/* A Flystick stands there with zeros, and its buttons. */
	feed(&s, "fr 7\n6df2 1 1 [0 -1.000 6 2]" ZEROS "[5 0.25 1.00]\n", 0);
	r = report_of(&s, TRACK_DTRACK_FLYSTICK);
	assert_int_equal(r->has, TRACK_LOST | TRACK_BUTTONS | TRACK_AXIS_VALUES);
	assert_int_equal(r->buttons, 5);
	/* A matrix of zeros is lost whatever the quality says, and a quality of -1 likewise. */
	feed(&s, "fr 8\n6df 1 [0 1 2]" ZEROS "\n", 0);
	assert_int_equal(report_of(&s, TRACK_DTRACK_FLYSTICK)->has,
			 TRACK_LOST | TRACK_BUTTONS | TRACK_AXIS_VALUES);
	feed(&s, "fr 9\n6df 1 [0 -1 2]" POSE "\n", 0);
	assert_true(report_of(&s, TRACK_DTRACK_FLYSTICK)->has & TRACK_LOST);
}

static void sticks_have_signs(void **state)
{
	static const char text[] = "fr 1\n6df2 1 1 [0 1 1 2]" POSE "[1 0.50 -0.25]\n6df 2 [0 1 0]" POSE
				   "[1 1 144]" POSE "\n";

	(void)state;
	for (unsigned i = 0; i < 4; i++) {
		struct stream s = { .setup = { .stick_x_left = i & 1, .stick_y_down = i >> 1 } };
		const struct track_report *r;

		assert_int_equal(feed(&s, text, 0), GR_OK);
		r = report_of(&s, TRACK_DTRACK_FLYSTICK);
		assert_float_equal(r->axes[0], (i & 1 ? -0.5 : 0.5), 0);
		assert_float_equal(r->axes[1], (i >> 1 ? 0.25 : -0.25), 0);
		/* 144: right and down, by names that need no sign. */
		r = report_of(&s, TRACK_DTRACK_FLYSTICK + 1);
		assert_float_equal(r->axes[0], 1, 0);
		assert_float_equal(r->axes[1], -1, 0);
	}
}

static void a_room_with_z_up(void **state)
{
	struct stream s = { .setup = { .z_up = true } };
	const struct gr_pose *T;
	vec3 up = { 0, 0, 1 }, turned;

	(void)state;
	/* One metre to the right, two away, three up; turned by 90 degrees about its z. */
	feed(&s, "fr 1\n6d 1 [0 1][1000 2000 3000][0 1 0 -1 0 0 0 0 1]\n", 0);
	T = &report_of(&s, 0)->T_base_sensor;
	assert_vector(T->p, 1, 3, -2);
	/* About our y, then: what pointed right points away. */
	glm_quat_rotatev((float *)T->q, (vec3){ 1, 0, 0 }, turned);
	assert_vector(turned, 0, 0, -1);
	glm_quat_rotatev((float *)T->q, up, turned);
	assert_vector(turned, 1, 0, 0);
}

static void numbers_tell_order(void **state)
{
	struct stream s = { 0 };
	char text[32];

	(void)state;
	assert_int_equal(feed(&s, "fr 100\n", 0), GR_OK);
	assert_int_equal(s.out.missed, 0);
	assert_int_equal(feed(&s, "fr 100\n", MS), -TRACK_FAULT_ORDER);
	assert_int_equal(feed(&s, "fr 99\n", MS), -TRACK_FAULT_ORDER);
	assert_int_equal(feed(&s, "fr 103\n", MS), GR_OK);
	assert_int_equal(s.out.missed, 2);
	/* Any number of duplicates is a duplicate. */
	for (int i = 0; i < 100; i++)
		assert_int_equal(feed(&s, "fr 103\n", MS), -TRACK_FAULT_ORDER);
	/* The controller began anew: the eighth in a row is believed. */
	for (int i = 0; i < 8; i++) {
		snprintf(text, sizeof text, "fr %d\n", i + 1);
		assert_int_equal(feed(&s, text, 2 * MS), i < 7 ? -TRACK_FAULT_ORDER : GR_OK);
	}
	assert_int_equal(s.out.missed, 0);
	/* After a second of nothing any is. */
	assert_int_equal(feed(&s, "fr 2\n", 2 * GR_NS_PER_S), GR_OK);
	/* A leap is no loss, the counter's end none either. */
	assert_int_equal(feed(&s, "fr 2147483000\n", 2 * GR_NS_PER_S), GR_OK);
	assert_int_equal(s.out.missed, 0);
	s = (struct stream){ 0 };
	assert_int_equal(feed(&s, "fr 4294967295\n", 0), GR_OK);
	assert_int_equal(feed(&s, "fr 1\n", 0), GR_OK);
	assert_int_equal(s.out.missed, 1);
}

static int64_t time_of(struct stream *s, unsigned number, const char *times, int64_t arrived_ns)
{
	char text[256];

	snprintf(text, sizeof text, "fr %u\n%s\n6d 1 [0 1]" POSE "\n", number, times);
	assert_int_equal(feed(s, text, arrived_ns), GR_OK);
	assert_true(s->out.reports[0].has & TRACK_DEVICE_TIME);
	return s->out.reports[0].device_ns;
}

static void times_do_not_wrap(void **state)
{
	struct stream s = { 0 };
	const int64_t start = time_of(&s, 1, "ts 86399.990000", GR_NS_PER_S);

	(void)state;
	assert_int_equal(time_of(&s, 2, "ts 0.006000", GR_NS_PER_S + 16 * MS) - start, 16 * MS);
	assert_int_equal(time_of(&s, 3, "ts 86399.998000", GR_NS_PER_S + 24 * MS) - start, 8 * MS);
	/* After a night of nothing, with the next midnight in it. */
	assert_int_equal(time_of(&s, 4, "ts 3600.0", GR_NS_PER_S + 90000 * GR_NS_PER_S) - start,
			 3600 * GR_NS_PER_S + 86400 * GR_NS_PER_S + 10 * MS);
	/* ts2 goes before ts, and begins at a zero of its own. */
	s = (struct stream){ 0 };
	assert_int_equal(time_of(&s, 1, "ts 5\nts2 1700000000 999999 4000", 0), 0);
	assert_int_equal(time_of(&s, 2, "ts 5\nts2 1700000001 9999 4000", 10 * MS),
			 10 * MS);
	/* A clock that was set by forty years is on another zero, and far from overflow. */
	assert_int_equal(time_of(&s, 3, "ts2 400000000 0 0", 20 * MS), 0);
	assert_int_equal(time_of(&s, 4, "ts 5", 30 * MS), 0);
	/* Without a time there is none. */
	feed(&s, "fr 5\n6d 1 [0 1]" POSE "\n", 40 * MS);
	assert_false(s.out.reports[0].has & TRACK_DEVICE_TIME);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_line_is_read),
		cmocka_unit_test(flysticks_old_and_new),
		cmocka_unit_test(tools_have_buttons),
		cmocka_unit_test(newer_lines_go_before_older_ones),
		cmocka_unit_test(numbers_beyond_are_counted),
		cmocka_unit_test(blanks_and_ends_may_differ),
		cmocka_unit_test(what_is_no_frame_is_refused),
		cmocka_unit_test(every_length),
		cmocka_unit_test(a_datagram_has_a_most),
		cmocka_unit_test(matrices_are_by_columns),
		cmocka_unit_test(every_turn_comes_back),
		cmocka_unit_test(a_matrix_that_turns_nothing_is_no_pose),
		cmocka_unit_test(lost_bodies),
		cmocka_unit_test(sticks_have_signs),
		cmocka_unit_test(a_room_with_z_up),
		cmocka_unit_test(numbers_tell_order),
		cmocka_unit_test(times_do_not_wrap),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
