/*
 * Work groups in two dimensions: GL 4.5 promises no more than 65535 groups on
 * an axis. Shaders take the group's number as x + y * groups_x and leave out
 * what lies past the end.
 */
#ifndef GROTTO_RENDERER_GI_DISPATCH_H
#define GROTTO_RENDERER_GI_DISPATCH_H

#include <stdint.h>

#define DISPATCH_AXIS_MAX 65535u

struct dispatch {
	uint32_t x, y;
};

/* For `items` in groups of `group` (> 0). GR_OK, GR_ERR_RANGE when two axes do not hold them. */
int dispatch_plan(uint64_t items, uint32_t group, struct dispatch *out);

#endif
