/*
 * Where things appear: on each wall in the quadrant where the visitor looks
 * for them (nothing mirrored or upside down), in each eye by its parallax, and
 * in each kind of picture in its half. Also what a frame does when the eye has
 * no picture or nothing changed.
 */
#include "base/log.h"
#include "base/result.h"
#include "renderer/renderer.h"
#include "tests/accuracy/cornell.h"
#include "tests/unit/gl.h"
#include "tests/unit/unit.h"

#define WIDTH 160
#define HEIGHT 120
#define MARKER 0.1f

enum { RED, GREEN, BLUE, MARKERS };

static const struct scene_material colours[MARKERS] = {
	{ .emission = { 1, 0, 0 }, .diffuse_image = -1, .emission_image = -1, .two_sided = true },
	{ .emission = { 0, 1, 0 }, .diffuse_image = -1, .emission_image = -1, .two_sided = true },
	{ .emission = { 0, 0, 1 }, .diffuse_image = -1, .emission_image = -1, .two_sided = true },
};

/* A small square about p whose normal is along an axis. */
static struct quad marker(int colour, const float p[3], int axis)
{
	static const float corner[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 }, { -1, 1 } };
	struct quad q = { .material = colour };

	for (int k = 0; k < 4; k++) {
		memcpy(q.at[k], p, sizeof(q.at[k]));
		q.at[k][(axis + 1) % 3] += MARKER * corner[k][0];
		q.at[k][(axis + 2) % 3] += MARKER * corner[k][1];
	}
	return q;
}

struct setup {
	struct scene scene;
	struct scene_file file;
	struct renderer *renderer;
	struct render_frame frame;
	int width, height;
	uint8_t *rgb;
};

static void start(struct setup *s, struct target *target, const struct quad *quads, size_t count,
		  const struct projection_wall *wall, enum renderer_eyes eyes)
{
	const struct renderer_params params = { .width = WIDTH, .height = HEIGHT, .eyes = eyes,
						.wall_given = true, .wall = *wall };

	memset(s, 0, sizeof(*s));
	s->file = quads_file();
	s->file.tone.curve = SCENE_CURVE_LINEAR;
	quads_scene(&s->scene, quads, count, colours, MARKERS);
	renderer_target_size(&params, &s->width, &s->height);
	s->rgb = quads_alloc((size_t)(3 * s->width * s->height), 1);
	assert_int_equal(renderer_create(&s->renderer, target, &params, &s->file, &s->scene),
			 GR_OK);
	render_frame_init(&s->frame, &s->file);
}

static void stop(struct setup *s)
{
	renderer_destroy(&s->renderer);
	quads_free(&s->scene);
	free(s->rgb);
}

static void draw(struct setup *s)
{
	assert_int_equal(renderer_draw(s->renderer, &s->frame), GR_OK);
	assert_int_equal(renderer_read_rgb(s->renderer, s->rgb), GR_OK);
}

/* Middle of the pixels of a colour, pixels from the upper left corner; how many there are. */
static int middle(const struct setup *s, int colour, int x0, int y0, int width, int height,
		  double at[2])
{
	double sum[2] = { 0, 0 };
	int n = 0;

	for (int y = y0; y < y0 + height; y++)
		for (int x = x0; x < x0 + width; x++) {
			if (s->rgb[3 * (y * s->width + x) + colour] < 128)
				continue;
			sum[0] += x - x0 + 0.5;
			sum[1] += y - y0 + 0.5;
			n++;
		}
	for (int i = 0; i < 2; i++)
		at[i] = n ? sum[i] / n : -1;
	return n;
}

struct expected {
	const char *wall;
	struct projection_wall corners;
	int axis;            /* the wall's normal */
	float red[3];        /* to the visitor's upper left */
	float green[3];      /* upper right */
	float blue[3];       /* lower left */
};

/*
 * A visitor in the middle, looking at each wall with the head upright; at the
 * floor with the toes to the front. Right of the front wall is +x; facing left
 * (-x), right is the front (-z); facing right, right is behind (+z); on the
 * floor up is the front.
 */
static const struct expected faces[] = {
	{ "front", { { -1.5f, 0, -1.5f }, { 1.5f, 0, -1.5f }, { -1.5f, 2.25f, -1.5f } }, 2,
	  { -0.75f, 1.7f, -1.5f }, { 0.75f, 1.7f, -1.5f }, { -0.75f, 0.5f, -1.5f } },
	{ "left", { { -1.5f, 0, 1.5f }, { -1.5f, 0, -1.5f }, { -1.5f, 2.25f, 1.5f } }, 0,
	  { -1.5f, 1.7f, 0.75f }, { -1.5f, 1.7f, -0.75f }, { -1.5f, 0.5f, 0.75f } },
	{ "right", { { 1.5f, 0, -1.5f }, { 1.5f, 0, 1.5f }, { 1.5f, 2.25f, -1.5f } }, 0,
	  { 1.5f, 1.7f, -0.75f }, { 1.5f, 1.7f, 0.75f }, { 1.5f, 0.5f, -0.75f } },
	{ "floor", { { -1.5f, 0, 1.5f }, { 1.5f, 0, 1.5f }, { -1.5f, 0, -1.5f } }, 1,
	  { -0.75f, 0, -0.75f }, { 0.75f, 0, -0.75f }, { -0.75f, 0, 0.75f } },
};

static void nothing_mirrored(void **state)
{
	for (size_t w = 0; w < sizeof(faces) / sizeof(faces[0]); w++) {
		const struct expected *e = &faces[w];
		const struct quad quads[3] = { marker(RED, e->red, e->axis),
					       marker(GREEN, e->green, e->axis),
					       marker(BLUE, e->blue, e->axis) };
		double red[2], green[2], blue[2];
		struct setup s;

		start(&s, *state, quads, 3, &e->corners, RENDERER_MONO);
		draw(&s);
		assert_true(middle(&s, RED, 0, 0, WIDTH, HEIGHT, red) > 20);
		assert_true(middle(&s, GREEN, 0, 0, WIDTH, HEIGHT, green) > 20);
		assert_true(middle(&s, BLUE, 0, 0, WIDTH, HEIGHT, blue) > 20);
		printf("# %s: red %.0f %.0f, green %.0f %.0f, blue %.0f %.0f of %d x %d\n", e->wall,
		       red[0], red[1], green[0], green[1], blue[0], blue[1], WIDTH, HEIGHT);
		assert_true(red[0] < WIDTH / 2 && red[1] < HEIGHT / 2);
		assert_true(green[0] > WIDTH / 2 && green[1] < HEIGHT / 2);
		assert_true(blue[0] < WIDTH / 2 && blue[1] > HEIGHT / 2);
		/* they lie in the wall's plane: at a quarter of its width for any head */
		assert_true(fabs(red[0] - WIDTH / 4.0) < 0.6);
		stop(&s);
	}
}

#define BEHIND 2.0
#define HEAD_DISTANCE 1.5

static const struct projection_wall front = { { -1.5f, 0, -1.5f }, { 1.5f, 0, -1.5f },
					      { -1.5f, 2.25f, -1.5f } };

/* A marker 2 m behind the front wall, left of the middle and high. */
static struct quad far_marker(void)
{
	const float p[3] = { -0.5f, 2.3f, (float)(-HEAD_DISTANCE - BEHIND) };

	return marker(GREEN, p, 2);
}

/* Where an eye at x sees it on the wall, pixels from the left. */
static double pixel_seen_from(double x)
{
	double share = HEAD_DISTANCE / (HEAD_DISTANCE + BEHIND);
	double on_wall = x + (-0.5 - x) * share;

	return (on_wall + 1.5) / 3 * WIDTH;
}

static void parallax(void **state)
{
	static const struct {
		enum renderer_eyes eyes;
		const char *name;
		int pictures, x[2], y[2];
		double eye[2]; /* in separations */
	} kinds[] = {
		{ RENDERER_MONO, "mono", 1, { 0, 0 }, { 0, 0 }, { 0, 0 } },
		{ RENDERER_LEFT, "left", 1, { 0, 0 }, { 0, 0 }, { -0.5, 0 } },
		{ RENDERER_RIGHT, "right", 1, { 0, 0 }, { 0, 0 }, { 0.5, 0 } },
		{ RENDERER_SIDE_BY_SIDE, "side by side", 2, { 0, WIDTH }, { 0, 0 }, { -0.5, 0.5 } },
		{ RENDERER_TOP_BOTTOM, "top bottom", 2, { 0, 0 }, { 0, HEIGHT }, { -0.5, 0.5 } },
	};
	const double separation = 0.3; /* wide, so that the pixels tell it */
	struct quad quad = far_marker();

	for (size_t k = 0; k < sizeof(kinds) / sizeof(kinds[0]); k++) {
		struct setup s;

		start(&s, *state, &quad, 1, &front, kinds[k].eyes);
		s.frame.eye_separation_m = (float)separation;
		s.frame.T_room_head.p[1] = 1.2f;
		draw(&s);
		for (int i = 0; i < kinds[k].pictures; i++) {
			double at[2], want = pixel_seen_from(kinds[k].eye[i] * separation);

			assert_true(middle(&s, GREEN, kinds[k].x[i], kinds[k].y[i], WIDTH, HEIGHT,
					   at) > 10);
			printf("# %s, picture %d: seen at %.2f, expected %.2f pixels\n",
			       kinds[k].name, i, at[0], want);
			assert_true(fabs(at[0] - want) < 0.5);
			assert_true(at[1] < HEIGHT / 2.0);
		}
		stop(&s);
	}
}

/* Turning the head about its own middle moves the eyes, and only them. */
static void eyes_turn_with_head(void **state)
{
	struct quad quad = far_marker();
	struct setup s;
	vec3 axis = { 0, 1, 0 };
	double at[2];

	start(&s, *state, &quad, 1, &front, RENDERER_RIGHT);
	s.frame.eye_separation_m = 0.3f;
	s.frame.T_room_head.p[1] = 1.2f;
	glm_quatv(s.frame.T_room_head.q, (float)M_PI, axis); /* looks back: right eye is at -x */
	draw(&s);
	assert_true(middle(&s, GREEN, 0, 0, WIDTH, HEIGHT, at) > 10);
	assert_true(fabs(at[0] - pixel_seen_from(-0.15)) < 0.5);
	stop(&s);
}

static void behind_the_wall(void **state)
{
	struct quad quad = far_marker();
	struct renderer_stats stats;
	struct setup s;
	double before[2], after[2];

	start(&s, *state, &quad, 1, &front, RENDERER_MONO);
	draw(&s);
	middle(&s, GREEN, 0, 0, WIDTH, HEIGHT, before);
	for (int k = 0; k < 3; k++) {
		static const float z[3] = { -1.5f, -1.50005f, -4 };

		s.frame.T_room_head.p[2] = z[k];
		assert_int_equal(renderer_draw(s.renderer, &s.frame), GR_NOTHING);
	}
	assert_int_equal(renderer_read_rgb(s.renderer, s.rgb), GR_OK);
	middle(&s, GREEN, 0, 0, WIDTH, HEIGHT, after);
	assert_true(before[0] == after[0] && before[1] == after[1]);
	renderer_stats(s.renderer, &stats);
	assert_int_equal(stats.skipped_eyes, 3);
	assert_int_equal(stats.nonfinite, 0);
	/* back in front, the picture is a new one */
	s.frame.T_room_head.p[2] = 0;
	s.frame.T_room_head.p[0] = 0.5f;
	draw(&s);
	middle(&s, GREEN, 0, 0, WIDTH, HEIGHT, after);
	assert_true(fabs(before[0] - after[0]) > 5);
	stop(&s);
}

static uint64_t ran(struct setup *s, const char *name)
{
	struct timer_stats t;

	for (int i = 0; i < TIMER_STAGES; i++) {
		timers_stats(renderer_timers(s->renderer), i, &t);
		if (t.name && strcmp(t.name, name) == 0)
			return t.count;
	}
	return 0;
}

static void refused(void **state)
{
	struct quad quad = far_marker();
	const struct renderer_params large = { .width = 10000, .height = 10,
					       .eyes = RENDERER_MONO };
	struct scene_camera camera = { .position = { 0, 0, 1 }, .up = { 0, 1, 0 }, .vfov_rad = 1 };
	struct renderer *r = NULL;
	struct setup s;

	start(&s, *state, &quad, 1, &front, RENDERER_SIDE_BY_SIDE);
	gr_log_set_level(0);
	assert_int_equal(renderer_create(&r, *state, &large, &s.file, &s.scene), GR_ERR_RANGE);
	gr_log_set_level(GR_LOG_WARNING);
	assert_null(r);
	assert_int_equal(renderer_draw_camera(s.renderer, &s.frame, &camera), GR_ERR_STATE);
	s.frame.T_room_head.p[1] = NAN;
	assert_int_equal(renderer_draw(s.renderer, &s.frame), GR_ERR_RANGE);
	s.frame.T_room_head.p[1] = 1;
	s.frame.T_scene_room.q[3] = 0;
	assert_int_equal(renderer_draw(s.renderer, &s.frame), GR_ERR_RANGE);
	s.frame.T_scene_room.q[3] = 1;
	s.frame.gi_incremental = NAN;
	assert_int_equal(renderer_draw(s.renderer, &s.frame), GR_ERR_RANGE);
	stop(&s);
}

static void unchanged_is_not_drawn(void **state)
{
	struct quad quad = far_marker();
	struct setup s;

	start(&s, *state, &quad, 1, &front, RENDERER_MONO);
	for (int k = 0; k < 8; k++) {
		assert_int_equal(renderer_draw(s.renderer, &s.frame), GR_OK);
		assert_int_equal(renderer_finished(s.renderer, INT64_C(10000000000)), GR_OK);
	}
	assert_int_equal(ran(&s, "shadow"), 1);
	assert_int_equal(ran(&s, "gbuffer"), 1);
	assert_int_equal(ran(&s, "shade"), 1);
	assert_int_equal(ran(&s, "tone"), 1);
	s.frame.exposure = 0.5f;
	for (int k = 0; k < 8; k++) {
		assert_int_equal(renderer_draw(s.renderer, &s.frame), GR_OK);
		assert_int_equal(renderer_finished(s.renderer, INT64_C(10000000000)), GR_OK);
	}
	assert_int_equal(ran(&s, "shade"), 1);
	assert_int_equal(ran(&s, "tone"), 2);
	stop(&s);
}

int main(void)
{
	struct target *target = gl_target_or_skip(2 * WIDTH, 2 * HEIGHT);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_prestate(nothing_mirrored, target),
		cmocka_unit_test_prestate(parallax, target),
		cmocka_unit_test_prestate(eyes_turn_with_head, target),
		cmocka_unit_test_prestate(behind_the_wall, target),
		cmocka_unit_test_prestate(unchanged_is_not_drawn, target),
		cmocka_unit_test_prestate(refused, target),
	};
	int failed;

	gr_log_init("test_stereo", GR_LOG_WARNING);
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	target_destroy(&target);
	return failed;
}
