#include "renderer/trace/reference.h"

#include "base/result.h"
#include "renderer/trace/estimate.h"

#include <stdlib.h>
#include <string.h>

void reference_film_finish(struct reference_film *film)
{
	free(film->radiance);
	free(film->squares);
	free(film->indirect);
	free(film->indirect_squares);
	memset(film, 0, sizeof *film);
}

double reference_film_error(const struct reference_film *film)
{
	const struct estimate_sums sums = {
		.items = (size_t)film->width * (size_t)film->height,
		.samples = film->samples,
		.total = film->radiance,
		.squares = film->squares,
		.nonfinite = film->nonfinite,
	};

	return estimate_relative_error(&sums);
}

static int means(const struct reference_film *film, const double *total, struct image *out)
{
	int result = image_create(out, film->width, film->height, 3);
	size_t values = 3 * (size_t)film->width * (size_t)film->height;

	for (size_t i = 0; result == GR_OK && i < values; i++)
		out->data[i] = film->samples > 0 ? (float)(total[i] / film->samples) : 0.0f;
	return result;
}

static int errors(const struct reference_film *film, const double *total, const double *squares,
		  struct image *out)
{
	int result = image_create(out, film->width, film->height, 3);
	size_t values = 3 * (size_t)film->width * (size_t)film->height;

	for (size_t i = 0; result == GR_OK && i < values; i++)
		out->data[i] = (float)estimate_error(total[i], squares[i], film->samples);
	return result;
}

int reference_film_images(const struct reference_film *film, struct image *radiance,
			  struct image *error, struct image *indirect)
{
	int result = GR_OK;

	if (radiance)
		memset(radiance, 0, sizeof *radiance);
	if (error)
		memset(error, 0, sizeof *error);
	if (indirect)
		memset(indirect, 0, sizeof *indirect);
	if (radiance)
		result = means(film, film->radiance, radiance);
	if (error && result == GR_OK)
		result = errors(film, film->radiance, film->squares, error);
	if (indirect && result == GR_OK)
		result = means(film, film->indirect, indirect);
	return result;
}

int reference_film_indirect_error(const struct reference_film *film, struct image *out)
{
	return errors(film, film->indirect, film->indirect_squares, out);
}
