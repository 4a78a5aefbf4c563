/*
 * Lamps of a frame for the tracer, as shaders/lamp.glsl has them: points (or
 * parallel light) with a cone; or, where asked for, spheres and discs in the sky
 * of the same power, which rays can hit.
 *
 * Read only after init; any thread.
 */
#ifndef GROTTO_RENDERER_TRACE_LAMPS_H
#define GROTTO_RENDERER_TRACE_LAMPS_H

#include "renderer/frame.h"
#include "renderer/trace/vector.h"

struct trace_lamp {
	enum scene_lamp_kind kind;
	struct v3 position, direction;
	struct v3 intensity;     /* W/sr; directional: W/m^2 */
	float umbra, widen;      /* cosine at the cone's edge; 1/(difference to the penumbra's), 0: hard */
	float radius;            /* of the sphere, metres; directional: cosine of the disc's half angle. 0: a point */
	struct v3 radiance;      /* of the sphere or disc, W/(m^2 sr), before the cone */
};

struct lamps {
	struct trace_lamp lamps[SCENE_MAX_LAMPS];
	int count; /* those that shine */
	int extended; /* of these, how many have an extent; they come first */
};
/* Lamps that are off, black, or not finite are left out. */
void lamps_init(struct lamps *out, const struct scene_file *file, const struct render_frame *frame,
		bool soft);

/* Where light of a lamp comes from, seen from a point. */
struct lamp_light {
	struct v3 direction; /* unit, to the lamp */
	float distance;      /* INFINITY for parallel light */
	struct v3 irradiance; /* point lamp: on a plane that faces it, W/m^2; extended: radiance / pdf */
	float pdf;           /* 1/sr; 0 for a point */
};
/* u: two numbers in [0, 1), used by extended lamps alone. */
struct lamp_light lamp_light(const struct trace_lamp *lamp, struct v3 from, const float u[2]);
/*
 * Radiance of an extended lamp that a ray meets before `distance`, and the
 * density with which lamp_light draws that direction; false: it misses.
 */
bool lamp_met(const struct trace_lamp *lamp, struct v3 from, struct v3 direction, float distance,
	      struct v3 *out_radiance, float *out_pdf);

#endif
