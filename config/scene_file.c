#include "config/scene_file.h"

#include "base/result.h"
#include "config/canonical.h"
#include "config/config_text.h"
#include "config/scene_sky.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* From a form without faults; its strings move over. */
static struct scene_file *build(struct scene_form *form, const char *path)
{
	struct scene_file *file = calloc(1, sizeof *file);

	if (!file)
		return NULL;
	file->path = strdup(path);
	file->lamps = calloc(form->lamp_count + 2, sizeof *file->lamps);
	file->cameras = calloc(form->camera_count + 1, sizeof *file->cameras);
	file->surfaces = calloc(form->surface_count + 1, sizeof *file->surfaces);
	if (!file->path || !file->lamps || !file->cameras || !file->surfaces) {
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
	for (; file->surface_count < form->surface_count; file->surface_count++) {
		struct scene_form_surface *from = &form->surfaces[file->surface_count];
		struct scene_surface *to = &file->surfaces[file->surface_count];

		*to = from->surface;
		to->line = (int)config_setting_source_line(from->at);
		from->surface.material = from->surface.file = NULL;
	}
	file->environment = form->environment.environment;
	form->environment.environment.file = form->environment.environment.time = NULL;
	/* last, so that the file's lamps keep their numbers */
	if (scene_sky_sun(&file->environment, &file->lamps[file->lamp_count]))
		file->lamp_count++;
	file->gi = form->gi.lpv.gi;
	file->gi.spacing_m = form->gi.surfels.gi.spacing_m;
	file->gi.links = form->gi.surfels.gi.links;
	file->gi.gathers = form->gi.surfels.gi.gathers;
	file->gi.taps = form->gi.surfels.gi.taps;
	file->gi.probes = form->gi.surfels.gi.probes;
	file->gi.share = (enum scene_gi_share)form->gi.share;
	file->gi.budget_ms = form->gi.budget_ms;
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
	scene_file_items(file, NULL, 0, file->hash);
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
	for (size_t i = 0; i < f->surface_count; i++) {
		free(f->surfaces[i].material);
		free(f->surfaces[i].file);
	}
	free(f->surfaces);
	free(f->environment.file);
	free(f->environment.time);
	free(f);
	*file = NULL;
}

char *scene_file_model_path(const struct scene_file *file)
{
	return scene_file_beside(file, file->model);
}

char *scene_file_beside(const struct scene_file *file, const char *name)
{
	return config_text_beside(file->path, name);
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

/* What is not given is NaN with any payload; it counts as one value. */
static void hash_given(struct canonical *c, const float *values, unsigned count)
{
	bool given = !isnan(values[0]);

	canonical_u64(c, given);
	if (given)
		canonical_floats(c, values, count);
}

/* The content of files counts where it is read (scene_content_hash). */
static void hash_surface(struct canonical *c, const struct scene_surface *surface)
{
	canonical_string(c, surface->material);
	canonical_u64(c, surface->kind);
	canonical_u64(c, surface->sides);
	hash_given(c, surface->reflectance, 3);
	hash_given(c, surface->specular, 3);
	hash_given(c, &surface->shininess, 1);
	hash_given(c, &surface->roughness, 1);
	hash_given(c, surface->emission, 3);
}

static void hash_environment(struct canonical *c, const struct scene_environment *e)
{
	canonical_u64(c, e->kind);
	if (e->kind == SCENE_ENVIRONMENT_CONSTANT) {
		canonical_floats(c, e->radiance, 3);
	} else if (e->kind == SCENE_ENVIRONMENT_IMAGE) {
		canonical_floats(c, &e->scale, 1);
		canonical_floats(c, &e->heading_rad, 1);
	}
	if (e->kind != SCENE_ENVIRONMENT_NONE)
		canonical_u64(c, e->upper_only);
	if (e->kind == SCENE_ENVIRONMENT_SKY) {
		canonical_floats(c, &e->heading_rad, 1);
		canonical_floats(c, &e->turbidity, 1);
		canonical_u64(c, e->sun);
		canonical_u64(c, e->time != NULL);
		canonical_floats(c, e->time ? e->place : &e->sun_elevation_rad, e->time ? 2 : 1);
		canonical_floats(c, &e->sun_azimuth_rad, e->time ? 0 : 1);
		canonical_u64(c, (uint64_t)e->time_s);
	}
}

static void hash_gi(struct canonical *c, const struct scene_gi *gi)
{
	canonical_u64(c, gi->method);
	canonical_u64(c, gi->lpv_mode);
	canonical_u64(c, (uint64_t)gi->lattice);
	canonical_u64(c, (uint64_t)gi->steps);
	canonical_floats(c, &gi->incremental, 1);
	canonical_u64(c, (uint64_t)gi->rsm_pixels);
	canonical_u64(c, (uint64_t)gi->link_rays);
	canonical_floats(c, gi->albedo_override, 3);
	canonical_u64(c, gi->share);
	canonical_floats(c, &gi->budget_ms, 1);
	canonical_floats(c, &gi->spacing_m, 1);
	canonical_u64(c, (uint64_t)gi->links);
	canonical_u64(c, (uint64_t)gi->gathers);
	canonical_u64(c, (uint64_t)gi->taps);
	canonical_u64(c, (uint64_t)gi->probes);
}

static void hash_tone(struct canonical *c, const struct scene_tone *tone)
{
	canonical_u64(c, tone->curve);
	canonical_floats(c, &tone->exposure, 1);
	/* The curve may be changed while the room runs, so what the others take counts, too. */
	canonical_floats(c, &tone->adaptation, 1);
	canonical_u64(c, tone->adapt);
	if (tone->adapt == SCENE_ADAPT_EXPONENTIAL)
		canonical_floats(c, &tone->adapt_s, 1);
	canonical_floats(c, &tone->luminance_max, 1);
	canonical_floats(c, &tone->bias, 1);
	canonical_u64(c, tone->srgb);
	if (!tone->srgb) {
		canonical_floats(c, &tone->gamma_display, 1);
		canonical_floats(c, &tone->gamma_end_to_end, 1);
	}
}

size_t scene_file_items(const struct scene_file *file, struct gr_item *items, size_t room,
			uint8_t hash[32])
{
	struct canonical_items c = canonical_items_start("grotto scene 4", items, room);
	struct canonical *part;

	canonical_floats(canonical_item(&c, "model_scale"), &file->model_scale, 1);
	canonical_floats(canonical_item(&c, "emission_scale"), &file->emission_scale, 1);
	canonical_u64(canonical_item(&c, "double_sided"), file->double_sided);
	canonical_floats(canonical_item(&c, "background"), file->background, 3);
	part = canonical_item(&c, "near_m and far_m");
	canonical_floats(part, &file->near_m, 1);
	canonical_floats(part, &file->far_m, 1);
	canonical_u64(canonical_item(&c, "shadow_pixels"), (uint64_t)file->shadow_pixels);
	part = canonical_item(&c, "lamps");
	canonical_u64(part, file->lamp_count);
	for (size_t i = 0; i < file->lamp_count; i++)
		if (!file->lamps[i].of_sky) /* computed: what it comes from counts */
			hash_lamp(part, &file->lamps[i]);
	part = canonical_item(&c, "materials");
	canonical_u64(part, file->surface_count);
	for (size_t i = 0; i < file->surface_count; i++)
		hash_surface(part, &file->surfaces[i]);
	hash_environment(canonical_item(&c, "environment"), &file->environment);
	hash_gi(canonical_item(&c, "gi"), &file->gi);
	part = canonical_item(&c, "medium");
	canonical_floats(part, &file->absorption_per_m, 1);
	canonical_floats(part, &file->scattering_per_m, 1);
	hash_tone(canonical_item(&c, "tone"), &file->tone);
	part = canonical_item(&c, "room");
	canonical_floats(part, file->room.p, 3);
	canonical_floats(part, &file->room_heading_rad, 1);
	return canonical_items_finish(&c, hash);
}
