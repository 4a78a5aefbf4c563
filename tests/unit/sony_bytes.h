/* Reports of DualShock 4 and DualSense as the pads would send them, made apart from the decoder. */
#ifndef GROTTO_TESTS_UNIT_SONY_BYTES_H
#define GROTTO_TESTS_UNIT_SONY_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define SONY_MOST 78

/* By half bytes, where the decoder goes bit by bit. */
static inline uint32_t sony_crc(const uint8_t *bytes, size_t len, uint32_t crc)
{
	static const uint32_t half[16] = {
		0x00000000, 0x1db71064, 0x3b6e20c8, 0x26d930ac, 0x76dc4190, 0x6b6b51f4,
		0x4db26158, 0x5005713c, 0xedb88320, 0xf00f9344, 0xd6d6a3e8, 0xcb61b38c,
		0x9b64c2b0, 0x86d3d2d4, 0xa00ae278, 0xbdbdf21c,
	};

	crc = ~crc;
	for (size_t i = 0; i < len; i++) {
		crc = half[(crc ^ bytes[i]) & 15] ^ crc >> 4;
		crc = half[(crc ^ bytes[i] >> 4) & 15] ^ crc >> 4;
	}
	return ~crc;
}

static inline void sony_put(uint8_t *bytes, size_t at, unsigned n, uint32_t value)
{
	for (unsigned i = 0; i < n; i++)
		bytes[at + i] = (uint8_t)(value >> 8 * i);
}

/* seed: 0xa1 of an input report, 0xa3 of a feature report. */
static inline void sony_seal(uint8_t seed, uint8_t *bytes, size_t len)
{
	sony_put(bytes, len - 4, 4, sony_crc(bytes, len - 4, sony_crc(&seed, 1, 0)));
}

struct sony_made {
	bool dualsense, bluetooth;
	unsigned count; /* of reports */
	uint32_t time;
	int gyro[3], accel[3];
	uint8_t buttons[3]; /* as in the report; [0] with the hat, 8 none */
	uint8_t battery;    /* the status byte */
};

/* Returns its length. */
static inline size_t sony_make(uint8_t bytes[SONY_MOST], const struct sony_made *m)
{
	const size_t len = m->bluetooth ? 78 : 64;
	const size_t at = !m->bluetooth ? 1 : m->dualsense ? 2 : 3;
	uint8_t *b = bytes + at;

	memset(bytes, 0, SONY_MOST);
	bytes[0] = !m->bluetooth ? 1 : m->dualsense ? 0x31 : 0x11;
	if (m->bluetooth && !m->dualsense)
		bytes[1] = 0xc0;
	memset(b, 128, 4);
	memcpy(b + (m->dualsense ? 7 : 4), m->buttons, 3);
	if (m->dualsense)
		b[6] = (uint8_t)m->count;
	else
		b[6] |= (uint8_t)(m->count << 2);
	if (m->dualsense)
		sony_put(b, 27, 4, m->time);
	else
		sony_put(b, 9, 2, m->time);
	for (unsigned i = 0; i < 3; i++) {
		sony_put(b, (m->dualsense ? 15 : 12) + 2 * i, 2, (uint32_t)m->gyro[i]);
		sony_put(b, (m->dualsense ? 21 : 18) + 2 * i, 2, (uint32_t)m->accel[i]);
	}
	b[m->dualsense ? 52 : 29] = m->battery;
	if (m->bluetooth)
		sony_seal(0xa1, bytes, len);
	return len;
}

/* A calibration of `scale` times the nominal one, the accelerometer's middle at 40. Its length. */
static inline size_t sony_make_calibration(uint8_t bytes[64], bool dualsense, bool bluetooth,
					   bool paired_signs, double scale)
{
	const size_t len = dualsense || bluetooth ? 41 : 37;
	/* 540 degrees/s are 8640 steps nominally, 1 g are 8192 */
	const int turn = (int)(8640 / scale), g = (int)(8192 / scale);

	memset(bytes, 0, 64);
	bytes[0] = dualsense || bluetooth ? 5 : 2;
	for (unsigned i = 0; i < 3; i++) {
		sony_put(bytes, 1 + 2 * i, 2, 7 * i);
		sony_put(bytes, 7 + (paired_signs ? 4 * i : 2 * i), 2,
			 (uint32_t)(turn + 7 * (int)i));
		sony_put(bytes, paired_signs ? 9 + 4 * i : 13 + 2 * i, 2,
			 (uint32_t)(7 * (int)i - turn));
		sony_put(bytes, 23 + 4 * i, 2, (uint32_t)(40 + g));
		sony_put(bytes, 25 + 4 * i, 2, (uint32_t)(40 - g));
	}
	sony_put(bytes, 19, 2, 540);
	sony_put(bytes, 21, 2, 540);
	if (bluetooth)
		sony_seal(0xa3, bytes, len);
	return len;
}

#endif
