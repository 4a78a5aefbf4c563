/*
 * The Cornell box by its published measurements (Cornell Program of Computer
 * Graphics), millimetres times 0.01, and a scene built of quadrilaterals, so
 * that the light can be tested without a model file.
 */
#ifndef GROTTO_TESTS_CORNELL_H
#define GROTTO_TESTS_CORNELL_H

#include "renderer/scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CORNELL_WHITE, CORNELL_RED, CORNELL_GREEN, CORNELL_LIGHT, CORNELL_MATERIALS };

struct quad {
	int material;
	float at[4][3]; /* counter-clockwise seen from the front */
};

static const struct quad cornell_quads[] __attribute__((unused)) = {
	/* floor */
	{ CORNELL_WHITE,
	  { { 5.528f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f },
	    { 0.0f, 0.0f, 5.592f }, { 5.496f, 0.0f, 5.592f } } },
	/* ceiling */
	{ CORNELL_WHITE,
	  { { 5.56f, 5.488f, 0.0f }, { 5.56f, 5.488f, 2.27f },
	    { 0.0f, 5.488f, 2.27f }, { 0.0f, 5.488f, 0.0f } } },
	{ CORNELL_WHITE,
	  { { 5.56f, 5.488f, 3.32f }, { 5.56f, 5.488f, 5.592f },
	    { 0.0f, 5.488f, 5.592f }, { 0.0f, 5.488f, 3.32f } } },
	{ CORNELL_WHITE,
	  { { 5.56f, 5.488f, 2.27f }, { 5.56f, 5.488f, 3.32f },
	    { 3.43f, 5.488f, 3.32f }, { 3.43f, 5.488f, 2.27f } } },
	{ CORNELL_WHITE,
	  { { 2.13f, 5.488f, 2.27f }, { 2.13f, 5.488f, 3.32f },
	    { 0.0f, 5.488f, 3.32f }, { 0.0f, 5.488f, 2.27f } } },
	/* emitter */
	{ CORNELL_LIGHT,
	  { { 3.43f, 5.488f, 2.27f }, { 3.43f, 5.488f, 3.32f },
	    { 2.13f, 5.488f, 3.32f }, { 2.13f, 5.488f, 2.27f } } },
	/* back_wall */
	{ CORNELL_WHITE,
	  { { 5.496f, 0.0f, 5.592f }, { 0.0f, 0.0f, 5.592f },
	    { 0.0f, 5.488f, 5.592f }, { 5.56f, 5.488f, 5.592f } } },
	/* right_wall */
	{ CORNELL_GREEN,
	  { { 0.0f, 0.0f, 5.592f }, { 0.0f, 0.0f, 0.0f },
	    { 0.0f, 5.488f, 0.0f }, { 0.0f, 5.488f, 5.592f } } },
	/* left_wall */
	{ CORNELL_RED,
	  { { 5.528f, 0.0f, 0.0f }, { 5.496f, 0.0f, 5.592f },
	    { 5.56f, 5.488f, 5.592f }, { 5.56f, 5.488f, 0.0f } } },
	/* short_block */
	{ CORNELL_WHITE,
	  { { 1.3f, 1.65f, 0.65f }, { 0.82f, 1.65f, 2.25f },
	    { 2.4f, 1.65f, 2.72f }, { 2.9f, 1.65f, 1.14f } } },
	{ CORNELL_WHITE,
	  { { 0.82f, 0.0f, 2.25f }, { 0.82f, 1.65f, 2.25f },
	    { 1.3f, 1.65f, 0.65f }, { 1.3f, 0.0f, 0.65f } } },
	{ CORNELL_WHITE,
	  { { 2.4f, 0.0f, 2.72f }, { 2.4f, 1.65f, 2.72f },
	    { 0.82f, 1.65f, 2.25f }, { 0.82f, 0.0f, 2.25f } } },
	{ CORNELL_WHITE,
	  { { 2.9f, 0.0f, 1.14f }, { 2.9f, 1.65f, 1.14f },
	    { 2.4f, 1.65f, 2.72f }, { 2.4f, 0.0f, 2.72f } } },
	{ CORNELL_WHITE,
	  { { 1.3f, 0.0f, 0.65f }, { 1.3f, 1.65f, 0.65f },
	    { 2.9f, 1.65f, 1.14f }, { 2.9f, 0.0f, 1.14f } } },
	/* tall_block */
	{ CORNELL_WHITE,
	  { { 4.23f, 3.3f, 2.47f }, { 2.65f, 3.3f, 2.96f },
	    { 3.14f, 3.3f, 4.56f }, { 4.72f, 3.3f, 4.06f } } },
	{ CORNELL_WHITE,
	  { { 2.65f, 0.0f, 2.96f }, { 2.65f, 3.3f, 2.96f },
	    { 4.23f, 3.3f, 2.47f }, { 4.23f, 0.0f, 2.47f } } },
	{ CORNELL_WHITE,
	  { { 3.14f, 0.0f, 4.56f }, { 3.14f, 3.3f, 4.56f },
	    { 2.65f, 3.3f, 2.96f }, { 2.65f, 0.0f, 2.96f } } },
	{ CORNELL_WHITE,
	  { { 4.72f, 0.0f, 4.06f }, { 4.72f, 3.3f, 4.06f },
	    { 3.14f, 3.3f, 4.56f }, { 3.14f, 0.0f, 4.56f } } },
	{ CORNELL_WHITE,
	  { { 4.23f, 0.0f, 2.47f }, { 4.23f, 3.3f, 2.47f },
	    { 4.72f, 3.3f, 4.06f }, { 4.72f, 0.0f, 4.06f } } },
};
#define CORNELL_QUADS (sizeof(cornell_quads) / sizeof(cornell_quads[0]))

static const struct scene_material cornell_materials[CORNELL_MATERIALS] __attribute__((unused)) = {
	{ .name = "white", .diffuse = { 0.725f, 0.71f, 0.68f }, .diffuse_image = -1,
	  .emission_image = -1 },
	{ .name = "red", .diffuse = { 0.63f, 0.065f, 0.05f }, .diffuse_image = -1,
	  .emission_image = -1 },
	{ .name = "green", .diffuse = { 0.14f, 0.45f, 0.091f }, .diffuse_image = -1,
	  .emission_image = -1 },
	{ .name = "light", .emission = { 17, 12, 4 }, .diffuse_image = -1, .emission_image = -1 },
};

static inline void quad_normal(const struct quad *q, float n[3])
{
	float a[3], b[3], length;

	for (int i = 0; i < 3; i++) {
		a[i] = q->at[1][i] - q->at[0][i];
		b[i] = q->at[2][i] - q->at[0][i];
	}
	n[0] = a[1] * b[2] - a[2] * b[1];
	n[1] = a[2] * b[0] - a[0] * b[2];
	n[2] = a[0] * b[1] - a[1] * b[0];
	length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	for (int i = 0; i < 3; i++)
		n[i] /= length;
}

static inline void *quads_alloc(size_t count, size_t size)
{
	void *p = calloc(count, size);

	if (!p)
		abort();
	return p;
}

/* Quads must be sorted so that those of one material follow each other. Free with quads_free. */
static inline void quads_scene(struct scene *s, const struct quad *quads, size_t count,
			       const struct scene_material *materials, size_t material_count)
{
	memset(s, 0, sizeof(*s));
	s->vertices = quads_alloc(4 * count, sizeof(*s->vertices));
	s->indices = quads_alloc(6 * count, sizeof(*s->indices));
	s->draws = quads_alloc(count, sizeof(*s->draws));
	s->materials = quads_alloc(material_count, sizeof(*s->materials));
	memcpy(s->materials, materials, material_count * sizeof(*materials));
	s->vertex_count = 4 * count;
	s->index_count = 6 * count;
	s->draw_count = count;
	s->material_count = material_count;
	for (int i = 0; i < 3; i++) {
		s->min[i] = INFINITY;
		s->max[i] = -INFINITY;
	}
	for (size_t q = 0; q < count; q++) {
		static const uint32_t corners[6] = { 0, 1, 2, 0, 2, 3 };
		float n[3];

		quad_normal(&quads[q], n);
		for (size_t k = 0; k < 4; k++) {
			struct scene_vertex *v = &s->vertices[4 * q + k];

			memcpy(v->position, quads[q].at[k], sizeof(v->position));
			memcpy(v->normal, n, sizeof(n));
			for (int i = 0; i < 3; i++) {
				s->min[i] = fminf(s->min[i], v->position[i]);
				s->max[i] = fmaxf(s->max[i], v->position[i]);
			}
		}
		for (size_t k = 0; k < 6; k++)
			s->indices[6 * q + k] = (uint32_t)(4 * q) + corners[k];
		s->draws[q] = (struct scene_draw){ (uint32_t)(6 * q), 6,
						   (uint32_t)quads[q].material };
		for (int i = 0; i < 3; i++)
			s->emissive |= materials[quads[q].material].emission[i] > 0;
	}
}

static inline void quads_free(struct scene *s)
{
	free(s->vertices);
	free(s->indices);
	free(s->draws);
	free(s->materials);
}

/* A scene file without a file: what the tests do not set is as here. */
static inline struct scene_file quads_file(void)
{
	return (struct scene_file){
		.name = "test",
		.model_scale = 1,
		.gi = { .method = SCENE_GI_NONE, .lattice = 32, .steps = 8, .rsm_pixels = 128,
			.link_rays = 16, .albedo_override = { -1, -1, -1 } },
		.tone = { .curve = SCENE_CURVE_REINHARD, .exposure = 1, .adaptation = 100,
			  .luminance_max = 1e4f, .bias = 0.85f, .gamma_display = 2.2f,
			  .gamma_end_to_end = 1.125f },
		.near_m = 0.05f,
		.far_m = 100,
		.shadow_pixels = 1024,
		.room = GR_POSE_IDENTITY,
	};
}

#endif
