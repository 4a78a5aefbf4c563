/* How well two pictures agree, given the noise that each is known to have. */
#ifndef GROTTO_TESTS_FOLDER_AGREEMENT_H
#define GROTTO_TESTS_FOLDER_AGREEMENT_H

#include "renderer/image/compare.h"

struct agreement {
	double ratio;       /* of the images' means, ours over theirs */
	double ratio_error; /* its standard error, relative */
	double nrmse;       /* of pixels */
	double blocks;      /* mean relative difference of blocks' means */
	double noise;       /* what of it both pictures' noise alone would give */
	double their_noise; /* what theirs alone would */
	double within_pixels, within_blocks; /* share of them within 3 standard errors; NaN: no errors */
	double chi2;        /* mean square difference of blocks over that of the noise; 1: noise alone */
	size_t nonfinite;
};
/*
 * error, their_error: standard errors of pixels, independent from pixel to pixel;
 * without data: none. block: its side in pixels. GR_OK, GR_ERR_RANGE, GR_ERR_NOMEM.
 */
int agreement_of(const struct image *ours, const struct image *error, const struct image *theirs,
		 const struct image *their_error, int block, struct agreement *out);
/* Standard errors of means over squares of that many pixels a side. */
int agreement_coarse_error(const struct image *error, int side, struct image *out);

#endif
