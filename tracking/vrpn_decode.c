/* VRPN's bytes, big endian. Pure. */
#include "tracking/vrpn.h"

#include "base/cursor.h"
#include "base/result.h"

#include <stdio.h>

#define ALIGN 8 /* bodies are padded to a multiple of it */

/* 16 characters, two blanks, the log mode, NULs. The two digits after the point do not matter. */
static const char cookie_text[] = "vrpn: ver. 07.35  0";
#define COOKIE_MAGIC 11 /* "vrpn: ver. " */
#define COOKIE_MAJOR 14 /* and "07." */

void track_vrpn_cookie(uint8_t out[TRACK_VRPN_COOKIE])
{
	memset(out, 0, TRACK_VRPN_COOKIE);
	memcpy(out, cookie_text, sizeof cookie_text - 1);
}

int track_vrpn_check_cookie(const uint8_t bytes[TRACK_VRPN_COOKIE])
{
	if (memcmp(bytes, cookie_text, COOKIE_MAGIC) != 0)
		return GR_ERR_FORMAT;
	return memcmp(bytes, cookie_text, COOKIE_MAJOR) == 0 ? GR_OK : GR_ERR_VERSION;
}

static uint32_t read_be32(struct gr_reader *r)
{
	return __builtin_bswap32(gr_read_u32(r));
}

static size_t padded(size_t len)
{
	return (len + ALIGN - 1) / ALIGN * ALIGN;
}

int track_vrpn_decode(const uint8_t *bytes, size_t len, struct track_vrpn_message *out,
		      size_t *used)
{
	struct gr_reader r = gr_reader(bytes, len);
	struct track_vrpn_message message;
	uint32_t total;
	int64_t seconds;

	if (len < 4)
		return GR_NOTHING;
	total = read_be32(&r);
	if (total < TRACK_VRPN_HEADER || total > TRACK_VRPN_MESSAGE_MOST)
		return -TRACK_FAULT_LENGTH;
	message.len = total - TRACK_VRPN_HEADER;
	if (len < TRACK_VRPN_HEADER + padded(message.len))
		return GR_NOTHING;
	seconds = read_be32(&r);
	message.time_ns = seconds * GR_NS_PER_S + (int64_t)read_be32(&r) * GR_NS_PER_US;
	message.sender = (int32_t)read_be32(&r);
	message.type = (int32_t)read_be32(&r);
	message.body = bytes + TRACK_VRPN_HEADER;
	*out = message;
	*used = TRACK_VRPN_HEADER + padded(message.len);
	return GR_OK;
}

static void write_be32(struct gr_writer *w, uint32_t value)
{
	gr_write_u32(w, __builtin_bswap32(value));
}

bool track_vrpn_encode(const struct track_vrpn_message *message, uint8_t *out, size_t room,
		       size_t *len)
{
	static const uint8_t zeros[ALIGN];
	struct gr_writer w;

	if (*len > room || message->len > TRACK_VRPN_BODY_MOST)
		return false;
	w = gr_writer(out + *len, room - *len);
	write_be32(&w, (uint32_t)(TRACK_VRPN_HEADER + message->len));
	write_be32(&w, (uint32_t)(message->time_ns / GR_NS_PER_S));
	write_be32(&w, (uint32_t)(message->time_ns % GR_NS_PER_S / GR_NS_PER_US));
	write_be32(&w, (uint32_t)message->sender);
	write_be32(&w, (uint32_t)message->type);
	write_be32(&w, 0); /* a number that is not looked at */
	gr_write_bytes(&w, message->body, message->len);
	gr_write_bytes(&w, zeros, padded(message->len) - message->len);
	if (w.ok)
		*len += w.len;
	return w.ok;
}

bool track_vrpn_describe(int32_t what, int32_t id, const char *name, uint8_t *out, size_t room,
			 size_t *len)
{
	uint8_t body[4 + TRACK_VRPN_NAME];
	struct gr_writer w = gr_writer(body, sizeof body);
	const size_t size = strlen(name) + 1;

	write_be32(&w, (uint32_t)size);
	gr_write_bytes(&w, name, size);
	return w.ok && track_vrpn_encode(&(struct track_vrpn_message){ .sender = id,
								       .type = what,
								       .body = body,
								       .len = w.len },
					 out, room, len);
}
