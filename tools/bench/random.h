/* PCG32 (O'Neill 2014) for benches: the same numbers from the same seed everywhere. */
#ifndef GROTTO_TOOLS_BENCH_RANDOM_H
#define GROTTO_TOOLS_BENCH_RANDOM_H

#include <math.h>
#include <stdint.h>

struct bench_random {
	uint64_t state;
};

static inline uint32_t bench_random_u32(struct bench_random *r)
{
	const uint64_t old = r->state;
	const uint32_t mixed = (uint32_t)(((old >> 18) ^ old) >> 27), turn = (uint32_t)(old >> 59);

	r->state = old * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (mixed >> turn) | (mixed << ((32 - turn) & 31));
}

static inline struct bench_random bench_random_start(uint64_t seed)
{
	struct bench_random r = { seed * 2 + 1 };

	bench_random_u32(&r);
	return r;
}

/* Uniform in [low, high). */
static inline double bench_random_range(struct bench_random *r, double low, double high)
{
	return low + (high - low) * (bench_random_u32(r) * 0x1p-32);
}

/* Of mean 0 and standard deviation 1 (Box and Muller 1958). */
static inline double bench_random_normal(struct bench_random *r)
{
	const double u = (bench_random_u32(r) + 1.0) * 0x1p-32, a = bench_random_range(r, 0, 2 * M_PI);

	return sqrt(-2 * log(u)) * cos(a);
}

#endif
