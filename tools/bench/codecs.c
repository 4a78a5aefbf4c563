#include <config.h>

#include "tools/bench/codecs.h"

#include <lzo/lzo1x.h>
#include <stdlib.h>
#ifdef HAVE_LZ4
#include <lz4.h>
#endif
#ifdef HAVE_ZSTD
#include <zstd.h>
#endif

/* As in a daemon, each keeps its working memory. */
struct codec_work {
	void *lzo, *lz4;
	void *zstd_pack, *zstd_unpack;
};

static size_t lzo_pack(struct codec_work *work, int level, const uint8_t *from, size_t len, uint8_t *to,
		       size_t room)
{
	lzo_uint packed_len = room;

	(void)level;
	return lzo1x_1_compress(from, len, to, &packed_len, work->lzo) == LZO_E_OK ? packed_len : 0;
}

static bool lzo_unpack(struct codec_work *work, const uint8_t *from, size_t packed_len, uint8_t *to, size_t len)
{
	lzo_uint got = len;

	(void)work;
	return lzo1x_decompress_safe(from, packed_len, to, &got, NULL) == LZO_E_OK && got == len;
}

#ifdef HAVE_LZ4
static size_t lz4_pack(struct codec_work *work, int level, const uint8_t *from, size_t len, uint8_t *to,
		       size_t room)
{
	const int n = LZ4_compress_fast_extState(work->lz4, (const char *)from, (char *)to, (int)len, (int)room,
						 level);

	return n > 0 ? (size_t)n : 0;
}

static bool lz4_unpack(struct codec_work *work, const uint8_t *from, size_t packed_len, uint8_t *to, size_t len)
{
	(void)work;
	return LZ4_decompress_safe((const char *)from, (char *)to, (int)packed_len, (int)len) == (int)len;
}
#else
#define lz4_pack NULL
#define lz4_unpack NULL
#endif

#ifdef HAVE_ZSTD
static size_t zstd_pack(struct codec_work *work, int level, const uint8_t *from, size_t len, uint8_t *to,
		       size_t room)
{
	const size_t n = ZSTD_compressCCtx(work->zstd_pack, to, room, from, len, level);

	return ZSTD_isError(n) ? 0 : n;
}

static bool zstd_unpack(struct codec_work *work, const uint8_t *from, size_t packed_len, uint8_t *to, size_t len)
{
	return ZSTD_decompressDCtx(work->zstd_unpack, to, len, from, packed_len) == len;
}
#else
#define zstd_pack NULL
#define zstd_unpack NULL
#endif

const struct codec codecs[CODECS] = {
	{ "LZO1X-1", 0, lzo_pack, lzo_unpack },
	{ "LZ4", 1, lz4_pack, lz4_unpack },
	{ "zstd -1", 1, zstd_pack, zstd_unpack },
	{ "zstd -3", 3, zstd_pack, zstd_unpack },
};

struct codec_work *codec_work_create(void)
{
	struct codec_work *work = calloc(1, sizeof *work);
	bool ok = work && lzo_init() == LZO_E_OK && (work->lzo = malloc(LZO1X_1_MEM_COMPRESS)) != NULL;

#ifdef HAVE_LZ4
	ok = ok && (work->lz4 = malloc((size_t)LZ4_sizeofState())) != NULL;
#endif
#ifdef HAVE_ZSTD
	ok = ok && (work->zstd_pack = ZSTD_createCCtx()) != NULL &&
	     (work->zstd_unpack = ZSTD_createDCtx()) != NULL;
#endif
	if (!ok)
		codec_work_destroy(&work);
	return work;
}

void codec_work_destroy(struct codec_work **work)
{
	struct codec_work *w = *work;

	*work = NULL;
	if (!w)
		return;
#ifdef HAVE_ZSTD
	ZSTD_freeCCtx(w->zstd_pack);
	ZSTD_freeDCtx(w->zstd_unpack);
#endif
	free(w->lz4);
	free(w->lzo);
	free(w);
}
