#include "tools/bench/truth_traced.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/trace/reference.h"

#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Grows when the tracer's answers change for the same question. */
#define EDITION 1u

struct saying {
	const char *what;
};

static bool say_progress(void *ctx, double done, double seconds_left, double error)
{
	const struct saying *saying = ctx;

	fprintf(stderr, "\r  truth %s: %3.0f %%", saying->what, 100 * done);
	if (seconds_left >= 0)
		fprintf(stderr, ", %.0f s left", seconds_left);
	if (error > 0 && isfinite(error))
		fprintf(stderr, ", error %.2f %%", 100 * error);
	fprintf(stderr, "    ");
	return true;
}

static struct reference_params params_of(const struct bench_traced *t, int samples,
					 struct saying *saying)
{
	struct reference_params params = REFERENCE_PARAMS;

	params.seed = t->seed;
	params.samples = samples;
	params.until_error = (double)t->until_error;
	params.soft_lamps = true;
	if (t->progress) {
		params.progress = say_progress;
		params.ctx = saying;
	}
	return params;
}

static void end_progress(const struct bench_traced *t)
{
	if (t->progress)
		fprintf(stderr, "\r%*s\r", 72, "");
}

static int trace_points(const struct bench_traced *t, const struct scene *scene,
			const struct render_frame *frame, const struct bench_points *points,
			const char *what, struct reference_point *found)
{
	struct saying saying = { what };
	struct reference_params params = params_of(t, t->point_samples, &saying);
	struct reference *reference;
	uint64_t nonfinite = 0;
	int result = reference_create(&reference, scene, t->file, frame);

	if (result != GR_OK)
		return result;
	for (size_t k = 0; k < points->count; k++) {
		memset(&found[k], 0, sizeof found[k]);
		memcpy(found[k].position, points->points[k].position, sizeof found[k].position);
		memcpy(found[k].normal, points->points[k].normal, sizeof found[k].normal);
	}
	result = reference_irradiance(reference, &params, found, points->count, &nonfinite);
	reference_destroy(&reference);
	end_progress(t);
	if (nonfinite)
		gr_warning("the truth had %llu samples that were not finite: left out",
			   (unsigned long long)nonfinite);
	return result;
}

/* What the environment sends straight: the scene again, with nothing else that shines. */
static int add_environment(const struct bench_traced *t, const struct bench_points *points,
			   struct reference_point *scratch, double (*irradiance)[3])
{
	struct scene dark = *t->scene;
	struct render_frame frame = t->frame;
	int result;

	dark.materials = malloc(t->scene->material_count * sizeof *dark.materials);
	if (!dark.materials)
		return GR_ERR_NOMEM;
	memcpy(dark.materials, t->scene->materials, t->scene->material_count * sizeof *dark.materials);
	for (size_t m = 0; m < dark.material_count; m++)
		memset(dark.materials[m].emission, 0, sizeof dark.materials[m].emission);
	dark.emissive = false;
	for (int i = 0; i < SCENE_MAX_LAMPS; i++)
		frame.lamps[i].on = false;
	result = trace_points(t, &dark, &frame, points, "of the environment", scratch);
	for (size_t k = 0; k < points->count && result == GR_OK; k++)
		for (int c = 0; c < 3; c++)
			irradiance[k][c] += scratch[k].total[c] - scratch[k].indirect[c];
	free(dark.materials);
	return result;
}

static int points(void *ctx, const struct bench_points *points, double (*irradiance)[3],
		  double *error)
{
	const struct bench_traced *t = ctx;
	struct reference_point *found = calloc(points->count + 1, sizeof *found);
	int result = GR_ERR_NOMEM;

	if (!found)
		return result;
	result = trace_points(t, t->scene, &t->frame, points, "at points", found);
	for (size_t k = 0; k < points->count && result == GR_OK; k++) {
		double square = 0;

		for (int c = 0; c < 3; c++) {
			irradiance[k][c] = found[k].indirect[c];
			square += found[k].indirect_error[c] * found[k].indirect_error[c];
		}
		error[k] = sqrt(square / 3);
	}
	if (result == GR_OK && t->scene->environment)
		result = add_environment(t, points, found, irradiance);
	free(found);
	return result;
}

static double noise_of(const struct image *radiance, const struct image *error)
{
	size_t count = (size_t)radiance->width * (size_t)radiance->height * 3;
	double sum = 0, square = 0;

	for (size_t i = 0; i < count; i++) {
		sum += (double)radiance->data[i];
		square += (double)error->data[i] * (double)error->data[i];
	}
	return sum > 0 ? sqrt(square / (double)count) / (sum / (double)count) : (double)NAN;
}

static int picture(void *ctx, struct image *radiance, struct image *indirect, double *noise)
{
	const struct bench_traced *t = ctx;
	struct saying saying = { "of the picture" };
	struct reference_params params = params_of(t, t->picture_samples, &saying);
	struct reference_film film = { 0 };
	struct reference_view view;
	struct reference *reference;
	struct image error = { 0 };
	int result = reference_view_camera(&t->camera, &view);

	if (result != GR_OK)
		return result;
	result = reference_create(&reference, t->scene, t->file, &t->frame);
	if (result != GR_OK)
		return result;
	result = reference_render(reference, &view, &params, &film);
	end_progress(t);
	/* with an environment the light field's part of a picture is not the film's indirect one */
	if (result == GR_OK)
		result = reference_film_images(&film, radiance, &error,
					       t->scene->environment ? NULL : indirect);
	if (result == GR_OK)
		*noise = noise_of(radiance, &error);
	image_finish(&error);
	reference_film_finish(&film);
	reference_destroy(&reference);
	return result;
}

struct bench_truth_source bench_traced_source(struct bench_traced *traced)
{
	return (struct bench_truth_source){ points, picture, traced };
}

static void add(crypto_generichash_state *state, const void *bytes, size_t len)
{
	crypto_generichash_update(state, bytes, len);
}

/* Values one by one: padding between them is anything. */
void bench_traced_key(const struct bench_traced *t, const struct bench_points *points,
		      uint8_t out[32])
{
	const uint32_t numbers[] = { EDITION, (uint32_t)t->point_samples, (uint32_t)t->picture_samples,
				     (uint32_t)t->camera.pixels[0], (uint32_t)t->camera.pixels[1],
				     (uint32_t)t->file->lamp_count };
	crypto_generichash_state state;

	crypto_generichash_init(&state, NULL, 0, 32);
	/* the method and its settings are in the file's hash, and no business of the truth's */
	add(&state, t->scene->hash, sizeof t->scene->hash);
	add(&state, numbers, sizeof numbers);
	add(&state, &t->seed, sizeof t->seed);
	add(&state, &t->until_error, sizeof t->until_error);
	add(&state, t->camera.position, sizeof t->camera.position);
	add(&state, t->camera.target, sizeof t->camera.target);
	add(&state, t->camera.up, sizeof t->camera.up);
	add(&state, &t->camera.vfov_rad, sizeof t->camera.vfov_rad);
	add(&state, t->file->background, sizeof t->file->background);
	add(&state, &t->frame.absorption_per_m, sizeof t->frame.absorption_per_m);
	add(&state, &t->frame.scattering_per_m, sizeof t->frame.scattering_per_m);
	for (size_t i = 0; i < t->file->lamp_count && i < SCENE_MAX_LAMPS; i++) {
		const struct frame_lamp *lamp = &t->frame.lamps[i];
		const struct scene_lamp *fixed = &t->file->lamps[i];
		const uint32_t kind[] = { (uint32_t)fixed->kind, lamp->on };

		add(&state, kind, sizeof kind);
		add(&state, lamp->position, sizeof lamp->position);
		add(&state, lamp->direction, sizeof lamp->direction);
		add(&state, lamp->intensity, sizeof lamp->intensity);
		add(&state, &fixed->cone_rad, sizeof fixed->cone_rad);
		add(&state, &fixed->penumbra_rad, sizeof fixed->penumbra_rad);
		add(&state, &fixed->radius_m, sizeof fixed->radius_m);
		add(&state, &fixed->angle_rad, sizeof fixed->angle_rad);
	}
	for (size_t k = 0; k < points->count; k++)
		add(&state, &points->points[k], sizeof points->points[k]);
	crypto_generichash_final(&state, out, 32);
}
