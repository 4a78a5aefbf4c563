#include "renderer/scene/environment.h"

#include "base/result.h"

#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct environment {
	float constant[3];
	bool upper_only;
	float heading_rad;
	double turn[2]; /* cosine and sine of the heading */

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

static double luminance(const float rgb[3])
{
	return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
}

static const float *pixel(const struct environment *e, int x, int y)
{
	x = (x % e->width + e->width) % e->width;
	y = y < 0 ? 0 : y >= e->height ? e->height - 1 : y;
	return e->rgb + 3 * ((size_t)y * (size_t)e->width + (size_t)x);
}

/* Mean over the pixel's square in u and v of what is linear between its neighbours. */
static void pixel_mean(const struct environment *e, int x, int y, float out[3])
{
	static const float share[3] = { 0.125f, 0.75f, 0.125f };

	out[0] = out[1] = out[2] = 0;
	for (int dy = -1; dy <= 1; dy++) {
		for (int dx = -1; dx <= 1; dx++) {
			const float *p = pixel(e, x + dx, y + dy);

			for (int c = 0; c < 3; c++)
				out[c] += share[dy + 1] * share[dx + 1] * p[c];
		}
	}
}

/* Cosines to +Y of a row's upper and lower edge, as far as light comes from there. */
static void edges_of(const struct environment *e, int y, int rows, double *top, double *bottom)
{
	*top = cos(M_PI * y / rows);
	*bottom = cos(M_PI * (y + 1) / rows);
	if (e->upper_only) {
		*top = fmax(*top, 0);
		*bottom = fmax(*bottom, 0);
	}
	/* cos(pi/2) is no exact 0, and half a row of 1e-16 is none. */
	if (*top - *bottom < 1e-12)
		*bottom = *top;
}

static void row_edges(const struct environment *e, int y, double *top, double *bottom)
{
	edges_of(e, y, e->height, top, bottom);
}

static double pixel_solid_angle(const struct environment *e, int y)
{
	double top, bottom;

	row_edges(e, y, &top, &bottom);
	return 2 * M_PI / e->width * (top - bottom);
}

static int build_sums(struct environment *e)
{
	size_t width = (size_t)e->width, height = (size_t)e->height;

	e->in_row = calloc((width + 1) * height, sizeof *e->in_row);
	e->rows = calloc(height + 1, sizeof *e->rows);
	if (!e->in_row || !e->rows)
		return GR_ERR_NOMEM;
	for (int y = 0; y < e->height; y++) {
		double *sums = e->in_row + (width + 1) * (size_t)y;
		double solid_angle = pixel_solid_angle(e, y);

		for (int x = 0; x < e->width; x++) {
			float mean[3];

			pixel_mean(e, x, y, mean);
			sums[x + 1] = sums[x] + luminance(mean) * solid_angle;
		}
		e->rows[y + 1] = e->rows[y] + sums[width];
	}
	return GR_OK;
}

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
				    "pixel %zu of row %zu is %g, times its scale %g more than %g W/(m2 sr)",
				    i % per_row / (size_t)image->channels, i / per_row, (double)value,
				    (double)scale, (double)ENVIRONMENT_MAX_RADIANCE);
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
	return build_sums(e);
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

/* Where a direction is in the picture: u and v in 0..1. */
static void place_of(const struct environment *e, const float direction[3], double *u, double *v)
{
	/* Back by the heading: the picture's own axes. */
	double x = e->turn[0] * (double)direction[0] - e->turn[1] * (double)direction[2];
	double z = e->turn[1] * (double)direction[0] + e->turn[0] * (double)direction[2];
	double y = fmin(fmax((double)direction[1], -1), 1);

	*u = atan2(z, x) / (2 * M_PI) + 0.5;
	*v = acos(y) / M_PI;
}

static void radiance_at(const struct environment *e, double u, double v, float out[3])
{
	double column = u * e->width - 0.5, row = v * e->height - 0.5;
	int x = (int)floor(column), y = (int)floor(row);
	float right = (float)(column - x), down = (float)(row - y);
	const float *a = pixel(e, x, y), *b = pixel(e, x + 1, y);
	const float *c = pixel(e, x, y + 1), *d = pixel(e, x + 1, y + 1);

	for (int i = 0; i < 3; i++)
		out[i] = (a[i] * (1 - right) + b[i] * right) * (1 - down) +
			 (c[i] * (1 - right) + d[i] * right) * down;
}

void environment_radiance(const struct environment *environment, const float direction[3],
			  float out[3])
{
	double u, v;

	if (environment->upper_only && !(direction[1] > 0)) {
		out[0] = out[1] = out[2] = 0;
	} else if (!environment->width) {
		memcpy(out, environment->constant, sizeof environment->constant);
	} else {
		place_of(environment, direction, &u, &v);
		radiance_at(environment, u, v, out);
	}
}

static bool is_even(const struct environment *e)
{
	return !e->width || !(e->rows[e->height] > 0);
}

/* Index of the step of rising sums in which `value` lies; steps of no height are left out. */
static int find_step(const double *sums, int count, double value)
{
	int low = 0, high = count;

	while (high - low > 1) {
		int middle = (low + high) / 2;

		if (sums[middle] <= value)
			low = middle;
		else
			high = middle;
	}
	/* value at the very end, by rounding */
	while (low > 0 && !(sums[low + 1] > sums[low]))
		low--;
	return low;
}

static double within(double low, double high, double value)
{
	double share = (value - low) / (high - low);

	return share < 0 ? 0 : share > 1 ? 1 : share;
}

static float sample_evenly(const struct environment *e, double u1, double u2, float direction[3])
{
	double y = e->upper_only ? 1 - u1 : 1 - 2 * u1; /* above 0 with upper_only */
	double r = sqrt(fmax(0, 1 - y * y));

	direction[0] = (float)(r * cos(2 * M_PI * u2));
	direction[1] = (float)y;
	direction[2] = (float)(r * sin(2 * M_PI * u2));
	return (float)((e->upper_only ? 2 : 1) / (4 * M_PI));
}

float environment_sample(const struct environment *environment, double u1, double u2,
			 float direction[3], float radiance[3])
{
	const struct environment *e = environment;
	double top, bottom, y, r, p, share;
	const double *sums;
	int row, column;
	float pdf;

	if (is_even(e)) {
		pdf = sample_evenly(e, u1, u2, direction);
		environment_radiance(e, direction, radiance);
		return pdf;
	}
	u1 *= e->rows[e->height];
	row = find_step(e->rows, e->height, u1);
	sums = e->in_row + (size_t)(e->width + 1) * (size_t)row;
	share = within(e->rows[row], e->rows[row + 1], u1);
	u2 *= sums[e->width];
	column = find_step(sums, e->width, u2);
	row_edges(e, row, &top, &bottom);
	y = top + share * (bottom - top);
	if (e->upper_only)
		y = fmax(y, 1e-9); /* the last row's lower edge is the horizon, whence nothing comes */
	p = 2 * M_PI * ((column + within(sums[column], sums[column + 1], u2)) / e->width - 0.5);
	r = sqrt(fmax(0, 1 - y * y));
	direction[0] = (float)(r * (e->turn[0] * cos(p) + e->turn[1] * sin(p)));
	direction[1] = (float)y;
	direction[2] = (float)(r * (e->turn[0] * sin(p) - e->turn[1] * cos(p)));
	radiance_at(e, p / (2 * M_PI) + 0.5, acos(y) / M_PI, radiance);
	return (float)((sums[column + 1] - sums[column]) /
		       (e->rows[e->height] * pixel_solid_angle(e, row)));
}

float environment_pdf(const struct environment *environment, const float direction[3])
{
	const struct environment *e = environment;
	const double *sums;
	double u, v;
	int x, y;

	if (e->upper_only && !(direction[1] > 0))
		return 0;
	if (is_even(e))
		return (float)((e->upper_only ? 2 : 1) / (4 * M_PI));
	place_of(e, direction, &u, &v);
	x = (int)(u * e->width);
	y = (int)(v * e->height);
	x = x < e->width ? x : e->width - 1;
	y = y < e->height ? y : e->height - 1;
	sums = e->in_row + (size_t)(e->width + 1) * (size_t)y;
	if (!(pixel_solid_angle(e, y) > 0))
		return 0;
	return (float)((sums[x + 1] - sums[x]) / (e->rows[e->height] * pixel_solid_angle(e, y)));
}

void environment_irradiance(const struct environment *environment, const float normal[3],
			    float out[3])
{
	const struct environment *e = environment;
	double sum[3] = { 0 };
	int rows, columns;

	if (!e->width) {
		/* Half of what is above the horizon is seen by a wall (a lune's projection). */
		double seen = e->upper_only ? 0.5 * (1 + (double)normal[1]) : 1;

		for (int i = 0; i < 3; i++)
			out[i] = (float)(M_PI * seen * (double)e->constant[i]);
		return;
	}
	/* Large pixels in parts, so that each is small as a lamp. */
	rows = e->height * (1 + 180 / e->height);
	columns = e->width * (1 + 360 / e->width);
	for (int row = 0; row < rows; row++) {
		double top, bottom, y, r;

		edges_of(e, row, rows, &top, &bottom);
		y = (top + bottom) / 2;
		r = sqrt(1 - y * y);
		for (int column = 0; column < columns; column++) {
			double u = (column + 0.5) / columns, p = 2 * M_PI * (u - 0.5);
			double x = r * (e->turn[0] * cos(p) + e->turn[1] * sin(p));
			double z = r * (e->turn[0] * sin(p) - e->turn[1] * cos(p));
			double c = x * (double)normal[0] + y * (double)normal[1] + z * (double)normal[2];
			float radiance[3];

			if (c <= 0)
				continue;
			radiance_at(e, u, (row + 0.5) / rows, radiance);
			for (int i = 0; i < 3; i++)
				sum[i] += (double)radiance[i] * c * (top - bottom) * 2 * M_PI / columns;
		}
	}
	for (int i = 0; i < 3; i++)
		out[i] = (float)sum[i];
}

void environment_pixels(const struct environment *environment, struct environment_pixels *out)
{
	*out = (struct environment_pixels){
		.rgb = environment->rgb,
		.width = environment->width,
		.height = environment->height,
		.heading_rad = environment->heading_rad,
		.upper_only = environment->upper_only,
	};
	memcpy(out->constant, environment->constant, sizeof out->constant);
}

void environment_describe(const struct environment *environment, char *text, size_t size)
{
	static const float up[3] = { 0, 1, 0 };
	const char *where = environment->upper_only ? ", from above the horizon only" : "";
	float e[3];

	environment_irradiance(environment, up, e);
	if (environment->width)
		snprintf(text, size, "a picture of %d x %d pixels%s, irradiance of open ground "
			 "%.4g %.4g %.4g W/m2", environment->width, environment->height, where,
			 (double)e[0], (double)e[1], (double)e[2]);
	else
		snprintf(text, size, "constant radiance %.4g %.4g %.4g W/(m2 sr)%s",
			 (double)environment->constant[0], (double)environment->constant[1],
			 (double)environment->constant[2], where);
}

void environment_hash(const struct environment *environment, uint8_t out[32])
{
	const int32_t head[3] = { environment->width, environment->height,
				  environment->upper_only };
	crypto_generichash_state state;

	crypto_generichash_init(&state, NULL, 0, 32);
	crypto_generichash_update(&state, (const uint8_t *)head, sizeof head);
	crypto_generichash_update(&state, (const uint8_t *)environment->constant,
				  sizeof environment->constant);
	crypto_generichash_update(&state, (const uint8_t *)&environment->heading_rad,
				  sizeof environment->heading_rad);
	if (environment->rgb)
		crypto_generichash_update(&state, (const uint8_t *)environment->rgb,
					  3 * (size_t)environment->width *
						  (size_t)environment->height * sizeof(float));
	crypto_generichash_final(&state, out, 32);
}
