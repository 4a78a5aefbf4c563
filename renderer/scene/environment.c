#include "renderer/scene/environment_private.h"

#include "base/plain.h"

#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

const float *environment_pixel(const struct environment *environment, int x, int y)
{
	const struct environment *e = environment;

	x = (x % e->width + e->width) % e->width;
	y = y < 0 ? 0 : y >= e->height ? e->height - 1 : y;
	return e->rgb + 3 * ((size_t)y * (size_t)e->width + (size_t)x);
}

void environment_place(const struct environment *environment, const float direction[3], double *u,
		       double *v)
{
	const struct environment *e = environment;
	/* Back by the heading: the picture's own axes. */
	double x = e->turn[0] * (double)direction[0] - e->turn[1] * (double)direction[2];
	double z = e->turn[1] * (double)direction[0] + e->turn[0] * (double)direction[2];
	double y = fmin(fmax((double)direction[1], -1), 1);

	*u = atan2(z, x) / (2 * M_PI) + 0.5;
	*v = acos(y) / M_PI;
}

void environment_look(const struct environment *environment, double u, double v, float out[3])
{
	const struct environment *e = environment;
	double column = u * e->width - 0.5, row = v * e->height - 0.5;
	int x = (int)floor(column), y = (int)floor(row);
	float right = (float)(column - x), down = (float)(row - y);
	const float *a = environment_pixel(e, x, y), *b = environment_pixel(e, x + 1, y);
	const float *c = environment_pixel(e, x, y + 1), *d = environment_pixel(e, x + 1, y + 1);

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
		environment_place(environment, direction, &u, &v);
		environment_look(environment, u, v, out);
	}
}

void environment_edges(const struct environment *environment, int row, int rows, double *top,
		       double *bottom)
{
	*top = cos(M_PI * row / rows);
	*bottom = cos(M_PI * (row + 1) / rows);
	if (environment->upper_only) {
		*top = fmax(*top, 0);
		*bottom = fmax(*bottom, 0);
	}
	/* cos(pi/2) is no exact 0, and half a row of 1e-16 is none. */
	if (*top - *bottom < 1e-12)
		*bottom = *top;
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

		environment_edges(e, row, rows, &top, &bottom);
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
			environment_look(e, u, (row + 0.5) / rows, radiance);
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
	if (environment->is_sky)
		snprintf(text, size, "a sky of turbidity %s, its sun %s degrees high, irradiance of open "
			 "ground without the sun's %s %s %s W/m2",
			 gr_plain((double)environment->turbidity, 3).text,
			 gr_plain(asin((double)environment->to_sun[1]) * 180 / M_PI, 3).text,
			 gr_plain((double)e[0], 4).text, gr_plain((double)e[1], 4).text,
			 gr_plain((double)e[2], 4).text);
	else if (environment->width)
		snprintf(text, size, "a picture of %d x %d pixels%s, irradiance of open ground "
			 "%s %s %s W/m2", environment->width, environment->height, where,
			 gr_plain((double)e[0], 4).text, gr_plain((double)e[1], 4).text,
			 gr_plain((double)e[2], 4).text);
	else
		snprintf(text, size, "constant radiance %s %s %s W/(m2 sr)%s",
			 gr_plain((double)environment->constant[0], 4).text,
			 gr_plain((double)environment->constant[1], 4).text,
			 gr_plain((double)environment->constant[2], 4).text, where);
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
	if (environment->is_sky) {
		/* Not the pixels: machines with another libm have other last bits. */
		const int32_t sky[4] = { (int32_t)lround(1e5 * (double)environment->turbidity),
					 (int32_t)lround(1e5 * (double)environment->to_sun[0]),
					 (int32_t)lround(1e5 * (double)environment->to_sun[1]),
					 (int32_t)lround(1e5 * (double)environment->to_sun[2]) };

		crypto_generichash_update(&state, (const uint8_t *)sky, sizeof sky);
	} else if (environment->rgb) {
		crypto_generichash_update(&state, (const uint8_t *)environment->rgb,
					  3 * (size_t)environment->width *
						  (size_t)environment->height * sizeof(float));
	}
	crypto_generichash_final(&state, out, 32);
}
