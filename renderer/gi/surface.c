#include "renderer/gi/surface.h"

#include "base/result.h"

#include <math.h>
#include <stdlib.h>

struct surface_lookup {
	const struct scene *scene;
	uint32_t *material; /* per triangle */
};

int surface_lookup_create(struct surface_lookup **out, const struct scene *scene)
{
	struct surface_lookup *lookup = calloc(1, sizeof *lookup);
	size_t triangles = scene->index_count / 3;

	*out = NULL;
	if (!lookup)
		return GR_ERR_NOMEM;
	lookup->scene = scene;
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

static float srgb_to_linear(float v)
{
	return v <= 0.04045f ? v / 12.92f : powf((v + 0.055f) / 1.055f, 2.4f);
}

/* Nearest texel, repeating. */
static void image_sample(const struct scene_image *image, const float uv[2], float out[3])
{
	int at[2];
	int size[2] = { image->width, image->height };
	const uint8_t *texel;

	for (int i = 0; i < 2; i++) {
		float t = uv[i] - floorf(uv[i]);

		at[i] = isfinite(t) ? (int)(t * (float)size[i]) : 0;
		if (at[i] >= size[i])
			at[i] = size[i] - 1;
	}
	texel = image->rgba + 4 * ((size_t)at[0] + (size_t)at[1] * (size_t)size[0]);
	for (int c = 0; c < 3; c++) {
		float v = (float)texel[c] / 255.0f;

		out[c] = image->srgb ? srgb_to_linear(v) : v;
	}
}

static void texture_at(const struct scene *scene, const struct scene_material *material,
		       const struct ray_hit *hit, float albedo[3])
{
	const uint32_t *t = scene->indices + 3 * (size_t)hit->triangle;
	float uv[2], texel[3];

	if (material->diffuse_image < 0 || (size_t)material->diffuse_image >= scene->image_count)
		return;
	for (int i = 0; i < 2; i++)
		uv[i] = (1 - hit->u - hit->v) * scene->vertices[t[0]].uv[i] +
			hit->u * scene->vertices[t[1]].uv[i] +
			hit->v * scene->vertices[t[2]].uv[i];
	image_sample(&scene->images[material->diffuse_image], uv, texel);
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
	texture_at(lookup->scene, material, hit, out->albedo);
	for (int c = 0; c < 3; c++)
		if (albedo_override[c] >= 0)
			out->albedo[c] = albedo_override[c];
}
