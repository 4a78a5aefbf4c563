#include "base/hash64.h"

#include "base/cursor.h"

#define STRIPE 32 /* bytes, a word to each of four lanes */
#define PRIME1 UINT64_C(0x9E3779B185EBCA87)
#define PRIME2 UINT64_C(0xC2B2AE3D27D4EB4F)
#define PRIME3 UINT64_C(0x165667B19E3779F9)
#define PRIME4 UINT64_C(0x85EBCA77C2B2AE63)
#define PRIME5 UINT64_C(0x27D4EB2F165667C5)

static uint64_t turn(uint64_t v, unsigned bits)
{
	return v << bits | v >> (64 - bits);
}

/* Written so that compilers see one load. */
static uint64_t word(const uint8_t *p)
{
	return (uint64_t)p[0] | (uint64_t)p[1] << 8 | (uint64_t)p[2] << 16 | (uint64_t)p[3] << 24 |
	       (uint64_t)p[4] << 32 | (uint64_t)p[5] << 40 | (uint64_t)p[6] << 48 | (uint64_t)p[7] << 56;
}

static uint64_t mix(uint64_t lane, uint64_t value)
{
	return turn(lane + value * PRIME2, 31) * PRIME1;
}

static uint64_t merge(uint64_t hash, uint64_t lane)
{
	return (hash ^ mix(0, lane)) * PRIME1 + PRIME4;
}

static uint64_t hash_stripes(const uint8_t *p, size_t stripes)
{
	uint64_t a = PRIME1 + PRIME2, b = PRIME2, c = 0, d = 0 - PRIME1, h;

	for (; stripes; stripes--, p += STRIPE) {
		a = mix(a, word(p));
		b = mix(b, word(p + 8));
		c = mix(c, word(p + 16));
		d = mix(d, word(p + 24));
	}
	h = turn(a, 1) + turn(b, 7) + turn(c, 12) + turn(d, 18);
	return merge(merge(merge(merge(h, a), b), c), d);
}

uint64_t gr_hash64(const void *bytes, size_t len)
{
	const size_t stripes = len / STRIPE;
	struct gr_reader r = gr_reader((const uint8_t *)bytes + stripes * STRIPE, len % STRIPE);
	uint64_t h = (stripes ? hash_stripes(bytes, stripes) : PRIME5) + len;

	while (gr_reader_left(&r) >= 8)
		h = turn(h ^ mix(0, gr_read_u64(&r)), 27) * PRIME1 + PRIME4;
	if (gr_reader_left(&r) >= 4)
		h = turn(h ^ gr_read_u32(&r) * PRIME1, 23) * PRIME2 + PRIME3;
	while (gr_reader_left(&r))
		h = turn(h ^ gr_read_u8(&r) * PRIME5, 11) * PRIME1;
	h = (h ^ h >> 33) * PRIME2;
	h = (h ^ h >> 29) * PRIME3;
	return h ^ h >> 32;
}
