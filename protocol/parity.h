/*
 * Parity fragments of a message that is cut into several: with k fragments and m of
 * parity, any k of the k + m give the message. A systematic Cauchy code over GF(2^8)
 * (J. Bloemer et al., An XOR-Based Erasure-Resilient Coding Scheme, ICSI TR-95-048),
 * computed by ISA-L: parity fragment i, numbered from k on, is the sum over the
 * fragments j of f_j / (i XOR j). Which fragments are lost does not matter, only how
 * many: a burst is no worse than single losses.
 *
 * Pure functions on the caller's memory; thread safe, no allocation.
 */
#ifndef GROTTO_PROTOCOL_PARITY_H
#define GROTTO_PROTOCOL_PARITY_H

#include "protocol/wire.h"

/* More of them would be a second message: half as many as the message has, rounded up. 0 for one fragment. */
static inline unsigned fdp_parity_most(unsigned count)
{
	const unsigned half = (count + 1) / 2;

	return count < 2 ? 0 : half < FDP_PARITY_MAX ? half : FDP_PARITY_MAX;
}

/*
 * Parity fragments count .. count + parity - 1 of a message of `count` fragments of
 * `chunk` bytes; message has count * chunk bytes (those after its end zero), out room
 * for parity * chunk. count 2..FDP_FRAGMENTS_MAX, parity 1..FDP_PARITY_MAX.
 */
void fdp_parity_make(const uint8_t *message, size_t chunk, unsigned count, unsigned parity,
		     uint8_t *out);

/*
 * The fragments that are missing, into their place in message, which holds the others
 * as above. lost: their indices; rows: as many parity fragments, 0..FDP_PARITY_MAX - 1,
 * which stand at parity + row * chunk. n 1..FDP_PARITY_MAX.
 */
void fdp_parity_heal(uint8_t *message, size_t chunk, unsigned count, const uint8_t *parity,
		     const uint8_t *lost, const uint8_t *rows, unsigned n);

#endif
