#include "tracking/polhemus_stream.h"

#include "base/result.h"
#include "tracking/liberty.h"
#include "tracking/report.h"
#include "tracking/viper.h"

#include <string.h>

_Static_assert(TRACK_POLHEMUS_STREAM >= 2 * TRACK_VIPER_FRAME_MOST, "a frame and a push");
_Static_assert(TRACK_POLHEMUS_STREAM >= 2 * (TRACK_LIBERTY_HEAD + TRACK_LIBERTY_BODY_MOST),
	       "likewise");

/* What a place in the stream may be the beginning of. */
enum guess { NO_FRAME, TOO_SHORT, FRAME };

void track_polhemus_stream_begin(struct track_polhemus_stream *s, enum track_polhemus_style style)
{
	s->style = style;
	s->from = s->to = 0;
	s->lost = true;
}

size_t track_polhemus_stream_push(struct track_polhemus_stream *s, const uint8_t *bytes, size_t len)
{
	memmove(s->bytes, s->bytes + s->from, s->to - s->from);
	s->to -= s->from;
	s->from = 0;
	if (len > sizeof s->bytes - s->to)
		len = sizeof s->bytes - s->to;
	memcpy(s->bytes + s->to, bytes, len);
	s->to += len;
	return len;
}

static enum guess guess_viper(const uint8_t *b, size_t left, size_t *len)
{
	const size_t magic = left < 4 ? left : 4;
	uint32_t size;

	if (memcmp(b, "VPRP", magic) != 0 && memcmp(b, "VPRC", magic) != 0)
		return NO_FRAME;
	if (left < TRACK_VIPER_HEAD)
		return TOO_SHORT;
	size = (uint32_t)b[4] | (uint32_t)b[5] << 8 | (uint32_t)b[6] << 16 | (uint32_t)b[7] << 24;
	if (size < 4 || size > TRACK_VIPER_FRAME_MOST - TRACK_VIPER_HEAD)
		return NO_FRAME;
	*len = TRACK_VIPER_HEAD + size;
	return left < *len ? TOO_SHORT : FRAME;
}

static enum guess guess_liberty(const uint8_t *b, size_t left, size_t *len)
{
	struct track_liberty_head head;
	uint8_t start[TRACK_LIBERTY_HEAD] = { 0 };

	/* Of a head that is not whole, what is there must be right. */
	if (left < 2 && b[0] != 'L' && b[0] != 'P')
		return NO_FRAME;
	if (left < 2)
		return TOO_SHORT;
	memcpy(start, b, left < sizeof start ? left : sizeof start);
	if (!track_liberty_head(start, &head))
		return NO_FRAME;
	if (left < sizeof start)
		return TOO_SHORT;
	*len = TRACK_LIBERTY_HEAD + (size_t)head.size;
	return left < *len ? TOO_SHORT : FRAME;
}

static bool is_text(uint8_t c)
{
	return (c >= 0x20 && c < 0x7f) || (c >= '\t' && c <= '\r');
}

/* Where there is no checksum, what follows a frame must be able to follow one. */
static bool may_follow(const uint8_t *b, size_t left)
{
	size_t ignored;

	if (left == 0 || guess_liberty(b, left, &ignored) != NO_FRAME)
		return true;
	for (size_t i = 0; i < left && i < TRACK_LIBERTY_HEAD; i++)
		if (!is_text(b[i]))
			return false;
	return true;
}

/* True: a fault to be told. */
static bool lose(struct track_polhemus_stream *s)
{
	const bool told = s->lost;

	s->lost = true;
	return !told;
}

int track_polhemus_stream_next(struct track_polhemus_stream *s, const uint8_t **frame, size_t *len)
{
	const bool viper = s->style == TRACK_POLHEMUS_VIPER;

	while (s->from < s->to) {
		const uint8_t *at = s->bytes + s->from;
		const size_t left = s->to - s->from;
		const enum guess guess = viper ? guess_viper(at, left, len)
					       : guess_liberty(at, left, len);

		if (guess == TOO_SHORT)
			return GR_NOTHING;
		if (guess == FRAME && (viper ? track_viper_intact(at, *len)
					     : may_follow(at + *len, left - *len))) {
			*frame = at;
			s->from += *len;
			s->lost = false;
			return GR_OK;
		}
		s->from++;
		if ((guess == FRAME || viper || !is_text(*at)) && lose(s))
			return guess == FRAME && viper ? -TRACK_FAULT_CHECKSUM
						       : -TRACK_FAULT_FORMAT;
	}
	return GR_NOTHING;
}
