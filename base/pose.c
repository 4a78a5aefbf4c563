#include "base/pose.h"

#include <math.h>

bool gr_pose_valid(const struct gr_pose *pose)
{
	float norm2 = 0;

	for (int i = 0; i < 3; i++)
		if (!isfinite(pose->p[i]))
			return false;
	for (int i = 0; i < 4; i++) {
		if (!isfinite(pose->q[i]))
			return false;
		norm2 += pose->q[i] * pose->q[i];
	}
	return fabsf(norm2 - 1.0f) < 2e-3f;
}

void gr_pose_mat4(const struct gr_pose *pose, mat4 out)
{
	versor q;

	glm_quat_copy((float *)pose->q, q);
	glm_quat_mat4(q, out);
	out[3][0] = pose->p[0];
	out[3][1] = pose->p[1];
	out[3][2] = pose->p[2];
}

void gr_pose_direction(const struct gr_pose *T, const vec3 direction, vec3 out)
{
	versor q;
	vec3 v = { direction[0], direction[1], direction[2] };

	glm_quat_copy((float *)T->q, q);
	glm_quat_rotatev(q, v, out);
}

void gr_pose_point(const struct gr_pose *T, const vec3 point, vec3 out)
{
	vec3 turned;

	gr_pose_direction(T, point, turned);
	for (int i = 0; i < 3; i++)
		out[i] = T->p[i] + turned[i];
}

void gr_pose_mul(const struct gr_pose *a, const struct gr_pose *b, struct gr_pose *out)
{
	struct gr_pose r;
	versor qa, qb;

	gr_pose_point(a, b->p, r.p);
	glm_quat_copy((float *)a->q, qa);
	glm_quat_copy((float *)b->q, qb);
	glm_quat_mul(qa, qb, r.q);
	glm_quat_normalize(r.q);
	*out = r;
}

void gr_pose_inverse(const struct gr_pose *a, struct gr_pose *out)
{
	struct gr_pose r = { { 0, 0, 0 }, { -a->q[0], -a->q[1], -a->q[2], a->q[3] } };
	vec3 p;

	gr_pose_direction(&r, a->p, p);
	for (int i = 0; i < 3; i++)
		r.p[i] = -p[i];
	*out = r;
}

void gr_pose_mix(const struct gr_pose *a, const struct gr_pose *b, float t, struct gr_pose *out)
{
	struct gr_pose r;
	versor qa, qb;

	for (int i = 0; i < 3; i++)
		r.p[i] = a->p[i] + (b->p[i] - a->p[i]) * t;
	glm_quat_copy((float *)a->q, qa);
	glm_quat_copy((float *)b->q, qb);
	glm_quat_slerp(qa, qb, t, r.q);
	glm_quat_normalize(r.q);
	*out = r;
}

void gr_pose_heading(const vec3 position, float heading, struct gr_pose *out)
{
	*out = GR_POSE_IDENTITY;
	for (int i = 0; i < 3; i++)
		out->p[i] = position[i];
	out->q[1] = sinf(heading * 0.5f);
	out->q[3] = cosf(heading * 0.5f);
}
