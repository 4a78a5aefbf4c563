/*
 * A stream of one of Polhemus' styles, cut into packets as the first byte
 * says: what is found does not depend on the cuts, and every frame goes
 * through the decoders as a copy of exactly its length.
 */
#ifndef GROTTO_TESTS_FUZZ_POLHEMUS_H
#define GROTTO_TESTS_FUZZ_POLHEMUS_H

#include "base/result.h"
#include "tracking/polhemus_reports.h"
#include "tracking/polhemus_stream.h"

#include <stdlib.h>
#include <string.h>

/* A frame of this style; `exact` has no byte after it. */
typedef void fuzz_frame(const uint8_t *exact, size_t len, void *ctx);

struct fuzz_found {
	size_t frames;
	uint64_t hash; /* of all their bytes */
};

static void fuzz_next(struct track_polhemus_stream *s, fuzz_frame *look, void *ctx,
		      struct fuzz_found *found)
{
	const uint8_t *frame;
	size_t len;
	int r;

	while ((r = track_polhemus_stream_next(s, &frame, &len)) != GR_NOTHING) {
		uint8_t *exact;

		if (r != GR_OK)
			continue;
		exact = malloc(len);
		if (!exact)
			abort();
		memcpy(exact, frame, len);
		if (look)
			look(exact, len, ctx);
		for (size_t i = 0; i < len; i++)
			found->hash = (found->hash ^ exact[i]) * UINT64_C(1099511628211);
		found->frames++;
		free(exact);
	}
}

static struct fuzz_found fuzz_stream(enum track_polhemus_style style, const uint8_t *bytes, size_t len,
				     size_t packet, fuzz_frame *look, void *ctx)
{
	struct track_polhemus_stream *s = malloc(sizeof *s);
	struct fuzz_found found = { 0 };

	if (!s)
		abort();
	track_polhemus_stream_begin(s, style);
	while (len > 0) {
		const size_t n = packet < len ? packet : len;

		if (track_polhemus_stream_push(s, bytes, n) != n)
			abort(); /* there is room for a packet whenever nothing is left to be found */
		fuzz_next(s, look, ctx, &found);
		bytes += n;
		len -= n;
	}
	free(s);
	return found;
}

/* What is made of numbers that a decoder let through, as the driver would. */
static void fuzz_frame_number(struct track_polhemus_state *state, uint32_t number, int64_t now_ns)
{
	const int64_t before_ns = state->device_ns;
	uint64_t missed;

	(void)track_polhemus_frame(state, number, now_ns, &missed);
	/* Never far back, and never so far ahead that a year of it would overflow. */
	if (state->device_ns < before_ns - 300 * state->period_ns ||
	    (state->known | state->present) >> TRACK_POLHEMUS_SENSORS)
		abort();
}

#endif
