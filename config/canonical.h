/*
 * The canonical form of a configuration: values as little-endian bytes in a
 * fixed order, hashed as they come, so that the same values on two machines
 * give the same 32 bytes. Private to config/.
 */
#ifndef GROTTO_CONFIG_CANONICAL_H
#define GROTTO_CONFIG_CANONICAL_H

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

#endif
