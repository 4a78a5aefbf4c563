/*
 * How far a picture is from what it should be: scene-linear figures, and two of
 * how different the two look when shown.
 *
 * Pictures are of equal size and 3 channels, scene-linear. A pixel that is not
 * finite in either is counted and left out of the linear figures; shown, it is
 * as wrong as can be.
 *
 * Thread safety: pure.
 */
#ifndef GROTTO_RENDERER_IMAGE_COMPARE_H
#define GROTTO_RENDERER_IMAGE_COMPARE_H

#include "renderer/image/image.h"

#include <stddef.h>

struct compare_params {
	const float *weights;     /* width x height, >= 0; NULL: all pixels alike */
	int block;                /* pixels a side of a block */
	double least;             /* relative figures leave out what is below this share of a band's mean */
	double exposure;          /* for what is shown: times this, cut at 1, sRGB */
	double pixels_per_degree; /* how the picture is looked at */
};
/* 67 pixels a degree: 0.7 m off a screen of 3840 pixels and 0.7 m, as FLIP is published. */
#define COMPARE_PARAMS \
	{ .block = 8, .least = 0.01, .exposure = 1, .pixels_per_degree = 67.0206 }

struct compare_figures {
	size_t nonfinite;     /* pixels */
	double mean, reference_mean; /* over pixels and bands */
	double bias;          /* mean / reference_mean - 1 */
	double nrmse;         /* root mean square difference / reference_mean */
	double p95;           /* 95th percentile of |difference| / reference */
	double block_error;   /* mean of |difference| / reference of the blocks' means */
	size_t blocks;        /* block means that count for it, each band for itself */
	double ssim;          /* Wang et al. 2004, luminance as shown; 1: the same; NaN: under 11 pixels a side */
	double flip;          /* mean of LDR-FLIP (Andersson et al. 2020) as shown; 0: the same, 1 at most */
};

/* GR_OK; GR_ERR_RANGE: sizes differ, or not 3 channels; GR_ERR_NOMEM. */
int compare_images(const struct image *picture, const struct image *reference,
		   const struct compare_params *params, struct compare_figures *out);

/* Means over blocks of that side; what is left at the right and lower edge is left out. */
int compare_block_means(const struct image *picture, const float *weights, int block,
			struct image *out);
/* exposure, cut to 0..1, sRGB curve; what is not finite stays so. */
int compare_shown(const struct image *picture, double exposure, struct image *out);

/* Of pictures as shown, sRGB in 0..1. map: 1 channel, errors 0..1; each pixel for itself. */
int compare_flip(const struct image *shown, const struct image *reference,
		 double pixels_per_degree, struct image *map);
/* Mean structural similarity over all whole windows of 11 x 11 pixels (sigma 1.5). */
int compare_ssim(const struct image *shown, const struct image *reference, const float *weights,
		 double *out);

#endif
