#include "renderer/view/emissive.h"

#include "base/result.h"
#include "renderer/view/maps.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FACES 5
/* Sixteen patches of five faces: a quarter of a lamp's resolution is plenty for a soft edge. */
#define MOST_PIXELS 256
#define MARGIN_TEXELS 9
/* What is nearer to the surface than so many least lengths throws no shadow: the lamp's own frame. */
#define PATCH_NEAR 2

struct emissive_stage {
	const struct gl_mesh *mesh;
	struct rsm *rsm;
	int first_layer;
	struct emissive_patches patches;
	struct depth_maps maps;
	unsigned buffer;
	float min[3], max[3];
	double least_m; /* map_least_length */
	bool depth_old, rsm_old;
};

struct patch_block {
	int32_t count[4];
	float map[4]; /* half width at distance 1; pixels; near, lift: metres */
	struct patch_record patches[PATCHES_MAX];
};

int emissive_layers(const struct emissive_patches *patches)
{
	return FACES * patches->group_count;
}

static float length3(const float v[3])
{
	return sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double map_half(int pixels, int margin)
{
	return (double)pixels / (pixels - 2 * margin);
}

/* Farthest corner of the scene's bounds. */
static double far_of(const struct emissive_stage *stage, const float origin[3])
{
	double sum = 0;

	for (int i = 0; i < 3; i++) {
		double a = fabs((double)stage->min[i] - (double)origin[i]);
		double b = fabs((double)stage->max[i] - (double)origin[i]);

		sum += fmax(a, b) * fmax(a, b);
	}
	return sqrt(sum) * 1.001 + 2 * PATCH_NEAR * stage->least_m;
}

static void fill_block(const struct emissive_stage *stage, struct patch_block *block)
{
	const struct emissive_patches *patches = &stage->patches;

	memset(block, 0, sizeof(*block));
	block->count[0] = patches->count;
	block->map[0] = (float)map_half(stage->maps.pixels, MARGIN_TEXELS);
	block->map[1] = (float)stage->maps.pixels;
	block->map[2] = (float)(PATCH_NEAR * stage->least_m);
	block->map[3] = (float)stage->least_m;
	for (int i = 0; i < patches->count; i++) {
		const struct emissive_patch *p = &patches->patches[i];
		struct patch_record *r = &block->patches[i];

		memcpy(r->centre, p->centre, sizeof(p->centre));
		memcpy(r->u, p->u, sizeof(p->u));
		memcpy(r->v, p->v, sizeof(p->v));
		memcpy(r->normal, p->normal, sizeof(p->normal));
		memcpy(r->origin, p->origin, sizeof(p->origin));
		memcpy(r->radiance, p->radiance, sizeof(p->radiance));
		r->centre[3] = fmaxf(length3(p->u), length3(p->v));
		r->origin[3] = (float)far_of(stage, p->origin);
		r->u[3] = 1 / length3(p->u);
		r->v[3] = 1 / length3(p->v);
		r->maps[0] = FACES * i;
	}
}

int emissive_create(struct emissive_stage **out, const struct emissive_patches *patches,
		    const struct scene *scene, const struct gl_mesh *mesh, int shadow_pixels,
		    struct rsm *rsm, int first_layer)
{
	struct emissive_stage *stage = calloc(1, sizeof(*stage));
	struct patch_block block;
	int pixels = shadow_pixels < MOST_PIXELS ? shadow_pixels : MOST_PIXELS;
	int result;

	*out = NULL;
	if (!stage)
		return GR_ERR_NOMEM;
	stage->mesh = mesh;
	stage->rsm = rsm;
	stage->first_layer = first_layer;
	stage->patches = *patches;
	stage->depth_old = true;
	stage->rsm_old = rsm != NULL;
	memcpy(stage->min, scene->min, sizeof(stage->min));
	memcpy(stage->max, scene->max, sizeof(stage->max));
	stage->least_m = map_least_length(scene->min, scene->max);
	result = depth_maps_init(&stage->maps, pixels, FACES * patches->count);
	if (result != GR_OK) {
		emissive_destroy(&stage);
		return result;
	}
	fill_block(stage, &block);
	glCreateBuffers(1, &stage->buffer);
	glNamedBufferStorage(stage->buffer, sizeof(block), &block, 0);
	*out = stage;
	return GR_OK;
}

void emissive_destroy(struct emissive_stage **stage)
{
	struct emissive_stage *s = *stage;

	if (!s)
		return;
	glDeleteBuffers(1, &s->buffer);
	depth_maps_finish(&s->maps);
	free(s);
	*stage = NULL;
}

bool emissive_wants(const struct emissive_stage *stage, bool medium_changed)
{
	return stage->depth_old || stage->rsm_old || (stage->rsm && medium_changed);
}

/* Face 0 along the frame's normal, then +u -u +v -v. */
static void face_view(const struct emissive_stage *stage, const struct map_basis *frame,
		      const float origin[3], int face, int pixels, int margin,
		      struct rsm_view *view)
{
	static const int cube_face[FACES] = { 4, 0, 1, 2, 3 };
	struct map_basis basis;

	map_basis_face(frame, cube_face[face], &basis);
	for (int i = 0; i < 3; i++) {
		view->origin[i] = origin[i];
		view->axis[i] = (float)-basis.back[i];
	}
	map_layer_perspective(&view->layer, &basis, origin,
			      map_half(pixels, margin), PATCH_NEAR * stage->least_m,
			      far_of(stage, origin), stage->least_m, pixels);
}

static void patch_frame(const struct emissive_patch *patch, struct map_basis *frame)
{
	double u = (double)length3(patch->u), v = (double)length3(patch->v);

	for (int i = 0; i < 3; i++) {
		frame->right[i] = (double)patch->u[i] / u;
		frame->up[i] = (double)patch->v[i] / v;
		frame->back[i] = (double)patch->normal[i];
	}
}

static void draw_depth(struct emissive_stage *stage)
{
	for (int i = 0; i < stage->patches.count; i++) {
		const struct emissive_patch *patch = &stage->patches.patches[i];
		struct map_basis frame;

		patch_frame(patch, &frame);
		for (int face = 0; face < FACES; face++) {
			struct rsm_view view;

			face_view(stage, &frame, patch->origin, face, stage->maps.pixels,
				  MARGIN_TEXELS, &view);
			depth_maps_draw(&stage->maps, FACES * i + face, &view.layer, stage->mesh);
		}
	}
}

static void draw_rsm(struct emissive_stage *stage)
{
	for (int g = 0; g < stage->patches.group_count; g++) {
		const struct emissive_group *group = &stage->patches.groups[g];
		const float against[3] = { -group->normal[0], -group->normal[1],
					   -group->normal[2] };
		struct map_basis frame;

		map_basis_look(against, &frame); /* so that back is the normal */
		for (int face = 0; face < FACES; face++) {
			struct rsm_view view;

			face_view(stage, &frame, group->origin, face, rsm_pixels(stage->rsm), 0,
				  &view);
			rsm_draw_patches(stage->rsm, stage->first_layer + FACES * g + face, &view,
					 group->first, group->count, stage->mesh);
		}
	}
}

void emissive_draw(struct emissive_stage *stage)
{
	glBindBufferBase(GL_UNIFORM_BUFFER, VIEW_BINDING_PATCHES, stage->buffer);
	if (stage->depth_old)
		draw_depth(stage);
	if (stage->rsm)
		draw_rsm(stage);
	stage->depth_old = false;
	stage->rsm_old = false;
}

void emissive_bind(const struct emissive_stage *stage)
{
	glBindBufferBase(GL_UNIFORM_BUFFER, VIEW_BINDING_PATCHES, stage->buffer);
	glBindTextureUnit(VIEW_UNIT_PATCH_DEPTH, stage->maps.texture);
	glBindSampler(VIEW_UNIT_PATCH_DEPTH, 0);
}

int emissive_pixels(const struct emissive_stage *stage)
{
	return stage->maps.pixels;
}
