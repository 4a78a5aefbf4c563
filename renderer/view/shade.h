/*
 * Radiance of an eye's picture: direct light of lamps and emissive surfaces
 * with their shadows, indirect light of the global illumination, emission
 * (seed 004 sections 3.3.3 and 3.3.4, listing 5.4). In W/(m^2 sr), 32 bit
 * float, nothing clamped.
 *
 * GL thread only.
 */
#ifndef GROTTO_RENDERER_VIEW_SHADE_H
#define GROTTO_RENDERER_VIEW_SHADE_H

#include "renderer/gi/gi.h"
#include "renderer/view/backdrop.h"
#include "renderer/view/emissive.h"
#include "renderer/view/gbuffer.h"
#include "renderer/view/shadow.h"

struct shade_parts {
	const struct shadow_stage *shadow;     /* NULL: the scene has none; as the others */
	const struct emissive_stage *emissive;
	const struct gi_method *gi;
	const struct backdrop *backdrop; /* never NULL */
};

/* What is kept of one eye. */
struct shade_picture {
	unsigned radiance, indirect; /* RGBA32F; indirect 0 unless kept */
	unsigned framebuffer, empty_vao;
	int width, height;
};

int shade_picture_init(struct shade_picture *picture, int width, int height, bool keep_indirect);
void shade_picture_finish(struct shade_picture *picture);
int shade_program(unsigned *out_program, const struct shade_parts *parts, bool keep_indirect);
/*
 * view_projection and eye as the G-buffer was drawn; indirect: false leaves the
 * global illumination out of this frame.
 */
void shade_draw(const struct shade_picture *picture, unsigned program,
		const struct shade_parts *parts, const struct gbuffer *gbuffer,
		const mat4 view_projection, const float eye[3], bool indirect);

#endif
