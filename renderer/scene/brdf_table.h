/*
 * A measured isotropic BRDF, in linear Rec.709 (renderer/scene/brdf_read.h has
 * the files and the colours), on a regular grid of the half vector's and the
 * difference vector's angles (Rusinkiewicz 1998).
 *
 * Reciprocity and mirror symmetry hold exactly: the azimuth of the difference
 * vector is folded to 0..pi/2. Grid points are interpolated between the eight
 * nearest samples (modified Shepard: Franke and Nielson 1980), logarithms of
 * the BRDF beside 1e-3/sr, nearness counted most along the half vector, where
 * highlights are steep. Where samples lie apart by more than a highlight is
 * wide, as in 10 degree steps over a mirror-like varnish, its shape is the
 * interpolation's; towards the horizon beyond the last samples, too.
 *
 * No more comes back than arrives: where the directional reflectance of a band
 * is above 1 at angle theta, f(i, o) is multiplied by min(s(i), s(o)) with
 * s = 1/reflectance, which keeps reciprocity. `limited` tells that it was so.
 *
 * Directions are of the surface's own frame, unit, +Z its normal. Below the
 * horizon the BRDF is 0.
 *
 * Thread safety: everything but create and destroy reads only.
 */
#ifndef GROTTO_RENDERER_SCENE_BRDF_TABLE_H
#define GROTTO_RENDERER_SCENE_BRDF_TABLE_H

#include "base/diag.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct brdf_table;
/* From a file or its text. GR_OK; GR_ERR_CONFIG with a line in diag; GR_ERR_NOMEM. */
int brdf_table_load(struct brdf_table **out, const char *path, struct gr_diag *diag);
int brdf_table_parse(struct brdf_table **out, const char *text, size_t len, const char *name,
		     struct gr_diag *diag);
void brdf_table_destroy(struct brdf_table **table);

/* 1/sr per band. */
void brdf_table_evaluate(const struct brdf_table *table, const float wi[3], const float wo[3],
			 float out[3]);
/*
 * A direction wi for wo and two numbers in [0, 1): a fifth of them by the cosine,
 * the others by luminance of the table times the cosine, cell by cell. Returns
 * its density per steradian, 0 when wo or the direction is below the horizon.
 */
float brdf_table_sample(const struct brdf_table *table, const float wo[3], double u1, double u2,
			float wi[3]);
/* The density of that. */
float brdf_table_pdf(const struct brdf_table *table, const float wo[3], const float wi[3]);

struct brdf_table_facts {
	size_t samples, wavelengths;
	size_t below_zero;   /* values of the file that were below 0 */
	size_t cut;          /* colours of samples that were out of the gamut, cut at 0 */
	float reflectance[3]; /* under light from everywhere alike */
	float normal[3];      /* directional, of light along the normal */
	float most;           /* directional, the most of any angle and band before the limit */
	bool limited;
	float misfit;         /* rms relative difference of table and samples above 1e-3/sr, luminance */
};
const struct brdf_table_facts *brdf_table_facts(const struct brdf_table *table);
/* BLAKE2b-256 of all that counts. */
void brdf_table_hash(const struct brdf_table *table, uint8_t out[32]);

#endif
