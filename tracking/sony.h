/*
 * Sony DualShock 4 (054c:05c4, 09cc, dongle 0ba0) and DualSense (0ce6, Edge
 * 0df2), by USB and Bluetooth: a wand whose orientation comes from the pad's
 * own gyroscope and accelerometer. One sensor, "pad"; no position.
 *
 * What of this is known how. Report layouts, time stamps, checksums and
 * calibration: from Sony's driver in Linux (drivers/hid/hid-playstation.c).
 * Order of the calibration by Bluetooth and dongle, which calibrations are
 * not believed, the nominal scale that is used then, bit 7 of byte 1 of a
 * DualShock 4's Bluetooth report, the dongle's bit for "no pad there", axes of
 * the sensors (X right, Y out of the pad's top, Z towards the player; right
 * handed): from SDL (src/joystick/hidapi/SDL_hidapi_ps4.c, SDL_sensor.h). The
 * short report by Bluetooth before the switch of mode, of a DualSense: from
 * memory. Nothing here was tried on a real device.
 *
 * By Bluetooth a pad says the short report alone until its calibration (a
 * feature report) is read; that is the switch of mode. There is none back:
 * only switching the pad off and on again does that.
 */
#ifndef GROTTO_TRACKING_SONY_H
#define GROTTO_TRACKING_SONY_H

#include "tracking/device.h"
#include "tracking/imu.h"

enum track_sony_model { TRACK_SONY_DUALSHOCK4, TRACK_SONY_DUALSENSE };

#define TRACK_SONY_USB_BYTES 64
#define TRACK_SONY_BLUETOOTH_BYTES 78
#define TRACK_SONY_SHORT_BYTES 10

/* In the order of the driver's names. The hat's directions are apart. */
enum track_sony_button {
	TRACK_SONY_CROSS,
	TRACK_SONY_CIRCLE,
	TRACK_SONY_SQUARE,
	TRACK_SONY_TRIANGLE,
	TRACK_SONY_L1,
	TRACK_SONY_R1,
	TRACK_SONY_L2,
	TRACK_SONY_R2,
	TRACK_SONY_SHARE, /* "create" of a DualSense */
	TRACK_SONY_OPTIONS,
	TRACK_SONY_L3,
	TRACK_SONY_R3,
	TRACK_SONY_PS,
	TRACK_SONY_TOUCHPAD,
	TRACK_SONY_MUTE, /* of a DualSense */
	TRACK_SONY_UP,
	TRACK_SONY_RIGHT,
	TRACK_SONY_DOWN,
	TRACK_SONY_LEFT,
	TRACK_SONY_BUTTONS,
};
extern const char *const track_sony_buttons[TRACK_SONY_BUTTONS + 1];

struct track_sony_report {
	uint8_t sticks[4];   /* left x y, right x y: 0 left and up, 128 middle */
	uint8_t triggers[2]; /* left, right */
	uint32_t buttons;    /* bit: enum track_sony_button */
	bool motion;	     /* what follows is there: not in the short report */
	uint8_t sequence;    /* +1 each report, of track_sony_bits bits */
	uint32_t time;	     /* see track_sony_bits */
	int16_t gyro[3];     /* x y z, of ... */
	int16_t accel[3];    /* likewise */
	float battery;	     /* 0..1; negative: not known */
};

/* How wide a model's counters are, and how many ns a step of its time is (a third of these). */
struct track_sony_bits {
	unsigned sequence, time;
	int64_t step_3ns;
};
struct track_sony_bits track_sony_bits(enum track_sony_model model);

/*
 * GR_OK; GR_NOTHING: the dongle says that no pad is near; -TRACK_FAULT_LENGTH,
 * -TRACK_FAULT_FORMAT (no report of this number, a hat that is none),
 * -TRACK_FAULT_CHECKSUM.
 */
int track_sony_decode(enum track_sony_model model, const uint8_t *bytes, size_t len,
		      struct track_sony_report *out);

/* Raw to rad/s and g: (raw - bias) * scale. */
struct track_sony_calibration {
	double bias[6], scale[6]; /* gyroscope, accelerometer */
};
/* 16 steps a degree/s, 8192 a g. */
void track_sony_nominal(struct track_sony_calibration *out);
/* The feature report with the calibration, by how the pad is connected, and its length. */
uint8_t track_sony_calibration_number(enum track_sony_model model, bool bluetooth);
size_t track_sony_calibration_bytes(enum track_sony_model model, bool bluetooth);
/*
 * Decodes it. paired_signs: plus and minus of an axis stand together (USB, and
 * each DualSense), else all plus, then all minus (a DualShock 4's Bluetooth,
 * and its dongle). GR_OK; -TRACK_FAULT_LENGTH, -TRACK_FAULT_FORMAT (another
 * report; values that cannot be: some copies send zeroes), -TRACK_FAULT_CHECKSUM.
 */
int track_sony_calibrate(enum track_sony_model model, bool bluetooth, bool paired_signs,
			 const uint8_t *bytes, size_t len, struct track_sony_calibration *out);

/* A copy's clock that stands still for so many reports is none: times of arrival are used. */
#define TRACK_SONY_STOOD 8

/* From one report to the next. `calibration` set, the rest 0, with imu.params. */
struct track_sony_state {
	struct track_sony_calibration calibration;
	struct track_imu imu;
	bool started;
	uint64_t sequence, time; /* unwrapped */
	uint32_t raw_time;
	unsigned stood; /* reports in a row with the same time */
	int64_t arrived_ns;
	uint32_t recentre; /* buttons that set the heading to that of the base when pressed */
	uint32_t held;
};
/* A report that arrived at arrived_ns, in the common form. Returns how many are missing before it.
 */
uint64_t track_sony_take(enum track_sony_model model, struct track_sony_state *state,
			 const struct track_sony_report *raw, int64_t arrived_ns,
			 struct track_report *out);

/* Borrowed while the device is made. */
struct track_sony_params {
	enum track_sony_model model;
	const char *serial; /* NULL: any; by Bluetooth the pad's address */
	const char *path;   /* of the USB bus; NULL: any */
	int number;	    /* of several that fit */
	uint32_t recentre;  /* buttons (bits) that turn the heading to the base's */
	float dead_zone;    /* of the sticks, 0..0.9 */
};
/* GR_OK, GR_ERR_NOMEM, GR_ERR_IO, GR_ERR_RANGE (a text too long). */
int track_sony_create(struct track_device **out, const struct track_sony_params *params,
		      const struct gr_clock *clock);

#endif
