#include "base/result.h"
#include "config/scene_options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Leaves out what the lamp does not use: the reader would warn about it. */
static void fill_lamp(const struct scene_lamp *from, struct scene_form_lamp *to)
{
	to->lamp = *from;
	if (from->kind != SCENE_LAMP_SPOT)
		to->lamp.cone_rad = to->lamp.penumbra_rad = NAN;
	if (from->kind == SCENE_LAMP_DIRECTIONAL)
		to->lamp.radius_m = NAN;
	else
		to->lamp.angle_rad = NAN;
	if (from->mount == SCENE_MOUNT_ORBIT)
		to->lamp.position[0] = NAN;
	else
		to->lamp.orbit_center[0] = to->lamp.orbit_radius_m = to->lamp.orbit_period_s = NAN;
}

static void fill_environment(const struct scene_environment *from, struct scene_environment *to)
{
	*to = *from;
	if (from->kind != SCENE_ENVIRONMENT_CONSTANT)
		to->radiance[0] = NAN;
	if (from->kind != SCENE_ENVIRONMENT_IMAGE) {
		to->scale = NAN;
		to->projection = (enum scene_projection)OPTION_ABSENT;
	}
	if (from->kind != SCENE_ENVIRONMENT_IMAGE && from->kind != SCENE_ENVIRONMENT_SKY)
		to->heading_rad = NAN;
	if (from->kind != SCENE_ENVIRONMENT_SKY)
		to->turbidity = NAN;
	if (from->kind != SCENE_ENVIRONMENT_SKY || from->time)
		to->sun_elevation_rad = to->sun_azimuth_rad = NAN;
	if (!from->time)
		to->place[0] = NAN;
}

int scene_file_write(FILE *out, const struct scene_file *file)
{
	/* Strings are borrowed: the form is never given to options_free. */
	struct scene_form form = { 0 };
	struct scene_form_lamp *lamps = calloc(file->lamp_count + 1, sizeof *lamps);
	struct scene_form_camera *cameras = calloc(file->camera_count + 1, sizeof *cameras);
	struct scene_form_surface *surfaces = calloc(file->surface_count + 1, sizeof *surfaces);
	int result = GR_ERR_NOMEM;

	if (!lamps || !cameras || !surfaces)
		goto out;
	memcpy(form.name, file->name, sizeof form.name);
	form.model = file->model;
	form.model_scale = file->model_scale;
	form.emission_scale = file->emission_scale;
	form.double_sided = file->double_sided;
	glm_vec3_copy((float *)file->background, form.background);
	form.near_m = file->near_m;
	form.far_m = file->far_m;
	form.shadow_pixels = file->shadow_pixels;
	form.lamps = lamps;
	for (size_t i = 0; i < file->lamp_count; i++)
		if (!file->lamps[i].of_sky)
			fill_lamp(&file->lamps[i], &lamps[form.lamp_count++]);
	form.cameras = cameras;
	form.camera_count = file->camera_count;
	for (size_t i = 0; i < file->camera_count; i++)
		cameras[i].camera = file->cameras[i];
	form.surfaces = surfaces;
	form.surface_count = file->surface_count;
	for (size_t i = 0; i < file->surface_count; i++)
		surfaces[i].surface = file->surfaces[i];
	fill_environment(&file->environment, &form.environment.environment);
	form.gi.method = (int)file->gi.method;
	form.gi.share = (int)file->gi.share;
	form.gi.budget_ms = file->gi.budget_ms;
	form.gi.lpv.gi = file->gi;
	form.gi.surfels.gi = file->gi;
	form.medium.absorption_per_m = file->absorption_per_m;
	form.medium.scattering_per_m = file->scattering_per_m;
	form.tone.tone = file->tone;
	form.tone.ambient = OPTION_ABSENT;
	if (form.tone.tone.srgb)
		form.tone.tone.gamma_end_to_end = form.tone.tone.gamma_display = NAN;
	glm_vec3_copy((float *)file->room.p, form.room.position);
	form.room.heading_rad = file->room_heading_rad;
	options_write(out, scene_options, &form);
	result = fflush(out) || ferror(out) ? GR_ERR_IO : GR_OK;
out:
	free(lamps);
	free(cameras);
	free(surfaces);
	return result;
}
