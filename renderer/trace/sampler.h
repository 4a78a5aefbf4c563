/*
 * Sample points: Owen-scrambled Sobol, shuffled and padded in pairs of
 * dimensions (Burley 2020; random.h). A set is SAMPLER_SET points: in each pair
 * of dimensions they are a scrambled (0,m,2)-net in base 2. Sets of other items
 * or numbers are scrambled independently, so means over sets are independent and
 * their spread is an honest error.
 *
 * Everything follows from (seed, item, set, index): equal on every machine, for
 * any number of threads. Pure; any thread.
 */
#ifndef GROTTO_RENDERER_TRACE_SAMPLER_H
#define GROTTO_RENDERER_TRACE_SAMPLER_H

#include "renderer/trace/random.h"

#include <stdint.h>

#define SAMPLER_SET_BITS 4
#define SAMPLER_SET (1 << SAMPLER_SET_BITS)

struct sampler {
	uint64_t key;	   /* of the set */
	uint32_t reversed; /* index of the point in the set, its bits in reverse */
};

static inline struct sampler sampler_start(uint64_t seed, uint64_t item, uint64_t set)
{
	return (struct sampler){ .key = random_item(random_start(seed, item), set) };
}

/* The four bits of a number below 16 in reverse. */
static inline uint32_t sampler_reverse_index(uint32_t x)
{
	return (uint32_t)(UINT64_C(0xf7b3d591e6a2c480) >> (4 * x)) & 15u;
}

/* index: below SAMPLER_SET. */
static inline void sampler_point(struct sampler *s, uint32_t index)
{
	s->reversed = sampler_reverse_index(index);
}

/* The second Sobol coordinate of an index below 16, its bits in reverse. */
static inline uint32_t sampler_second(uint32_t index)
{
	return (0x1u & (0u - (index & 1u))) ^ (0x3u & (0u - (index >> 1 & 1u))) ^
	       (0x5u & (0u - (index >> 2 & 1u))) ^ (0xfu & (0u - (index >> 3)));
}

/* Two numbers in [0, 1) of pair `pair`. */
static inline void sampler_pair(const struct sampler *s, uint32_t pair, float out[2])
{
	uint64_t seeds = random_mix(s->key + (pair + 1) * RANDOM_STEP);
	/* shuffled as Owen scrambling shuffles: aligned blocks stay blocks */
	uint32_t index =
		sampler_reverse_index(random_scramble(s->reversed, (uint32_t)(seeds >> 16)) & 15u);

	/* the first Sobol coordinate, its bits in reverse, is the index itself */
	out[0] = random_share(random_scramble(index, (uint32_t)(seeds >> 32)));
	out[1] = random_share(random_scramble(sampler_second(index), (uint32_t)seeds));
}

#endif
