/* What is packed. Private to bench-packing. */
#ifndef GROTTO_TOOLS_BENCH_PACKING_H
#define GROTTO_TOOLS_BENCH_PACKING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A message, copied by whoever takes it. False: no more. */
typedef bool packing_keep_fn(void *ctx, const uint8_t *bytes, size_t len);

/*
 * The slices that the first of `nodes` nodes sends of a scene's shared light, one a
 * frame, while its first lamp moves 8 mm in each: drawn here, without a display. False,
 * said on stderr or in the log: the scene cannot be drawn, or its light not be shared.
 */
bool packing_light(const char *scene, unsigned nodes, unsigned frames, packing_keep_fn *keep, void *ctx);

#endif
