/*
 * What a HID device's reports hold, from its report descriptor: the buttons,
 * axes and hat switches of its gamepads, and where their bits are. Pure.
 *
 * Source: USB Device Class Definition for HID 1.11, 5.4 to 5.6 and 6.2.2; HID
 * Usage Tables 1.12. Where devices differ from that, as Linux does
 * (drivers/hid/hid-core.c, hid-input.c): a maximum below the minimum is an
 * unsigned one, a report may be longer than it was said to be.
 *
 * A descriptor comes from outside: everything in it is bounded, and what is
 * malformed is refused with the byte at which it is.
 */
#ifndef GROTTO_TRACKING_HID_DESCRIPTOR_H
#define GROTTO_TRACKING_HID_DESCRIPTOR_H

#include "tracking/report.h"

#include <stddef.h>

#define TRACK_HID_DESCRIPTOR_MOST 4096 /* bytes, as the kernel has it */
#define TRACK_HID_REPORT_MOST 1024     /* bytes of an input report, its number included */
#define TRACK_HID_FIELDS 256
#define TRACK_HID_PADS 4     /* gamepads behind one node, each an application collection */
#define TRACK_HID_BUTTONS 28 /* of a pad; the hat's four directions are buttons after these */
#define TRACK_HID_HAT_UP TRACK_HID_BUTTONS /* then right, down, left */

/* A pad's axes, by their places in track_report.axes. */
enum track_hid_axis {
	TRACK_HID_X,
	TRACK_HID_Y,
	TRACK_HID_Z,
	TRACK_HID_RX,
	TRACK_HID_RY,
	TRACK_HID_RZ,
	TRACK_HID_SLIDER, /* the first of sliders, dials, wheels, pedals; 0..1 */
	TRACK_HID_SLIDER2,
	TRACK_HID_AXES,
};

enum track_hid_kind {
	TRACK_HID_BUTTON_FIELD, /* pressed: index is the button */
	TRACK_HID_ARRAY_FIELD,	/* the number of one that is pressed: `first` is that of button 0 */
	TRACK_HID_AXIS_FIELD,	/* index is enum track_hid_axis */
	TRACK_HID_HAT_FIELD,
};

struct track_hid_field {
	uint16_t bit;	/* from the first byte after the report's number; little endian */
	uint8_t bits;	/* 1..32 */
	uint8_t report; /* its number; 0 where reports have none */
	uint8_t pad;
	uint8_t kind; /* enum track_hid_kind */
	uint8_t index;
	bool turned;	      /* of an axis: down is positive in the device */
	int64_t min, max;     /* logical; signed where min < 0 */
	int64_t first, last;  /* of an array: the values that are buttons, and */
	uint8_t first_button; /* which button `first` is */
};

struct track_hid_pads {
	bool numbered; /* each report begins with a byte that says which it is */
	unsigned pad_count, field_count;
	uint32_t usages[TRACK_HID_PADS];  /* TRACK_HID_GAMEPAD, ... */
	uint8_t has_axes[TRACK_HID_PADS]; /* bit: enum track_hid_axis */
	uint32_t has_buttons[TRACK_HID_PADS];
	uint16_t bytes[256]; /* of each report, its number included; 0: there is none */
	struct track_hid_field fields[TRACK_HID_FIELDS];
};

/*
 * Reads a descriptor. all: application collections of any usage count (a
 * device that somebody named); else gamepads and joysticks. GR_OK, or
 * GR_ERR_FORMAT with the reason in `why`, *out undefined.
 */
int track_hid_parse(const uint8_t *bytes, size_t len, bool all, struct track_hid_pads *out,
		    char *why, size_t size);

/* What pads say, from one report to the next: a device may say a part in each. */
struct track_hid_values {
	uint32_t buttons[TRACK_HID_PADS];
	float axes[TRACK_HID_PADS][TRACK_HID_AXES];
};
/* All at rest: triggers at 0, the rest in the middle. */
void track_hid_rest(struct track_hid_values *values);
/*
 * Takes an input report. triggers: axes (bits) that go from 0 to 1. Returns
 * which pads it was of (bits), 0 when of none; or -TRACK_FAULT_LENGTH (shorter
 * than the descriptor says), -TRACK_FAULT_FORMAT (no such report), values
 * untouched then. A value outside its logical range says nothing, as HID has
 * it: an axis stays, a hat is released.
 */
int track_hid_take(const struct track_hid_pads *pads, const uint8_t *bytes, size_t len,
		   uint8_t triggers, struct track_hid_values *values);
/* A pad in the common form; no pose, no time. */
void track_hid_report(const struct track_hid_values *values, unsigned pad,
		      struct track_report *out);

#endif
