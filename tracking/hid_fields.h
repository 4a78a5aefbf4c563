/* What hid_descriptor.c and hid_fields.c share: the state of a descriptor's items. */
#ifndef GROTTO_TRACKING_HID_FIELDS_H
#define GROTTO_TRACKING_HID_FIELDS_H

#include "tracking/hid_descriptor.h"

#define HID_RANGES 128 /* of usages, of one main item */

struct hid_globals {
	uint32_t page, size, count; /* size in bits */
	int32_t min, max;	    /* logical, each signed by its own size */
	uint32_t max_unsigned;
	uint8_t report;
};

struct hid_usage {
	uint32_t value;
	bool paged; /* the page is in its upper half; else it is the page of the main item */
};

struct hid_range {
	struct hid_usage first;
	uint32_t last;
};

struct hid_locals {
	struct hid_range ranges[HID_RANGES];
	unsigned count;
	struct hid_usage min; /* whose maximum has not come yet */
	bool has_min;
	unsigned alternatives; /* usages of a delimited set so far, plus one; 0: not in one */
};

/* The n-th usage of an item, with its page; 0: there are not so many. */
uint32_t hid_usage_at(const struct hid_locals *locals, uint32_t page, uint32_t n);
/* Of an application collection: a gamepad or joystick. */
bool hid_is_pad(uint32_t usage);
/*
 * Adds the fields of an input item that begins at `bit` of its report. NULL,
 * or what is wrong with it.
 */
const char *hid_add_fields(struct track_hid_pads *out, const struct hid_globals *globals,
			   const struct hid_locals *locals, unsigned pad, uint32_t flags,
			   uint32_t bit);

#endif
