/*
 * How much may be on its way to a node: what was sent and not yet taken out of its
 * socket stays below the receive buffer that the node announced, so that what it is
 * too slow to read is not lost there, and nothing is sent for nothing.
 *
 * Sent is counted as the kernel counts it, each datagram with the room that holds it.
 * Taken out is what was sent before something that the node speaks of: a frame that it
 * acknowledges, a PROBE or SWAP of which it says the time back. (From its own socket; the
 * group's is read after it.) Silence opens nothing: who is stuck gets no more
 * than a PROBE a frame. Pure.
 */
#ifndef GROTTO_PROTOCOL_WINDOW_H
#define GROTTO_PROTOCOL_WINDOW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define FDP_WINDOW_MARKS 8
#define FDP_WINDOW_UNASKED 212992 /* what Linux gives a socket that has announced nothing */

struct fdp_window_mark {
	uint64_t key, total;
};

struct fdp_window {
	uint64_t own;   /* cost of what was sent to this node alone */
	uint64_t taken; /* of all that was sent to it; never goes back */
	uint32_t room;  /* announced; 0: not yet */
	unsigned next;  /* place of the next time */
	struct fdp_window_mark frames[FDP_WINDOW_MARKS], times[FDP_WINDOW_MARKS];
};

/*
 * Of a datagram of `len` bytes: drivers hold it in buffers of powers of two, or in
 * halves of pages, with some 600 bytes about it.
 */
static inline uint64_t fdp_window_cost(size_t len)
{
	return 2 * (uint64_t)len + 1024;
}

/* All: cost of what went to all nodes so far, this one among them. */
static inline uint64_t fdp_window_under_way(const struct fdp_window *w, uint64_t all)
{
	return w->own + all - w->taken;
}

/* What does not hurry leaves a quarter for what does, and that some for signs of life. */
static inline bool fdp_window_fits(const struct fdp_window *w, uint64_t all, uint64_t cost, bool hurries)
{
	const uint64_t room = w->room ? w->room : FDP_WINDOW_UNASKED, under_way = fdp_window_under_way(w, all);

	/* One at a time goes to the smallest of sockets. */
	return !under_way || under_way + cost <= room - room / (hurries ? 16 : 4);
}

/* The node begins anew; nothing is on its way to it. */
static inline void fdp_window_start(struct fdp_window *w, uint64_t all)
{
	memset(w, 0, sizeof *w);
	w->taken = all;
}

static inline void fdp_window_take(struct fdp_window *w, uint64_t total)
{
	if (total > w->taken)
		w->taken = total;
}

/* The state of a frame has been sent, for the first time if it counts. */
static inline void fdp_window_mark_frame(struct fdp_window *w, uint64_t all, uint64_t frame)
{
	struct fdp_window_mark *mark = &w->frames[frame % FDP_WINDOW_MARKS];

	if (mark->key != frame)
		*mark = (struct fdp_window_mark){ frame, w->own + all };
}

/* Something has been sent that bears this time, by its lower half. */
static inline void fdp_window_mark_time(struct fdp_window *w, uint64_t all, uint32_t low)
{
	w->times[w->next++ % FDP_WINDOW_MARKS] = (struct fdp_window_mark){ low, w->own + all };
}

/* The node speaks of a frame, and of a time, 0: of none. */
static inline void fdp_window_heard(struct fdp_window *w, uint64_t frame, uint32_t low)
{
	const struct fdp_window_mark *mark = &w->frames[frame % FDP_WINDOW_MARKS];

	if (frame && mark->key == frame)
		fdp_window_take(w, mark->total);
	for (unsigned i = 0; low && i < FDP_WINDOW_MARKS; i++)
		if (w->times[i].key == low)
			fdp_window_take(w, w->times[i].total);
}

#endif
