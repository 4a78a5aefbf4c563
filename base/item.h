/*
 * The parts of a configuration by name, each as a digest: where two machines'
 * files differ, the first part that does can be named.
 */
#ifndef GROTTO_BASE_ITEM_H
#define GROTTO_BASE_ITEM_H

#include <stdint.h>

#define GR_ITEM_NAME 64 /* with the final NUL */
#define GR_ITEM_DIGEST 8

struct gr_item {
	char name[GR_ITEM_NAME]; /* printable ASCII, as the file calls it: "walls[2] (right)" */
	uint8_t digest[GR_ITEM_DIGEST];
};

#endif
