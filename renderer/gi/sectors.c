#include "renderer/gi/sectors.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

/* z slowest, without the middle; the opposite of j stands at 25 - j. */
const signed char sector_offset[SECTOR_COUNT][3] = {
	{ -1, -1, -1 }, { 0, -1, -1 }, { 1, -1, -1 }, { -1, 0, -1 }, { 0, 0, -1 },
	{ 1, 0, -1 },	{ -1, 1, -1 }, { 0, 1, -1 },  { 1, 1, -1 },  { -1, -1, 0 },
	{ 0, -1, 0 },	{ 1, -1, 0 },  { -1, 0, 0 },  { 1, 0, 0 },   { -1, 1, 0 },
	{ 0, 1, 0 },	{ 1, 1, 0 },   { -1, -1, 1 }, { 0, -1, 1 },  { 1, -1, 1 },
	{ -1, 0, 1 },	{ 0, 0, 1 },   { 1, 0, 1 },   { -1, 1, 1 },  { 0, 1, 1 },
	{ 1, 1, 1 },
};

static const double hop[SECTOR_KINDS] = { 1.0, 1.41421356237309505, 1.73205080756887729 };
static const double members[SECTOR_KINDS] = { 6, 12, 8 };

/*
 * Integrates over the 1/48 of the sphere with 0 <= z <= y <= x, seen on the
 * plane x = 1 where dw = (1 + y^2 + z^2)^(-3/2) dy dz.
 */
static void integrate(struct sectors *s)
{
	enum { STEPS = 2048 };
	const double h = 1.0 / STEPS;
	double area[SECTOR_KINDS] = { 0 }, cosine[SECTOR_KINDS] = { 0 };

	for (int iy = 0; iy < STEPS; iy++) {
		for (int iz = 0; iz <= iy; iz++) {
			double y = (iy + 0.5) * h;
			double z = (iz + 0.5) * h;
			double r2 = 1 + y * y + z * z;
			/* the diagonal's squares lie half inside */
			double w = (iz == iy ? 0.5 : 1.0) * h * h / (r2 * sqrt(r2));
			double c[SECTOR_KINDS] = { 1.0 / hop[0], (1 + y) / hop[1],
						   (1 + y + z) / hop[2] };
			int k = c[0] > c[1] ? (c[0] > c[2] ? 0 : 2) : (c[1] > c[2] ? 1 : 2);

			area[k] += w;
			cosine[k] += w * c[k] / sqrt(r2);
		}
	}
	double sum = area[0] + area[1] + area[2];
	for (int k = 0; k < SECTOR_KINDS; k++) {
		s->mu[k] = cosine[k] / area[k];
		/* 48 such wedges; scaled so that the sphere is whole to the last bit */
		s->omega[k] = 4 * PI * area[k] / sum / members[k];
	}
}

void sectors_init(struct sectors *s)
{
	memset(s, 0, sizeof *s);
	integrate(s);
	for (int k = 0; k < SECTOR_KINDS; k++) {
		s->a[k] = s->omega[k] / (4 * PI);
		s->b[k] = 3 * s->mu[k] * s->a[k];
	}
	for (int j = 0; j < SECTOR_COUNT; j++) {
		int k = sector_kind(j);

		if (sector_offset[j][0] > 0) {
			s->look_f += 4 * s->a[k];
			s->look_v += 2 * s->b[k] / hop[k];
		}
	}
	s->lobe = 0.5 * s->look_f / s->look_v;
}

double medium_transmittance(double sigma_per_m, double metres)
{
	if (sigma_per_m >= 1)
		return 0;
	return pow(1 - sigma_per_m, metres);
}

void sectors_medium(const struct sectors *s, double absorption_per_m, double scattering_per_m,
		    double d, struct sector_medium *out)
{
	double sigma_t = absorption_per_m + scattering_per_m;
	double albedo = sigma_t > 0 ? scattering_per_m / sigma_t : 0;
	double through = 0, scattered = 0;

	for (int k = 0; k < SECTOR_KINDS; k++) {
		double t = medium_transmittance(sigma_t, d * hop[k]);

		out->a[k] = t * s->a[k];
		out->b[k] = t * s->b[k];
		through += members[k] * s->a[k] * t;
		scattered += members[k] * s->a[k] * (1 - t) * albedo;
	}
	/* The odd part of psi cancels in the sum over opposite sectors: what is
	 * scattered in a cell is a multiple of F, and goes out evenly. */
	for (int k = 0; k < SECTOR_KINDS; k++)
		out->a[k] += scattered * s->a[k];
	out->keep_f = through + scattered;
	out->keep_v = through;
}
