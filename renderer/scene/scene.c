#include "renderer/scene/scene.h"

#include "renderer/scene/brdf_table.h"
#include "renderer/scene/environment.h"

#include <stdlib.h>

void scene_destroy(struct scene **scene)
{
	struct scene *s = *scene;

	if (!s)
		return;
	for (size_t i = 0; i < s->image_count; i++) {
		free(s->images[i].name);
		free(s->images[i].rgba);
	}
	for (size_t i = 0; i < s->table_count; i++)
		brdf_table_destroy(&s->tables[i]);
	environment_destroy(&s->environment);
	free(s->tables);
	free(s->images);
	free(s->materials);
	free(s->draws);
	free(s->indices);
	free(s->vertices);
	free(s);
	*scene = NULL;
}

void scene_note_emission(struct scene *scene)
{
	scene->emissive = false;
	for (size_t i = 0; i < scene->draw_count; i++) {
		const float *e = scene->materials[scene->draws[i].material].emission;

		scene->emissive = scene->emissive || e[0] > 0.0f || e[1] > 0.0f || e[2] > 0.0f;
	}
}
