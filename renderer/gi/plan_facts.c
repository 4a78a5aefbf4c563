#include "renderer/gi/plan_private.h"

#include "base/result.h"
#include "renderer/gi/surfel_count.h"

#include <math.h>
#include <string.h>

static double area_of(const struct scene *scene, size_t first)
{
	const float *p[3];
	double a[3], b[3], n[3];

	for (size_t c = 0; c < 3; c++)
		p[c] = scene->vertices[scene->indices[first + c]].position;
	for (int i = 0; i < 3; i++) {
		a[i] = (double)p[1][i] - (double)p[0][i];
		b[i] = (double)p[2][i] - (double)p[0][i];
	}
	n[0] = a[1] * b[2] - a[2] * b[1];
	n[1] = a[2] * b[0] - a[0] * b[2];
	n[2] = a[0] * b[1] - a[1] * b[0];
	return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static double sum3(const float v[3])
{
	return (double)v[0] + (double)v[1] + (double)v[2];
}

/* More of what it reflects goes into a mirror's direction, or near it, than all around. */
static bool mirrors(const struct scene_material *m)
{
	return m->kind == MATERIAL_MIRROR || m->kind == MATERIAL_CONDUCTOR ||
	       sum3(m->specular) > sum3(m->diffuse);
}

void gi_facts_take(struct gi_facts *out, const struct scene *scene, const struct scene_file *file)
{
	double mirror = 0;

	*out = (struct gi_facts){
		.triangles = scene->index_count / 3,
		.absorption_per_m = (double)file->absorption_per_m,
		.scattering_per_m = (double)file->scattering_per_m,
		.environment = file->environment.kind != SCENE_ENVIRONMENT_NONE,
	};
	for (int i = 0; i < 3; i++)
		out->size_m[i] = (double)scene->max[i] - (double)scene->min[i];
	for (size_t d = 0; d < scene->draw_count; d++) {
		const struct scene_draw *draw = &scene->draws[d];
		const struct scene_material *m = &scene->materials[draw->material];
		double area = 0;

		for (size_t i = 0; i < draw->index_count; i += 3)
			area += area_of(scene, draw->first_index + i);
		area *= m->two_sided ? 2 : 1;
		out->area_m2 += area;
		mirror += mirrors(m) ? area : 0;
		if (sum3(m->emission) > 0)
			out->emissive_triangles += draw->index_count / 3;
	}
	out->mirror_share = out->area_m2 > 0 ? mirror / out->area_m2 : 0;
	for (size_t i = 0; i < file->lamp_count; i++) {
		if (file->lamps[i].mount == SCENE_MOUNT_FIXED)
			out->lamps_fixed++;
		else
			out->lamps_moving++;
	}
}

/* Surfels that the areas alone would have when they are counted: far enough apart to tell. */
static const double count_flat[2] = { 500, 2000 };

/* Two digits: what another processor's rounding does to a few rays must not choose. */
static double rounded(double v)
{
	double power = v > 0 ? pow(10, floor(log10(v)) - 1) : 1;

	return v > 0 ? round(v / power) * power : 0;
}

/* more[i] = edge / spacing[i] + piece, neither below zero. */
int gi_facts_count(struct gi_facts *facts, const struct scene *scene)
{
	double inverse[2], more[2], edge, piece;

	for (int i = 0; i < 2; i++) {
		double spacing = sqrt(SURFEL_DENSITY * facts->area_m2 / count_flat[i]);
		size_t count;
		int result = GR_ERR_RANGE;

		if (isfinite(spacing) && spacing > 0)
			result = surfel_count(scene, (float)spacing, 0, &count);
		if (result != GR_OK)
			return result;
		inverse[i] = 1 / spacing;
		more[i] = fmax(0, (double)count - count_flat[i]);
	}
	edge = fmax(0, (more[1] - more[0]) / (inverse[1] - inverse[0]));
	edge = fmin(edge, more[1] / inverse[1]);
	piece = more[1] - edge * inverse[1];
	facts->edge_surfels_m = rounded(edge);
	facts->piece_surfels = rounded(piece);
	return GR_OK;
}
