/*
 * What a film belongs to. Fields one by one: structures have gaps, and names
 * and lines of files do not matter to light.
 */
#include "renderer/scene/brdf_table.h"
#include "renderer/scene/environment.h"
#include "renderer/trace/reference_private.h"

#include <sodium.h>

typedef crypto_generichash_state hash_state;

static void add(hash_state *state, const void *bytes, size_t len)
{
	crypto_generichash_update(state, bytes, len);
}

static void add_number(hash_state *state, uint64_t n)
{
	add(state, &n, sizeof n);
}

static void add_floats(hash_state *state, const float *values, size_t count)
{
	add(state, values, count * sizeof *values);
}

static void add_materials(hash_state *state, const struct scene *scene)
{
	for (size_t i = 0; i < scene->material_count; i++) {
		const struct scene_material *m = &scene->materials[i];
		const int numbers[] = { (int)m->kind, m->table, m->diffuse_image, m->tinted_specular,
					m->emission_image, m->two_sided };

		add(state, numbers, sizeof numbers);
		add_floats(state, m->diffuse, 3);
		add_floats(state, m->specular, 3);
		add_floats(state, m->emission, 3);
		add_floats(state, &m->shininess, 1);
		add_floats(state, &m->alpha, 1);
	}
	for (size_t i = 0; i < scene->image_count; i++) {
		const struct scene_image *image = &scene->images[i];
		const int numbers[] = { image->width, image->height, image->srgb };

		add(state, numbers, sizeof numbers);
		add(state, image->rgba, (size_t)image->width * (size_t)image->height * 4);
	}
	for (size_t i = 0; i < scene->table_count; i++) {
		uint8_t hash[32];

		brdf_table_hash(scene->tables[i], hash);
		add(state, hash, sizeof hash);
	}
}

static void add_scene(hash_state *state, const struct scene *scene)
{
	add_number(state, scene->vertex_count);
	for (size_t i = 0; i < scene->vertex_count; i++) {
		add_floats(state, scene->vertices[i].position, 3);
		add_floats(state, scene->vertices[i].normal, 3);
		add_floats(state, scene->vertices[i].uv, 2);
	}
	add_number(state, scene->index_count);
	add(state, scene->indices, scene->index_count * sizeof *scene->indices);
	for (size_t i = 0; i < scene->draw_count; i++) {
		const struct scene_draw *draw = &scene->draws[i];
		const uint32_t numbers[] = { draw->first_index, draw->index_count, draw->material };

		add(state, numbers, sizeof numbers);
	}
	add_materials(state, scene);
	add_number(state, scene->environment != NULL);
	if (scene->environment) {
		uint8_t hash[32];

		environment_hash(scene->environment, hash);
		add(state, hash, sizeof hash);
	}
}

static void add_lamps(hash_state *state, const struct reference *reference)
{
	add_number(state, reference->file.lamp_count);
	for (size_t i = 0; i < reference->file.lamp_count; i++) {
		const struct scene_lamp *file = &reference->lamps[i];
		const struct frame_lamp *lamp = &reference->frame.lamps[i];

		add_number(state, (uint64_t)file->kind);
		add_number(state, lamp->on);
		add_floats(state, lamp->position, 3);
		add_floats(state, lamp->direction, 3);
		add_floats(state, lamp->intensity, 3);
		add_floats(state, &file->cone_rad, 1);
		add_floats(state, &file->penumbra_rad, 1);
		add_floats(state, &file->radius_m, 1);
		add_floats(state, &file->angle_rad, 1);
	}
}

void reference_hash(const struct reference *reference, uint8_t out[32])
{
	const struct path_scene *scene = &reference->scene;
	const float medium[] = { scene->medium.extinction, scene->medium.albedo,
				 scene->background.x, scene->background.y, scene->background.z };
	hash_state state;

	crypto_generichash_init(&state, NULL, 0, 32);
	add_scene(&state, scene->world.scene);
	add_lamps(&state, reference);
	add_floats(&state, medium, sizeof medium / sizeof medium[0]);
	crypto_generichash_final(&state, out, 32);
}

void reference_key(const struct reference *reference, const struct reference_view *view,
		   const struct reference_params *params, uint8_t out[32])
{
	const uint64_t numbers[] = { params->seed, (uint64_t)params->max_bounces, params->soft_lamps,
				     (uint64_t)view->width, (uint64_t)view->height, SAMPLER_SET };
	hash_state state;

	crypto_generichash_init(&state, NULL, 0, 32);
	add(&state, reference->hash, sizeof reference->hash);
	add(&state, numbers, sizeof numbers);
	add_floats(&state, view->eye, 3);
	add_floats(&state, view->corner, 3);
	add_floats(&state, view->right, 3);
	add_floats(&state, view->down, 3);
	crypto_generichash_final(&state, out, 32);
}
