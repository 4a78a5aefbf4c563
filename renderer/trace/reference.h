/*
 * The truth: a path tracer on Embree for the scene that the renderer draws.
 * Every lamp kind, emissive surfaces (next event estimation and multiple
 * importance sampling: Veach 1997), environment, homogeneous medium, and every
 * material of renderer/scene/scene.h. Unbiased but for max_bounces; Russian
 * roulette keeps the expectation. What no path from the eye can find is missing:
 * light of a lamp without extent by way of a perfect mirror (soft_lamps finds it).
 *
 * Samples are Owen-scrambled Sobol points (Burley 2020) of a seed in sets of
 * SAMPLER_SET, each scrambled on its own; the spread of the sets' means gives
 * the standard errors. Equal seeds give equal results, to the last bit, for any
 * number of threads.
 *
 * Lamps without extent are points here, whatever their radius_m says, unless
 * soft_lamps asks for spheres (discs in the sky for directional ones); neither
 * is seen by the eye itself.
 *
 * As the renderer draws: the eye looks through the backs of one-sided surfaces;
 * all other light is stopped and absorbed by them. Shading uses the interpolated
 * normals, and no light arrives from behind the geometric surface.
 *
 * indirect is what methods of global illumination compute. From the eye: light
 * off the surface that is seen that came to it by way of others (or was scattered
 * by the medium), two bounces in all or more. At a point of a surface: all that
 * was reflected or scattered on its way there.
 *
 * Thread safety: one thread calls; it starts threads of its own.
 */
#ifndef GROTTO_RENDERER_TRACE_REFERENCE_H
#define GROTTO_RENDERER_TRACE_REFERENCE_H

#include "renderer/frame.h"
#include "renderer/image/image.h"
#include "renderer/scene/scene.h"
#include "renderer/view/projection.h"

#include <stdbool.h>
#include <stdint.h>

struct reference_film;

struct reference_params {
	uint64_t seed;
	int samples;       /* most a pixel or point; counted up to whole sets, at least two */
	double until_error; /* stop when the rms standard error over the mean is below; 0: all samples.
			     * At least 64 samples are taken, of what is black 65536 of all pixels */
	int max_bounces;   /* times that light may be reflected or scattered before the first surface; 0..1024 */
	int threads;       /* 0: all cores */
	bool soft_lamps;
	/*
	 * Called about four times a second from the calling thread; NULL: not.
	 * done 0..1, seconds left as far as known (negative: not), error as in
	 * until_error (negative: not known yet). false stops: what the last whole pass
	 * over all pixels left is handed out.
	 */
	bool (*progress)(void *ctx, double done, double seconds_left, double error);
	/*
	 * Of reference_render, from the calling thread: every time when all pixels have
	 * the same number of samples, the film as it is, to be kept. NULL: not.
	 */
	void (*keep)(void *ctx, const struct reference_film *film);
	void *ctx;
};
#define REFERENCE_PARAMS \
	{ .seed = 1, .samples = 256, .max_bounces = 64 }

struct reference;
/*
 * scene must outlive it; the frame's lamps and medium count. GR_OK, GR_ERR_NOMEM,
 * GR_ERR_UNSUPPORTED without Embree.
 */
int reference_create(struct reference **out, const struct scene *scene,
		     const struct scene_file *file, const struct render_frame *frame);
void reference_destroy(struct reference **reference);
/* Rays that the last call of reference_render or reference_irradiance traced. */
uint64_t reference_rays(const struct reference *reference);

/* A pinhole that looks at a picture: rays through its pixels, box filter of one pixel. */
struct reference_view {
	float eye[3];
	float corner[3];         /* from the eye to the picture's upper left corner; scene, metres */
	float right[3], down[3]; /* the picture's whole width and height */
	int width, height;
};
/* GR_ERR_RANGE as projection_camera. */
int reference_view_camera(const struct scene_camera *camera, struct reference_view *out);
/* A wall of a CAVE in the scene as an eye there sees it. GR_ERR_RANGE as projection_off_axis. */
int reference_view_wall(const struct projection_wall *wall, const struct gr_pose *T_scene_room,
			const float eye_room[3], int width, int height,
			struct reference_view *out);

/*
 * Sums so far, resumable: pass the same again, with the same reference, view,
 * seed, and more samples; what comes of it is bit for bit what one go gives.
 * Zeroed first; finish after.
 */
struct reference_film {
	int width, height;
	int samples;      /* taken of every pixel */
	double *radiance; /* 3 a pixel: sums */
	double *squares;  /* 3: sums over the sets of (sum of a set)^2 / SAMPLER_SET */
	double *indirect, *indirect_squares; /* likewise of the indirect part */
	uint64_t seed;
	uint8_t key[32];    /* of scene, lamps, view and parameters: a film of others is refused */
	uint64_t nonfinite; /* samples that were NaN or Inf: an error, left out and counted */
};
/*
 * GR_OK; GR_NOTHING when progress stopped it; GR_ERR_MISMATCH for a film of
 * something else, which stays as it was; GR_ERR_RANGE for parameters or a view
 * out of range; GR_ERR_NOMEM.
 */
int reference_render(struct reference *reference, const struct reference_view *view,
		     const struct reference_params *params, struct reference_film *film);
/* rms standard error over the mean of the radiance; negative: not known (fewer than two sets, few and all black). */
double reference_film_error(const struct reference_film *film);
/* To pictures of 3 channels; each may be NULL. error: standard error of the mean, 0 before two sets. */
int reference_film_images(const struct reference_film *film, struct image *radiance,
			  struct image *error, struct image *indirect);
int reference_film_indirect_error(const struct reference_film *film, struct image *out);
void reference_film_finish(struct reference_film *film);
/*
 * A versioned, checksummed file (docs/reference.md), written whole or not at all.
 * GR_OK, GR_ERR_IO, GR_ERR_NOMEM.
 */
int reference_film_save(const struct reference_film *film, const char *path);
/*
 * film zeroed first. GR_ERR_IO; GR_ERR_VERSION; GR_ERR_FORMAT for one that is
 * damaged, cut short or none: *film stays zero, and diag says what is wrong.
 */
int reference_film_load(struct reference_film *film, const char *path, struct gr_diag *diag);
/* The same from bytes; name stands in diag. */
int reference_film_parse(struct reference_film *film, const uint8_t *bytes, size_t len,
			 const char *name, struct gr_diag *diag);

/* Irradiance on the side of a surface point that its normal shows. */
struct reference_point {
	float position[3], normal[3]; /* unit; rays start a little off the surface */
	double total[3], indirect[3]; /* W/m^2 per band; indirect: all that was reflected at least once */
	double total_error[3], indirect_error[3]; /* standard errors, NaN before two sets; all NaN before the first */
};
/* As reference_render; positions beyond RAYS_MOST are out of range. Samples of a point depend on the seed and its place in the array. */
int reference_irradiance(struct reference *reference, const struct reference_params *params,
			 struct reference_point *points, size_t count, uint64_t *out_nonfinite);

#endif
