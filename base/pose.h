/*
 * Rigid poses. T_a_b takes coordinates of frame b to frame a, so
 * T_room_head applied to the origin is where the head is in the room.
 *
 * Frames (all right handed, +Y up, metres):
 *   room   the CAVE: origin on the floor in its middle, -Z is the front
 *   scene  the model, glTF axes
 *   head   the midpoint between the eyes, -Z is where the person looks
 *   wand   its tip, -Z is where it points
 */
#ifndef GROTTO_BASE_POSE_H
#define GROTTO_BASE_POSE_H

#include <cglm/cglm.h>
#include <stdbool.h>

struct gr_pose {
	vec3 p;   /* metres */
	versor q; /* unit quaternion x y z w */
};

#define GR_POSE_IDENTITY ((struct gr_pose){ { 0, 0, 0 }, { 0, 0, 0, 1 } })

/* All parts finite and the quaternion of unit length within 1e-3. */
bool gr_pose_valid(const struct gr_pose *pose);
void gr_pose_mat4(const struct gr_pose *pose, mat4 out);
/* out = a * b, so T_a_c = T_a_b * T_b_c. out may be a or b. */
void gr_pose_mul(const struct gr_pose *a, const struct gr_pose *b, struct gr_pose *out);
void gr_pose_inverse(const struct gr_pose *a, struct gr_pose *out);
void gr_pose_point(const struct gr_pose *T, const vec3 point, vec3 out);
void gr_pose_direction(const struct gr_pose *T, const vec3 direction, vec3 out);
/* Position linear, orientation slerp along the shorter arc; t in [0,1]. */
void gr_pose_mix(const struct gr_pose *a, const struct gr_pose *b, float t, struct gr_pose *out);
/* A turn about +Y; radians, counter-clockwise seen from above. */
void gr_pose_heading(const vec3 position, float heading, struct gr_pose *out);

#endif
