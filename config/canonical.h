/*
 * The canonical form of a configuration: values as little-endian bytes in a
 * fixed order, hashed as they come, so that the same values on two machines
 * give the same 32 bytes. Private to config/.
 */
#ifndef GROTTO_CONFIG_CANONICAL_H
#define GROTTO_CONFIG_CANONICAL_H

#include "base/item.h"

#include <sodium.h>
#include <stddef.h>
#include <stdint.h>

struct canonical {
	crypto_generichash_state state;
};

/* kind separates layouts from scenes, and one form from its successor. */
void canonical_start(struct canonical *canonical, const char *kind);
void canonical_u64(struct canonical *canonical, uint64_t value);
/* -0 counts as 0. */
void canonical_floats(struct canonical *canonical, const float *values, size_t count);
/* NULL differs from "". */
void canonical_string(struct canonical *canonical, const char *text);
void canonical_finish(struct canonical *canonical, uint8_t out[32]);

/*
 * The same part by part: the hash is that of the parts' hashes, so that two
 * forms that differ do so in a part that has a name.
 */
struct canonical_items {
	struct canonical whole, part;
	struct gr_item *items; /* NULL: only the hash is wanted */
	size_t room, count;    /* count: parts there are, whether or not there was room */
	char name[GR_ITEM_NAME];
};

struct canonical_items canonical_items_start(const char *kind, struct gr_item *items, size_t room);
/* What is written to the result from now on belongs to the part of this name. */
struct canonical *canonical_item(struct canonical_items *c, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
/* The number of parts. */
size_t canonical_items_finish(struct canonical_items *c, uint8_t out[32]);

#endif
