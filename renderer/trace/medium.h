/*
 * The homogeneous medium, as shaders/medium.glsl and the lattice have it: sigma
 * is the fraction that one metre takes out of a ray, so a path of d metres lets
 * (1 - sigma)^d through: coefficients of -ln(1 - sigma) per metre. What is taken
 * is shared between absorption and scattering as their sigmas are. Scattering is
 * alike in all directions.
 *
 * The medium fills all space between things; light from outside of everything
 * (parallel lamps, the environment) enters it where the scene's bounds begin.
 */
#ifndef GROTTO_RENDERER_TRACE_MEDIUM_H
#define GROTTO_RENDERER_TRACE_MEDIUM_H

#include "renderer/trace/vector.h"

struct medium {
	float extinction; /* 1/m; 0: vacuum */
	float albedo;     /* scattered share of what is taken, 0..1 */
	struct v3 min, max; /* of the scene */
};

/* From sigma 1 on nothing gets through a metre: 2^-1e6, as the renderer has it. */
static inline void medium_init(struct medium *out, float absorption, float scattering,
			       const float min[3], const float max[3])
{
	float sigma = absorption + scattering;

	out->extinction = sigma < 1.0f ? -log1pf(-sigma) : 693147.0f;
	out->albedo = sigma > 0.0f ? scattering / sigma : 0.0f;
	out->min = v3_of(min);
	out->max = v3_of(max);
	if (!(sigma > 0.0f))
		out->extinction = 0.0f;
}

/* Metres from p along a unit direction to where the bounds end, 0 outside. */
static inline float medium_exit(const struct medium *m, struct v3 p, struct v3 direction)
{
	const float d[3] = { direction.x, direction.y, direction.z };
	const float low[3] = { m->min.x - p.x, m->min.y - p.y, m->min.z - p.z };
	const float high[3] = { m->max.x - p.x, m->max.y - p.y, m->max.z - p.z };
	float t = INFINITY;

	for (int i = 0; i < 3; i++)
		if (fabsf(d[i]) > 1e-12f)
			t = smaller_of(t, (d[i] > 0.0f ? high[i] : low[i]) / d[i]);
	return t > 0.0f && isfinite(t) ? t : 0.0f;
}

/* Share of the light that a way of so many metres lets through; infinite: to the bounds. */
static inline float medium_passes(const struct medium *m, struct v3 p, struct v3 direction,
				  float metres)
{
	if (m->extinction == 0.0f)
		return 1.0f;
	if (!isfinite(metres))
		metres = medium_exit(m, p, direction);
	return expf(-m->extinction * metres);
}

#endif
