/*
 * A token bucket: what may be sent besides the frame. Full at first; refused
 * bytes are not owed, who wants them asks again.
 */
#ifndef GROTTO_PROTOCOL_BUCKET_H
#define GROTTO_PROTOCOL_BUCKET_H

#include <stdbool.h>
#include <stdint.h>

struct fdp_rate {
	uint64_t bytes_s; /* under 2^33 */
	uint64_t burst;   /* bytes; holds the longest single one */
};

struct fdp_bucket {
	int64_t at_ns; /* when `left` was right; 0: never used */
	uint64_t left;
};

static inline void fdp_bucket_fill(struct fdp_bucket *b, const struct fdp_rate *rate, int64_t now_ns)
{
	const int64_t ns = now_ns - b->at_ns;
	uint64_t more;

	if (!b->at_ns || ns > INT64_C(1000000000)) {
		b->left = rate->burst;
		b->at_ns = now_ns;
		return;
	}
	more = ns > 0 ? (uint64_t)ns * rate->bytes_s / 1000000000u : 0;
	if (!more)
		return; /* what is less than a byte is not lost */
	b->left = b->left + more < rate->burst ? b->left + more : rate->burst;
	b->at_ns = now_ns;
}

#endif
