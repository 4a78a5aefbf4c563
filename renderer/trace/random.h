/*
 * What all sample points are made of: keys by hashing, and Owen scrambling of
 * Sobol's numbers, whose bits are kept in reverse (Burley 2020, "Practical
 * Hash-based Owen Scrambling", with Vegdahl's constants for the hash). Pure; any
 * thread; equal on every machine.
 */
#ifndef GROTTO_RENDERER_TRACE_RANDOM_H
#define GROTTO_RENDERER_TRACE_RANDOM_H

#include <stdint.h>

#define RANDOM_STEP UINT64_C(0x9e3779b97f4a7c15)

/* splitmix64's finaliser (Steele et al. 2014; Stafford's variant 13). */
static inline uint64_t random_mix(uint64_t x)
{
	x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
	x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
	return x ^ (x >> 31);
}

/* The key of an item of what a key stands for. */
static inline uint64_t random_item(uint64_t key, uint64_t item)
{
	return random_mix(key ^ (item + RANDOM_STEP));
}

static inline uint64_t random_start(uint64_t seed, uint64_t item)
{
	return random_item(random_mix(seed + RANDOM_STEP), item);
}

static inline uint32_t random_reverse(uint32_t x)
{
	x = __builtin_bswap32(x);
	x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
	x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
	return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

/* A nested uniform scramble of bits given in reverse: each bit depends on those below it. */
static inline uint32_t random_scramble(uint32_t x, uint32_t seed)
{
	x ^= x * 0x3d20adeau;
	x += seed;
	x *= (seed >> 16) | 1u;
	x ^= x * 0x05526c56u;
	x ^= x * 0x53a22864u;
	return x;
}

/* Of bits in reverse, in [0, 1): 24 of them, so that it is below 1 in float. */
static inline float random_share(uint32_t reversed)
{
	return (float)(random_reverse(reversed) >> 8) * 0x1p-24f;
}

#endif
