/*
 * What a person may change while the room runs: the scene file's values at
 * start, then what came over the control socket. Pure.
 */
#ifndef GROTTO_DAEMON_MASTER_SETTINGS_H
#define GROTTO_DAEMON_MASTER_SETTINGS_H

#include "config/scene_file.h"
#include "protocol/params.h"

#include <stddef.h>
#include <stdint.h>

struct master_settings {
	uint32_t gi_on, gi_steps, gi_gathers, tone_curve;
	float gi_incremental, absorption, scattering, exposure, gamma_encode, eye_separation;
	float adaptation, luminance_max, tone_bias; /* of the tone curve; cd/m^2, cd/m^2 */
	bool eye_adapts; /* what the first two become in a frame is master_adapt.h's */
	uint32_t lamp_on;                     /* bit i: lamp i of the scene file */
	float lamp_intensity[3 * PARAM_MAX_LAMPS];
};

/* The encoding's exponent is end-to-end gamma over display gamma (seed 004, table 3.1). */
void master_settings_init(struct master_settings *settings, const struct scene_file *scene,
			  float eye_separation_m);

/*
 * words: a setting's name (as in docs/control.md) and its values. GR_OK, or
 * GR_ERR_RANGE with nothing changed and what would be right in `why`.
 */
int master_settings_set(struct master_settings *settings, const struct scene_file *scene,
			char *const *words, int count, char *why, size_t size);

/* From the parameters of a frame. */
void master_settings_read(struct master_settings *settings, const struct param_state *params);
/* Into the parameters, for `frame`; GR_ERR_RANGE names the parameter in *refused. */
int master_settings_apply(const struct master_settings *settings, struct param_state *params,
			  uint64_t frame, const char **refused);

#endif
