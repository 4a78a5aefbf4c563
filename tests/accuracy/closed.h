/*
 * For tests of the reference against closed forms: rows of analytic.csv, a tally
 * of estimates against what is known, and scenes of quads.
 */
#ifndef GROTTO_TESTS_CLOSED_H
#define GROTTO_TESTS_CLOSED_H

#include "base/result.h"
#include "renderer/scene/environment.h"
#include "renderer/trace/reference.h"
#include "tests/accuracy/cornell.h"
#include "tests/unit/shared.h"
#include "tests/unit/unit.h"

#include <math.h>

#define PI 3.14159265358979323846

/* Estimates against values: how many standard errors apart, and how large those are. */
struct tally {
	const char *name;
	int count;
	double worst_sigma, sum_sigma2, worst_error;
};

/* want 0: an absolute bound of 1e-6. Rounding of float may add 1e-5. */
static inline void tally_add(struct tally *t, double got, double error, double want)
{
	double scale = fabs(want) > 0 ? fabs(want) : 1.0;
	double off = fmax(fabs(got - want) - (want != 0 ? 1e-5 * scale : 1e-6), 0.0);
	double sigma = off > 0 ? off / fmax(error, 1e-12) : 0.0;

	t->count++;
	t->sum_sigma2 += sigma * sigma;
	t->worst_sigma = fmax(t->worst_sigma, sigma);
	t->worst_error = fmax(t->worst_error, error / scale);
	if (sigma > 3.0 || error > 0.002 * scale)
		printf("# %s: %.7g +- %.2g where %.7g is right (%.1f standard errors)\n", t->name,
		       got, error, want, sigma);
}

static inline void tally_end(const struct tally *t)
{
	printf("# %s: %d values, worst %.2f standard errors (rms %.2f), largest of those %.3f %%\n",
	       t->name, t->count, t->worst_sigma, sqrt(t->sum_sigma2 / fmax(t->count, 1)),
	       100 * t->worst_error);
	assert_true(t->count > 0);
	assert_true(t->worst_sigma <= 3.0);
	assert_true(t->worst_error <= 0.002);
}

static inline FILE *closed_open(void)
{
	char path[1024];
	FILE *f = NULL;

	if (shared_file("reference/analytic/analytic.csv", path))
		f = fopen(path, "r");
	if (!f)
		skip();
	return f;
}

/* A scene of quads, its reference, and what belongs to it. */
struct closed {
	struct scene scene;
	struct scene_file file;
	struct scene_lamp lamp;
	struct render_frame frame;
	struct reference *reference;
};

static inline void closed_start(struct closed *c, const struct quad *quads, size_t count,
				const struct scene_material *materials, size_t material_count)
{
	quads_scene(&c->scene, quads, count, materials, material_count);
	c->file = quads_file();
	render_frame_init(&c->frame, &c->file);
	assert_int_equal(reference_create(&c->reference, &c->scene, &c->file, &c->frame), GR_OK);
}

/* After a change of scene, file or frame. */
static inline void closed_again(struct closed *c)
{
	reference_destroy(&c->reference);
	assert_int_equal(reference_create(&c->reference, &c->scene, &c->file, &c->frame), GR_OK);
}

/* The same radiance from all around. */
static inline void closed_sky(struct closed *c, float radiance)
{
	struct scene_file file = c->file;
	struct gr_diag diag = { 0 };

	file.environment.kind = SCENE_ENVIRONMENT_CONSTANT;
	for (int i = 0; i < 3; i++)
		file.environment.radiance[i] = radiance;
	assert_int_equal(environment_create(&c->scene.environment, &file, &diag), GR_OK);
	gr_diag_finish(&diag);
	closed_again(c);
}

static inline void closed_end(struct closed *c)
{
	reference_destroy(&c->reference);
	environment_destroy(&c->scene.environment);
	quads_free(&c->scene);
}

/* Irradiance of one point, green band. */
static inline void closed_point(struct closed *c, const struct reference_params *params,
				const double p[3], const double n[3], double *out, double *out_error)
{
	struct reference_point point = {
		.position = { (float)p[0], (float)p[1], (float)p[2] },
		.normal = { (float)n[0], (float)n[1], (float)n[2] },
	};
	uint64_t nonfinite;

	assert_int_equal(reference_irradiance(c->reference, params, &point, 1, &nonfinite), GR_OK);
	assert_int_equal(nonfinite, 0);
	*out = point.total[1];
	*out_error = point.total_error[1];
}

/* Radiance that one eye sees in one direction, green band. */
static inline void closed_look(struct closed *c, const struct reference_params *params,
			       const double eye[3], const double direction[3], double *out,
			       double *out_error)
{
	struct reference_view view = { .width = 1, .height = 1 };
	struct reference_film film = { 0 };
	struct image mean, error;

	for (int i = 0; i < 3; i++) {
		view.eye[i] = (float)eye[i];
		view.corner[i] = (float)direction[i];
	}
	assert_int_equal(reference_render(c->reference, &view, params, &film), GR_OK);
	assert_int_equal(film.nonfinite, 0);
	assert_int_equal(reference_film_images(&film, &mean, &error, NULL), GR_OK);
	*out = (double)mean.data[1];
	*out_error = (double)error.data[1];
	image_finish(&mean);
	image_finish(&error);
	reference_film_finish(&film);
}

/* The inside of a cube about the origin. */
static inline void closed_cube(struct quad out[6], int material, float half)
{
	for (int face = 0; face < 6; face++) {
		int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
		float side = face % 2 ? half : -half;

		out[face].material = material;
		for (int k = 0; k < 4; k++) {
			/* counter-clockwise about the inward normal */
			int turn = face % 2 ? 3 - k : k;

			out[face].at[k][axis] = side;
			out[face].at[k][u] = turn == 1 || turn == 2 ? half : -half;
			out[face].at[k][v] = turn >= 2 ? half : -half;
		}
	}
}

#endif
