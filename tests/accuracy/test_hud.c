/*
 * The HUD beside the wand: one thing in both eyes and across walls, readable
 * at any exposure, without a trace in the light, and nothing at all while it is
 * not shown.
 */
#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "renderer/gi/gi.h"
#include "renderer/renderer.h"
#include "renderer/view/hud_parts.h"
#include "tests/accuracy/cornell.h"
#include "tests/unit/gl.h"
#include "tests/unit/unit.h"

/* As test_seam: outermost pixel centres on the wall's edges. */
#define STEPS 180
#define PIXELS (STEPS + 1)
#define SEPARATION 0.064f
#define SCALE 4

static const struct projection_wall front = { { -1.5f, 0, -1.5f }, { 1.5f, 0, -1.5f }, { -1.5f, 3, -1.5f } };
static const struct projection_wall left = { { -1.5f, 0, 1.5f }, { -1.5f, 0, -1.5f }, { -1.5f, 3, 1.5f } };

struct setup {
	struct scene scene;
	struct scene_file file;
	struct scene_lamp lamps[1];
	struct renderer *renderer;
	struct render_frame frame;
	int width, height;
	uint8_t *rgb;
};

static void widen(const struct projection_wall *wall, struct projection_wall *out)
{
	const float half = 0.5f / STEPS;

	for (int i = 0; i < 3; i++) {
		float right = (wall->lower_right[i] - wall->lower_left[i]) * half;
		float up = (wall->upper_left[i] - wall->lower_left[i]) * half;

		out->lower_left[i] = wall->lower_left[i] - right - up;
		out->lower_right[i] = wall->lower_right[i] + right - up;
		out->upper_left[i] = wall->upper_left[i] - right + up;
	}
}

/* A dark quadrilateral behind the wand, or before it, and a lamp that is far away. */
static void start(struct setup *s, struct target *target, const struct projection_wall *wall,
		  enum renderer_eyes eyes, float quad_z)
{
	const float z = quad_z;
	const struct quad quad = { 0, { { -9, -9, z }, { 9, -9, z }, { 9, 9, z }, { -9, 9, z } } };
	static const struct scene_material dark = { .diffuse = { 0.02f, 0.02f, 0.02f }, .diffuse_image = -1,
						    .emission_image = -1, .two_sided = true };
	struct renderer_params params = { .width = PIXELS, .height = PIXELS, .eyes = eyes, .wall_given = true,
					  .keep_radiance = true };

	memset(s, 0, sizeof *s);
	widen(wall, &params.wall);
	s->file = quads_file();
	s->lamps[0] = (struct scene_lamp){ .name = "torch", .kind = SCENE_LAMP_SPOT, .position = { 0, 2, 3 },
					   .direction = { 0, 0, -1 }, .intensity = { 40, 20, 10 },
					   .cone_rad = 0.9f, .penumbra_rad = 0.1f, .on = true };
	s->file.lamps = s->lamps;
	s->file.lamp_count = 1;
	s->file.gi.method = SCENE_GI_LPV;
	s->file.gi.lattice = 8;
	s->file.gi.steps = 2;
	s->file.gi.rsm_pixels = 32;
	s->file.shadow_pixels = 64;
	quads_scene(&s->scene, &quad, 1, &dark, 1);
	renderer_target_size(&params, &s->width, &s->height);
	s->rgb = quads_alloc((size_t)(3 * s->width * s->height), 1);
	assert_int_equal(renderer_create(&s->renderer, target, &params, &s->file, &s->scene), GR_OK);
	render_frame_init(&s->frame, &s->file);
	s->frame.eye_separation_m = SEPARATION;
	s->frame.hand = (struct frame_hand){ .shown = true, .scale = 2, .torch = 0, .torch_hue = 0.05f,
					     .T_room_wand = { { -0.45f, 1.55f, -0.45f }, { 0, 0.382683f, 0, 0.923880f } } };
}

static void stop(struct setup *s)
{
	renderer_destroy(&s->renderer);
	quads_free(&s->scene);
	free(s->rgb);
}

static void draw(struct setup *s)
{
	struct renderer_stats stats;

	s->frame.frame++;
	assert_int_equal(renderer_draw(s->renderer, &s->frame), GR_OK);
	assert_int_equal(renderer_read_rgb(s->renderer, s->rgb), GR_OK);
	renderer_stats(s->renderer, &stats);
	assert_int_equal(stats.gl_errors, 0);
}

/* GROTTO_TEST_PICTURES: what is looked at goes there as PPM files. */
static void keep(const struct setup *s, const char *name)
{
	const char *folder = getenv("GROTTO_TEST_PICTURES");
	char path[512];
	FILE *file;

	if (!folder)
		return;
	snprintf(path, sizeof path, "%s/%s.ppm", folder, name);
	file = fopen(path, "wb");
	assert_non_null(file);
	fprintf(file, "P6\n%d %d\n255\n", s->width, s->height);
	fwrite(s->rgb, 3, (size_t)(s->width * s->height), file);
	fclose(file);
}

static struct hud_view view_of(enum frame_hand_mode mode)
{
	struct hud_view v;

	memset(&v, 0, sizeof v);
	v.T_room_wand = GR_POSE_IDENTITY;
	v.T_room_scene = GR_POSE_IDENTITY;
	v.scale = 1;
	v.mode = mode;
	v.quality = v.refines = v.has_torch = v.torch_on = true;
	v.torch_direction[1] = -1;
	v.torch_intensity[0] = 100;
	v.torch_half_angle = 0.4f;
	v.torch_hue = 0.3f;
	v.absorption_per_m = 0.2f;
	v.scattering_per_m = 3; /* beyond the bar */
	v.incremental = 0.8f;
	v.work = 'P';
	v.work_share = 0.25f;
	return v;
}

/* Everything fits, is a body and no mirror image, and stands beside the wand. */
static void parts_are_sound(void **state)
{
	struct hud_part parts[HUD_PARTS_MOST];
	const vec3 eye = { 0, 0.3f, 0.4f };
	size_t most = 0;

	(void)state;
	for (int mode = 0; mode < FRAME_HAND_MODES; mode++) {
		struct hud_view v = view_of((enum frame_hand_mode)mode);
		const size_t count = hud_parts(&v, parts);
		int white = 0;

		most = count > most ? count : most;
		assert_true(count > 8 && count < HUD_PARTS_MOST);
		hud_parts_sort(parts, count, eye);
		for (size_t i = 0; i < count; i++) {
			mat3 m;
			float p[3];

			glm_mat4_pick3(parts[i].T_room_part, m);
			assert_true(isfinite(glm_mat3_det(m)) && glm_mat3_det(m) > 0);
			for (int k = 0; k < 3; k++) {
				p[k] = parts[i].T_room_part[3][k];
				assert_true(parts[i].color[k] >= 0 && parts[i].color[k] <= 1);
			}
			assert_true(fabsf(p[0]) < 0.2f && fabsf(p[1]) < 0.1f);
			white += parts[i].color[0] == 1 && parts[i].color[1] == 1 && parts[i].color[2] == 1;
		}
		assert_true(white > 0);
		for (size_t i = 1; i < count; i++) { /* farthest first; a cone counts by its middle */
			vec3 a, b;

			for (int k = 0; k < 3; k++) {
				a[k] = parts[i - 1].T_room_part[3][k] -
				       (parts[i - 1].shape == HUD_CONE ? 0.5f : 0) * parts[i - 1].T_room_part[2][k];
				b[k] = parts[i].T_room_part[3][k] -
				       (parts[i].shape == HUD_CONE ? 0.5f : 0) * parts[i].T_room_part[2][k];
			}
			assert_true(glm_vec3_distance(a, (float *)eye) >= glm_vec3_distance(b, (float *)eye) - 1e-6f);
		}
	}
	printf("# at most %zu parts, room for %d\n", most, HUD_PARTS_MOST);
}

static const uint8_t *at(const struct setup *s, int x, int y)
{
	return s->rgb + 3 * ((ptrdiff_t)y * s->width + x);
}

static bool bright(const uint8_t *pixel)
{
	return pixel[0] > 90 || pixel[1] > 90 || pixel[2] > 90;
}

/* Both walls' pixels for the same rays, along the edge that they share. */
static void joins_across_walls(void **state)
{
	static const float heads[3][3] = { { 0, 1.7f, 0 }, { 0.1f, 1.5f, 0.2f }, { -0.2f, 1.8f, 0.1f } };
	static const float aside[FRAME_HAND_MODES] = { 0.1f, -0.125f, -0.125f };
	static uint8_t seams[FRAME_HAND_MODES * 3][2 * PIXELS][3];
	int differ = 0, shown = 0, pixels[2] = { 0, 0 };

	for (int w = 0; w < 2; w++) {
		struct setup s;

		start(&s, *state, w ? &left : &front, RENDERER_SIDE_BY_SIDE, -4);
		s.frame.exposure = 1e-9f; /* the room is black: what is seen is the HUD */
		s.frame.hand.scale = SCALE;
		for (int k = 0; k < FRAME_HAND_MODES * 3; k++) {
			const float by = aside[k / 3] * SCALE * (float)M_SQRT1_2;
			char name[64];

			s.frame.hand.mode = (enum frame_hand_mode)(k / 3);
			/* Along the wand's right hand, so that symbols, or bars, lie across the edge. */
			s.frame.hand.T_room_wand.p[0] = -0.45f + by;
			s.frame.hand.T_room_wand.p[2] = -0.45f - by;
			memcpy(s.frame.T_room_head.p, heads[k % 3], sizeof heads[0]);
			draw(&s);
			snprintf(name, sizeof name, "hud-%d-%d-%s", k / 3, k % 3, w ? "left" : "front");
			keep(&s, name);
			for (int y = 0; y < 2 * PIXELS; y++) { /* one eye's, then the other's */
				const int x = y / PIXELS * PIXELS + (w ? PIXELS - 1 : 0);
				const uint8_t *p = at(&s, x, y % PIXELS);
				uint8_t *other = seams[k][y];

				if (!w) {
					memcpy(other, p, 3);
				} else if (bright(p) || bright(other)) {
					shown++;
					differ += abs(p[0] - other[0]) > 3 || abs(p[1] - other[1]) > 3 ||
						  abs(p[2] - other[2]) > 3;
				}
			}
			for (int i = 0; i < s.width * s.height; i++)
				pixels[w] += bright(s.rgb + (ptrdiff_t)3 * i);
		}
		stop(&s);
	}
	printf("# %d pixels on the edge show the HUD in one picture or the other, %d differ; %d and %d pixels in all\n",
	       shown, differ, pixels[0], pixels[1]);
	assert_true(pixels[0] > 2000 && pixels[1] > 2000); /* it spans both */
	assert_true(shown > 40);
	assert_true(differ * 50 <= shown);
}

/* Where an eye sees a point of the room on the front wall, pixels from the upper left of its picture. */
static void seen_at(const vec3 eye, const vec3 point, double out[2])
{
	const double t = (-1.5 - (double)eye[2]) / ((double)point[2] - (double)eye[2]);
	const double x = (double)eye[0] + t * ((double)point[0] - (double)eye[0]);
	const double y = (double)eye[1] + t * ((double)point[1] - (double)eye[1]);

	out[0] = (x + 1.5) / 3 * STEPS;
	out[1] = (1 - y / 3) * STEPS;
}

/* Each eye sees it where it is, not painted on the wall. */
static void stereo_puts_it_at_the_wand(void **state)
{
	struct hud_part parts[HUD_PARTS_MOST];
	struct hud_view v = view_of(FRAME_HAND_NAVIGATION);
	double places[2][2] = { { 0 } };
	struct setup s;

	start(&s, *state, &front, RENDERER_SIDE_BY_SIDE, -4);
	s.frame.exposure = 1e-9f;
	s.frame.hand.scale = SCALE;
	s.frame.hand.T_room_wand = (struct gr_pose){ { 0.1f, 1.6f, -0.5f }, { 0, 0, 0, 1 } };
	draw(&s);
	keep(&s, "hud-stereo");
	v.T_room_wand = s.frame.hand.T_room_wand;
	v.scale = s.frame.hand.scale;
	assert_true(hud_parts(&v, parts) > 0);
	for (int eye = 0; eye < 2; eye++) {
		/* The mark beside the symbol in use, white, the first of the parts. */
		const vec3 from = { (eye ? 0.5f : -0.5f) * SEPARATION, 1.7f, 0 };
		double want[2], sum[2] = { 0, 0 };
		int n = 0;

		seen_at(from, parts[0].T_room_part[3], want);
		for (int y = 0; y < PIXELS; y++)
			for (int x = 0; x < PIXELS; x++) {
				if (fabs(x - want[0]) > 4 || fabs(y - want[1]) > 15 || !bright(at(&s, eye * PIXELS + x, y)))
					continue;
				sum[0] += x;
				sum[1] += y;
				n++;
			}
		assert_true(n > 10);
		for (int i = 0; i < 2; i++)
			places[eye][i] = sum[i] / n;
		printf("# eye %d sees the mark at %.2f %.2f, expected %.2f %.2f pixels\n", eye, places[eye][0],
		       places[eye][1], want[0], want[1]);
		assert_true(fabs(places[eye][0] - want[0]) < 0.6 && fabs(places[eye][1] - want[1]) < 0.6);
	}
	/* 0.64 m away, with a wall at 1.5 m: 8.6 cm to the left in the right eye. On the wall it would be none. */
	assert_true(fabs(places[0][0] - places[1][0] - 0.086 / 3 * STEPS) < 0.7);
	stop(&s);
}

static uint64_t ran(const struct setup *s, const char *name)
{
	struct timer_stats t;

	for (int i = 0; i < TIMER_STAGES; i++) {
		timers_stats(renderer_timers(s->renderer), i, &t);
		if (t.name && !strcmp(t.name, name))
			return t.count;
	}
	return 0;
}

/* The light, its maps and the radiance are the same to the bit with it and without; hidden, nothing is left. */
static void leaves_no_trace(void **state)
{
	struct setup s;
	struct renderer_stats before, after;
	struct image with, without;
	uint64_t hash;
	uint8_t *plain;
	size_t bytes;

	start(&s, *state, &front, RENDERER_MONO, -4);
	bytes = (size_t)(3 * s.width * s.height);
	s.frame.hand.shown = false;
	for (int i = 0; i < 80; i++) /* until the light rests */
		draw(&s);
	assert_int_equal(ran(&s, "hud"), 0);
	plain = unit_copy(s.rgb, bytes);
	hash = renderer_light_hash(s.renderer);
	renderer_stats(s.renderer, &before);
	assert_int_equal(renderer_read_radiance(s.renderer, 0, &without), GR_OK);
	s.frame.hand.shown = true;
	s.frame.hand.mode = FRAME_HAND_LIGHTING;
	for (int i = 0; i < 8; i++) {
		s.frame.hand.T_room_wand.p[0] += 0.01f;
		draw(&s);
	}
	assert_true(memcmp(plain, s.rgb, bytes) != 0);
	renderer_stats(s.renderer, &after);
	assert_int_equal(renderer_light_hash(s.renderer), hash);
	assert_int_equal(after.shadow_updates, before.shadow_updates);
	assert_int_equal(after.gi_updates, before.gi_updates);
	assert_int_equal(renderer_read_radiance(s.renderer, 0, &with), GR_OK);
	assert_memory_equal(with.data, without.data, (size_t)(s.width * s.height) * 3 * sizeof(float));
	image_finish(&with);
	image_finish(&without);
	for (int i = 0; i < 8; i++) { /* shown as before: not drawn again */
		assert_int_equal(renderer_draw(s.renderer, &s.frame), GR_OK);
		assert_int_equal(renderer_finished(s.renderer, INT64_C(10000000000)), GR_OK);
	}
	const uint64_t drawn = ran(&s, "hud");

	assert_true(drawn >= 1 && drawn <= 8);
	s.frame.hand.shown = false;
	for (int i = 0; i < 8; i++)
		draw(&s);
	assert_memory_equal(plain, s.rgb, bytes);
	assert_int_equal(ran(&s, "hud"), drawn);
	free(plain);
	/* A wand that is nowhere is refused while it is to be shown. */
	s.frame.hand.shown = true;
	s.frame.hand.T_room_wand.p[0] = NAN;
	assert_int_equal(renderer_draw(s.renderer, &s.frame), GR_ERR_RANGE);
	s.frame.hand.shown = false;
	assert_int_equal(renderer_draw(s.renderer, &s.frame), GR_OK);
	stop(&s);
}

/* The brightest pixel within the HUD's mark; *rim: the darkest near it. */
static int mark_of(struct setup *s, int *rim)
{
	struct hud_part parts[HUD_PARTS_MOST];
	struct hud_view v = view_of(s->frame.hand.mode);
	double want[2];
	int most = 0;

	*rim = 255;
	draw(s);
	v.T_room_wand = s->frame.hand.T_room_wand;
	v.scale = s->frame.hand.scale;
	hud_parts(&v, parts);
	seen_at(s->frame.T_room_head.p, parts[0].T_room_part[3], want);
	for (int y = -2; y <= 2; y++)
		for (int x = -4; x <= 4; x++) {
			const int level = at(s, (int)lrint(want[0]) + x, (int)lrint(want[1]) + y)[1];

			*rim = level < *rim ? level : *rim;
			if (abs(x) <= 2)
				most = level > most ? level : most;
		}
	return most;
}

/* Milliseconds a frame: the tone pass, and the HUD over it when it is shown and moves. */
static double frame_ms(struct setup *s, bool shown, int frames)
{
	const int64_t start_ns = gr_clock_now(&gr_clock_monotonic);

	s->frame.hand.shown = shown;
	for (int i = 0; i < frames; i++) {
		s->frame.exposure = i & 1 ? 1 : 0.9f;
		s->frame.hand.T_room_wand.p[0] = 0.1f + 1e-3f * (float)(i & 1);
		assert_int_equal(renderer_draw(s->renderer, &s->frame), GR_OK);
		assert_int_equal(renderer_finished(s->renderer, INT64_C(60000000000)), GR_OK);
	}
	return (double)(gr_clock_now(&gr_clock_monotonic) - start_ns) * 1e-6 / frames;
}

static void costs_little(void **state)
{
	double with[5], without[5];
	struct setup s;

	start(&s, *state, &front, RENDERER_SIDE_BY_SIDE, -4);
	s.frame.hand.mode = FRAME_HAND_SETTINGS;
	s.frame.hand.T_room_wand = (struct gr_pose){ { 0.1f, 1.6f, -0.5f }, { 0, 0, 0, 1 } };
	frame_ms(&s, true, 60); /* until the light rests */
	for (int i = 0; i < 5; i++) { /* in turns, on a machine that does other things, too */
		without[i] = frame_ms(&s, false, 10);
		with[i] = frame_ms(&s, true, 10);
	}
	for (int i = 1; i < 5; i++) {
		with[0] = fmin(with[0], with[i]);
		without[0] = fmin(without[0], without[i]);
	}
	printf("# both eyes of %d x %d: tone alone %.3f ms, with the HUD %.3f ms (least of five)\n", PIXELS, PIXELS,
	       without[0], with[0]);
	stop(&s);
}

static void readable_and_faint_behind(void **state)
{
	static const float exposures[] = { 1e-6f, 1e-2f, 1, 1e9f };
	int levels[4], rim = 0, behind, hidden;
	struct setup s;

	start(&s, *state, &front, RENDERER_MONO, -4);
	s.frame.hand.T_room_wand = (struct gr_pose){ { 0.1f, 1.6f, -0.5f }, { 0, 0, 0, 1 } };
	s.frame.hand.scale = SCALE;
	for (int i = 0; i < 4; i++) {
		s.frame.exposure = exposures[i];
		levels[i] = mark_of(&s, &rim);
	}
	assert_true(at(&s, 90, 5)[1] > 250); /* at the last one all else is white, */
	assert_true(rim < 60);               /* and it still has its rim */
	stop(&s);
	/* The hand is in a wall: still there, and seen to be behind. */
	start(&s, *state, &front, RENDERER_MONO, -0.3f);
	s.frame.hand.T_room_wand = (struct gr_pose){ { 0.1f, 1.6f, -0.5f }, { 0, 0, 0, 1 } };
	s.frame.exposure = 1e-6f;
	hidden = mark_of(&s, &behind);
	stop(&s);
	printf("# the mark is at %d, %d and %d of 255 over six decades of exposure, in white at %d with a rim at "
	       "%d; behind a surface at %d\n",
	       levels[0], levels[1], levels[2], levels[3], rim, hidden);
	assert_true(levels[0] > 200 && levels[1] == levels[0] && levels[2] == levels[0]);
	assert_true(hidden > 40 && hidden < levels[0] / 2);
}

int main(void)
{
	struct target *target = gl_target_or_skip(2 * PIXELS, PIXELS);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_prestate(parts_are_sound, target),
		cmocka_unit_test_prestate(joins_across_walls, target),
		cmocka_unit_test_prestate(stereo_puts_it_at_the_wand, target),
		cmocka_unit_test_prestate(leaves_no_trace, target),
		cmocka_unit_test_prestate(costs_little, target),
		cmocka_unit_test_prestate(readable_and_faint_behind, target),
	};
	int failed;

	gr_log_init("test_hud", GR_LOG_WARNING);
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	target_destroy(&target);
	return failed;
}
