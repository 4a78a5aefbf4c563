/* What the planner's files share. */
#ifndef GROTTO_RENDERER_GI_PLAN_PRIVATE_H
#define GROTTO_RENDERER_GI_PLAN_PRIVATE_H

#include "renderer/gi/plan.h"

/* Surfels on a surface: of surfel_bake.c, Poisson discs that leave no gap. */
#define SURFEL_DENSITY 0.7

bool gi_plan_has_light(const struct gi_facts *facts);
/* Metres; the baker's own where the settings name none. */
double gi_plan_spacing(const struct gi_facts *facts, const struct scene_gi *gi);
/* why, from all else. */
void gi_plan_say(struct gi_plan *plan, const struct gi_facts *facts);

#endif
