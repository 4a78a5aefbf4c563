/*
 * A scene file as it is written, before it is checked and turned into struct
 * scene_file. Private to config/.
 */
#ifndef GROTTO_CONFIG_SCENE_OPTIONS_H
#define GROTTO_CONFIG_SCENE_OPTIONS_H

#include "config/options.h"
#include "config/scene_file.h"

struct scene_form_lamp {
	const config_setting_t *at;
	struct scene_lamp lamp;
};

struct scene_form_camera {
	const config_setting_t *at;
	struct scene_camera camera;
};

struct scene_form_surface {
	const config_setting_t *at;
	struct scene_surface surface; /* strings owned */
};

struct scene_form_environment {
	const config_setting_t *at;
	struct scene_environment environment; /* strings owned */
};

/* Both are all of struct scene_gi; each fills its own part. */
struct scene_form_surfels {
	const config_setting_t *at;
	struct scene_gi gi;
};

struct scene_form_lpv {
	const config_setting_t *at;
	struct scene_gi gi;
};

struct scene_form_gi {
	const config_setting_t *at;
	int method, share;
	float budget_ms;
	struct scene_form_lpv lpv;
	struct scene_form_surfels surfels;
};

struct scene_form_medium {
	const config_setting_t *at;
	float absorption_per_m, scattering_per_m;
};

struct scene_form_tone {
	const config_setting_t *at;
	struct scene_tone tone; /* gamma_end_to_end NaN when not given */
	int ambient;
};

struct scene_form_room {
	const config_setting_t *at;
	vec3 position;
	float heading_rad;
};

struct scene_form {
	const config_setting_t *at;
	char name[SCENE_NAME_MAX];
	char *model;
	float model_scale, emission_scale;
	bool double_sided;
	vec3 background;
	float near_m, far_m;
	int shadow_pixels;
	struct scene_form_lamp *lamps;
	size_t lamp_count;
	struct scene_form_camera *cameras;
	size_t camera_count;
	struct scene_form_surface *surfaces;
	size_t surface_count;
	struct scene_form_environment environment;
	struct scene_form_gi gi;
	struct scene_form_medium medium;
	struct scene_form_tone tone;
	struct scene_form_room room;
};

extern const struct option scene_options[];

/* End-to-end gamma for `ambient`, in the order of its choices (seed 004, table 3.1). */
extern const float scene_ambient_gamma[3];
#define SCENE_AMBIENT_DEFAULT 1 /* dim */

/* Completes the form (unit directions, gamma) and reports every fault. */
void scene_check(struct options_reader *reader, struct scene_form *form);

#endif
