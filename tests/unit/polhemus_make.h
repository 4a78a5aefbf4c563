/* Frames as Polhemus' trackers would send them, for tests and mocks. */
#ifndef GROTTO_TESTS_UNIT_POLHEMUS_MAKE_H
#define GROTTO_TESTS_UNIT_POLHEMUS_MAKE_H

#include "base/cursor.h"
#include "tracking/liberty.h"
#include "tracking/viper.h"

#define MAKE_VIPER_MOST 540

/* Sensor i of frame n: a place in metres and a turn that depend on both. */
static inline void make_place(unsigned sensor, uint32_t frame, float place_m[3], float turn[4])
{
	place_m[0] = 0.5f + 0.001f * (float)(frame % 500);
	place_m[1] = 0.1f * (float)sensor;
	place_m[2] = -0.25f;
	turn[0] = 0.5f;
	turn[1] = -0.5f;
	turn[2] = 0.5f;
	turn[3] = 0.5f;
}

/* Of the sensors whose bit is set; 28 + 32 each. */
static inline size_t make_viper_pose(uint8_t out[MAKE_VIPER_MOST], uint32_t frame, uint32_t sensors)
{
	struct gr_writer w = gr_writer(out, MAKE_VIPER_MOST);
	const unsigned count = (unsigned)__builtin_popcount(sensors);
	float place[3], turn[4];

	gr_write_bytes(&w, "VPRP", 4);
	gr_write_u32(&w, 20 + 32 * count);
	gr_write_u32(&w, 7);
	gr_write_u32(&w, frame);
	gr_write_u32(&w, 0);
	gr_write_u32(&w, count);
	for (unsigned i = 0; i < 16; i++) {
		if (!(sensors >> i & 1))
			continue;
		make_place(i, frame, place, turn);
		/* Metres, quaternion, button 1, distortion 51. */
		gr_write_u32(&w, i | 3u << 8 | 2u << 10 | 1u << 13 | 51u << 14);
		for (int k = 0; k < 3; k++)
			gr_write_f32(&w, place[k]);
		for (int k = 0; k < 4; k++)
			gr_write_f32(&w, turn[k]);
	}
	gr_write_u32(&w, track_viper_checksum(out, w.len));
	return w.len;
}

static inline size_t make_viper_reply(uint8_t out[MAKE_VIPER_MOST], uint32_t command, uint32_t action,
				      const void *payload, size_t len)
{
	struct gr_writer w = gr_writer(out, MAKE_VIPER_MOST);

	gr_write_bytes(&w, "VPRC", 4);
	gr_write_u32(&w, (uint32_t)(24 + len));
	gr_write_u32(&w, 7);
	gr_write_u32(&w, command);
	gr_write_u32(&w, action);
	gr_write_u32(&w, 0);
	gr_write_u32(&w, 0);
	gr_write_bytes(&w, payload, len);
	gr_write_u32(&w, track_viper_checksum(out, w.len));
	return w.len;
}

#define MAKE_LIBERTY_MOST (TRACK_LIBERTY_HEAD + TRACK_LIBERTY_BODY)

/* Of one station, 0-based; what: "LY", "PA", "LU". scale: units of a metre. */
static inline size_t make_liberty_pose(uint8_t out[MAKE_LIBERTY_MOST], const char *what, uint8_t command,
				       unsigned station, uint32_t frame, float scale, bool button)
{
	struct gr_writer w = gr_writer(out, MAKE_LIBERTY_MOST);
	float place[3], turn[4];

	make_place(station, frame, place, turn);
	gr_write_bytes(&w, what, 2);
	gr_write_u8(&w, (uint8_t)(station + 1));
	gr_write_u8(&w, command);
	gr_write_u8(&w, ' ');
	gr_write_u8(&w, 0);
	gr_write_u16(&w, button ? TRACK_LIBERTY_BODY : TRACK_LIBERTY_BODY_PLAIN);
	gr_write_u32(&w, frame * 1000 / 240);
	gr_write_u32(&w, frame);
	gr_write_u32(&w, 3);
	for (int k = 0; k < 3; k++)
		gr_write_f32(&w, place[k] * scale);
	for (int k = 0; k < 4; k++)
		gr_write_f32(&w, turn[k]);
	if (button)
		gr_write_u32(&w, 1);
	return w.len;
}

#endif
