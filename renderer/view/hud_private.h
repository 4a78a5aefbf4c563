/* Between hud_parts.c (symbols) and hud_bars.c (letters and bars). Metres at scale 1, in the wand's frame. */
#ifndef GROTTO_RENDERER_VIEW_HUD_PRIVATE_H
#define GROTTO_RENDERER_VIEW_HUD_PRIVATE_H

#include "renderer/view/hud_parts.h"

#define HUD_GREY { 0.55f, 0.55f, 0.55f, 1 }
#define HUD_DARK { 0.3f, 0.3f, 0.3f, 1 }
#define HUD_WHITE { 1, 1, 1, 1 }

struct hud_list {
	struct hud_part *parts;
	size_t count;
	mat4 T_room_wand; /* with the HUD's scale */
};

/* What does not fit is left out: HUD_PARTS_MOST is enough for all. */
void hud_add(struct hud_list *list, enum hud_shape shape, mat4 T_wand_part, const vec4 color);
/* A box in the plane, its middle at x and y. */
void hud_add_box(struct hud_list *list, float x, float y, const vec3 size, const vec4 color);
/* The lamp's colour, as bright as the display has it; dim when it is off. */
void hud_torch_color(const struct hud_view *view, vec4 out);
/* The bars of the layout in use. */
void hud_add_bars(struct hud_list *list, const struct hud_view *view);

#endif
