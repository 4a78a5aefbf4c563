/* From what a scene file says, or a picture, to an environment. */
#include "renderer/scene/environment_private.h"

#include "base/plain.h"
#include "base/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int check_pixels(const struct image *image, float scale, const char *name,
			struct gr_diag *diag, size_t *negative)
{
	size_t per_row = (size_t)image->width * (size_t)image->channels;
	size_t count = per_row * (size_t)image->height;

	*negative = 0;
	for (size_t i = 0; i < count; i++) {
		float value = image->data[i];

		if (!isfinite(value)) {
			gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL,
				    "pixel %zu of row %zu is %g; an environment's values are finite",
				    i % per_row / (size_t)image->channels, i / per_row, (double)value);
			return GR_ERR_CONFIG;
		}
		if ((double)value * (double)scale > (double)ENVIRONMENT_MAX_RADIANCE) {
			gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL,
				    "pixel %zu of row %zu is %s, times its scale %s more than %s W/(m2 sr)",
				    i % per_row / (size_t)image->channels, i / per_row,
				    gr_plain((double)value, 4).text, gr_plain((double)scale, 4).text,
				    gr_plain((double)ENVIRONMENT_MAX_RADIANCE, 4).text);
			return GR_ERR_CONFIG;
		}
		*negative += value < 0;
	}
	return GR_OK;
}

static int check_image(const struct image *image, float scale, const char *name,
		       struct gr_diag *diag)
{
	size_t negative;
	int result;

	if ((image->channels != 1 && image->channels != 3) || image->width < 1 ||
	    image->height < 1 || image->width > ENVIRONMENT_MAX_SIDE ||
	    image->height > ENVIRONMENT_MAX_SIDE) {
		gr_diag_add(diag, GR_DIAG_ERROR, name, 0, NULL,
			    "%d x %d pixels of %d channels; an environment has 1 or 3 channels and "
			    "sides of at most %d", image->width, image->height, image->channels,
			    ENVIRONMENT_MAX_SIDE);
		return GR_ERR_CONFIG;
	}
	result = check_pixels(image, scale, name, diag, &negative);
	if (result != GR_OK)
		return result;
	if (negative)
		gr_diag_add(diag, GR_DIAG_WARNING, name, 0, NULL,
			    "%zu values below 0 are taken as 0", negative);
	if (image->width != 2 * image->height && image->width * image->height > 1)
		gr_diag_add(diag, GR_DIAG_WARNING, name, 0, NULL,
			    "%d x %d pixels; a latitude-longitude picture is twice as wide as high",
			    image->width, image->height);
	return GR_OK;
}

static int take_pixels(struct environment *e, const struct image *image, float scale)
{
	size_t count = (size_t)image->width * (size_t)image->height;

	e->rgb = malloc(3 * count * sizeof *e->rgb);
	if (!e->rgb)
		return GR_ERR_NOMEM;
	e->width = image->width;
	e->height = image->height;
	for (size_t i = 0; i < count; i++) {
		for (size_t c = 0; c < 3; c++) {
			float value = image->channels == 1 ? image->data[i]
							   : image->data[3 * i + c];

			e->rgb[3 * i + c] = value > 0 ? value * scale : 0.0f;
		}
	}
	return environment_build_sums(e);
}

static struct environment *create(const struct scene_environment *said)
{
	struct environment *e = calloc(1, sizeof *e);

	if (!e)
		return NULL;
	e->upper_only = said->upper_only;
	e->heading_rad = said->heading_rad;
	e->turn[0] = cos((double)said->heading_rad);
	e->turn[1] = sin((double)said->heading_rad);
	return e;
}

int environment_from_image(struct environment **out, const struct image *image,
			   const struct scene_environment *said, const char *name,
			   struct gr_diag *diag)
{
	int result = check_image(image, said->scale, name, diag);

	*out = NULL;
	if (result != GR_OK)
		return result;
	*out = create(said);
	result = *out ? take_pixels(*out, image, said->scale) : GR_ERR_NOMEM;
	if (result != GR_OK)
		environment_destroy(out);
	return result;
}

int environment_create(struct environment **out, const struct scene_file *file,
		       struct gr_diag *diag)
{
	const struct scene_environment *said = &file->environment;
	struct image image;
	char *path;
	int result;

	*out = NULL;
	if (said->kind == SCENE_ENVIRONMENT_NONE)
		return GR_NOTHING;
	if (said->kind == SCENE_ENVIRONMENT_CONSTANT) {
		*out = create(said);
		if (!*out)
			return GR_ERR_NOMEM;
		memcpy((*out)->constant, said->radiance, sizeof(*out)->constant);
		return GR_OK;
	}
	path = scene_file_beside(file, said->file);
	if (!path)
		return GR_ERR_NOMEM;
	result = image_read_exr(path, &image, diag);
	if (result == GR_OK)
		result = environment_from_image(out, &image, said, path, diag);
	image_finish(&image);
	free(path);
	return result;
}

void environment_destroy(struct environment **environment)
{
	struct environment *e = *environment;

	if (!e)
		return;
	free(e->rgb);
	free(e->in_row);
	free(e->rows);
	free(e);
	*environment = NULL;
}
