/* Separable filters over planes, for compare_flip.c and compare_ssim.c. */
#ifndef GROTTO_RENDERER_IMAGE_CONVOLVE_H
#define GROTTO_RENDERER_IMAGE_CONVOLVE_H

#define CONVOLVE_MAX_RADIUS 256

/* Values -radius..radius at [0..2 radius]. */
struct kernel {
	int radius;
	double at[2 * CONVOLVE_MAX_RADIUS + 1];
};

/* exp(-x^2 / 2 sigma^2), not normalised. */
void kernel_gaussian(struct kernel *kernel, double sigma, int radius);
/*
 * to = sum over kernels `across` (columns) and `down` (rows); beyond the edge the
 * edge's value goes on. to may not be from; spare is width x height.
 */
void convolve(const float *from, int width, int height, const struct kernel *across,
	      const struct kernel *down, float *spare, float *to);

#endif
