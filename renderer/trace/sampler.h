/*
 * Sample points: Owen-scrambled Sobol, shuffled and padded in pairs of
 * dimensions (Burley 2020, "Practical Hash-based Owen Scrambling", with
 * Vegdahl's constants for the hash). A set is SAMPLER_SET points: in each pair
 * of dimensions they are a scrambled (0,m,2)-net in base 2. Sets of other items
 * or numbers are scrambled independently, so means over sets are independent and
 * their spread is an honest error.
 *
 * Everything follows from (seed, item, set, index): equal on every machine, for
 * any number of threads. Pure; any thread.
 */
#ifndef GROTTO_RENDERER_TRACE_SAMPLER_H
#define GROTTO_RENDERER_TRACE_SAMPLER_H

#include <stdint.h>

#define SAMPLER_SET_BITS 4
#define SAMPLER_SET (1 << SAMPLER_SET_BITS)

struct sampler {
	uint64_t key;     /* of the set */
	uint32_t reversed; /* index of the point in the set, its bits in reverse */
};

/* splitmix64's finaliser (Steele et al. 2014; Stafford's variant 13). */
static inline uint64_t sampler_mix(uint64_t x)
{
	x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
	x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
	return x ^ (x >> 31);
}

#define SAMPLER_STEP UINT64_C(0x9e3779b97f4a7c15)

static inline struct sampler sampler_start(uint64_t seed, uint64_t item, uint64_t set)
{
	uint64_t key = sampler_mix(seed + SAMPLER_STEP);

	key = sampler_mix(key ^ (item + SAMPLER_STEP));
	return (struct sampler){ .key = sampler_mix(key ^ (set + SAMPLER_STEP)) };
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

static inline uint32_t sampler_reverse(uint32_t x)
{
	x = __builtin_bswap32(x);
	x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
	x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
	return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

/* A nested uniform scramble of bits given in reverse: each bit depends on those below it. */
static inline uint32_t sampler_permute(uint32_t x, uint32_t seed)
{
	x ^= x * 0x3d20adeau;
	x += seed;
	x *= (seed >> 16) | 1u;
	x ^= x * 0x05526c56u;
	x ^= x * 0x53a22864u;
	return x;
}

/* The second Sobol coordinate of an index below 16, its bits in reverse. */
static inline uint32_t sampler_second(uint32_t index)
{
	return (0x1u & (0u - (index & 1u))) ^ (0x3u & (0u - (index >> 1 & 1u))) ^
	       (0x5u & (0u - (index >> 2 & 1u))) ^ (0xfu & (0u - (index >> 3)));
}

static inline float sampler_float(uint32_t reversed)
{
	/* 24 bits: below 1 in float */
	return (float)(sampler_reverse(reversed) >> 8) * 0x1p-24f;
}

/* Two numbers in [0, 1) of pair `pair`. */
static inline void sampler_pair(const struct sampler *s, uint32_t pair, float out[2])
{
	uint64_t seeds = sampler_mix(s->key + (pair + 1) * SAMPLER_STEP);
	/* shuffled as Owen scrambling shuffles: aligned blocks stay blocks */
	uint32_t index = sampler_reverse_index(
		sampler_permute(s->reversed, (uint32_t)(seeds >> 16)) & 15u);

	/* the first Sobol coordinate, its bits in reverse, is the index itself */
	out[0] = sampler_float(sampler_permute(index, (uint32_t)(seeds >> 32)));
	out[1] = sampler_float(sampler_permute(sampler_second(index), (uint32_t)seeds));
}

#endif
