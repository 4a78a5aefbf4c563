#include "renderer/scene/scene.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

void scene_destroy(struct scene **scene)
{
	struct scene *s = *scene;

	if (!s)
		return;
	for (size_t i = 0; i < s->image_count; i++) {
		free(s->images[i].name);
		free(s->images[i].rgba);
	}
	free(s->images);
	free(s->materials);
	free(s->draws);
	free(s->indices);
	free(s->vertices);
	free(s);
	*scene = NULL;
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
