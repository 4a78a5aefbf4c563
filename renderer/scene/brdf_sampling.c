/*
 * Directions by what a table sends there. For each two degrees of wo the
 * hemisphere is cut into cells; a cell's weight is luminance times cosine,
 * averaged over points in it, times its solid angle. Densities are those of
 * the cells, so they are exact however steep the table is within one.
 */
#include "renderer/scene/brdf_private.h"

#include "base/result.h"

#include <math.h>
#include <stdlib.h>

#define POINTS 3 /* along each side of a cell */

static double theta_edge(int i)
{
	return M_PI / 2 * i / SAMPLING_THETA;
}

/* Away from the mirror's azimuth. */
static double phi_edge(int i)
{
	double step = (double)i / SAMPLING_PHI;

	return M_PI * step * step;
}

/* Of both halves, left and right of the mirror's azimuth. */
static double solid_angle(int theta, int phi)
{
	return 2 * (cos(theta_edge(theta)) - cos(theta_edge(theta + 1))) *
	       (phi_edge(phi + 1) - phi_edge(phi));
}

static double cell_weight(const struct brdf_table *t, double theta_o, int theta, int phi)
{
	double sum = 0;

	for (int k = 0; k < POINTS * POINTS; k++) {
		double a = (k % POINTS + 0.5) / POINTS, b = ((double)(k / POINTS) + 0.5) / POINTS;
		double at = theta_edge(theta) + a * (theta_edge(theta + 1) - theta_edge(theta));
		double off = phi_edge(phi) + b * (phi_edge(phi + 1) - phi_edge(phi));
		double f[3];

		brdf_evaluate_angles(t, at, theta_o, M_PI - off, f);
		sum += (0.2126 * f[0] + 0.7152 * f[1] + 0.0722 * f[2]) * cos(at);
	}
	return sum * solid_angle(theta, phi);
}

int brdf_build_sampling(struct brdf_table *table)
{
	table->sums = calloc(SAMPLING_IN, sizeof *table->sums);
	if (!table->sums)
		return GR_ERR_NOMEM;
	for (int in = 0; in < SAMPLING_IN; in++) {
		double sums[SAMPLING_CELLS + 1] = { 0 };
		double theta_o = (in + 0.5) / SAMPLING_IN * M_PI / 2;

		for (int cell = 0; cell < SAMPLING_CELLS; cell++)
			sums[cell + 1] = sums[cell] + cell_weight(table, theta_o, cell / SAMPLING_PHI,
								  cell % SAMPLING_PHI);
		for (int cell = 0; cell <= SAMPLING_CELLS; cell++)
			table->sums[in][cell] = sums[SAMPLING_CELLS] > 0
							? (float)(sums[cell] / sums[SAMPLING_CELLS])
							: (float)cell / SAMPLING_CELLS;
	}
	return GR_OK;
}

static const float *sums_for(const struct brdf_table *t, const float wo[3])
{
	double theta = acos(wo[2] > 1 ? 1 : (double)wo[2]);
	int in = (int)(theta / (M_PI / 2) * SAMPLING_IN);

	return t->sums[in < SAMPLING_IN ? in : SAMPLING_IN - 1];
}

/* Of cosine of theta and azimuth off the mirror's (0..pi). */
static double density(const float *sums, double c, double off)
{
	int theta = (int)(acos(c > 1 ? 1 : c) / (M_PI / 2) * SAMPLING_THETA);
	int phi = (int)(sqrt(off / M_PI) * SAMPLING_PHI);
	int cell;

	theta = theta < SAMPLING_THETA ? theta : SAMPLING_THETA - 1;
	phi = phi < SAMPLING_PHI ? phi : SAMPLING_PHI - 1;
	cell = theta * SAMPLING_PHI + phi;
	return SAMPLING_COSINE * c / M_PI + (1 - SAMPLING_COSINE) *
						    ((double)sums[cell + 1] - (double)sums[cell]) /
						    solid_angle(theta, phi);
}

float brdf_table_pdf(const struct brdf_table *table, const float wo[3], const float wi[3])
{
	double between;

	if (!(wi[2] > 0) || !(wo[2] > 0))
		return 0;
	between = atan2((double)wi[1], (double)wi[0]) - atan2((double)wo[1], (double)wo[0]);
	return (float)density(sums_for(table, wo), (double)wi[2],
			      M_PI - fabs(remainder(between, 2 * M_PI)));
}

static int find_cell(const float *sums, double u)
{
	int low = 0, high = SAMPLING_CELLS;

	while (high - low > 1) {
		int middle = (low + high) / 2;

		if ((double)sums[middle] <= u)
			low = middle;
		else
			high = middle;
	}
	while (low > 0 && !(sums[low + 1] > sums[low]))
		low--;
	return low;
}

/* Cosine and azimuth off the mirror's, signed, within a cell. */
static void place_in_cell(const float *sums, double u1, double u2, double *c, double *off)
{
	int cell = find_cell(sums, u1);
	int theta = cell / SAMPLING_PHI, phi = cell % SAMPLING_PHI;
	double height = (double)sums[cell + 1] - (double)sums[cell];
	double share = height > 0 ? (u1 - (double)sums[cell]) / height : 0.5;
	double side = u2 < 0.5 ? -1 : 1;

	share = share < 0 ? 0 : share > 1 ? 1 : share;
	u2 = u2 < 0.5 ? 2 * u2 : 2 * u2 - 1;
	*c = cos(theta_edge(theta)) + share * (cos(theta_edge(theta + 1)) - cos(theta_edge(theta)));
	*off = side * (phi_edge(phi) + u2 * (phi_edge(phi + 1) - phi_edge(phi)));
}

float brdf_table_sample(const struct brdf_table *table, const float wo[3], double u1, double u2,
			float wi[3])
{
	double c, off, s, phi;

	wi[0] = wi[1] = wi[2] = 0;
	if (!(wo[2] > 0))
		return 0;
	if (u1 < SAMPLING_COSINE) {
		c = sqrt(1 - u1 / SAMPLING_COSINE);
		off = 2 * M_PI * u2 - M_PI;
	} else {
		place_in_cell(sums_for(table, wo), (u1 - SAMPLING_COSINE) / (1 - SAMPLING_COSINE), u2,
			      &c, &off);
	}
	s = sqrt(fmax(0, 1 - c * c));
	phi = atan2((double)wo[1], (double)wo[0]) + M_PI + off;
	wi[0] = (float)(s * cos(phi));
	wi[1] = (float)(s * sin(phi));
	wi[2] = (float)c;
	return wi[2] > 0 ? (float)density(sums_for(table, wo), c, fabs(off)) : 0;
}
