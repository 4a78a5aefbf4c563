/* A visitor to start from, and how far two poses are apart. */
#ifndef GROTTO_TESTS_VISITOR_H
#define GROTTO_TESTS_VISITOR_H

#include "tests/unit/unit.h"

#include "base/result.h"
#include "tracking/sim.h"

#include <math.h>

static const struct track_sim_params plain __attribute__((unused)) = {
	.start_head = { { 0.1f, 1.7f, 0.2f }, { 0, 0, 0, 1 } },
	.start_wand = { { 0.3f, 1.2f, -0.2f }, { 0, 0, 0, 1 } },
	.room_min = { -1.5f, 0, -1.5f },
	.room_max = { 1.5f, 3, 1.5f },
	.rate_hz = 100,
	.seed = 1,
	.walk_radius_m = 0.8f,
	.walk_speed_m_s = 0.6f,
	.head = true,
	.wand = true,
};

static inline struct track_source *sim(const struct track_sim_params *params)
{
	struct track_source *source = NULL;
	struct gr_diag diag = { 0 };

	assert_int_equal(track_sim_create(&source, params, &diag), GR_OK);
	assert_int_equal(diag.count, 0);
	return source;
}

/* Radians. */
static inline float turn_between(const struct gr_pose *a, const struct gr_pose *b)
{
	struct gr_pose back, d;

	gr_pose_inverse(a, &back);
	gr_pose_mul(&back, b, &d);
	return 2.0f * atan2f(sqrtf(d.q[0] * d.q[0] + d.q[1] * d.q[1] + d.q[2] * d.q[2]),
			     fabsf(d.q[3]));
}

/* Metres. */
static inline float distance(const struct gr_pose *a, const struct gr_pose *b)
{
	return glm_vec3_distance((float *)a->p, (float *)b->p);
}

#endif
