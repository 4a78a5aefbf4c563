#include "record/ring.h"

#include "base/result.h"

#include <stdlib.h>
#include <string.h>

/*
 * A message is a length, its bytes, and padding to eight. One that would run
 * over the ring's end begins at its start instead, after a word that says so.
 */
#define WORD 8
#define TURN UINT32_MAX

static uint64_t rounded(uint32_t len)
{
	return (WORD + (uint64_t)len + WORD - 1) / WORD * WORD;
}

int record_ring_init(struct record_ring *ring, size_t size)
{
	if (size < 64 || (size & (size - 1)) != 0)
		return GR_ERR_RANGE;
	ring->bytes = malloc(size);
	ring->size = size;
	atomic_init(&ring->put, 0);
	atomic_init(&ring->taken, 0);
	return ring->bytes ? GR_OK : GR_ERR_NOMEM;
}

void record_ring_finish(struct record_ring *ring)
{
	free(ring->bytes);
	ring->bytes = NULL;
}

bool record_ring_put(struct record_ring *ring, const void *bytes, uint32_t len)
{
	uint64_t put = atomic_load_explicit(&ring->put, memory_order_relaxed);
	const uint64_t taken = atomic_load_explicit(&ring->taken, memory_order_acquire);
	const uint64_t need = rounded(len), to_end = ring->size - (put & (ring->size - 1));
	const uint64_t turn = need > to_end ? to_end : 0;
	uint8_t *at;

	if (need + turn > ring->size - (put - taken))
		return false;
	if (turn) {
		const uint32_t word = TURN;
		memcpy(ring->bytes + (put & (ring->size - 1)), &word, sizeof word);
		put += turn;
	}
	at = ring->bytes + (put & (ring->size - 1));
	memcpy(at, &len, sizeof len);
	memcpy(at + WORD, bytes, len);
	atomic_store_explicit(&ring->put, put + need, memory_order_release);
	return true;
}

const uint8_t *record_ring_peek(struct record_ring *ring, uint32_t *out_len)
{
	const uint64_t put = atomic_load_explicit(&ring->put, memory_order_acquire);
	uint64_t taken = atomic_load_explicit(&ring->taken, memory_order_relaxed);
	const uint8_t *at = ring->bytes + (taken & (ring->size - 1));

	if (put == taken)
		return NULL;
	memcpy(out_len, at, sizeof *out_len);
	if (*out_len == TURN) {
		taken += ring->size - (taken & (ring->size - 1));
		atomic_store_explicit(&ring->taken, taken, memory_order_release);
		at = ring->bytes;
		memcpy(out_len, at, sizeof *out_len);
	}
	return at + WORD;
}

void record_ring_drop(struct record_ring *ring)
{
	const uint64_t taken = atomic_load_explicit(&ring->taken, memory_order_relaxed);
	uint32_t len;

	memcpy(&len, ring->bytes + (taken & (ring->size - 1)), sizeof len);
	atomic_store_explicit(&ring->taken, taken + rounded(len), memory_order_release);
}
