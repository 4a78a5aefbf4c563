/* Bytes of DualShock 4 and DualSense. Pure. */
#include "tracking/sony.h"

#include "base/cursor.h"
#include "base/result.h"

enum transport { INPUT_SEED = 0xa1, FEATURE_SEED = 0xa3 };

/* Bits of the three bytes that both models have in this order, the hat in the lowest four. */
static const struct {
	uint8_t byte, bit, button;
} button_bits[] = {
	{ 0, 4, TRACK_SONY_SQUARE },   { 0, 5, TRACK_SONY_CROSS },    { 0, 6, TRACK_SONY_CIRCLE },
	{ 0, 7, TRACK_SONY_TRIANGLE }, { 1, 0, TRACK_SONY_L1 },	      { 1, 1, TRACK_SONY_R1 },
	{ 1, 2, TRACK_SONY_L2 },       { 1, 3, TRACK_SONY_R2 },	      { 1, 4, TRACK_SONY_SHARE },
	{ 1, 5, TRACK_SONY_OPTIONS },  { 1, 6, TRACK_SONY_L3 },	      { 1, 7, TRACK_SONY_R3 },
	{ 2, 0, TRACK_SONY_PS },       { 2, 1, TRACK_SONY_TOUCHPAD }, { 2, 2, TRACK_SONY_MUTE },
};

const char *const track_sony_buttons[TRACK_SONY_BUTTONS + 1] = {
	"cross", "circle", "square", "triangle", "l1",	 "r1", "l2",	"r2",	"share", "options",
	"l3",	 "r3",	   "ps",     "touchpad", "mute", "up", "right", "down", "left",	 NULL,
};

/* CRC-32 as zlib has it, of the transport's byte and all but the last four. */
static bool sum_fits(uint8_t seed, const uint8_t *bytes, size_t len)
{
	struct gr_reader r = gr_reader(bytes + len - 4, 4);
	uint32_t crc = UINT32_MAX;

	for (size_t i = 0; i < len - 3; i++) {
		crc ^= i ? bytes[i - 1] : seed;
		for (int bit = 0; bit < 8; bit++)
			crc = crc & 1 ? crc >> 1 ^ UINT32_C(0xEDB88320) : crc >> 1;
	}
	return ~crc == gr_read_u32(&r);
}

static bool take_buttons(const uint8_t bytes[3], bool mute, uint32_t *out)
{
	static const uint8_t directions[] = { 1, 3, 2, 6, 4, 12, 8, 9, 0 };
	const unsigned hat = bytes[0] & 15;

	if (hat >= sizeof directions)
		return false;
	*out = (uint32_t)directions[hat] << TRACK_SONY_UP;
	for (size_t i = 0; i < sizeof button_bits / sizeof *button_bits; i++)
		if (bytes[button_bits[i].byte] >> button_bits[i].bit & 1)
			*out |= UINT32_C(1) << button_bits[i].button;
	if (!mute)
		*out &= ~(UINT32_C(1) << TRACK_SONY_MUTE);
	return true;
}

static void read_vector(struct gr_reader *r, int16_t out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = (int16_t)gr_read_u16(r);
}

static void read_sticks(struct gr_reader *r, struct track_sony_report *out)
{
	for (int i = 0; i < 4; i++)
		out->sticks[i] = gr_read_u8(r);
}

/* A DualShock 4's block, and the short report of both: its first nine bytes. */
static bool read_dualshock4(struct gr_reader *r, bool whole, struct track_sony_report *out)
{
	const uint8_t *buttons;
	uint8_t status;

	read_sticks(r, out);
	buttons = gr_read_bytes(r, 3);
	if (!buttons || !take_buttons(buttons, false, &out->buttons))
		return false;
	out->sequence = buttons[2] >> 2;
	for (int i = 0; i < 2; i++)
		out->triggers[i] = gr_read_u8(r);
	if (!whole)
		return true;
	out->time = gr_read_u16(r);
	(void)gr_read_u8(r); /* temperature */
	read_vector(r, out->gyro);
	read_vector(r, out->accel);
	(void)gr_read_bytes(r, 5);
	status = gr_read_u8(r);
	/* Ten steps; by cable it counts to eleven, which is full. */
	out->battery = (float)((status & 15) < 10 ? status & 15 : 10) / 10.0f;
	return true;
}

static bool read_dualsense(struct gr_reader *r, struct track_sony_report *out)
{
	const uint8_t *buttons;
	uint8_t status;

	read_sticks(r, out);
	for (int i = 0; i < 2; i++)
		out->triggers[i] = gr_read_u8(r);
	out->sequence = gr_read_u8(r);
	buttons = gr_read_bytes(r, 3);
	if (!buttons || !take_buttons(buttons, true, &out->buttons))
		return false;
	(void)gr_read_bytes(r, 5);
	read_vector(r, out->gyro);
	read_vector(r, out->accel);
	out->time = gr_read_u32(r);
	(void)gr_read_bytes(r, 21);
	status = gr_read_u8(r);
	/* High: 0 runs on it, 1 charges, 2 is full; else something is wrong with it. */
	out->battery = status >> 4 > 2				? -1.0f
		       : status >> 4 == 2 || (status & 15) > 10 ? 1.0f
								: (float)(status & 15) / 10.0f;
	return true;
}

/* Where the block begins in a report of this number; 0: it is none. */
static size_t block_at(enum track_sony_model model, const uint8_t *bytes, size_t len, size_t *whole)
{
	const bool ds4 = model == TRACK_SONY_DUALSHOCK4;

	*whole = bytes[0] == 1 ? TRACK_SONY_USB_BYTES : TRACK_SONY_BLUETOOTH_BYTES;
	if (bytes[0] == 1) {
		if (len == TRACK_SONY_SHORT_BYTES)
			*whole = TRACK_SONY_SHORT_BYTES;
		return 1;
	}
	return ds4 && bytes[0] == 0x11 ? 3 : !ds4 && bytes[0] == 0x31 ? 2 : 0;
}

int track_sony_decode(enum track_sony_model model, const uint8_t *bytes, size_t len,
		      struct track_sony_report *out)
{
	const bool ds4 = model == TRACK_SONY_DUALSHOCK4;
	struct track_sony_report report = { .battery = -1 };
	struct gr_reader r;
	size_t at, whole;

	if (len < 1)
		return -TRACK_FAULT_LENGTH;
	at = block_at(model, bytes, len, &whole);
	if (!at)
		return -TRACK_FAULT_FORMAT;
	if (len != whole)
		return -TRACK_FAULT_LENGTH;
	if (bytes[0] != 1 && !sum_fits(INPUT_SEED, bytes, len))
		return -TRACK_FAULT_CHECKSUM;
	if (ds4 && bytes[0] == 0x11 && !(bytes[1] & 0x80))
		return GR_NOTHING; /* sound alone */
	if (ds4 && len == TRACK_SONY_USB_BYTES && (bytes[31] & 4))
		return GR_NOTHING; /* the dongle hears no pad */
	r = gr_reader(bytes + at, len - at);
	report.motion = len != TRACK_SONY_SHORT_BYTES;
	if (!(ds4 || !report.motion ? read_dualshock4(&r, report.motion, &report)
				    : read_dualsense(&r, &report)))
		return -TRACK_FAULT_FORMAT;
	*out = report;
	return GR_OK;
}

/* ---- calibration ---- */

#define RAD_PER_DEG 0.017453292519943295
#define PER_DEG_S 16.0 /* nominal */
#define PER_G 8192.0
#define BIAS_MOST 1024 /* with more, or a scale that is off by half, it is not believed */

void track_sony_nominal(struct track_sony_calibration *out)
{
	for (int i = 0; i < 6; i++) {
		out->bias[i] = 0;
		out->scale[i] = i < 3 ? RAD_PER_DEG / PER_DEG_S : 1 / PER_G;
	}
}

uint8_t track_sony_calibration_number(enum track_sony_model model, bool bluetooth)
{
	return model == TRACK_SONY_DUALSHOCK4 && !bluetooth ? 0x02 : 0x05;
}

size_t track_sony_calibration_bytes(enum track_sony_model model, bool bluetooth)
{
	return model == TRACK_SONY_DUALSHOCK4 && !bluetooth ? 37 : 41;
}

/* False: it cannot be. */
static bool believable(const struct track_sony_calibration *c,
		       const struct track_sony_calibration *nominal)
{
	for (int i = 0; i < 6; i++) {
		const double off = c->scale[i] / nominal->scale[i];

		if (c->bias[i] > BIAS_MOST || c->bias[i] < -BIAS_MOST || off < 0.5 || off > 1.5)
			return false;
	}
	return true;
}

int track_sony_calibrate(enum track_sony_model model, bool bluetooth, bool paired_signs,
			 const uint8_t *bytes, size_t len, struct track_sony_calibration *out)
{
	struct track_sony_calibration made = { 0 }, nominal;
	struct gr_reader r = gr_reader(bytes, len);
	int16_t v[17]; /* biases, gyroscope's plus and minus, speed's, accelerometer's */

	if (len != track_sony_calibration_bytes(model, bluetooth))
		return -TRACK_FAULT_LENGTH;
	if (gr_read_u8(&r) != track_sony_calibration_number(model, bluetooth))
		return -TRACK_FAULT_FORMAT;
	if (bluetooth && !sum_fits(FEATURE_SEED, bytes, len))
		return -TRACK_FAULT_CHECKSUM;
	for (int i = 0; i < 17; i++)
		v[i] = (int16_t)gr_read_u16(&r);
	for (int i = 0; i < 3; i++) {
		const int plus = v[paired_signs ? 3 + 2 * i : 3 + i];
		const int minus = v[paired_signs ? 4 + 2 * i : 6 + i];
		const int span = (plus > v[i] ? plus - v[i] : v[i] - plus) +
				 (minus > v[i] ? minus - v[i] : v[i] - minus);
		const int up = v[11 + 2 * i], down = v[12 + 2 * i];

		/* A copy's zeroes. What the gyroscope says at rest is found at rest. */
		if (!span || up == down)
			return -TRACK_FAULT_FORMAT;
		made.scale[i] = RAD_PER_DEG * (v[9] + v[10]) / span;
		made.bias[3 + i] = (up + down) / 2.0;
		made.scale[3 + i] = 2.0 / (up - down);
	}
	track_sony_nominal(&nominal);
	if (!believable(&made, &nominal))
		return -TRACK_FAULT_FORMAT;
	*out = made;
	return GR_OK;
}
