/*
 * Numbers for the baker: PCG32 (O'Neill 2014) streams, and Owen-scrambled Sobol
 * points in three dimensions for any number of points (Sobol 1967; trace/random.h).
 * Each point by itself is uniform, so a mean over any number of them is unbiased.
 * Pure; any thread.
 */
#ifndef GROTTO_RENDERER_GI_SURFEL_RANDOM_H
#define GROTTO_RENDERER_GI_SURFEL_RANDOM_H

#include "renderer/trace/random.h"

#include <stdint.h>

static inline uint32_t random_u32(uint64_t *state)
{
	uint64_t old = *state;
	uint32_t x = (uint32_t)(((old >> 18) ^ old) >> 27);
	uint32_t turn = (uint32_t)(old >> 59);

	*state = old * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (x >> turn) | (x << ((32 - turn) & 31));
}

/* In [0, 1). */
static inline double random_uniform(uint64_t *state)
{
	return random_u32(state) * 0x1p-32;
}

/*
 * Point `index` of the sequence as it is, below 2^16 points, each coordinate's bits
 * in reverse: the same for all sets, so that who needs many sets has a table.
 */
static inline void sobol_raw(uint32_t index, uint32_t out[3])
{
	uint32_t second = 0, third = 0;
	/* direction numbers of the polynomials x + 1 and x^2 + x + 1 (Joe and Kuo: m = 1; 1 3) */
	uint32_t v2 = 1u << 31, a = 1u << 31, b = 3u << 30;

	for (uint32_t i = index; i; i >>= 1) {
		uint32_t c = a ^ b ^ (a >> 2);

		if (i & 1) {
			second ^= v2;
			third ^= a;
		}
		v2 ^= v2 >> 1;
		a = b;
		b = c;
	}
	out[0] = index;
	out[1] = random_reverse(second);
	out[2] = random_reverse(third);
}

/* What scrambles the set of a key. */
static inline void sobol_seeds(uint64_t key, uint32_t out[3])
{
	for (uint32_t d = 0; d < 3; d++)
		out[d] = (uint32_t)(random_mix(key + d * RANDOM_STEP) >> 32);
}

static inline void sobol_owen(const uint32_t raw[3], const uint32_t seeds[3], float out[3])
{
	for (int d = 0; d < 3; d++)
		out[d] = random_share(random_scramble(raw[d], seeds[d]));
}

/* Point `index` of the set of a key; all coordinates in [0, 1). */
static inline void sobol_point(uint64_t key, uint32_t index, float out[3])
{
	uint32_t raw[3], seeds[3];

	sobol_raw(index, raw);
	sobol_seeds(key, seeds);
	sobol_owen(raw, seeds, out);
}

#endif
