#include "renderer/gi/surfel_set.h"

#include <math.h>
#include <sodium.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static void probes_finish(struct surfel_probes *probes)
{
	free(probes->directions);
	free(probes->links);
	free(probes->fixed);
	free(probes->fixed_way);
	free(probes->distance);
	free(probes->alive);
}

void surfel_set_destroy(struct surfel_set **set)
{
	struct surfel_set *s = *set;

	if (!s)
		return;
	free(s->surfels);
	free(s->area);
	free(s->albedo);
	free(s->fixed_emissive);
	free(s->fixed_other);
	free(s->fixed_way);
	free(s->links);
	free(s->taps);
	free(s->grid.keys);
	free(s->grid.first);
	free(s->grid.members);
	probes_finish(&s->probes);
	free(s);
	*set = NULL;
}

size_t surfel_set_parts(const struct surfel_set *set, struct surfel_part out[SURFEL_PARTS])
{
	const struct surfel_grid *grid = &set->grid;
	const struct surfel_probes *probes = &set->probes;
	size_t slots = grid->slots ? grid->slots
				   : (size_t)grid->size[0] * (size_t)grid->size[1] *
					     (size_t)grid->size[2];
	const struct surfel_part parts[SURFEL_PARTS] = {
		{ set->surfels, set->count * sizeof *set->surfels },
		{ set->area, set->count * sizeof *set->area },
		{ set->albedo, set->count * sizeof *set->albedo },
		{ set->fixed_emissive, set->count * sizeof *set->fixed_emissive },
		{ set->fixed_other, set->count * sizeof *set->fixed_other },
		{ set->links, set->count * set->links_each * sizeof *set->links },
		{ set->taps, set->count * set->taps_each * sizeof *set->taps },
		{ grid->keys, grid->slots * sizeof *grid->keys },
		{ grid->first, (slots + 1) * sizeof *grid->first },
		{ grid->members, grid->member_count * sizeof *grid->members },
		{ probes->directions, probes->count ? probes->links_each * sizeof *probes->directions : 0 },
		{ probes->links, probes->count * probes->links_each * sizeof *probes->links },
		{ probes->fixed, probes->count * sizeof *probes->fixed },
		{ probes->distance, probes->count * sizeof *probes->distance },
		{ probes->alive, probes->count * sizeof *probes->alive },
		{ set->fixed_way, set->count * sizeof *set->fixed_way },
		{ probes->fixed_way, probes->count * sizeof *probes->fixed_way },
	};
	size_t bytes = 0;

	memcpy(out, parts, sizeof parts);
	for (size_t i = 0; i < SURFEL_PARTS; i++)
		bytes += parts[i].bytes;
	return bytes;
}

size_t surfel_set_bytes(const struct surfel_set *set)
{
	struct surfel_part parts[SURFEL_PARTS];

	return surfel_set_parts(set, parts);
}

uint64_t surfel_set_hash(const struct surfel_set *set)
{
	struct surfel_part parts[SURFEL_PARTS];
	crypto_generichash_state state;
	uint8_t digest[16];
	uint64_t hash;
	const float lengths[3] = { set->spacing_m, set->radius_m, set->extinction };
	const uint64_t counts[4] = { set->count, set->links_each, set->taps_each,
				     set->probes.count };

	crypto_generichash_init(&state, NULL, 0, sizeof digest);
	crypto_generichash_update(&state, (const uint8_t *)lengths, sizeof lengths);
	crypto_generichash_update(&state, (const uint8_t *)counts, sizeof counts);
	surfel_set_parts(set, parts);
	for (size_t i = 0; i < SURFEL_PARTS; i++)
		crypto_generichash_update(&state, parts[i].data, parts[i].bytes);
	crypto_generichash_final(&state, digest, sizeof digest);
	memcpy(&hash, digest, sizeof hash);
	return hash;
}

float surfel_thinned(const float way[2], float more)
{
	const float spread = way[1] / fmaxf(way[0], 1e-30f); /* metres */

	if (!(more < 0 || more > 0))
		return 1;
	if (spread * fabsf(more) < 1e-3f)
		return expf(-more * way[0] * (1 - 0.5f * spread * more));
	return powf(fmaxf(1 + more * spread, 0.25f), -way[0] / spread);
}

void surfel_way_of(double light, double way, double way2, float out[2])
{
	const double mean = light > 0 ? way / light : 0;

	out[0] = (float)mean;
	out[1] = light > 0 ? (float)fmax(0, way2 / light - mean * mean) : 0;
}

static int16_t pack_16(float v)
{
	return (int16_t)lrintf(fminf(fmaxf(v, -1.0f), 1.0f) * 32767.0f);
}

uint32_t surfel_normal_pack(const float normal[3])
{
	float sum = fabsf(normal[0]) + fabsf(normal[1]) + fabsf(normal[2]);
	float x = normal[0] / sum, y = normal[1] / sum;

	if (normal[2] < 0) {
		float fold = (1.0f - fabsf(y)) * copysignf(1.0f, x);

		y = (1.0f - fabsf(x)) * copysignf(1.0f, y);
		x = fold;
	}
	return (uint32_t)(uint16_t)pack_16(x) | (uint32_t)(uint16_t)pack_16(y) << 16;
}

void surfel_normal_unpack(uint32_t packed, float out[3])
{
	float x = fmaxf((float)(int16_t)(packed & 0xffff) / 32767.0f, -1.0f);
	float y = fmaxf((float)(int16_t)(packed >> 16) / 32767.0f, -1.0f);
	float z = 1.0f - fabsf(x) - fabsf(y), fold = fmaxf(-z, 0.0f), length;

	x -= copysignf(fold, x);
	y -= copysignf(fold, y);
	length = sqrtf(x * x + y * y + z * z);
	out[0] = x / length;
	out[1] = y / length;
	out[2] = z / length;
}

void surfel_frame(const float n[3], float u[3], float v[3])
{
	float sign = copysignf(1.0f, n[2]);
	float a = -1.0f / (sign + n[2]);
	float b = n[0] * n[1] * a;

	u[0] = 1.0f + sign * n[0] * n[0] * a;
	u[1] = sign * b;
	u[2] = -sign * n[0];
	v[0] = b;
	v[1] = sign + n[1] * n[1] * a;
	v[2] = -n[1];
}

static float dot3(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Step, 0..16, on |x| + |y| = 1 from (1, 0) by way of (0, 1). */
static float diamond(float x, float y)
{
	float quarter = y >= 0 ? (x >= 0 ? y : 1.0f - x) : (x < 0 ? 2.0f - y : 3.0f + x);

	return quarter * (float)SURFEL_SECTORS * 0.25f;
}

static float sight_along(const struct surfel *surfel, float radius_m, const float normal[3],
			 const float d[3])
{
	float u[3], v[3];

	surfel_frame(normal, u, v);
	float x = dot3(d, u), y = dot3(d, v), length = fabsf(x) + fabsf(y);
	if (!(length > 0))
		return 0;
	float step = diamond(x / length, y / length);
	int k = (int)step;
	float f = step - (float)k;
	uint8_t a = surfel->reach[k % SURFEL_SECTORS], b = surfel->reach[(k + 1) % SURFEL_SECTORS];
	float by_a = a == 255 ? 0 : 255.0f / (float)a, by_b = b == 255 ? 0 : 255.0f / (float)b;

	return length / (1.41421356f * radius_m) * ((1 - f) * by_a + f * by_b);
}

/* Most surfels of a flat wall: their sight is 0 in every direction. */
static bool sees_all(const struct surfel *surfel)
{
	static const uint8_t no_end[SURFEL_SECTORS] = {
		255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255,
	};

	return memcmp(surfel->reach, no_end, sizeof no_end) == 0;
}

float surfel_sight(const struct surfel_set *set, size_t i, const float position[3])
{
	const struct surfel *surfel = &set->surfels[i];
	float normal[3], d[3];

	if (sees_all(surfel))
		return 0;
	surfel_normal_unpack(surfel->normal, normal);
	for (int k = 0; k < 3; k++)
		d[k] = position[k] - surfel->position[k];
	return sight_along(surfel, set->radius_m, normal, d);
}

static float fade(float sight)
{
	float t = (sight - SURFEL_FADE_FROM) / (1 - SURFEL_FADE_FROM);

	if (sight > 1)
		return sight <= SURFEL_SIGHT_MOST ? SURFEL_BEHIND : 0;
	t = fmaxf(t, 0);
	return 1 - (1 - SURFEL_FADE) * t * t * (3 - 2 * t);
}

float surfel_weight(const struct surfel_set *set, size_t i, const float position[3],
		    const float normal[3])
{
	const struct surfel *surfel = &set->surfels[i];
	float own[3], d[3];

	for (int k = 0; k < 3; k++)
		d[k] = position[k] - surfel->position[k];
	float near = 1 - dot3(d, d) / (set->radius_m * set->radius_m);
	if (near <= 0)
		return 0; /* most of a cell's: before anything is computed */
	surfel_normal_unpack(surfel->normal, own);
	float facing = 2 * dot3(own, normal) - 1;
	float off = 0.5f * (dot3(d, own) + dot3(d, normal)) / (SURFEL_PLANE * set->spacing_m);
	float level = 1 - off * off;
	if (facing <= 0 || level <= 0)
		return 0;
	return near * near * facing * facing * level * level *
	       (sees_all(surfel) ? 1 : fade(sight_along(surfel, set->radius_m, own, d)));
}
