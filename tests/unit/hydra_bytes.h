/* A Hydra's input report as the device would send it, made apart from the decoder. */
#ifndef GROTTO_TESTS_UNIT_HYDRA_BYTES_H
#define GROTTO_TESTS_UNIT_HYDRA_BYTES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define HYDRA_BYTES 52

/* By a table, where the decoder goes bit by bit. */
static inline uint16_t hydra_crc(const uint8_t *bytes, size_t len)
{
	uint16_t table[256], crc = 0x1D0F;

	for (unsigned i = 0; i < 256; i++) {
		unsigned c = i << 8;

		for (int bit = 0; bit < 8; bit++)
			c = c & 0x8000 ? c << 1 ^ 0x1021 : c << 1;
		table[i] = (uint16_t)c;
	}
	for (size_t i = 0; i < len; i++)
		crc = (uint16_t)((unsigned)crc << 8 ^ table[(crc >> 8 ^ bytes[i]) & 0xff]);
	return crc;
}

static inline void hydra_put(uint8_t *bytes, size_t at, int value)
{
	bytes[at] = (uint8_t)value;
	bytes[at + 1] = (uint8_t)(value >> 8);
}

static inline void hydra_seal(uint8_t bytes[HYDRA_BYTES])
{
	hydra_put(bytes, 50, hydra_crc(bytes, 50));
}

/* Both wands at rest, unturned, at -x and +x of the base; z points down. */
static inline void hydra_make(uint8_t bytes[HYDRA_BYTES], uint8_t sequence, int x_mm, int y_mm,
			      int z_mm)
{
	memset(bytes, 0, HYDRA_BYTES);
	hydra_put(bytes, 0, 1);
	hydra_put(bytes, 2, HYDRA_BYTES);
	hydra_put(bytes, 4, 2);
	for (int wand = 0; wand < 2; wand++) {
		uint8_t *w = bytes + 6 + 22 * wand;

		w[0] = (uint8_t)(wand + 1);
		w[1] = sequence;
		hydra_put(w, 2, wand ? x_mm : -x_mm);
		hydra_put(w, 4, y_mm);
		hydra_put(w, 6, z_mm);
		hydra_put(w, 8, 32767);
		w[16] = 0x80;
	}
	hydra_seal(bytes);
}

#endif
