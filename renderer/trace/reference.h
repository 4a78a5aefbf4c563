/*
 * The truth: a path tracer on Embree for the scene that the renderer draws.
 * Every lamp kind, emissive surfaces (next event estimation and multiple
 * importance sampling: Veach 1997), environment, homogeneous medium, and every
 * material of renderer/scene/scene.h. Unbiased but for max_bounces; Russian
 * roulette keeps the expectation.
 *
 * Samples are Owen-scrambled Sobol points (Burley 2020) of a seed: equal seeds
 * give equal results for any number of threads.
 *
 * Lamps without extent are points here, whatever their radius_m says, unless
 * soft_lamps asks for spheres (discs in the sky for directional ones).
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

struct reference_params {
	uint64_t seed;
	int samples;       /* most a pixel or point */
	double until_error; /* stop when the rms standard error over the mean is below; 0: all samples */
	int max_bounces;   /* surfaces that a path may meet after the first; at most 1024 */
	int threads;       /* 0: all cores */
	bool soft_lamps;
	/*
	 * Called about four times a second from the calling thread; NULL: not.
	 * done 0..1, seconds left as far as known (negative: not), error as in
	 * until_error. false stops: what there is so far is handed out.
	 */
	bool (*progress)(void *ctx, double done, double seconds_left, double error);
	void *ctx;
};
#define REFERENCE_PARAMS \
	{ .seed = 1, .samples = 256, .max_bounces = 64 }

struct reference;
/* scene must outlive it; the frame's lamps and medium count. GR_OK, GR_ERR_NOMEM. */
int reference_create(struct reference **out, const struct scene *scene,
		     const struct scene_file *file, const struct render_frame *frame);
void reference_destroy(struct reference **reference);

/* A pinhole that looks at a picture: rays through its pixels, box filter of one pixel. */
struct reference_view {
	float eye[3];
	float corner[3], right[3], down[3]; /* of the picture: upper left, its whole width and height; scene, metres */
	int width, height;
};
int reference_view_camera(const struct scene_camera *camera, struct reference_view *out);
/* A wall of a CAVE in the scene as an eye there sees it. GR_ERR_RANGE behind the wall. */
int reference_view_wall(const struct projection_wall *wall, const struct gr_pose *T_scene_room,
			const float eye_room[3], int width, int height,
			struct reference_view *out);

/*
 * Sums so far, resumable: pass the same again, with the same reference, view,
 * seed, and more samples. Zeroed first; finish after.
 */
struct reference_film {
	int width, height;
	int samples;        /* taken of every pixel */
	double *radiance;   /* 3 a pixel: sums */
	double *squares;    /* 3: sums of squares of batch means, times batch size; see reference.c */
	double *indirect;   /* 3: sums of light with two or more bounces off surfaces before the eye */
	uint64_t seed;
	uint8_t key[32];    /* of scene, lamps and view: a film of another is refused */
	uint64_t nonfinite; /* samples that were NaN or Inf: an error, left out and counted */
};
int reference_render(struct reference *reference, const struct reference_view *view,
		     const struct reference_params *params, struct reference_film *film);
/* To pictures of 3 channels; each may be NULL. error: standard error of the mean. */
int reference_film_images(const struct reference_film *film, struct image *radiance,
			  struct image *error, struct image *indirect);
void reference_film_finish(struct reference_film *film);
/* Checksummed file; a damaged one or of another key: GR_ERR_FORMAT, GR_ERR_MISMATCH. */
int reference_film_save(const struct reference_film *film, const char *path);
int reference_film_load(struct reference_film *film, const char *path);

/* Irradiance on the side of a surface point that its normal shows. */
struct reference_point {
	float position[3], normal[3]; /* unit; the ray starts a little off the surface */
	double total[3], indirect[3]; /* W/m^2 per band; indirect: all that was reflected at least once */
	double total_error[3], indirect_error[3]; /* standard errors */
};
int reference_irradiance(struct reference *reference, const struct reference_params *params,
			 struct reference_point *points, size_t count, uint64_t *out_nonfinite);

#endif
