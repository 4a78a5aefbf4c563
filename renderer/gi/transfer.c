#include "renderer/gi/transfer.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#define SAMPLES 4096

void transfer_lobe(const float direction[3], float out[4])
{
	const float c0 = 0.886226925f, c1 = 1.023326708f;

	out[0] = c0;
	out[1] = -c1 * direction[1];
	out[2] = c1 * direction[2];
	out[3] = -c1 * direction[0];
}

/* Uniform in 0..1, PCG32 (O'Neill 2014). */
static float uniform(uint64_t *state)
{
	uint64_t old = *state;
	uint32_t x = (uint32_t)(((old >> 18) ^ old) >> 27);
	uint32_t turn = (uint32_t)(old >> 59);

	*state = old * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (float)((x >> turn) | (x << ((32 - turn) & 31))) * 0x1p-32f;
}

/* Mean lobe over points of the cell inside the cone around its inscribed sphere. */
static void sample(int j, uint64_t *state, float out[4])
{
	const signed char *o = sector_offset[j];
	float distance = sqrtf((float)(sector_kind(j) + 1));
	float rim = sqrtf(1 - 0.25f / (distance * distance)); /* cosine of the cone */
	double sum[4] = { 0 };
	int found = 0;

	while (found < SAMPLES) {
		float p[3], length = 0, along = 0, lobe[4];

		for (int i = 0; i < 3; i++) {
			p[i] = (float)o[i] + uniform(state) - 0.5f;
			length += p[i] * p[i];
		}
		length = sqrtf(length);
		for (int i = 0; i < 3; i++) {
			p[i] /= length;
			along += p[i] * (float)o[i] / distance;
		}
		if (along < rim)
			continue;
		transfer_lobe(p, lobe);
		for (int i = 0; i < 4; i++)
			sum[i] += (double)lobe[i];
		found++;
	}
	for (int i = 0; i < 4; i++)
		out[i] = (float)(sum[i] / SAMPLES);
}

void transfer_init(struct transfer *t)
{
	uint64_t state = 20130413;
	double squares = 0, first = 0;

	for (int j = 0; j < SECTOR_COUNT; j++) {
		sample(j, &state, t->vector[j]);
		squares += (double)t->vector[j][0] * (double)t->vector[j][0];
		first += (double)t->vector[j][0];
	}
	t->kappa = 1 / sqrt(squares);
	for (int j = 0; j < SECTOR_COUNT; j++) {
		t->fraction[j] = (float)((double)t->vector[j][0] / first);
		for (int i = 0; i < 4; i++)
			t->vector[j][i] *= (float)t->kappa;
	}
}

void transfer_medium(float absorption, float scattering, float d, float *kept, float *scattered)
{
	float mean = 1.4164218f * d;
	float lambda_a = absorption > 0 ? powf(absorption, mean) : 0;
	float lambda_s = scattering > 0 ? powf(scattering, mean) : 0;

	*kept = 1 - lambda_a - lambda_s;
	*scattered = lambda_s * 3.5449077f;
}
