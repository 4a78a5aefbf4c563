/*
 * The whole pipeline of one wall (or one still): shadow and reflective shadow
 * maps of lamps that changed, global illumination, and per eye G-buffer,
 * shading, tone curve and encoding. Stages that the scene does not need do
 * not exist; the log says which run and why.
 *
 * GL thread only. No allocation after create.
 */
#ifndef GROTTO_RENDERER_RENDERER_H
#define GROTTO_RENDERER_RENDERER_H

#include "renderer/alive.h"
#include "renderer/frame.h"
#include "renderer/gl/target.h"
#include "renderer/gl/timer.h"
#include "renderer/image/image.h"
#include "renderer/scene/scene.h"
#include "renderer/view/projection.h"

#include <stdbool.h>
#include <stdint.h>

struct projector;    /* renderer/tone/projector.h */
struct adapt_sample; /* renderer/tone/adapt.h */

enum renderer_eyes {
	RENDERER_MONO,
	RENDERER_QUAD_BUFFER,
	RENDERER_SIDE_BY_SIDE,
	RENDERER_TOP_BOTTOM,
	RENDERER_LEFT,
	RENDERER_RIGHT,
};

struct renderer_params {
	int width, height; /* of one eye's picture */
	enum renderer_eyes eyes;
	bool wall_given;
	struct projection_wall wall; /* room frame; without it: a camera per still */
	bool keep_radiance;          /* scene-linear pictures can be read back */
	bool quiet;                  /* the stages are not logged */
	const struct projector *projector; /* for create; NULL: pictures are encoded for the scene's display */
	bool dither;                 /* of the target's bits; none where that is float */
	/* For gi.method = "auto": this plan, copied; NULL: the one that plan_light.h makes here. */
	const struct light_plan *light;
	struct alive alive; /* asked between the steps of renderer_create, and while surfels are baked */
};

/* Target size that params need: both eyes for side-by-side and top-bottom. */
void renderer_target_size(const struct renderer_params *params, int *width, int *height);

struct renderer;
struct light_plan;
/* target, file and scene must outlive the renderer. Logs the stages. GR_NOTHING: `alive` ended it. */
int renderer_create(struct renderer **out, struct target *target,
		    const struct renderer_params *params, const struct scene_file *file,
		    const struct scene *scene);
void renderer_destroy(struct renderer **renderer);

/*
 * Submits one frame for the wall. GR_OK, or GR_NOTHING when an eye is where
 * no picture exists (behind the wall): the last picture stays and is counted.
 * Does not wait for the GPU. What did not change is not drawn again: without a
 * change of lamps, light, medium or head the last picture stays as it is.
 *
 * GR_ERR_STATE without a wall, GR_ERR_RANGE for a frame with a pose, a lamp
 * that is on, or a number that is not finite, GR_ERR_GL.
 */
int renderer_draw(struct renderer *renderer, const struct render_frame *frame);
/* A still from a camera of the scene file instead of the wall; one eye only (RENDERER_MONO). */
int renderer_draw_camera(struct renderer *renderer, const struct render_frame *frame,
			 const struct scene_camera *camera);
/*
 * Whether the GPU has finished the last submitted frame. wait_ns 0 polls.
 * GR_OK finished, GR_NOTHING not yet, GR_ERR_GL lost.
 */
int renderer_finished(struct renderer *renderer, int64_t wait_ns);

/*
 * Final picture as encoded 8 bit RGB (3 bytes a pixel, row 0 top) of what
 * renderer_target_size says; of quad-buffer the left eye. Waits. In a window
 * it is there only before the swap.
 */
int renderer_read_rgb(struct renderer *renderer, uint8_t *rgb);
/* Scene-linear radiance of one eye, 3 channels; needs keep_radiance. Waits. */
int renderer_read_radiance(struct renderer *renderer, int eye, struct image *out);
/* Indirect irradiance-reflected part alone (same units), for accuracy tests. Needs keep_radiance. */
int renderer_read_indirect(struct renderer *renderer, int eye, struct image *out);
/*
 * Indirect irradiance of the light field (W/m^2 per band) at points of
 * surfaces, as shading takes it; zero without a method. For tests and
 * measurements: it compiles and allocates, and waits. At most
 * RENDERER_POINTS_MAX points. GR_OK, GR_ERR_RANGE, GR_ERR_NOMEM, GR_ERR_GL.
 */
struct renderer_point {
	float position[3], normal[3]; /* scene, metres; unit, towards the lit side */
};
#define RENDERER_POINTS_MAX ((size_t)1 << 20)
int renderer_read_irradiance(struct renderer *renderer, const struct renderer_point *points,
			     size_t count, float (*out)[3]);
struct gi_plan;
/* What was chosen for gi.method = "auto" (renderer/gi/plan.h); NULL: the scene file chose. */
const struct gi_plan *renderer_plan(const struct renderer *renderer);
/* The same with what it follows from (renderer/plan_light.h). */
const struct light_plan *renderer_light_plan(const struct renderer *renderer);
/* Surfels that light the scene; 0: another method. */
size_t renderer_surfels(const struct renderer *renderer);
struct gi_stats;
/* Of the method; false when there is none. */
bool renderer_gi_stats(const struct renderer *renderer, struct gi_stats *out);
/* Hash of the light field, see gi.h; 0 when there is no method. Waits. */
uint64_t renderer_light_hash(struct renderer *renderer);
struct timers *renderer_timers(struct renderer *renderer);

/*
 * Work that the nodes share out; renderer/gi/gi.h says what each call does.
 * Without a method that can, they give GR_ERR_UNSUPPORTED, and 0 bytes.
 */
/* Room for all slices of up to `nodes` nodes: the largest count times its longest slice. */
size_t renderer_share_bytes(const struct renderer *renderer, unsigned nodes);
int renderer_share_set(struct renderer *renderer, unsigned index, unsigned count);
/* Once, when renderer_finished has said so. */
int renderer_share_take(struct renderer *renderer, uint8_t *bytes, size_t size, size_t *out_len);
int renderer_share_put(struct renderer *renderer, const uint8_t *bytes, size_t len);

/*
 * What the eye looks at of this wall (renderer/tone/gaze.h), of the newest frame that the
 * GPU has finished, counted from 1. GR_NOTHING: none yet, or the scene's tone.adapt is fixed.
 * Never waits.
 */
int renderer_glance(struct renderer *renderer, struct adapt_sample *out, uint64_t *out_frame);

struct renderer_stats {
	uint64_t frames, skipped_eyes;
	uint64_t shadow_updates, gi_updates; /* frames in which the stage ran */
	uint64_t gl_errors;
	uint64_t nonfinite; /* pixels, and cells of the light field, that were not finite */
};
void renderer_stats(const struct renderer *renderer, struct renderer_stats *out);

#endif
