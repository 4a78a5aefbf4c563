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

int surfel_cpu_irradiance(const struct surfel_cpu *cpu, const float position[3],
			  const float normal[3], double out[3])
{
	const struct surfel_set *set = cpu->set;
	const uint32_t *members;
	size_t count = surfel_set_cell(set, position, &members);
	double weights = 0, sum[3] = { 0 };
	int heard = 0;

	for (size_t k = 0; k < count; k++) {
		size_t i = members[k];
		double w = (double)surfel_weight(set, i, position, normal);

		weights += w;
		heard += w > 0;
		for (int c = 0; c < 3; c++)
			sum[c] += w * (cpu->indirect[i][c] + (double)set->fixed_other[i][c]);
	}
	for (int c = 0; c < 3; c++)
		out[c] = weights > 0 ? sum[c] / weights : 0;
	return heard;
}
