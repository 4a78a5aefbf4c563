/* The Hydra's bytes. Pure. */
#include "tracking/hydra.h"

#include "base/cursor.h"
#include "base/result.h"

#include <stdlib.h>

#define SUM_AT 50
#define SIDE_MM 20 /* nearer to the base's middle a wand is on no side */

/* CRC-16 with polynomial 0x1021 from 0x1D0F ("AUG-CCITT"); "123456789" gives 0xE5CC. */
static uint16_t checksum(const uint8_t *bytes, size_t len)
{
	uint16_t crc = 0x1D0F;

	for (size_t i = 0; i < len; i++) {
		crc = (uint16_t)(crc ^ (unsigned)bytes[i] << 8);
		for (int bit = 0; bit < 8; bit++)
			crc = (uint16_t)(crc & 0x8000 ? (unsigned)crc << 1 ^ 0x1021
						      : (unsigned)crc << 1);
	}
	return crc;
}

static int16_t read_s16(struct gr_reader *r)
{
	return (int16_t)gr_read_u16(r);
}

/* False: it is not the wand that stands here. */
static bool read_wand(struct gr_reader *r, unsigned number, struct track_hydra_wand *out)
{
	const unsigned which = gr_read_u8(r);

	out->sequence = gr_read_u8(r);
	for (int i = 0; i < 3; i++)
		out->place_mm[i] = read_s16(r);
	for (int i = 0; i < 4; i++)
		out->turn[i] = read_s16(r);
	out->buttons = gr_read_u8(r);
	for (int i = 0; i < 2; i++)
		out->stick[i] = read_s16(r);
	out->trigger = gr_read_u8(r);
	return which == number;
}

int track_hydra_decode(const uint8_t *bytes, size_t len, struct track_hydra_report *out)
{
	struct track_hydra_report report;
	struct gr_reader r = gr_reader(bytes, len);
	bool right;

	if (len != TRACK_HYDRA_BYTES)
		return -TRACK_FAULT_LENGTH;
	if ((bytes[SUM_AT] | bytes[SUM_AT + 1] << 8) != checksum(bytes, SUM_AT))
		return -TRACK_FAULT_CHECKSUM;
	right = gr_read_u16(&r) == 1;
	right = (gr_read_u16(&r) == TRACK_HYDRA_BYTES) && right;
	right = (gr_read_u16(&r) == TRACK_HYDRA_WANDS) && right;
	for (unsigned i = 0; i < TRACK_HYDRA_WANDS; i++)
		right = read_wand(&r, i + 1, &report.wands[i]) && right;
	if (!right)
		return -TRACK_FAULT_FORMAT;
	*out = report;
	return GR_OK;
}

void track_hydra_mode(bool motion, uint8_t out[TRACK_HYDRA_FEATURE_BYTES])
{
	uint8_t sum = 0;

	memset(out, 0, TRACK_HYDRA_FEATURE_BYTES);
	out[6] = 1;
	out[8] = 4;
	out[9] = motion ? 3 : 0;
	for (int i = 1; i < 89; i++)
		sum ^= out[i];
	out[89] = sum;
}

/* ---- to the common form ---- */

static int64_t squared(const int32_t a[3], const int32_t b[3], int sign)
{
	int64_t sum = 0;

	for (int i = 0; i < 3; i++) {
		const int64_t d = (int64_t)sign * a[i] - b[i];

		sum += d * d;
	}
	return sum;
}

/* A left wand is left of the base; one in the middle is taken to be above it (z points down). */
static int first_sign(unsigned wand, const int32_t mm[3])
{
	if (abs(mm[0]) < SIDE_MM)
		return mm[2] > 0 ? -1 : 1;
	return (mm[0] > 0) == (wand == 0) ? -1 : 1;
}

static void place(struct track_hydra_state *state, unsigned wand, const int16_t raw_mm[3], vec3 out)
{
	int32_t mm[3] = { raw_mm[0], raw_mm[1], raw_mm[2] };
	int *sign = &state->sign[wand];

	if (!*sign)
		*sign = first_sign(wand, mm);
	else if (squared(mm, state->last_mm[wand], -*sign) <
		 squared(mm, state->last_mm[wand], *sign))
		*sign = -*sign;
	for (int i = 0; i < 3; i++)
		state->last_mm[wand][i] = *sign * mm[i];
	/* X right, Y to the user, Z down becomes X right, Y up, Z to the user. */
	out[0] = 0.001f * (float)state->last_mm[wand][0];
	out[1] = 0.001f * (float)-state->last_mm[wand][2];
	out[2] = 0.001f * (float)state->last_mm[wand][1];
}

static void turn(const int16_t raw[4], versor out)
{
	float q[4];

	for (int i = 0; i < 4; i++)
		q[i] = (float)raw[i] / 32768.0f;
	/* Y and Z the other way round than the position's; then the same change of axes. */
	out[0] = q[1];
	out[1] = q[3];
	out[2] = -q[2];
	out[3] = q[0];
}

/* The device's bits in the order of the driver's names. */
static uint32_t buttons(uint8_t raw)
{
	static const uint8_t mask[] = { 0x01, 0x04, 0x08, 0x02, 0x10, 0x20, 0x40 };
	uint32_t bits = 0;

	for (unsigned i = 0; i < sizeof mask; i++)
		bits |= raw & mask[i] ? UINT32_C(1) << i : 0;
	return bits;
}

static void one_report(struct track_hydra_state *state, unsigned wand,
		       const struct track_hydra_wand *raw, struct track_report *out)
{
	*out = (struct track_report){
		.device_ns = (int64_t)state->sequence[wand] * TRACK_HYDRA_PERIOD_NS,
		.has = TRACK_POSITION | TRACK_ORIENTATION | TRACK_BUTTONS | TRACK_AXIS_VALUES |
		       TRACK_DEVICE_TIME,
		.sensor = wand,
		.buttons = buttons(raw->buttons),
		.axis_count = 3,
		.axes = { (float)raw->stick[0] / 32768.0f, (float)raw->stick[1] / 32768.0f,
			  (float)raw->trigger / 255.0f },
	};
	place(state, wand, raw->place_mm, out->T_base_sensor.p);
	turn(raw->turn, out->T_base_sensor.q);
}

uint64_t track_hydra_reports(struct track_hydra_state *state, const struct track_hydra_report *raw,
			     int64_t arrived_ns, struct track_report out[TRACK_HYDRA_WANDS])
{
	const int64_t since_ns = arrived_ns - state->arrived_ns;
	uint64_t missed = 0;

	for (unsigned i = 0; i < TRACK_HYDRA_WANDS; i++) {
		const uint64_t last = state->sequence[i];
		const uint8_t sequence = raw->wands[i].sequence;
		uint64_t expected;

		if (!state->started) {
			state->sequence[i] = sequence;
		} else {
			/* A burst after a stall: several at once, each still the last one's
			 * successor. */
			expected = last + (uint64_t)(since_ns > GR_NS_PER_S / 2
							     ? since_ns / TRACK_HYDRA_PERIOD_NS
							     : 1);
			state->sequence[i] = track_unwrap(sequence, 8, expected);
			if (i == 0 && state->sequence[i] > last + 1)
				missed = state->sequence[i] - last - 1;
		}
		one_report(state, i, &raw->wands[i], &out[i]);
	}
	state->started = true;
	state->arrived_ns = arrived_ns;
	return missed;
}
