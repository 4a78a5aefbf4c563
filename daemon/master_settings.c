#include "daemon/master_settings.h"

#include "base/plain.h"
#include "base/result.h"
#include "renderer/tone/adapt.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Settings that are one number, the parameter's first; range and unit are the parameter's. */
struct simple_setting {
	const char *name;
	enum param_id id;
	bool whole; /* uint32_t, else float */
	size_t offset;
};

#define AT(member) offsetof(struct master_settings, member)
static const struct simple_setting simple[] = {
	{ "gi_on", PARAM_GI_ON, true, AT(gi_on) },
	{ "gi_steps", PARAM_GI_STEPS, true, AT(gi_steps) },
	{ "gi_gathers", PARAM_GI_GATHERS, true, AT(gi_gathers) },
	{ "gi_incremental", PARAM_GI_INCREMENTAL, false, AT(gi_incremental) },
	{ "absorption", PARAM_ABSORPTION, false, AT(absorption) },
	{ "scattering", PARAM_SCATTERING, false, AT(scattering) },
	{ "exposure", PARAM_EXPOSURE, false, AT(exposure) },
	{ "tone_curve", PARAM_TONE_CURVE, true, AT(tone_curve) },
	{ "gamma_encode", PARAM_GAMMA_ENCODE, false, AT(gamma_encode) },
	{ "adaptation", PARAM_ADAPTATION, false, AT(adaptation) },
	{ "luminance_max", PARAM_LUMINANCE_MAX, false, AT(luminance_max) },
	{ "tone_bias", PARAM_TONE_BIAS, false, AT(tone_bias) },
	{ "eye_separation", PARAM_EYE_SEPARATION, false, AT(eye_separation) },
};
#define SIMPLE_COUNT (sizeof simple / sizeof *simple)

void master_settings_init(struct master_settings *settings, const struct scene_file *scene,
			  float eye_separation_m)
{
	*settings = (struct master_settings){
		.gi_on = scene->gi.method != SCENE_GI_NONE,
		.gi_steps = (uint32_t)scene->gi.steps,
		.gi_gathers = (uint32_t)scene->gi.gathers,
		.tone_curve = scene->tone.curve,
		.gi_incremental = scene->gi.incremental,
		.absorption = scene->absorption_per_m,
		.scattering = scene->scattering_per_m,
		.exposure = scene->tone.exposure,
		.gamma_encode = scene->tone.gamma_end_to_end / scene->tone.gamma_display,
		.eye_separation = eye_separation_m,
		.adaptation = scene->tone.adaptation,
		.luminance_max = scene->tone.luminance_max,
		.eye_adapts = scene->tone.adapt != SCENE_ADAPT_FIXED,
		.tone_bias = scene->tone.bias,
	};
	for (size_t i = 0; i < scene->lamp_count && i < PARAM_MAX_LAMPS; i++) {
		if (scene->lamps[i].on)
			settings->lamp_on |= 1u << i;
		memcpy(settings->lamp_intensity + 3 * i, scene->lamps[i].intensity,
		       3 * sizeof(float));
	}
}

static bool parse_number(const char *text, bool whole, double min, double max, double *out)
{
	char *end;

	errno = 0;
	*out = strtod(text, &end);
	if (errno || end == text || *end || !isfinite(*out) || *out < min || *out > max)
		return false;
	return !whole || *out == floor(*out);
}

static int find_lamp(const struct scene_file *scene, const char *name, char *why, size_t size)
{
	size_t len;

	for (size_t i = 0; i < scene->lamp_count && i < PARAM_MAX_LAMPS; i++)
		if (!strcmp(scene->lamps[i].name, name))
			return (int)i;
	len = (size_t)snprintf(why, size, "no lamp '%.40s'; the scene has", name);
	for (size_t i = 0; i < scene->lamp_count && len < size; i++)
		len += (size_t)snprintf(why + len, size - len, "%s %s", i ? "," : "",
					scene->lamps[i].name);
	if (scene->lamp_count == 0 && len < size)
		snprintf(why + len, size - len, " none");
	return -1;
}

static int set_lamp(struct master_settings *settings, const struct scene_file *scene,
		    char *const *words, int count, char *why, size_t size)
{
	int lamp;

	if (count != 3 || (strcmp(words[2], "on") && strcmp(words[2], "off"))) {
		snprintf(why, size, "write: set lamp NAME on|off");
		return GR_ERR_RANGE;
	}
	lamp = find_lamp(scene, words[1], why, size);
	if (lamp < 0)
		return GR_ERR_RANGE;
	if (!strcmp(words[2], "on"))
		settings->lamp_on |= 1u << lamp;
	else
		settings->lamp_on &= ~(1u << lamp);
	return GR_OK;
}

static int set_lamp_intensity(struct master_settings *settings, const struct scene_file *scene,
			      char *const *words, int count, char *why, size_t size)
{
	const struct param_info *info = param_info(PARAM_LAMP_INTENSITY);
	double rgb[3];
	int lamp;

	if (count != 5) {
		snprintf(why, size, "write: set lamp_intensity NAME RED GREEN BLUE");
		return GR_ERR_RANGE;
	}
	lamp = find_lamp(scene, words[1], why, size);
	if (lamp < 0)
		return GR_ERR_RANGE;
	for (int i = 0; i < 3; i++) {
		if (!parse_number(words[2 + i], false, info->min, info->max, &rgb[i])) {
			snprintf(why, size, "lamp_intensity '%.40s': give %s to %s %s", words[2 + i],
				 gr_plain(info->min, 6).text, gr_plain(info->max, 6).text, info->unit);
			return GR_ERR_RANGE;
		}
	}
	for (int i = 0; i < 3; i++)
		settings->lamp_intensity[3 * lamp + i] = (float)rgb[i];
	return GR_OK;
}

static int set_simple(struct master_settings *settings, const struct simple_setting *setting,
		      char *const *words, int count, char *why, size_t size)
{
	const struct param_info *info = param_info(setting->id);
	void *at = (char *)settings + setting->offset;
	double value;

	if (count != 2 || !parse_number(words[1], setting->whole, info->min, info->max, &value)) {
		snprintf(why, size, "%s: give one %snumber from %s to %s%s%s", setting->name,
			 setting->whole ? "whole " : "", gr_plain(info->min, 6).text,
			 gr_plain(info->max, 6).text,
			 *info->unit ? " " : "", info->unit);
		return GR_ERR_RANGE;
	}
	if (setting->whole)
		*(uint32_t *)at = (uint32_t)value;
	else
		*(float *)at = (float)value;
	return GR_OK;
}

int master_settings_set(struct master_settings *settings, const struct scene_file *scene,
			char *const *words, int count, char *why, size_t size)
{
	size_t len;

	if (count >= 1 && !strcmp(words[0], "lamp"))
		return set_lamp(settings, scene, words, count, why, size);
	if (count >= 1 && !strcmp(words[0], "lamp_intensity"))
		return set_lamp_intensity(settings, scene, words, count, why, size);
	for (size_t i = 0; count >= 1 && i < SIMPLE_COUNT; i++)
		if (!strcmp(words[0], simple[i].name))
			return set_simple(settings, &simple[i], words, count, why, size);
	len = (size_t)snprintf(why, size, "no setting '%.40s'; there are lamp, lamp_intensity",
			       count >= 1 ? words[0] : "");
	for (size_t i = 0; i < SIMPLE_COUNT && len < size; i++)
		len += (size_t)snprintf(why + len, size - len, ", %s", simple[i].name);
	return GR_ERR_RANGE;
}

void master_settings_read(struct master_settings *settings, const struct param_state *params)
{
	for (size_t i = 0; i < SIMPLE_COUNT; i++)
		memcpy((char *)settings + simple[i].offset, param_get(params, simple[i].id), 4);
	memcpy(&settings->lamp_on, param_get(params, PARAM_LAMP_ON), sizeof settings->lamp_on);
	memcpy(settings->lamp_intensity, param_get(params, PARAM_LAMP_INTENSITY),
	       sizeof settings->lamp_intensity);
}

/* An eye that has long been used to it. */
static int apply_adaptation(float level, struct param_state *params, uint64_t frame)
{
	struct adapt_state eye;
	float levels[2], pigment[2];

	if (adapt_settle(&eye, (double)level) != GR_OK)
		return GR_ERR_RANGE;
	levels[0] = levels[1] = level;
	pigment[0] = (float)eye.cone_pigment;
	pigment[1] = (float)eye.rod_pigment;
	if (param_set(params, PARAM_ADAPTATION, levels, frame) < 0 ||
	    param_set(params, PARAM_PIGMENT, pigment, frame) < 0)
		return GR_ERR_RANGE;
	return GR_OK;
}

int master_settings_apply(const struct master_settings *settings, struct param_state *params,
			  uint64_t frame, const char **refused)
{
	int r = GR_OK;

	for (size_t i = 0; i < SIMPLE_COUNT; i++) {
		const void *at = (const char *)settings + simple[i].offset;
		int set;

		if (settings->eye_adapts &&
		    (simple[i].id == PARAM_ADAPTATION || simple[i].id == PARAM_LUMINANCE_MAX))
			continue;
		set = simple[i].id == PARAM_ADAPTATION ?
				  apply_adaptation(settings->adaptation, params, frame) :
				  param_set(params, simple[i].id, at, frame);

		if (set < 0) {
			*refused = simple[i].name;
			r = GR_ERR_RANGE;
		}
	}
	if (param_set(params, PARAM_LAMP_INTENSITY, settings->lamp_intensity, frame) < 0) {
		*refused = "lamp_intensity";
		r = GR_ERR_RANGE;
	}
	return r;
}
