/*
 * The hard cases of light that changes, through the whole renderer and for every
 * method alike: lamps that go off, on and out, two of them, another colour, air
 * that absorbs, and nodes that must come to the same bits.
 */
#include "base/log.h"
#include "base/result.h"
#include "renderer/gi/gi.h"
#include "renderer/renderer.h"
#include "renderer/trace/reference.h"
#include "tests/accuracy/hard/room.h"
#include "tests/unit/unit.h"

#include <math.h>
#include <unistd.h>

#define LONG_NS INT64_C(600000000000)
#define INTENSITY 60

static struct target *target;
static char folder[64];
static struct scene_file *file;
static struct scene *scene;

static const struct {
	enum scene_gi_method method;
	const char *name;
	int dark_frames; /* most until a lamp that is off is 0.1 % */
	double sum;      /* most that two lamps are off the sum of each */
	double absorbed; /* most that indirect light in absorbing air is off the reference */
} methods[] = {
	/* the lattice's clamp is not linear (tests/unit/test_lattice_math: without it 1e-5) */
	{ SCENE_GI_LPV, "lpv", 11, 0.25, 0.35 },
	{ SCENE_GI_SURFELS, "surfels", 11, 1e-5, 0.05 },
	{ SCENE_GI_PROBES, "probes", 11, 1e-5, 0.06 },
};
#define METHODS (sizeof methods / sizeof *methods)

struct room {
	struct renderer *renderer;
	struct render_frame frame;
};

static void begin(struct room *r, size_t method)
{
	const struct renderer_params params = { .width = HARD_PIXELS, .height = HARD_PIXELS,
						.eyes = RENDERER_MONO, .keep_radiance = true,
						.quiet = true };

	file->gi.method = methods[method].method;
	assert_int_equal(renderer_create(&r->renderer, target, &params, file, scene), GR_OK);
	render_frame_init(&r->frame, file);
	r->frame.lamps[1].on = false;
	r->frame.frame = 1;
}

static void end(struct room *r)
{
	struct renderer_stats stats;
	struct gi_stats gi;

	renderer_stats(r->renderer, &stats);
	assert_true(renderer_gi_stats(r->renderer, &gi));
	assert_int_equal(stats.nonfinite + stats.gl_errors + gi.nonfinite, 0);
	renderer_destroy(&r->renderer);
}

static void draw(struct room *r)
{
	assert_int_equal(renderer_draw_camera(r->renderer, &r->frame, &file->cameras[0]), GR_OK);
	assert_int_equal(renderer_finished(r->renderer, LONG_NS), GR_OK);
	r->frame.frame++;
}

/* Light from the start at its steady state, and what a camera then sees of it. */
static double settled(struct room *r, struct image *out)
{
	struct image indirect;
	double mean;

	r->frame.gi_epoch++;
	draw(r);
	assert_int_equal(renderer_read_indirect(r->renderer, 0, &indirect), GR_OK);
	mean = hard_mean(&indirect);
	if (out)
		*out = indirect;
	else
		image_finish(&indirect);
	return mean;
}

static double seen(struct room *r)
{
	struct image indirect;
	double mean;

	draw(r);
	assert_int_equal(renderer_read_indirect(r->renderer, 0, &indirect), GR_OK);
	mean = hard_mean(&indirect);
	image_finish(&indirect);
	return mean;
}

static void shine(struct room *r, float red, float green, float blue)
{
	memcpy(r->frame.lamps[0].intensity, (float[3]){ red, green, blue }, sizeof(vec3));
}

static void off_and_on(void **state)
{
	static const float parts[] = { 1, 0, 1, 1e-3f, 1e-7f };

	(void)state;
	for (size_t m = 0; m < METHODS; m++) {
		double lit, last = INFINITY;
		struct room r;
		int frames = 0;

		begin(&r, m);
		lit = settled(&r, NULL);
		assert_true(lit > 0);
		shine(&r, 0, 0, 0);
		for (; frames < 40 && last > 1e-3 * lit; frames++)
			last = seen(&r);
		printf("# %s: a lamp that is off is under 0.1 %% after %d frames\n", methods[m].name, frames);
		assert_true(frames <= methods[m].dark_frames);
		for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
			shine(&r, INTENSITY * parts[k], INTENSITY * parts[k], INTENSITY * parts[k]);
			for (int i = 0; i < 30; i++)
				last = seen(&r);
			/* what is left of the light before when work stops */
			assert_true(fabs(last - lit * (double)parts[k]) < 1e-4 * lit);
		}
		printf("# %s: faded to 1e-7, %.2e of the light\n", methods[m].name, last / lit);
		assert_true(last > 0);
		end(&r);
	}
}

static double worst_off(const struct image *a, const struct image *b, const struct image *c, const float by[3])
{
	size_t pixels = (size_t)a->width * (size_t)a->height;
	double worst = 0;

	for (size_t i = 0; i < 3 * pixels; i++)
		worst = fmax(worst, fabs((double)(a->data[i] - by[i % 3] * b->data[i] -
						  (c ? c->data[i] : 0))));
	return worst;
}

static void two_lamps(void **state)
{
	static const float plain[3] = { 1, 1, 1 }, colour[3] = { 1, 0.4f, 0.05f };

	(void)state;
	for (size_t m = 0; m < METHODS; m++) {
		struct image one, other, both, coloured;
		double mean, sum, colours;
		struct room r;

		begin(&r, m);
		settled(&r, &one);
		r.frame.lamps[1].on = true;
		mean = settled(&r, &both);
		r.frame.lamps[0].on = false;
		settled(&r, &other);
		r.frame.lamps[1].on = false;
		r.frame.lamps[0].on = true;
		shine(&r, INTENSITY * colour[0], INTENSITY * colour[1], INTENSITY * colour[2]);
		settled(&r, &coloured);
		sum = worst_off(&both, &one, &other, plain) / mean;
		colours = worst_off(&coloured, &one, NULL, colour) / mean;
		printf("# %s: two lamps are off the sum of each by %.1e of the mean, another colour by %.1e\n",
		       methods[m].name, sum, colours);
		assert_true(sum < methods[m].sum && colours < 1e-5);
		image_finish(&one);
		image_finish(&other);
		image_finish(&both);
		image_finish(&coloured);
		end(&r);
	}
}

/* Indirect light that a camera sees, traced. */
static double traced(const struct render_frame *frame)
{
	const struct reference_params params = { .seed = 1, .samples = 256, .max_bounces = 64 };
	struct reference_film film = { 0 };
	struct reference *reference;
	struct reference_view view;
	struct image indirect;
	double mean;

	assert_int_equal(reference_create(&reference, scene, file, frame), GR_OK);
	assert_int_equal(reference_view_camera(&file->cameras[0], &view), GR_OK);
	assert_int_equal(reference_render(reference, &view, &params, &film), GR_OK);
	assert_int_equal(film.nonfinite, 0);
	assert_int_equal(reference_film_images(&film, NULL, NULL, &indirect), GR_OK);
	mean = hard_mean(&indirect);
	image_finish(&indirect);
	reference_film_finish(&film);
	reference_destroy(&reference);
	return mean;
}

/* sigma 0.1/m, as the reference has it; and clear again. */
static void absorbing_air(void **state)
{
	double clear_truth = 0, truth = 0;

	(void)state;
	for (size_t m = 0; m < METHODS; m++) {
		double clear, thick;
		struct room r;

		begin(&r, m);
		if (m == 0)
			clear_truth = traced(&r.frame);
		clear = settled(&r, NULL);
		r.frame.absorption_per_m = 0.1f;
		if (m == 0)
			truth = traced(&r.frame);
		thick = settled(&r, NULL);
		printf("# %s: absorption of 0.1/m leaves %.4f of the clear room's indirect light, %+.1f %% off "
		       "the reference (%.4f); clear %+.1f %%\n",
		       methods[m].name, thick / clear, 100 * (thick / truth - 1), truth / clear_truth,
		       100 * (clear / clear_truth - 1));
		assert_true(fabs(thick / truth - 1) < methods[m].absorbed);
		r.frame.absorption_per_m = 0;
		assert_true(fabs(settled(&r, NULL) / clear - 1) < 1e-6);
		end(&r);
	}
}

/* Two nodes that saw the same, and one that joins late: the same bits in every frame. */
static void same_bits(void **state)
{
	(void)state;
	for (size_t m = 0; m < METHODS; m++) {
		struct room a, b;
		uint64_t hash = 0;

		begin(&a, m);
		begin(&b, m);
		for (int i = 0; i < 10; i++) {
			if (i == 5) {
				end(&b);
				begin(&b, m);
				a.frame.gi_epoch = b.frame.gi_epoch = 9;
				b.frame.frame = a.frame.frame;
			}
			a.frame.lamps[0].position[0] = b.frame.lamps[0].position[0] = 2 + 0.05f * (float)i;
			draw(&a);
			draw(&b);
			hash = renderer_light_hash(a.renderer);
			assert_true(hash != 0 && hash == renderer_light_hash(b.renderer));
		}
		printf("# %s: two runs and a late join, hashes equal in every frame (last %016llx)\n",
		       methods[m].name, (unsigned long long)hash);
		end(&a);
		end(&b);
	}
}

static int build(void **state)
{
	const struct hard_scene wanted = { .scale = 1, .intensity = { INTENSITY, 30 }, .gathers = 2,
					   .steps = 8 };
	static struct model model;
	char scene_path[128], model_path[128];
	struct gr_diag diag = { 0 };

	(void)state;
	snprintf(folder, sizeof folder, "/tmp/grotto-light-XXXXXX");
	if (!mkdtemp(folder))
		return -1;
	snprintf(scene_path, sizeof scene_path, "%s/hard.scene", folder);
	snprintf(model_path, sizeof model_path, "%s/hard.glb", folder);
	hard_plain(&model);
	model_write(&model, model_path);
	hard_write_scene(&wanted, scene_path, "hard.glb");
	if (scene_file_load(scene_path, &file, &diag) != GR_OK ||
	    scene_import(file, &scene, &diag) != GR_OK)
		return -1;
	gr_diag_finish(&diag);
	unlink(model_path);
	return unlink(scene_path);
}

static int tidy(void **state)
{
	char kept[128];

	(void)state;
	scene_destroy(&scene);
	scene_file_destroy(&file);
	snprintf(kept, sizeof kept, "%s/hard.surfels", folder);
	unlink(kept);
	return rmdir(folder);
}

int main(void)
{
	const struct target_params params = { .kind = TARGET_HEADLESS, .width = HARD_PIXELS,
					      .height = HARD_PIXELS, .gpu = -1 };
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(off_and_on),
		cmocka_unit_test(two_lamps),
		cmocka_unit_test(absorbing_air),
		cmocka_unit_test(same_bits),
	};
	int failed;

	/* that a bake of surfels is none of probes is said each time */
	gr_log_init("test_hard_light", GR_LOG_ERROR);
	if (target_create(&target, &params) != GR_OK) {
		printf("# no OpenGL 4.5 here: skipped\n");
		return 77;
	}
	failed = cmocka_run_group_tests(tests, build, tidy);
	target_destroy(&target);
	return failed;
}
