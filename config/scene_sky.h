/*
 * The sky of a scene file: where its sun is, and the lamp that this is. Private to config/.
 */
#ifndef GROTTO_CONFIG_SCENE_SKY_H
#define GROTTO_CONFIG_SCENE_SKY_H

#include "config/scene_options.h"

/* Name of the sun's lamp; a lamp of the file may not have it beside a sky with a sun. */
#define SCENE_SUN_NAME "sun"

/* Reports what is wrong with a sky, and completes to_sun. */
void scene_sky_check(struct options_reader *reader, struct scene_form *form);
/* Whether there is a sun; as a directional lamp. */
bool scene_sky_sun(const struct scene_environment *environment, struct scene_lamp *out);

#endif
