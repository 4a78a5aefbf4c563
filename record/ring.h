/*
 * A queue of messages in a ring of bytes, from one thread to another without
 * a lock: neither side ever waits for the other. Bounded: what does not fit is
 * refused.
 *
 * Threads: one puts, one takes. Init and finish while neither runs.
 */
#ifndef GROTTO_RECORD_RING_H
#define GROTTO_RECORD_RING_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct record_ring {
	uint8_t *bytes;
	size_t size; /* a power of two */
	/* Bytes ever put and taken, so far apart that they share no cache line. */
	_Atomic uint64_t put;
	uint8_t apart[64];
	_Atomic uint64_t taken;
};

/* size: a power of two, at least 64. GR_OK, GR_ERR_RANGE, GR_ERR_NOMEM. */
int record_ring_init(struct record_ring *ring, size_t size);
void record_ring_finish(struct record_ring *ring);

/* Copies a message in. False when there is no room for it now. */
bool record_ring_put(struct record_ring *ring, const void *bytes, uint32_t len);
/* The oldest message in place, NULL when there is none; stays until record_ring_drop. */
const uint8_t *record_ring_peek(struct record_ring *ring, uint32_t *out_len);
void record_ring_drop(struct record_ring *ring);

#endif
