/*
 * Off-axis (generalised) perspective projection: Kooima, "Generalized
 * Perspective Projection", 2009. Computed in double, delivered in float.
 */
#ifndef GROTTO_RENDERER_VIEW_PROJECTION_H
#define GROTTO_RENDERER_VIEW_PROJECTION_H

#include <cglm/cglm.h>
#include <stdbool.h>

struct projection_wall {
	vec3 lower_left, lower_right, upper_left; /* any frame, metres */
};

struct projection {
	mat4 view;       /* to eye space: axes along the wall, eye at the origin */
	mat4 projection; /* OpenGL clip space, z -1..1 */
	mat4 view_projection;
	float l, r, b, t; /* frustum at the near plane */
	float distance;   /* eye to the wall's plane, metres, positive in front */
};

/* Closest that an eye may come to a wall's plane before it is refused, metres. */
#define PROJECTION_MIN_DISTANCE 1e-4f

/*
 * GR_OK; GR_ERR_RANGE when the eye is not finite, behind the wall or nearer
 * than PROJECTION_MIN_DISTANCE, the wall degenerate, or near/far not
 * 0 < near < far. Then *out is untouched: the caller keeps the last picture.
 */
int projection_off_axis(const struct projection_wall *wall, const vec3 eye, float near_m,
			float far_m, struct projection *out);
/* A symmetric camera for stills, through the same type. */
int projection_camera(const vec3 position, const vec3 target, const vec3 up, float vfov_rad,
		      float aspect, float near_m, float far_m, struct projection *out);

#endif
