/*
 * XXH64 (Yann Collet's specification of XXH64, 0.1.1) with seed 0: a hash that tells
 * accidents apart, several bytes a cycle. It resists nobody who chooses the bytes.
 */
#ifndef GROTTO_BASE_HASH64_H
#define GROTTO_BASE_HASH64_H

#include <stddef.h>
#include <stdint.h>

/* The same on machines of either byte order. */
uint64_t gr_hash64(const void *bytes, size_t len);

#endif
