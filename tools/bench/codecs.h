/*
 * Ways to pack a message, for bench-packing: the protocol's LZO1X-1, and LZ4 and
 * zstd where configure found them. One thread for each work.
 */
#ifndef GROTTO_TOOLS_BENCH_CODECS_H
#define GROTTO_TOOLS_BENCH_CODECS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CODECS 4

struct codec_work; /* memory that they work in */

struct codec {
	const char *name;
	int level;
	/* Bytes of the packed form, 0: no room or no memory. NULL: configure found no library of it. */
	size_t (*pack)(struct codec_work *work, int level, const uint8_t *from, size_t len, uint8_t *to,
		       size_t room);
	/* Gives exactly `len` bytes, or false. */
	bool (*unpack)(struct codec_work *work, const uint8_t *from, size_t packed_len, uint8_t *to, size_t len);
};
extern const struct codec codecs[CODECS];

/* NULL: there is no memory. */
struct codec_work *codec_work_create(void);
void codec_work_destroy(struct codec_work **work);

#endif
