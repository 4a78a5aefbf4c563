#include "renderer/image/convolve.h"

#include <math.h>
#include <stddef.h>

void kernel_gaussian(struct kernel *kernel, double sigma, int radius)
{
	kernel->radius = radius;
	for (int i = -radius; i <= radius; i++)
		kernel->at[i + radius] = exp(-(double)i * i / (2 * sigma * sigma));
}

static int inside(int at, int count)
{
	return at < 0 ? 0 : at >= count ? count - 1 : at;
}

void convolve(const float *from, int width, int height, const struct kernel *across,
	      const struct kernel *down, float *spare, float *to)
{
	for (int y = 0; y < height; y++) {
		const float *row = from + (ptrdiff_t)y * width;

		for (int x = 0; x < width; x++) {
			double sum = 0;

			for (int k = -across->radius; k <= across->radius; k++)
				sum += across->at[k + across->radius] * (double)row[inside(x + k, width)];
			spare[(ptrdiff_t)y * width + x] = (float)sum;
		}
	}
	for (int y = 0; y < height; y++) {
		for (int x = 0; x < width; x++) {
			double sum = 0;

			for (int k = -down->radius; k <= down->radius; k++)
				sum += down->at[k + down->radius] *
				       (double)spare[(ptrdiff_t)inside(y + k, height) * width + x];
			to[(ptrdiff_t)y * width + x] = (float)sum;
		}
	}
}
