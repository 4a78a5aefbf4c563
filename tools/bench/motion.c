#include "tools/bench/motion.h"

#include "tools/bench/measure.h"

#include <math.h>
#include <string.h>

#define AIR 1e-6f

void bench_motion_init(struct bench_motion *motion, const struct scene_file *file)
{
	vec3 up = { 0, 1, 0 };

	memset(motion, 0, sizeof *motion);
	motion->file = file;
	render_frame_init(&motion->rest, file);
	motion->lamp = -1;
	for (size_t i = 0; i < file->lamp_count && i < SCENE_MAX_LAMPS && motion->lamp < 0; i++)
		if (motion->rest.lamps[i].on && glm_vec3_max(motion->rest.lamps[i].intensity) > 0)
			motion->lamp = (int)i;
	if (motion->lamp < 0)
		return;
	glm_vec3_cross(motion->rest.lamps[motion->lamp].direction, up, motion->way);
	if (glm_vec3_norm(motion->way) < 1e-3f)
		glm_vec3_copy((vec3){ 1, 0, 0 }, motion->way);
	glm_vec3_normalize(motion->way);
}

void bench_motion_frame(const struct bench_motion *motion, double step, struct render_frame *out)
{
	struct frame_lamp *lamp;
	float far = (float)(step * BENCH_STEP_M);

	*out = motion->rest;
	if (motion->lamp < 0) {
		if (lround(fabs(step)) % 2 == 1)
			out->absorption_per_m += AIR;
		return;
	}
	lamp = &out->lamps[motion->lamp];
	if (motion->file->lamps[motion->lamp].kind == SCENE_LAMP_DIRECTIONAL) {
		glm_vec3_muladds((float *)motion->way, far / MOTION_LEVER_M, lamp->direction);
		glm_vec3_normalize(lamp->direction);
	} else {
		glm_vec3_muladds((float *)motion->way, far, lamp->position);
	}
}

void bench_motion_dark(const struct bench_motion *motion, struct render_frame *out)
{
	*out = motion->rest;
	for (int i = 0; i < SCENE_MAX_LAMPS; i++)
		out->lamps[i].on = false;
}
