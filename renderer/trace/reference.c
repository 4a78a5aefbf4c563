#include "renderer/trace/reference.h"

#include "base/result.h"
#include "renderer/trace/estimate.h"
#include "renderer/trace/reference_private.h"
#include "renderer/trace/sampler.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int reference_create(struct reference **out, const struct scene *scene,
		     const struct scene_file *file, const struct render_frame *frame)
{
	struct reference *reference = calloc(1, sizeof *reference);
	int result;

	*out = NULL;
	if (!reference)
		return GR_ERR_NOMEM;
	reference->frame = *frame;
	reference->file.lamps = reference->lamps;
	reference->file.lamp_count =
		file->lamp_count < SCENE_MAX_LAMPS ? file->lamp_count : SCENE_MAX_LAMPS;
	if (reference->file.lamp_count > 0)
		memcpy(reference->lamps, file->lamps,
		       reference->file.lamp_count * sizeof *reference->lamps);
	reference->scene.background = v3_of(file->background);
	medium_init(&reference->scene.medium, frame->absorption_per_m, frame->scattering_per_m,
		    scene->min, scene->max);
	result = world_init(&reference->scene.world, scene, 0);
	if (result == GR_OK)
		result = emitters_init(&reference->scene.emitters, &reference->scene.world);
	if (result != GR_OK) {
		reference_destroy(&reference);
		return result;
	}
	reference_hash(reference, reference->hash);
	*out = reference;
	return GR_OK;
}

void reference_destroy(struct reference **reference)
{
	if (!*reference)
		return;
	emitters_finish(&(*reference)->scene.emitters);
	world_finish(&(*reference)->scene.world);
	free(*reference);
	*reference = NULL;
}

uint64_t reference_rays(const struct reference *reference)
{
	return reference->rays;
}

static bool params_ok(const struct reference_params *params)
{
	return params->samples > 0 && params->samples <= 1 << 30 && params->until_error >= 0.0 &&
	       params->max_bounces >= 0 && params->max_bounces <= REFERENCE_MOST_BOUNCES;
}

static void prepare(struct reference *reference, const struct reference_params *params)
{
	reference->scene.max_bounces = params->max_bounces;
	lamps_init(&reference->scene.lamps, &reference->file, &reference->frame, params->soft_lamps);
}

/* --- pictures --- */

static struct path_light sample_pixel(const void *ctx, const struct path_scene *scene, size_t item,
				      const struct sampler *sampler)
{
	const struct reference_view *view = ctx;
	float u[2], x, y;
	struct v3 to;

	sampler_pair(sampler, 0, u);
	x = ((float)(item % (size_t)view->width) + u[0]) / (float)view->width;
	y = ((float)(item / (size_t)view->width) + u[1]) / (float)view->height;
	to = v3_ahead(v3_ahead(v3_of(view->corner), v3_of(view->right), x), v3_of(view->down), y);
	return path_from_eye(scene, sampler, v3_of(view->eye), v3_unit(to));
}

static bool view_ok(const struct reference_view *view)
{
	const float *parts[] = { view->eye, view->corner, view->right, view->down };

	for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
		if (!v3_finite(v3_of(parts[i])) || v3_widest(v3_of(parts[i])) > RAYS_MOST)
			return false;
	return view->width > 0 && view->height > 0 && view->width <= IMAGE_MAX_SIDE &&
	       view->height <= IMAGE_MAX_SIDE &&
	       (size_t)view->width * (size_t)view->height <= IMAGE_MAX_SAMPLES / 3;
}

static int film_start(struct reference_film *film, const struct reference_view *view,
		      const struct reference_params *params, const uint8_t key[32])
{
	size_t values = 3 * (size_t)view->width * (size_t)view->height;
	double **sums[] = { &film->radiance, &film->squares, &film->indirect,
			    &film->indirect_squares };

	if (film->radiance)
		return film->width == view->width && film->height == view->height &&
				       memcmp(film->key, key, sizeof film->key) == 0
			       ? GR_OK
			       : GR_ERR_MISMATCH;
	memset(film, 0, sizeof *film);
	for (size_t i = 0; i < sizeof sums / sizeof sums[0]; i++) {
		*sums[i] = calloc(values, sizeof **sums[i]);
		if (!*sums[i]) {
			reference_film_finish(film);
			return GR_ERR_NOMEM;
		}
	}
	film->width = view->width;
	film->height = view->height;
	film->seed = params->seed;
	memcpy(film->key, key, sizeof film->key);
	return GR_OK;
}

/* Lets the caller see the film while it grows. */
struct keeper {
	const struct reference_params *params;
	struct reference_film *film;
};

static void keep_film(void *ctx, const struct estimate_sums *sums)
{
	const struct keeper *keeper = ctx;

	keeper->film->samples = sums->samples;
	keeper->film->nonfinite = sums->nonfinite;
	keeper->params->keep(keeper->params->ctx, keeper->film);
}

int reference_render(struct reference *reference, const struct reference_view *view,
		     const struct reference_params *params, struct reference_film *film)
{
	struct keeper keeper = { params, film };
	const struct estimate_work todo = { sample_pixel, view, params->keep ? keep_film : NULL,
					    &keeper };
	struct estimate_sums sums;
	uint8_t key[32];
	int result;

	if (!params_ok(params) || !view_ok(view))
		return GR_ERR_RANGE;
	reference_key(reference, view, params, key);
	result = film_start(film, view, params, key);
	if (result != GR_OK)
		return result;
	prepare(reference, params);
	sums = (struct estimate_sums){
		.items = (size_t)film->width * (size_t)film->height,
		.samples = film->samples,
		.total = film->radiance,
		.squares = film->squares,
		.indirect = film->indirect,
		.indirect_squares = film->indirect_squares,
		.nonfinite = film->nonfinite,
	};
	result = estimate_run(&sums, &reference->scene, params, &todo);
	reference->rays = sums.rays;
	film->samples = sums.samples;
	film->nonfinite = sums.nonfinite;
	return result;
}

/* --- points --- */

static struct path_light sample_point(const void *ctx, const struct path_scene *scene, size_t item,
				      const struct sampler *sampler)
{
	const struct reference_point *points = ctx;

	return path_irradiance(scene, sampler, v3_of(points[item].position),
			       v3_of(points[item].normal));
}

static bool points_ok(const struct reference_point *points, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		struct v3 n = v3_of(points[i].normal);

		if (!v3_finite(v3_of(points[i].position)) || !v3_finite(n) ||
		    v3_widest(v3_of(points[i].position)) > RAYS_MOST ||
		    !(fabsf(v3_dot(n, n) - 1.0f) < 1e-3f))
			return false;
	}
	return true;
}

static void fill_points(const struct estimate_sums *sums, struct reference_point *points)
{
	for (size_t i = 0; i < sums->items; i++) {
		for (size_t c = 0; c < 3; c++) {
			size_t at = 3 * i + c;
			double n = sums->samples;

			if (sums->samples == 0) { /* nothing is known yet: not 0 */
				points[i].total[c] = points[i].indirect[c] = NAN;
				points[i].total_error[c] = points[i].indirect_error[c] = NAN;
				continue;
			}
			points[i].total[c] = sums->total[at] / n;
			points[i].indirect[c] = sums->indirect[at] / n;
			if (sums->samples < 2 * SAMPLER_SET) { /* one set has no error: not 0 */
				points[i].total_error[c] = points[i].indirect_error[c] = NAN;
				continue;
			}
			points[i].total_error[c] =
				estimate_error(sums->total[at], sums->squares[at], sums->samples);
			points[i].indirect_error[c] = estimate_error(
				sums->indirect[at], sums->indirect_squares[at], sums->samples);
		}
	}
}

int reference_irradiance(struct reference *reference, const struct reference_params *params,
			 struct reference_point *points, size_t count, uint64_t *out_nonfinite)
{
	const struct estimate_work todo = { .sample = sample_point, .ctx = points };
	struct estimate_sums sums = { .items = count };
	double *values;
	int result;

	if (out_nonfinite)
		*out_nonfinite = 0;
	if (!params_ok(params) || !points_ok(points, count))
		return GR_ERR_RANGE;
	values = calloc(count ? count : 1, 12 * sizeof *values);
	if (!values)
		return GR_ERR_NOMEM;
	sums.total = values;
	sums.squares = values + 3 * count;
	sums.indirect = values + 6 * count;
	sums.indirect_squares = values + 9 * count;
	prepare(reference, params);
	result = estimate_run(&sums, &reference->scene, params, &todo);
	reference->rays = sums.rays;
	if (result == GR_OK || result == GR_NOTHING)
		fill_points(&sums, points);
	if (out_nonfinite)
		*out_nonfinite = sums.nonfinite;
	free(values);
	return result;
}
