#include "config/canonical.h"

#include "base/cursor.h"

#include <string.h>

void canonical_start(struct canonical *canonical, const char *kind)
{
	crypto_generichash_init(&canonical->state, NULL, 0, 32);
	canonical_string(canonical, kind);
}

void canonical_u64(struct canonical *canonical, uint64_t value)
{
	uint8_t bytes[8];
	struct gr_writer writer = gr_writer(bytes, sizeof bytes);

	gr_write_u64(&writer, value);
	crypto_generichash_update(&canonical->state, bytes, sizeof bytes);
}

void canonical_floats(struct canonical *canonical, const float *values, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		uint8_t bytes[4];
		struct gr_writer writer = gr_writer(bytes, sizeof bytes);

		gr_write_f32(&writer, values[i] + 0.0f);
		crypto_generichash_update(&canonical->state, bytes, sizeof bytes);
	}
}

void canonical_string(struct canonical *canonical, const char *text)
{
	size_t len = text ? strlen(text) : 0;

	canonical_u64(canonical, text ? len + 1 : 0);
	if (len)
		crypto_generichash_update(&canonical->state, (const unsigned char *)text, len);
}

void canonical_finish(struct canonical *canonical, uint8_t out[32])
{
	crypto_generichash_final(&canonical->state, out, 32);
}
