/* A plan in words: what, why, at what cost. */
#include "renderer/gi/plan_private.h"

#include "base/plain.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void gi_plan_settings(char *text, size_t size, const struct scene_gi *gi)
{
	char probes[48] = "", spacing[48] = "usual spacing";

	if (gi->method == SCENE_GI_PROBES)
		snprintf(probes, sizeof probes, "%d probes along the longest side, ", gi->probes);
	if (gi->spacing_m > 0)
		snprintf(spacing, sizeof spacing, "%s m apart", gr_plain((double)gi->spacing_m, 3).text);
	switch (gi->method) {
	case SCENE_GI_LPV:
		snprintf(text, size, "a lattice of %d cells, %d steps", gi->lattice, gi->steps);
		break;
	case SCENE_GI_SURFELS:
	case SCENE_GI_PROBES:
		snprintf(text, size, "%ssurfels %s, %d links, %d gather%s, %d taps", probes, spacing,
			 gi->links, gi->gathers, gi->gathers == 1 ? "" : "s", gi->taps);
		break;
	case SCENE_GI_NONE:
	case SCENE_GI_AUTO:
		snprintf(text, size, "none");
		break;
	}
}

static void put_reason(char *text, size_t size, const struct gi_facts *facts, const struct gi_plan *plan)
{
	const char *still = facts->moving_geometry
				    ? "things move, and only probes light what is not baked"
				    : "nothing moves but lamps";
	char scattered[32] = "";

	if (facts->scattering_per_m > 0)
		snprintf(scattered, sizeof scattered, "%s", gr_plain_percent(gi_plan_scattered(facts)).text);

	if (plan->gi.method == SCENE_GI_NONE)
		snprintf(text, size, "%s",
			 gi_plan_has_light(facts) ? "no surface can be lit"
						  : "no lamp, no emissive surface, no environment");
	else if (plan->gi.method == SCENE_GI_LPV && facts->scattering_per_m > 0)
		snprintf(text, size, "the air scatters about %s of the light, which only the lattice carries%s",
			 scattered, facts->environment ? "; it leaves the environment out" : "");
	else
		snprintf(text, size, "%s%s%s%s%s", still,
			 facts->environment ? "; there is an environment, which the lattice does not know" : "",
			 facts->scattering_per_m > 0 ? "; the air scatters about " : "", scattered,
			 facts->scattering_per_m > 0 ? " of the light, which is left out" : "");
}

static void put_error(char *text, size_t size, const struct gi_plan *plan)
{
	snprintf(text, size, "%s (%s to %s)", gr_plain_percent(plan->error).text,
		 gr_plain_percent(plan->error_least).text, gr_plain_percent(plan->error_most).text);
}

void gi_plan_say(struct gi_plan *plan, const struct gi_facts *facts)
{
	char settings[GI_PLAN_TEXT], reason[256], error[112], count[48] = "", over[144] = "";

	gi_plan_settings(settings, sizeof settings, &plan->gi);
	put_reason(reason, sizeof reason, facts, plan);
	put_error(error, sizeof error, plan);
	if (plan->gi.method == SCENE_GI_NONE) {
		snprintf(plan->why, sizeof plan->why, "none: %s", reason);
		return;
	}
	if (plan->surfels > 0)
		snprintf(count, sizeof count, "%s surfels, ", gr_plain(round(plan->surfels), 4).text);
	if (!plan->within && plan->adopted)
		snprintf(over, sizeof over, "; more than the budget of %s ms, for it is the room's plan",
			 gr_plain((double)plan->gi.budget_ms, 3).text);
	else if (!plan->within && !plan->baked)
		snprintf(over, sizeof over, "; nothing fits the budget of %s ms: gi.budget_ms = %s is the least that does",
			 gr_plain((double)plan->gi.budget_ms, 3).text,
			 gr_plain(gi_plan_budget_for(plan->update_ms), 3).text);
	snprintf(plan->why, sizeof plan->why,
		 "%s: %s; %s%s%s ms a frame while the light changes%s, expected error (nRMSE) %s%s", settings,
		 reason, plan->baked ? "" : "expected ", count, gr_plain(plan->update_ms, 3).text,
		 facts->lamps_moving ? "" : " (no lamp moves by itself)", error, over);
}
