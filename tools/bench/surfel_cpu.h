/*
 * Relit surfels on the CPU, plainly: what the GPU's result is compared with,
 * and the accuracy of a set by itself.
 */
#ifndef GROTTO_TOOLS_BENCH_SURFEL_CPU_H
#define GROTTO_TOOLS_BENCH_SURFEL_CPU_H

#include "renderer/gi/surfel_set.h"
#include "tools/bench/truth.h"

struct surfel_cpu {
	const struct surfel_set *set;
	double (*lamps)[3];    /* E of the lamps, mean over the taps */
	double (*indirect)[3]; /* E_indirect */
	double (*exitance)[3]; /* B */
};
/* Aborts when out of memory: tests only. The set must outlive it. */
void surfel_cpu_init(struct surfel_cpu *out, const struct surfel_set *set);
void surfel_cpu_finish(struct surfel_cpu *cpu);
/* Sets `lamps` to the spot's light; needs the truth's rays. */
void surfel_cpu_spot(struct surfel_cpu *cpu, const struct truth *truth);
/* Gathers until nothing changes by more than a millionth; returns how often. */
int surfel_cpu_settle(struct surfel_cpu *cpu);
/*
 * Indirect irradiance as shading has it: E_indirect and fixed_other. Returns
 * the number of surfels heard.
 */
int surfel_cpu_irradiance(const struct surfel_cpu *cpu, const float position[3],
			  const float normal[3], double out[3]);

#endif
