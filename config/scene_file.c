#include "config/scene_file.h"

#include "base/result.h"
#include "config/canonical.h"
#include "config/config_text.h"
#include "config/scene_options.h"

#include <stdlib.h>
#include <string.h>

/* From a form without faults; its strings move over. */
static struct scene_file *build(struct scene_form *form, const char *path)
{
	struct scene_file *file = calloc(1, sizeof *file);

	if (!file)
		return NULL;
	file->path = strdup(path);
	file->lamps = calloc(form->lamp_count + 1, sizeof *file->lamps);
	file->cameras = calloc(form->camera_count + 1, sizeof *file->cameras);
	if (!file->path || !file->lamps || !file->cameras) {
		scene_file_destroy(&file);
		return NULL;
	}
	memcpy(file->name, form->name, sizeof file->name);
	file->model = form->model;
	form->model = NULL;
	file->model_scale = form->model_scale;
	file->emission_scale = form->emission_scale;
	file->double_sided = form->double_sided;
	for (; file->lamp_count < form->lamp_count; file->lamp_count++) {
		file->lamps[file->lamp_count] = form->lamps[file->lamp_count].lamp;
		file->lamps[file->lamp_count].line =
			(int)config_setting_source_line(form->lamps[file->lamp_count].at);
	}
	for (; file->camera_count < form->camera_count; file->camera_count++) {
		file->cameras[file->camera_count] = form->cameras[file->camera_count].camera;
		file->cameras[file->camera_count].line =
			(int)config_setting_source_line(form->cameras[file->camera_count].at);
	}
	file->gi = form->gi.lpv.gi;
	file->gi.method = (enum scene_gi_method)form->gi.method;
	file->absorption_per_m = form->medium.absorption_per_m;
	file->scattering_per_m = form->medium.scattering_per_m;
	glm_vec3_copy(form->background, file->background);
	file->tone = form->tone.tone;
	file->near_m = form->near_m;
	file->far_m = form->far_m;
	file->shadow_pixels = form->shadow_pixels;
	file->room_heading_rad = form->room.heading_rad;
	gr_pose_heading(form->room.position, form->room.heading_rad, &file->room);
	scene_file_hash(file, file->hash);
	return file;
}

int scene_file_parse(const char *text, size_t len, const char *path, struct scene_file **out,
		     struct gr_diag *diag)
{
	struct options_reader reader = { .file = path, .diag = diag };
	struct scene_form form = { 0 };
	config_t config;
	int result;

	*out = NULL;
	if (sodium_init() < 0)
		return GR_ERR_UNSUPPORTED;
	result = config_text_parse(text, len, path, &config, diag);
	if (result < 0)
		return result;
	reader.root = config_root_setting(&config);
	options_read(&reader, scene_options, reader.root, &form);
	if (!reader.nomem)
		scene_check(&reader, &form);
	if (reader.nomem)
		result = GR_ERR_NOMEM;
	else if (reader.faults)
		result = GR_ERR_CONFIG;
	else if (!(*out = build(&form, path)))
		result = GR_ERR_NOMEM;
	options_free(scene_options, &form);
	config_destroy(&config);
	return result;
}

int scene_file_load(const char *path, struct scene_file **out, struct gr_diag *diag)
{
	char *text;
	size_t len;
	int result = config_text_load(path, &text, &len, diag);

	*out = NULL;
	if (result < 0)
		return result;
	result = scene_file_parse(text, len, path, out, diag);
	free(text);
	return result;
}

void scene_file_destroy(struct scene_file **file)
{
	struct scene_file *f = *file;

	if (!f)
		return;
	free(f->path);
	free(f->model);
	free(f->lamps);
	free(f->cameras);
	free(f);
	*file = NULL;
}

char *scene_file_model_path(const struct scene_file *file)
{
	return config_text_beside(file->path, file->model);
}

int scene_file_find_camera(const struct scene_file *file, const char *name)
{
	for (size_t i = 0; i < file->camera_count; i++)
		if (!strcmp(file->cameras[i].name, name))
			return (int)i;
	return -1;
}

float scene_tone_gamma_encode(const struct scene_tone *tone)
{
	return tone->gamma_end_to_end / tone->gamma_display;
}

static void hash_lamp(struct canonical *c, const struct scene_lamp *lamp)
{
	canonical_string(c, lamp->name);
	canonical_u64(c, lamp->kind);
	canonical_u64(c, lamp->mount);
	canonical_u64(c, lamp->on);
	canonical_floats(c, lamp->direction, 3);
	canonical_floats(c, lamp->intensity, 3);
	canonical_floats(c, lamp->kind == SCENE_LAMP_DIRECTIONAL ? &lamp->angle_rad : &lamp->radius_m, 1);
	/* What the kind and mount do not use does not count: scene_file_write leaves it out. */
	if (lamp->mount == SCENE_MOUNT_ORBIT) {
		canonical_floats(c, lamp->orbit_center, 3);
		canonical_floats(c, &lamp->orbit_radius_m, 1);
		canonical_floats(c, &lamp->orbit_period_s, 1);
	} else {
		canonical_floats(c, lamp->position, 3);
	}
	if (lamp->kind == SCENE_LAMP_SPOT) {
		canonical_floats(c, &lamp->cone_rad, 1);
		canonical_floats(c, &lamp->penumbra_rad, 1);
	}
}

void scene_file_hash(const struct scene_file *file, uint8_t out[32])
{
	const struct scene_gi *gi = &file->gi;
	const struct scene_tone *tone = &file->tone;
	struct canonical c;

	canonical_start(&c, "grotto scene 1");
	canonical_floats(&c, &file->model_scale, 1);
	canonical_floats(&c, &file->emission_scale, 1);
	canonical_u64(&c, file->double_sided);
	canonical_u64(&c, file->lamp_count);
	for (size_t i = 0; i < file->lamp_count; i++)
		hash_lamp(&c, &file->lamps[i]);
	canonical_u64(&c, gi->method);
	canonical_u64(&c, gi->lpv_mode);
	canonical_u64(&c, (uint64_t)gi->lattice);
	canonical_u64(&c, (uint64_t)gi->steps);
	canonical_floats(&c, &gi->incremental, 1);
	canonical_u64(&c, (uint64_t)gi->rsm_pixels);
	canonical_u64(&c, (uint64_t)gi->link_rays);
	canonical_floats(&c, gi->albedo_override, 3);
	canonical_floats(&c, &file->absorption_per_m, 1);
	canonical_floats(&c, &file->scattering_per_m, 1);
	canonical_floats(&c, file->background, 3);
	canonical_u64(&c, tone->curve);
	canonical_floats(&c, &tone->exposure, 1);
	canonical_u64(&c, tone->srgb);
	if (!tone->srgb) {
		canonical_floats(&c, &tone->gamma_display, 1);
		canonical_floats(&c, &tone->gamma_end_to_end, 1);
	}
	canonical_floats(&c, &file->near_m, 1);
	canonical_floats(&c, &file->far_m, 1);
	canonical_u64(&c, (uint64_t)file->shadow_pixels);
	canonical_floats(&c, file->room.p, 3);
	canonical_floats(&c, &file->room_heading_rad, 1);
	canonical_finish(&c, out);
}
