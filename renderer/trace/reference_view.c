#include "renderer/trace/reference.h"

#include "base/result.h"

#include <math.h>

/* Any will do: only the directions are used. */
#define NEAR_M 1.0f
#define FAR_M 2.0f

static void from_projection(const struct projection *p, const struct gr_pose *T, struct reference_view *out)
{
	double across = p->r - p->l, high = p->t - p->b;
	vec3 corner, right, down;

	for (int i = 0; i < 3; i++) {
		corner[i] = (float)(p->l * p->right[i] + p->t * p->up[i] - p->near_m * p->back[i]);
		right[i] = (float)(across * p->right[i]);
		down[i] = (float)(-high * p->up[i]);
	}
	gr_pose_direction(T, corner, out->corner);
	gr_pose_direction(T, right, out->right);
	gr_pose_direction(T, down, out->down);
}

int reference_view_camera(const struct scene_camera *camera, struct reference_view *out)
{
	const struct gr_pose still = GR_POSE_IDENTITY;
	struct projection p;
	int result = projection_camera(camera->position, camera->target, camera->up,
				       camera->vfov_rad,
				       (float)camera->pixels[0] / (float)camera->pixels[1], NEAR_M,
				       FAR_M, &p);

	if (result != GR_OK)
		return result;
	from_projection(&p, &still, out);
	for (int i = 0; i < 3; i++)
		out->eye[i] = camera->position[i];
	out->width = camera->pixels[0];
	out->height = camera->pixels[1];
	return GR_OK;
}

int reference_view_wall(const struct projection_wall *wall, const struct gr_pose *T_scene_room,
			const float eye_room[3], int width, int height,
			struct reference_view *out)
{
	const vec3 eye = { eye_room[0], eye_room[1], eye_room[2] };
	struct projection p;
	int result = projection_off_axis(wall, eye, NEAR_M, FAR_M, &p);

	if (result != GR_OK)
		return result;
	from_projection(&p, T_scene_room, out);
	gr_pose_point(T_scene_room, eye, out->eye);
	out->width = width;
	out->height = height;
	return GR_OK;
}
