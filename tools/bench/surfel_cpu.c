#include "tools/bench/surfel_cpu.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define GATHERS_MOST 1000

static void *rows(size_t count)
{
	void *p = calloc(count + 1, sizeof(double[3]));

	if (!p)
		abort();
	return p;
}

void surfel_cpu_init(struct surfel_cpu *out, const struct surfel_set *set)
{
	out->set = set;
	out->lamps = rows(set->count);
	out->indirect = rows(set->count);
	out->exitance = rows(set->count);
}

void surfel_cpu_finish(struct surfel_cpu *cpu)
{
	free(cpu->lamps);
	free(cpu->indirect);
	free(cpu->exitance);
}

void surfel_cpu_spot(struct surfel_cpu *cpu, const struct truth *truth)
{
	const struct surfel_set *set = cpu->set;

	for (size_t i = 0; i < set->count; i++) {
		double sum[3] = { 0 };

		for (uint32_t k = 0; k < set->taps_each; k++) {
			const struct surfel_tap *tap = &set->taps[i * set->taps_each + k];
			float normal[3], e[3];

			surfel_normal_unpack(tap->normal, normal);
			truth_direct(truth, tap->position, normal, e);
			for (int c = 0; c < 3; c++)
				sum[c] += (double)e[c] / set->taps_each;
		}
		memcpy(cpu->lamps[i], sum, sizeof sum);
	}
}

/* Largest change over the largest value. */
static double gather(struct surfel_cpu *cpu)
{
	const struct surfel_set *set = cpu->set;
	double change = 0, most = 0;

	for (size_t i = 0; i < set->count; i++)
		for (int c = 0; c < 3; c++)
			cpu->exitance[i][c] =
				(double)set->albedo[i][c] *
				(cpu->lamps[i][c] + (double)set->fixed_emissive[i][c] +
				 (double)set->fixed_other[i][c] + cpu->indirect[i][c]);
	for (size_t i = 0; i < set->count; i++) {
		double sum[3] = { 0 };

		for (uint32_t k = 0; k < set->links_each; k++) {
			uint32_t to = set->links[i * set->links_each + k];

			if (to == SURFEL_NONE)
				continue;
			for (int c = 0; c < 3; c++)
				sum[c] += cpu->exitance[to][c];
		}
		for (int c = 0; c < 3; c++) {
			double e = sum[c] / set->links_each;

			change = fmax(change, fabs(e - cpu->indirect[i][c]));
			most = fmax(most, e);
			cpu->indirect[i][c] = e;
		}
	}
	return most > 0 ? change / most : 0;
}

int surfel_cpu_settle(struct surfel_cpu *cpu)
{
	int gathers = 1;

	while (gather(cpu) > 1e-6 && gathers < GATHERS_MOST)
		gathers++;
	return gathers;
}

/* As shaders/gi_surfels.glsl has them. */
#define STIFF 0.01
#define LEAST 0.1

/* Sums of weights times 1, x, y; xx, xy, yy; and light times 1, x, y. */
struct moments {
	double m[3], mm[3], e[3][3];
};

static void add(struct moments *sums, const struct surfel_cpu *cpu, size_t i, double w, double x,
		double y)
{
	const double by[3] = { 1, x, y }, squares[3] = { x * x, x * y, y * y };

	for (int k = 0; k < 3; k++) {
		sums->m[k] += w * by[k];
		sums->mm[k] += w * squares[k];
		for (int c = 0; c < 3; c++)
			sums->e[k][c] += w * by[k] *
					 (cpu->indirect[i][c] + (double)cpu->set->fixed_other[i][c]);
	}
}

/* The plane through the surfels' light, weighed, at the point. */
static void fit(const struct moments *s, double out[3])
{
	double x = s->m[1] / s->m[0], y = s->m[2] / s->m[0];
	double xx = s->mm[0] / s->m[0] - x * x + STIFF, yy = s->mm[2] / s->m[0] - y * y + STIFF;
	double xy = s->mm[1] / s->m[0] - x * y, inverse = 1 / (xx * yy - xy * xy);

	for (int c = 0; c < 3; c++) {
		double e = s->e[0][c] / s->m[0];
		double gx = s->e[1][c] / s->m[0] - x * e, gy = s->e[2][c] / s->m[0] - y * e;

		out[c] = fmax(e - (x * (yy * gx - xy * gy) + y * (xx * gy - xy * gx)) * inverse,
			      LEAST * e);
	}
}

int surfel_cpu_irradiance(const struct surfel_cpu *cpu, const float position[3],
			  const float normal[3], double out[3])
{
	const struct surfel_set *set = cpu->set;
	const uint32_t *members;
	size_t count = surfel_set_cell(set, position, &members);
	struct moments sums = { { 0 }, { 0 }, { { 0 } } };
	float u[3], v[3];
	int heard = 0;

	surfel_frame(normal, u, v);
	for (size_t k = 0; k < count; k++) {
		double w = (double)surfel_weight(set, members[k], position, normal), x = 0, y = 0;

		for (int i = 0; i < 3; i++) {
			double d = (double)((position[i] - set->surfels[members[k]].position[i]) /
					    set->radius_m);

			x += d * (double)u[i];
			y += d * (double)v[i];
		}
		heard += w > 0;
		add(&sums, cpu, members[k], w, x, y);
	}
	memset(out, 0, 3 * sizeof *out);
	if (sums.m[0] > 0)
		fit(&sums, out);
	return heard;
}
