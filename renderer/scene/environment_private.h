/* Inside of an environment: look-up (environment.c), reading (environment_load.c), sampling. */
#ifndef GROTTO_RENDERER_SCENE_ENVIRONMENT_PRIVATE_H
#define GROTTO_RENDERER_SCENE_ENVIRONMENT_PRIVATE_H

#include "renderer/scene/environment.h"

struct environment {
	float constant[3];
	bool upper_only;
	float heading_rad;
	double turn[2]; /* cosine and sine of the heading */

	/* Of a sky, which is a picture, too. */
	bool is_sky;
	float turbidity, to_sun[3];

	/* Of a picture. */
	int width, height; /* 0: constant */
	float *rgb;
	/*
	 * Sums of luminance times solid angle over a row's pixels from the left, and
	 * over whole rows from the top: width + 1 a row, height + 1. Of the mean over
	 * each pixel, so that none from which light comes has weight 0.
	 */
	double *in_row, *rows;
};

/* Value of a pixel; columns go around, rows are held at the ends. */
const float *environment_pixel(const struct environment *environment, int x, int y);
/* Cosines to +Y of a row's edges when there are so many rows, as far as light comes from there. */
void environment_edges(const struct environment *environment, int row, int rows, double *top,
		       double *bottom);
/* Where a direction is in the picture: u and v in 0..1. */
void environment_place(const struct environment *environment, const float direction[3], double *u,
		       double *v);
/* What the picture shows there. */
void environment_look(const struct environment *environment, double u, double v, float out[3]);
/* Fills in_row and rows. GR_ERR_NOMEM. */
int environment_build_sums(struct environment *environment);

#endif
