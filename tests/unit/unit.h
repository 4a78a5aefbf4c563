/* What every unit test needs: cmocka's includes in its order, and a seeded sweep. */
#ifndef GROTTO_TESTS_UNIT_H
#define GROTTO_TESTS_UNIT_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

/* PCG32 (O'Neill 2014): property sweeps print their seed and take GROTTO_TEST_SEED. */
struct unit_random {
	uint64_t state;
};

static inline uint32_t unit_random_u32(struct unit_random *r)
{
	uint64_t old = r->state;
	uint32_t xored = (uint32_t)(((old >> 18) ^ old) >> 27);
	uint32_t turn = (uint32_t)(old >> 59);

	r->state = old * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (xored >> turn) | (xored << ((32 - turn) & 31));
}

/* Uniform in [low, high). */
static inline double unit_random_range(struct unit_random *r, double low, double high)
{
	return low + (high - low) * (unit_random_u32(r) * 0x1p-32);
}

/* 0..n-1 in any order (Fisher and Yates). */
static inline void unit_shuffle(struct unit_random *r, unsigned *order, unsigned n)
{
	for (unsigned i = 0; i < n; i++)
		order[i] = i;
	for (unsigned i = n; i > 1; i--) {
		const unsigned k = unit_random_u32(r) % i, t = order[i - 1];

		order[i - 1] = order[k];
		order[k] = t;
	}
}

static inline struct unit_random unit_random_start(const char *name)
{
	const char *given = getenv("GROTTO_TEST_SEED");
	uint64_t seed = given ? strtoull(given, NULL, 0) : (uint64_t)time(NULL);
	struct unit_random r = { seed * 2 + 1 };

	printf("# %s: seed %llu (GROTTO_TEST_SEED repeats it)\n", name, (unsigned long long)seed);
	unit_random_u32(&r);
	return r;
}

/* A heap copy of exactly len bytes, so that a sanitizer sees one byte read too many. */
static __attribute__((noinline, unused)) uint8_t *unit_copy(const void *bytes, size_t len)
{
	uint8_t *copy = malloc(len ? len : 1);

	if (!copy)
		abort();
	if (len)
		memcpy(copy, bytes, len);
	return copy;
}

/* Three floats are those numbers, to 1e-6. */
static inline void assert_vector(const float *v, double x, double y, double z)
{
	assert_true(fabs((double)v[0] - x) < 1e-6);
	assert_true(fabs((double)v[1] - y) < 1e-6);
	assert_true(fabs((double)v[2] - z) < 1e-6);
}

#endif
