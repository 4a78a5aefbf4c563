#include "renderer/gi/surface.h"

#include "base/result.h"
#include "renderer/scene/texel.h"

#include <stdlib.h>

struct surface_lookup {
	const struct scene *scene;
	uint32_t *material; /* per triangle */
	struct texel_curve curve;
};

int surface_lookup_create(struct surface_lookup **out, const struct scene *scene)
{
	struct surface_lookup *lookup = calloc(1, sizeof *lookup);
	size_t triangles = scene->index_count / 3;

	*out = NULL;
	if (!lookup)
		return GR_ERR_NOMEM;
	lookup->scene = scene;
	texel_curve_init(&lookup->curve);
	lookup->material = calloc(triangles ? triangles : 1, sizeof *lookup->material);
	if (!lookup->material) {
		free(lookup);
		return GR_ERR_NOMEM;
	}
	for (size_t d = 0; d < scene->draw_count; d++) {
		const struct scene_draw *draw = &scene->draws[d];

		for (uint32_t i = 0; i < draw->index_count / 3; i++)
			lookup->material[draw->first_index / 3 + i] = draw->material;
	}
	*out = lookup;
	return GR_OK;
}

void surface_lookup_destroy(struct surface_lookup **lookup)
{
	if (!*lookup)
		return;
	free((*lookup)->material);
	free(*lookup);
	*lookup = NULL;
}

static void texture_at(const struct surface_lookup *lookup, const struct scene_material *material,
		       const struct ray_hit *hit, float albedo[3])
{
	const struct scene *scene = lookup->scene;
	const uint32_t *t = scene->indices + 3 * (size_t)hit->triangle;
	float uv[2], texel[3];

	if (material->diffuse_image < 0 || (size_t)material->diffuse_image >= scene->image_count)
		return;
	for (int i = 0; i < 2; i++)
		uv[i] = (1 - hit->u - hit->v) * scene->vertices[t[0]].uv[i] +
			hit->u * scene->vertices[t[1]].uv[i] +
			hit->v * scene->vertices[t[2]].uv[i];
	texel_at(&lookup->curve, &scene->images[material->diffuse_image], uv, texel);
	for (int c = 0; c < 3; c++)
		albedo[c] *= texel[c];
}

void surface_at(const struct surface_lookup *lookup, const struct ray_hit *hit,
		const float direction[3], const float albedo_override[3],
		struct surface_point *out)
{
	const struct scene_material *material =
		&lookup->scene->materials[lookup->material[hit->triangle]];
	float toward = 0;
	float sign;

	for (int i = 0; i < 3; i++)
		toward += hit->normal[i] * direction[i];
	sign = toward > 0 ? -1.0f : 1.0f;
	for (int i = 0; i < 3; i++)
		out->facing[i] = sign * hit->normal[i];
	out->back = toward > 0 && !material->two_sided;
	for (int c = 0; c < 3; c++)
		out->albedo[c] = out->back ? 0.0f : material->diffuse[c];
	if (out->back)
		return;
	texture_at(lookup, material, hit, out->albedo);
	for (int c = 0; c < 3; c++)
		if (albedo_override[c] >= 0)
			out->albedo[c] = albedo_override[c];
}
