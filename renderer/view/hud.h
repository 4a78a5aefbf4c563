/*
 * Draws the HUD beside the wand over an eye's finished picture: after the
 * tone curve, in the display's own values, so that it is as readable in the
 * dark as in the sun, whatever the exposure. It belongs to the hand and not
 * to the scene: no lamp lights it, it throws no shadow, and the light knows
 * nothing of it.
 *
 * It is always seen. Where the scene is nearer to the eye than the HUD it is
 * drawn faint: a hand that is in a wall still finds its buttons, and where an
 * eye's parallax says "behind" the picture does not say "in front".
 *
 * GL thread only. No allocation after create.
 */
#ifndef GROTTO_RENDERER_VIEW_HUD_H
#define GROTTO_RENDERER_VIEW_HUD_H

#include "renderer/view/gbuffer.h"
#include "renderer/view/hud_parts.h"
#include "renderer/view/projection.h"

struct hud_eye {
	const struct projection_wall *wall; /* room */
	vec3 position, position_scene;
	const struct gbuffer *gbuffer; /* of the scene, from there */
	int x, y; /* lower left corner of its picture in the framebuffer that is bound */
};

struct hud_stage;
int hud_create(struct hud_stage **out);
void hud_destroy(struct hud_stage **stage);
/*
 * What the frame shows; file: what the light is computed by. True when it is not what it
 * showed before. NULL for a frame without a wall: nothing is shown.
 */
bool hud_take(struct hud_stage *stage, const struct render_frame *frame, const struct scene_file *file);
/* Something is to be drawn. */
bool hud_shown(const struct hud_stage *stage);
/* Into the framebuffer that is bound; its viewport is the eye's picture. */
void hud_draw(struct hud_stage *stage, const struct hud_eye *eye);

#endif
