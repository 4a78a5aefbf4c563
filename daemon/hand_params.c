/* The hand in the parameters of a frame, and whether the light rests. */
#include "daemon/hand.h"

#include "base/result.h"

#include <math.h>
#include <string.h>

static void of_lamps_on(uint32_t on, const float *from, float *to)
{
	for (int i = 0; i < PARAM_MAX_LAMPS; i++)
		if (on >> i & 1)
			memcpy(to + (ptrdiff_t)3 * i, from + (ptrdiff_t)3 * i, 3 * sizeof *to);
}

void hand_light_of(const struct param_state *params, struct hand_light *out)
{
	memset(out, 0, sizeof *out); /* it is compared as a whole */
	out->on = *param_u32(params, PARAM_LAMP_ON);
	of_lamps_on(out->on, param_f32(params, PARAM_LAMP_POSITION), out->position);
	of_lamps_on(out->on, param_f32(params, PARAM_LAMP_DIRECTION), out->direction);
	of_lamps_on(out->on, param_f32(params, PARAM_LAMP_INTENSITY), out->intensity);
	out->absorption = *param_f32(params, PARAM_ABSORPTION);
	out->scattering = *param_f32(params, PARAM_SCATTERING);
}

uint32_t hand_refine(struct hand *hand, const struct hand_light *light, int64_t step_ns)
{
	if (memcmp(light, &hand->light, sizeof *light) != 0) {
		hand->light = *light;
		hand->rest_ns = 0;
	} else if (step_ns > 0 && hand->rest_ns < HAND_REST_NS) {
		hand->rest_ns += step_ns < HAND_REST_NS ? step_ns : HAND_REST_NS;
	}
	return hand->quality && hand->rest_ns >= HAND_REST_NS ? HAND_REFINE : 1;
}

int hand_write(struct hand *hand, int64_t step_ns, struct param_state *params, uint64_t frame,
	       const char **refused)
{
	const uint32_t flags = (hand->bindings->hud ? HAND_FLAG_HUD : 0) |
			       (hand->quality ? HAND_FLAG_QUALITY : 0) |
			       (hand->put_down ? HAND_FLAG_PUT_DOWN : 0);
	const uint32_t mode = hand->mode, torch = (uint32_t)(hand->torch + 1);
	struct hand_light light;
	uint32_t refine;
	const struct {
		enum param_id id;
		const void *value;
	} all[] = {
		{ PARAM_HAND_MODE, &mode },	{ PARAM_HAND_FLAGS, &flags },
		{ PARAM_HAND_TORCH, &torch },	{ PARAM_HAND_HUE, &hand->hue },
		{ PARAM_HUD_SCALE, &hand->bindings->hud_scale }, { PARAM_GI_REFINE, &refine },
	};
	int r = GR_OK;

	hand_light_of(params, &light);
	refine = hand_refine(hand, &light, step_ns);
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		if (param_set(params, all[i].id, all[i].value, frame) < 0) {
			*refused = param_info(all[i].id)->name;
			r = GR_ERR_RANGE;
		}
	return r;
}

void hand_adopt(struct hand *hand, const struct param_state *params)
{
	const uint32_t flags = *param_u32(params, PARAM_HAND_FLAGS);
	const ptrdiff_t at = 3 * (ptrdiff_t)hand->torch;
	const float *direction = param_f32(params, PARAM_LAMP_DIRECTION) + (at > 0 ? at : 0);

	hand->buttons = *param_u32(params, PARAM_WAND_BUTTONS);
	hand->stale = 0;
	hand->mode = (enum hand_mode)*param_u32(params, PARAM_HAND_MODE);
	hand->hue = *param_f32(params, PARAM_HAND_HUE);
	hand->quality = flags & HAND_FLAG_QUALITY;
	/* The same scene has the same torch; and there is none that shines nowhere. */
	hand->put_down = flags & HAND_FLAG_PUT_DOWN && hand->torch >= 0 &&
			 *param_u32(params, PARAM_HAND_TORCH) == (uint32_t)(hand->torch + 1) &&
			 fabsf(glm_vec3_norm2((float *)direction) - 1) < 1e-2f;
	if (hand->put_down) {
		memcpy(hand->position, param_f32(params, PARAM_LAMP_POSITION) + at, sizeof hand->position);
		memcpy(hand->direction, direction, sizeof hand->direction);
	}
	hand->drag.on = hand->flight.on = false;
	hand_light_of(params, &hand->light);
	hand->rest_ns = *param_u32(params, PARAM_GI_REFINE) > 1 ? HAND_REST_NS : 0;
}
