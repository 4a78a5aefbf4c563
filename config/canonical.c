#include "config/canonical.h"

#include "base/cursor.h"

#include <stdarg.h>
#include <stdio.h>
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

struct canonical_items canonical_items_start(const char *kind, struct gr_item *items, size_t room)
{
	struct canonical_items c = { .items = items, .room = items ? room : 0 };

	canonical_start(&c.whole, kind);
	return c;
}

static void end_item(struct canonical_items *c)
{
	uint8_t hash[32];

	if (!c->name[0])
		return;
	canonical_finish(&c->part, hash);
	crypto_generichash_update(&c->whole.state, hash, sizeof hash);
	if (c->count < c->room) {
		memcpy(c->items[c->count].name, c->name, sizeof c->name);
		memcpy(c->items[c->count].digest, hash, GR_ITEM_DIGEST);
	}
	c->count++;
}

struct canonical *canonical_item(struct canonical_items *c, const char *format, ...)
{
	va_list args;

	end_item(c);
	va_start(args, format);
	vsnprintf(c->name, sizeof c->name, format, args);
	va_end(args);
	canonical_start(&c->part, "part");
	return &c->part;
}

size_t canonical_items_finish(struct canonical_items *c, uint8_t out[32])
{
	end_item(c);
	canonical_finish(&c->whole, out);
	return c->count;
}
