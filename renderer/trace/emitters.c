#include "renderer/trace/emitters.h"

#include "base/result.h"

#include <stdlib.h>
#include <string.h>

/* Points of a triangle whose mean emission stands for its texture. */
#define TEXTURE_POINTS 16

static double area_of(const struct world *world, unsigned triangle)
{
	double e[2][3], n[3];
	struct v3 a = world_corner(world, triangle, 0);

	for (int k = 0; k < 2; k++) {
		struct v3 b = world_corner(world, triangle, k + 1);

		e[k][0] = (double)b.x - (double)a.x;
		e[k][1] = (double)b.y - (double)a.y;
		e[k][2] = (double)b.z - (double)a.z;
	}
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		n[i] = e[0][j] * e[1][k] - e[0][k] * e[1][j];
	}
	return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static void triangle_point(const float u[2], float out[2])
{
	float root = sqrtf(u[0]);

	out[0] = (1.0f - root);
	out[1] = root * u[1];
}

static double mean_emission(const struct world *world, unsigned triangle)
{
	double sum = 0.0;

	for (int i = 0; i < TEXTURE_POINTS; i++) {
		float u[2] = { ((float)(i / 4) + 0.5f) / 4.0f, ((float)(i % 4) + 0.5f) / 4.0f };
		float at[2];

		triangle_point(u, at);
		sum += (double)v3_mean(world_emission(world, triangle, at[0], at[1]));
	}
	return sum / TEXTURE_POINTS;
}

/* Vose 1991: slots below the mean are filled up by those above. */
static int build_alias(struct emitters *out, const double *power, double total)
{
	size_t count = out->count, small = 0, large = count;
	double *left = malloc(count * sizeof *left);
	unsigned *order = malloc(count * sizeof *order);

	if (!left || !order) {
		free(left);
		free(order);
		return GR_ERR_NOMEM;
	}
	for (size_t i = 0; i < count; i++) {
		left[i] = power[i] / total * (double)count;
		order[left[i] < 1.0 ? small++ : --large] = (unsigned)i;
		out->emitters[i].share = 1.0f;
		out->emitters[i].alias = (unsigned)i;
	}
	for (size_t next = 0; next < small && small < count;) {
		unsigned low = order[next++], high = order[small];

		out->emitters[low].share = (float)left[low];
		out->emitters[low].alias = high;
		left[high] -= 1.0 - left[low];
		if (left[high] < 1.0)
			small++;
	}
	free(left);
	free(order);
	return GR_OK;
}

static void fill(struct emitter *e, const struct world *world, unsigned triangle)
{
	const struct scene_material *m = world_material(world, triangle);
	struct v3 b = world_corner(world, triangle, 1), c = world_corner(world, triangle, 2);
	float scale;

	e->triangle = triangle;
	e->two_sided = m->two_sided;
	e->textured = m->emission_image >= 0;
	e->radiance = v3_of(m->emission);
	e->corner = world_corner(world, triangle, 0);
	e->ab = v3_sub(b, e->corner);
	e->ac = v3_sub(c, e->corner);
	e->lift = world_lift(e->corner, b, c);
	/* small edges would leave float's range when multiplied */
	scale = 1.0f / larger_of(v3_widest(e->ab), v3_widest(e->ac));
	e->normal = v3_unit(v3_cross(v3_scale(e->ab, scale), v3_scale(e->ac, scale)));
}

static int measure(struct emitters *out, const struct world *world, double *power)
{
	size_t triangles = world->scene->index_count / 3;
	double total = 0.0;
	size_t n = 0;
	int result;

	for (size_t t = 0; t < triangles; t++) {
		if (v3_black(v3_of(world_material(world, (unsigned)t)->emission)))
			continue;
		power[n] = area_of(world, (unsigned)t) * mean_emission(world, (unsigned)t);
		if (!(power[n] > 0.0) || !isfinite(power[n]))
			continue;
		fill(&out->emitters[n], world, (unsigned)t);
		total += power[n++];
	}
	out->count = n;
	if (n == 0 || !isfinite(total)) {
		out->count = 0;
		return GR_OK;
	}
	out->density = calloc(triangles, sizeof *out->density);
	if (!out->density)
		return GR_ERR_NOMEM;
	result = build_alias(out, power, total);
	for (size_t i = 0; i < n; i++) {
		unsigned t = out->emitters[i].triangle;

		out->density[t] = (float)(power[i] / total / area_of(world, t));
	}
	return result;
}

int emitters_init(struct emitters *out, const struct world *world)
{
	size_t triangles = world->scene->index_count / 3, emissive = 0;
	double *power;
	int result;

	memset(out, 0, sizeof *out);
	for (size_t t = 0; t < triangles; t++) {
		const struct v3 emission = v3_of(world_material(world, (unsigned)t)->emission);

		/* v3_black of a NaN is as may be: it must not pass for dark */
		if (!isfinite(emission.x) || !isfinite(emission.y) || !isfinite(emission.z))
			return GR_ERR_RANGE;
		emissive += !v3_black(emission);
	}
	if (emissive == 0)
		return GR_OK;
	power = malloc(emissive * sizeof *power);
	out->emitters = calloc(emissive, sizeof *out->emitters);
	result = power && out->emitters ? measure(out, world, power) : GR_ERR_NOMEM;
	free(power);
	if (result != GR_OK)
		emitters_finish(out);
	return result;
}

void emitters_finish(struct emitters *emitters)
{
	free(emitters->emitters);
	free(emitters->density);
	memset(emitters, 0, sizeof *emitters);
}

static const struct emitter *draw(const struct emitters *emitters, float choose)
{
	double place = (double)choose * (double)emitters->count;
	size_t slot = (size_t)place;
	const struct emitter *e = &emitters->emitters[slot];

	return place - (double)slot < (double)e->share ? e : &emitters->emitters[e->alias];
}

bool emitters_sample(const struct emitters *emitters, const struct world *world, struct v3 from,
		     float choose, const float u[2], struct emitter_light *out)
{
	const struct emitter *e = draw(emitters, choose);
	struct v3 point, to;
	float at[2], cosine;

	triangle_point(u, at);
	point = v3_ahead(v3_ahead(e->corner, e->ab, at[0]), e->ac, at[1]);
	to = v3_sub(point, from);
	out->distance = v3_length(to);
	if (!(out->distance > 0.0f))
		return false;
	out->direction = v3_scale(to, 1.0f / out->distance);
	cosine = -v3_dot(e->normal, out->direction);
	if (cosine == 0.0f || (cosine < 0.0f && !e->two_sided))
		return false;
	out->target = v3_ahead(point, e->normal, cosine > 0.0f ? e->lift : -e->lift);
	out->radiance = e->textured ? world_emission(world, e->triangle, at[0], at[1]) : e->radiance;
	out->pdf = emitters_pdf(emitters, e->triangle, out->distance, fabsf(cosine));
	return out->pdf > 0.0f && isfinite(out->pdf);
}
