/*
 * What is true of a scene, traced once and kept: indirect irradiance at points
 * of surfaces, and a camera's picture. Files lie in a folder under a key of
 * all that the truth depends on; the pictures are OpenEXR and can be looked at.
 * A file that is damaged, or of another key or version, is traced anew.
 */
#ifndef GROTTO_TOOLS_BENCH_TRUTH_STORE_H
#define GROTTO_TOOLS_BENCH_TRUTH_STORE_H

#include "renderer/image/image.h"
#include "tools/bench/points.h"

#include <stdbool.h>
#include <stdint.h>

struct bench_truth {
	size_t count;
	double (*irradiance)[3]; /* what the light field should say at each point, W/m^2 */
	double *error;           /* standard errors of the means over the bands */
	double noise;            /* root of their mean square over the mean */
	struct image radiance;   /* 3 channels, W/(m^2 sr) */
	struct image indirect;   /* the part that the light field gives; no data where that is not known */
	double picture_noise;    /* rms standard error of `radiance` over its mean */
	double seconds;          /* that tracing took, when it was traced */
	bool kept;               /* nothing had to be traced */
};

/* Where truth comes from; the tests have one of their own. */
struct bench_truth_source {
	/* Fills irradiance and error of count points. */
	int (*points)(void *ctx, const struct bench_points *points, double (*irradiance)[3],
		      double *error);
	/* Creates the images (indirect may stay without data) and says the noise. */
	int (*picture)(void *ctx, struct image *radiance, struct image *indirect, double *noise);
	void *ctx;
};

/*
 * key: of everything that the source's answer depends on. folder NULL: nothing
 * is kept. GR_OK or the source's result; that files cannot be written is said
 * in the log and no failure. Free with bench_truth_finish in any case.
 */
int bench_truth_get(struct bench_truth *out, const char *folder, const uint8_t key[32],
		    const struct bench_points *points, const struct bench_truth_source *source);
void bench_truth_finish(struct bench_truth *truth);

#endif
