/*
 * Off-axis (generalised) perspective projection: Kooima, "Generalized
 * Perspective Projection", 2009. Computed in double; the matrices that the
 * GPU takes are float.
 *
 * Pure functions, any thread.
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
	double l, r, b, t; /* frustum at the near plane, metres */
	double near_m;
	double right[3], up[3], back[3]; /* eye-space axes in the wall's frame, unit; -back looks */
	double distance; /* eye to the wall's plane, metres, positive in front; 0 for a camera */
};

/* Closest that an eye may come to a wall's plane before it is refused, metres. */
#define PROJECTION_MIN_DISTANCE 1e-4

/*
 * GR_OK; GR_ERR_RANGE when the eye is not finite, behind the wall or nearer
 * than PROJECTION_MIN_DISTANCE, the wall degenerate, or near/far not
 * 0 < near < far. Then *out is untouched: the caller keeps the last picture.
 * Corners that are not quite a rectangle are taken as the rectangle on the
 * lower edge with the upper corner's height.
 *
 * The double members put the picture's corners on the wall's corners within
 * what rounding the corners to float leaves of the rectangle (4e-6 m measured,
 * 1 mm off the wall included). The float matrices hold to 2e-5 m from 0.1 m
 * off the wall on; at 1 mm their rounding alone is 2 mm on a turned wall.
 */
int projection_off_axis(const struct projection_wall *wall, const vec3 eye, float near_m,
			float far_m, struct projection *out);
/*
 * A symmetric camera for stills, through the same type. GR_ERR_RANGE also when
 * up is along the view, or vfov_rad not in (0, pi).
 */
int projection_camera(const vec3 position, const vec3 target, const vec3 up, float vfov_rad,
		      float aspect, float near_m, float far_m, struct projection *out);

#endif
