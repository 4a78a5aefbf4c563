#include "protocol/parity.h"

#include <isa-l/erasure_code.h>
#include <string.h>

#define TABLE_BYTES 32 /* ISA-L's, of one coefficient */
#define AT_ONCE 6      /* rows that its fastest loops make of one pass over the sources */

_Static_assert(FDP_FRAGMENTS_MAX + FDP_PARITY_MAX <= 256, "each fragment needs an element of GF(2^8)");

/* Never of two equal numbers: parity is numbered from the end of the fragments on. */
static uint8_t coefficient(unsigned parity_index, unsigned index)
{
	return gf_inv((uint8_t)(parity_index ^ index));
}

/* out[r] = sum of matrix[r][j] * from[j], for at most AT_ONCE rows of `count` coefficients. */
static void combine(uint8_t *matrix, unsigned rows, uint8_t **from, unsigned count, size_t chunk,
		    uint8_t **out)
{
	uint8_t tables[TABLE_BYTES * AT_ONCE * FDP_FRAGMENTS_MAX];

	ec_init_tables((int)count, (int)rows, matrix, tables);
	ec_encode_data((int)chunk, (int)count, (int)rows, tables, from, out);
}

static unsigned rows_now(unsigned left)
{
	return left < AT_ONCE ? left : AT_ONCE;
}

void fdp_parity_make(const uint8_t *message, size_t chunk, unsigned count, unsigned parity,
		     uint8_t *out)
{
	uint8_t *from[FDP_FRAGMENTS_MAX], *to[AT_ONCE], matrix[AT_ONCE * FDP_FRAGMENTS_MAX];

	for (unsigned j = 0; j < count; j++)
		from[j] = (uint8_t *)message + j * chunk; /* ISA-L reads only */
	for (unsigned done = 0, rows; done < parity; done += rows) {
		rows = rows_now(parity - done);
		for (unsigned r = 0; r < rows; r++) {
			for (unsigned j = 0; j < count; j++)
				matrix[r * count + j] = coefficient(count + done + r, j);
			to[r] = out + (done + r) * chunk;
		}
		combine(matrix, rows, from, count, chunk, to);
	}
}

/* Of the coefficients that the lost fragments have in these parity fragments. */
static void invert(unsigned count, const uint8_t *lost, const uint8_t *rows, unsigned n,
		   uint8_t *inverse)
{
	uint8_t matrix[FDP_PARITY_MAX * FDP_PARITY_MAX];

	for (unsigned r = 0; r < n; r++)
		for (unsigned c = 0; c < n; c++)
			matrix[r * n + c] = coefficient(count + rows[r], lost[c]);
	/* Every square part of a Cauchy matrix has an inverse. */
	gf_invert_matrix(matrix, inverse, (int)n);
}

/* A lost fragment as a sum of what is there; in the place of each lost one stands its parity fragment. */
static void write_row(uint8_t *out, unsigned count, const uint8_t *inverse, const uint8_t *lost,
		      const uint8_t *rows, unsigned n)
{
	unsigned next = 0;

	for (unsigned j = 0; j < count; j++) {
		uint8_t sum = 0;

		if (next < n && lost[next] == j) {
			out[j] = inverse[next++];
			continue;
		}
		for (unsigned r = 0; r < n; r++)
			sum ^= gf_mul(inverse[r], coefficient(count + rows[r], j));
		out[j] = sum;
	}
}

void fdp_parity_heal(uint8_t *message, size_t chunk, unsigned count, const uint8_t *parity,
		     const uint8_t *lost, const uint8_t *rows, unsigned n)
{
	uint8_t *from[FDP_FRAGMENTS_MAX], *to[AT_ONCE], matrix[AT_ONCE * FDP_FRAGMENTS_MAX];
	uint8_t inverse[FDP_PARITY_MAX * FDP_PARITY_MAX];

	invert(count, lost, rows, n, inverse);
	for (unsigned j = 0; j < count; j++)
		from[j] = message + j * chunk;
	for (unsigned i = 0; i < n; i++)
		from[lost[i]] = (uint8_t *)parity + rows[i] * chunk;
	for (unsigned done = 0, now; done < n; done += now) {
		now = rows_now(n - done);
		for (unsigned r = 0; r < now; r++) {
			write_row(matrix + r * count, count, inverse + (done + r) * n, lost, rows, n);
			to[r] = message + lost[done + r] * chunk;
		}
		combine(matrix, now, from, count, chunk, to);
	}
}
