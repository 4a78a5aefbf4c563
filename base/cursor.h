/*
 * Bounded cursors over bytes, little endian, with sticky failure: after the
 * first access out of bounds every read gives 0, every write is dropped, and
 * `ok` stays false. A decoder checks once, at its end, with
 * gr_reader_done(): ok and nothing left over.
 *
 * The bytes belong to the caller and must outlive the cursor.
 */
#ifndef GROTTO_BASE_CURSOR_H
#define GROTTO_BASE_CURSOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

struct gr_reader {
	const uint8_t *bytes;
	size_t len;
	size_t at;
	bool ok;
};

struct gr_writer {
	uint8_t *bytes;
	size_t size;
	size_t len;
	bool ok;
};

static inline struct gr_reader gr_reader(const void *bytes, size_t len)
{
	return (struct gr_reader){ bytes, len, 0, true };
}

static inline struct gr_writer gr_writer(void *bytes, size_t size)
{
	return (struct gr_writer){ bytes, size, 0, true };
}

static inline size_t gr_reader_left(const struct gr_reader *r)
{
	return r->ok ? r->len - r->at : 0;
}

static inline bool gr_reader_done(const struct gr_reader *r)
{
	return r->ok && r->at == r->len;
}

/* n bytes in place, or NULL (and sticky failure) when they are not there. */
static inline const uint8_t *gr_read_bytes(struct gr_reader *r, size_t n)
{
	const uint8_t *p;

	if (!r->ok || r->len - r->at < n) {
		r->ok = false;
		return NULL;
	}
	p = r->bytes + r->at;
	r->at += n;
	return p;
}

static inline uint8_t gr_read_u8(struct gr_reader *r)
{
	const uint8_t *p = gr_read_bytes(r, 1);
	return p ? p[0] : 0;
}

static inline uint16_t gr_read_u16(struct gr_reader *r)
{
	const uint8_t *p = gr_read_bytes(r, 2);
	return p ? (uint16_t)((unsigned)p[0] | (unsigned)p[1] << 8) : 0;
}

static inline uint32_t gr_read_u32(struct gr_reader *r)
{
	const uint8_t *p = gr_read_bytes(r, 4);
	return p ? (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24 : 0;
}

static inline uint64_t gr_read_u64(struct gr_reader *r)
{
	uint64_t low = gr_read_u32(r);
	uint64_t high = gr_read_u32(r);
	return low | high << 32;
}

static inline float gr_read_f32(struct gr_reader *r)
{
	uint32_t bits = gr_read_u32(r);
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

/*
 * A number in as few bytes as it needs: seven bits each, the lowest first, the
 * top bit of all but the last set. At most 10 bytes; there is one form of each
 * number, and any other is a failure.
 */
#define GR_VARINT_MOST 10
static inline uint64_t gr_read_varint(struct gr_reader *r)
{
	uint64_t value = 0;

	for (unsigned shift = 0; shift < 70; shift += 7) {
		const uint8_t byte = gr_read_u8(r);

		if (!r->ok || (shift == 63 && byte > 1) || (shift && !byte))
			break;
		value |= (uint64_t)(byte & 0x7f) << shift;
		if (!(byte & 0x80))
			return value;
	}
	r->ok = false;
	return 0;
}

static inline uint8_t *gr_write_room(struct gr_writer *w, size_t n)
{
	uint8_t *p;

	if (!w->ok || w->size - w->len < n) {
		w->ok = false;
		return NULL;
	}
	p = w->bytes + w->len;
	w->len += n;
	return p;
}

static inline void gr_write_bytes(struct gr_writer *w, const void *bytes, size_t n)
{
	uint8_t *p = gr_write_room(w, n);
	if (p && n)
		memcpy(p, bytes, n);
}

static inline void gr_write_u8(struct gr_writer *w, uint8_t v)
{
	uint8_t *p = gr_write_room(w, 1);
	if (p)
		p[0] = v;
}

static inline void gr_write_u16(struct gr_writer *w, uint16_t v)
{
	uint8_t *p = gr_write_room(w, 2);
	if (p) {
		p[0] = (uint8_t)v;
		p[1] = (uint8_t)(v >> 8);
	}
}

static inline void gr_write_u32(struct gr_writer *w, uint32_t v)
{
	uint8_t *p = gr_write_room(w, 4);
	if (p) {
		p[0] = (uint8_t)v;
		p[1] = (uint8_t)(v >> 8);
		p[2] = (uint8_t)(v >> 16);
		p[3] = (uint8_t)(v >> 24);
	}
}

static inline void gr_write_u64(struct gr_writer *w, uint64_t v)
{
	gr_write_u32(w, (uint32_t)v);
	gr_write_u32(w, (uint32_t)(v >> 32));
}

static inline void gr_write_varint(struct gr_writer *w, uint64_t v)
{
	for (; v >= 0x80; v >>= 7)
		gr_write_u8(w, (uint8_t)(v | 0x80));
	gr_write_u8(w, (uint8_t)v);
}

/* Small numbers of either sign as small ones without. */
static inline uint64_t gr_zigzag(int64_t v)
{
	return (uint64_t)v << 1 ^ (v < 0 ? UINT64_MAX : 0);
}

static inline int64_t gr_unzigzag(uint64_t v)
{
	return (int64_t)(v >> 1 ^ (v & 1 ? UINT64_MAX : 0));
}

static inline void gr_write_f32(struct gr_writer *w, float v)
{
	uint32_t bits;
	memcpy(&bits, &v, sizeof bits);
	gr_write_u32(w, bits);
}

#endif
