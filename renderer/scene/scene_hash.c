/* What two machines compare, so that they never draw one room from different files. */
#include "renderer/scene/brdf_table.h"
#include "renderer/scene/environment.h"
#include "renderer/scene/scene.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

static void hash_u64(crypto_generichash_state *state, uint64_t value)
{
	uint8_t bytes[8];

	for (int i = 0; i < 8; i++)
		bytes[i] = (uint8_t)(value >> (8 * i));
	crypto_generichash_update(state, bytes, sizeof bytes);
}

static void hash_bytes(crypto_generichash_state *state, const void *bytes, size_t len)
{
	hash_u64(state, len);
	if (len)
		crypto_generichash_update(state, bytes, len);
}

static void hash_material(crypto_generichash_state *state, const struct scene_material *m)
{
	hash_u64(state, m->kind);
	hash_bytes(state, &m->alpha, sizeof m->alpha);
	hash_u64(state, (uint64_t)(int64_t)m->table);
	hash_bytes(state, m->diffuse, sizeof m->diffuse);
	hash_bytes(state, m->specular, sizeof m->specular);
	hash_bytes(state, &m->shininess, sizeof m->shininess);
	hash_bytes(state, m->emission, sizeof m->emission);
	hash_u64(state, (uint64_t)(int64_t)m->diffuse_image);
	hash_u64(state, (uint64_t)(int64_t)m->emission_image);
	hash_u64(state, (uint64_t)m->two_sided | (uint64_t)m->tinted_specular << 1);
}

static void hash_parts(crypto_generichash_state *state, const struct scene *scene)
{
	uint8_t part[32];

	hash_u64(state, scene->table_count);
	for (size_t i = 0; i < scene->table_count; i++) {
		brdf_table_hash(scene->tables[i], part);
		hash_bytes(state, part, sizeof part);
	}
	hash_u64(state, scene->environment != NULL);
	if (scene->environment) {
		environment_hash(scene->environment, part);
		hash_bytes(state, part, sizeof part);
	}
}

/* Field by field: structs have padding, and names and paths are no content. */
void scene_hash(struct scene *scene)
{
	crypto_generichash_state state;

	crypto_generichash_init(&state, NULL, 0, sizeof scene->hash);
	hash_bytes(&state, scene->vertices, scene->vertex_count * sizeof scene->vertices[0]);
	hash_bytes(&state, scene->indices, scene->index_count * sizeof scene->indices[0]);
	hash_u64(&state, scene->draw_count);
	for (size_t i = 0; i < scene->draw_count; i++) {
		hash_u64(&state, scene->draws[i].first_index);
		hash_u64(&state, scene->draws[i].index_count);
		hash_u64(&state, scene->draws[i].material);
	}
	hash_u64(&state, scene->material_count);
	for (size_t i = 0; i < scene->material_count; i++)
		hash_material(&state, &scene->materials[i]);
	hash_u64(&state, scene->image_count);
	for (size_t i = 0; i < scene->image_count; i++) {
		const struct scene_image *image = &scene->images[i];

		hash_u64(&state, (uint64_t)image->width << 1 | image->srgb);
		hash_bytes(&state, image->rgba, (size_t)image->width * (size_t)image->height * 4);
	}
	hash_parts(&state, scene);
	crypto_generichash_final(&state, scene->hash, sizeof scene->hash);
}

void scene_content_hash(const struct scene_file *file, const struct scene *scene,
			uint8_t out[32])
{
	crypto_generichash_state state;

	crypto_generichash_init(&state, NULL, 0, 32);
	crypto_generichash_update(&state, file->hash, sizeof file->hash);
	crypto_generichash_update(&state, scene->hash, sizeof scene->hash);
	crypto_generichash_final(&state, out, 32);
}

static struct gr_item *add_item(struct gr_item *item, const char *name, const uint8_t hash[32])
{
	snprintf(item->name, sizeof item->name, "%s", name);
	memcpy(item->digest, hash, sizeof item->digest);
	return item + 1;
}

size_t scene_content_items(const struct scene_file *file, const struct scene *scene,
			   struct gr_item items[SCENE_ITEMS_MAX])
{
	struct gr_item *end = items;
	uint8_t hash[32] = { 0 };
	crypto_generichash_state state;

	end += scene_file_items(file, items, SCENE_FILE_ITEMS_MAX, hash);
	crypto_generichash_init(&state, NULL, 0, sizeof hash);
	for (size_t i = 0; i < scene->table_count; i++) {
		brdf_table_hash(scene->tables[i], hash);
		hash_bytes(&state, hash, sizeof hash);
	}
	crypto_generichash_final(&state, hash, sizeof hash);
	end = add_item(end, "a file of its materials", hash);
	memset(hash, 0, sizeof hash);
	if (scene->environment)
		environment_hash(scene->environment, hash);
	end = add_item(end, "the file of its environment", hash);
	/* Of all of these together, so the model's own when they are alike. */
	end = add_item(end, "its model", scene->hash);
	return (size_t)(end - items);
}
