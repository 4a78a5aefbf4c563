#include "protocol/pack.h"

#include "protocol/wire.h"

#include "base/result.h"

#include <lzo/lzo1x.h>
#include <stdlib.h>

/* What LZO1X-1 may write for incompressible input (lzo's own documentation, LZO.FAQ). */
#define PACKED_MAX (FDP_MESSAGE_MAX + FDP_MESSAGE_MAX / 16 + 64 + 3)

struct fdp_packer {
	_Alignas(16) uint8_t work[LZO1X_1_MEM_COMPRESS];
	uint8_t packed[PACKED_MAX];
};

int fdp_packer_create(struct fdp_packer **out)
{
	*out = NULL;
	if (lzo_init() != LZO_E_OK)
		return GR_ERR_UNSUPPORTED;
	*out = calloc(1, sizeof **out);
	return *out ? GR_OK : GR_ERR_NOMEM;
}

void fdp_packer_destroy(struct fdp_packer **packer)
{
	free(*packer);
	*packer = NULL;
}

int fdp_pack(struct fdp_packer *packer, const uint8_t *bytes, size_t len,
	     const uint8_t **out_bytes, size_t *out_len)
{
	lzo_uint packed_len = PACKED_MAX;

	if (!len || len > FDP_MESSAGE_MAX)
		return GR_ERR_RANGE;
	if (lzo1x_1_compress(bytes, len, packer->packed, &packed_len, packer->work) != LZO_E_OK ||
	    packed_len >= len)
		return GR_NOTHING;
	*out_bytes = packer->packed;
	*out_len = packed_len;
	return GR_OK;
}

int fdp_unpack(const uint8_t *bytes, size_t len, uint8_t *plain, size_t plain_len)
{
	lzo_uint got = plain_len;

	if (lzo1x_decompress_safe(bytes, len, plain, &got, NULL) != LZO_E_OK || got != plain_len)
		return GR_ERR_FORMAT;
	return GR_OK;
}
