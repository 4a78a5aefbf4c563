/* From what a scene file says, or a picture, to an environment. */
#include "config.h" /* _GNU_SOURCE */

#include "renderer/scene/environment_private.h"

#include "base/plain.h"
#include "base/result.h"
#include "renderer/scene/environment_cube.h"
#include "renderer/scene/sky.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pixels around, 0.7 degrees: what lies between is linear to 0.1 per cent but next to the sun. */
#define SKY_WIDTH 512

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

/* Six pictures, by the names that the one with the * stands for. */
static int read_faces(const char *path, struct image *out, struct gr_diag *diag)
{
	static const char *const names[6] = { "px", "nx", "py", "ny", "pz", "nz" };
	const char *star = strrchr(path, '*');
	struct image faces[6] = { { 0 } };
	int result = star ? GR_OK : GR_ERR_CONFIG;

	for (int i = 0; i < 6 && result == GR_OK; i++) {
		char *name;

		if (asprintf(&name, "%.*s%s%s", (int)(star - path), path, names[i], star + 1) < 0) {
			result = GR_ERR_NOMEM;
			break;
		}
		result = image_read_light(name, &faces[i], diag);
		free(name);
	}
	if (result == GR_OK)
		result = cube_unfold(faces, path, out, diag);
	for (int i = 0; i < 6; i++)
		image_finish(&faces[i]);
	return result;
}

/* As latitude-longitude, whatever it was; *out is to be finished in any case. */
static int read_picture(const char *path, enum scene_projection projection, struct image *out,
			struct gr_diag *diag)
{
	struct image cross;
	int result;

	memset(out, 0, sizeof *out);
	if (projection == SCENE_PROJECTION_LATLONG)
		return image_read_light(path, out, diag);
	if (projection == SCENE_PROJECTION_FACES)
		return read_faces(path, out, diag);
	result = image_read_light(path, &cross, diag);
	if (result == GR_OK)
		result = cube_unfold_cross(&cross, path, out, diag);
	image_finish(&cross);
	return result;
}

/* The paper's sky as a picture: its horizon goes on below, where nothing comes from. */
static int create_sky(struct environment **out, const struct scene_environment *said,
		      const char *name, struct gr_diag *diag)
{
	const double to_sun[3] = { (double)said->to_sun[0], (double)said->to_sun[1],
				   (double)said->to_sun[2] };
	struct scene_environment unturned = *said;
	struct image picture;
	struct sky sky;
	int result;

	sky_init(&sky, (double)said->turbidity, to_sun);
	result = sky_picture(&sky, SKY_WIDTH, SKY_WIDTH / 2, &picture);
	if (result != GR_OK)
		return result;
	unturned.scale = 1;
	unturned.heading_rad = 0; /* the sun's direction has it */
	unturned.upper_only = true;
	result = environment_from_image(out, &picture, &unturned, name, diag);
	image_finish(&picture);
	if (result == GR_OK) {
		(*out)->is_sky = true;
		(*out)->turbidity = said->turbidity;
		memcpy((*out)->to_sun, said->to_sun, sizeof said->to_sun);
	}
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
	if (said->kind == SCENE_ENVIRONMENT_SKY)
		return create_sky(out, said, file->path, diag);
	path = scene_file_beside(file, said->file);
	if (!path)
		return GR_ERR_NOMEM;
	result = read_picture(path, said->projection, &image, diag);
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
