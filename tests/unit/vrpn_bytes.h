/* VRPN's messages as a server writes them, put together apart from the driver's own encoder. */
#ifndef GROTTO_TESTS_UNIT_VRPN_BYTES_H
#define GROTTO_TESTS_UNIT_VRPN_BYTES_H

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct vrpn_bytes {
	uint8_t at[1 << 17];
	size_t len;
};

static inline void vrpn_u32(struct vrpn_bytes *b, uint32_t v)
{
	for (int shift = 24; shift >= 0; shift -= 8)
		b->at[b->len++] = (uint8_t)(v >> shift);
}

static inline void vrpn_f64(struct vrpn_bytes *b, double v)
{
	uint64_t bits;

	memcpy(&bits, &v, sizeof bits);
	vrpn_u32(b, (uint32_t)(bits >> 32));
	vrpn_u32(b, (uint32_t)bits);
}

/* Header and body, and zeros up to eight bytes; time in microseconds. */
static inline void vrpn_message(struct vrpn_bytes *b, uint64_t time_us, int32_t sender, int32_t type,
				const void *body, size_t len)
{
	if (b->len + len + 32 > sizeof b->at)
		abort();
	vrpn_u32(b, (uint32_t)(24 + len));
	vrpn_u32(b, (uint32_t)(time_us / 1000000));
	vrpn_u32(b, (uint32_t)(time_us % 1000000));
	vrpn_u32(b, (uint32_t)sender);
	vrpn_u32(b, (uint32_t)type);
	vrpn_u32(b, 4711); /* what is not looked at */
	if (len)
		memcpy(b->at + b->len, body, len);
	b->len += len;
	while (b->len % 8)
		b->at[b->len++] = 0;
}

static inline void vrpn_name(struct vrpn_bytes *b, int32_t what, int32_t id, const char *name)
{
	static struct vrpn_bytes body;

	body.len = 0;
	vrpn_u32(&body, (uint32_t)strlen(name) + 1);
	memcpy(body.at + body.len, name, strlen(name) + 1);
	body.len += strlen(name) + 1;
	vrpn_message(b, 0, id, what, body.at, body.len);
}

/* At (x, 1, 2), turned by q. */
static inline size_t vrpn_pose_body(uint8_t out[64], int32_t sensor, double x, const double q[4])
{
	static struct vrpn_bytes body;

	body.len = 0;
	vrpn_u32(&body, (uint32_t)sensor);
	vrpn_u32(&body, 0);
	vrpn_f64(&body, x);
	vrpn_f64(&body, 1);
	vrpn_f64(&body, 2);
	for (int i = 0; i < 4; i++)
		vrpn_f64(&body, q[i]);
	memcpy(out, body.at, 64);
	return body.len;
}

static inline void vrpn_pose(struct vrpn_bytes *b, uint64_t time_us, int32_t sender, int32_t type,
			     int32_t sensor, double x)
{
	static const double q[4] = { 0, 0, 0, 1 };
	uint8_t body[64];

	vrpn_message(b, time_us, sender, type, body, vrpn_pose_body(body, sensor, x, q));
}

static inline void vrpn_button(struct vrpn_bytes *b, int32_t sender, int32_t type, int32_t button,
			       int32_t pressed)
{
	static struct vrpn_bytes body;

	body.len = 0;
	vrpn_u32(&body, (uint32_t)button);
	vrpn_u32(&body, (uint32_t)pressed);
	vrpn_message(b, 0, sender, type, body.at, body.len);
}

static inline void vrpn_channels(struct vrpn_bytes *b, int32_t sender, int32_t type, unsigned count,
				 const double *values)
{
	static struct vrpn_bytes body;

	body.len = 0;
	vrpn_f64(&body, count);
	for (unsigned i = 0; i < count; i++)
		vrpn_f64(&body, values[i]);
	vrpn_message(b, 0, sender, type, body.at, body.len);
}

#endif
