/*
 * Where a peer's clock stands beside ours: offset and skew of two
 * CLOCK_MONOTONICs, from the time stamps in packets that flow anyway. Pure,
 * fixed size, no allocation; integers and doubles, nothing reads a clock.
 *
 * Four stamps make an exchange, as in NTP (Mills, RFC 5905, section 8). It
 * says for certain that the peer's clock less ours lies within half its round
 * trip (less what the peer held it) of its middle; queues only ever add to the
 * trip, so the exchange with the least trip is the best (the "clock filter").
 * The least of each FDP_CLOCK_BIN_NS is kept, for FDP_CLOCK_BINS of them; a
 * line through those, weighted by what their trips exceed the least, gives
 * offset and skew. What the slope cannot be known from is taken from what
 * crystals do (0 +- 50 ppm), so that a short past gives no wild slope.
 *
 * What it cannot see is a difference of the two ways' delays: half of it is
 * in the offset, whatever is measured. It is inside error_ns, always.
 *
 * A clock that stepped (a suspended machine's stands still): three exchanges
 * in a row that the estimate cannot explain, and it begins anew. Loss and
 * reordering do no harm: an exchange carries all its stamps.
 */
#ifndef GROTTO_PROTOCOL_CLOCK_OFFSET_H
#define GROTTO_PROTOCOL_CLOCK_OFFSET_H

#include <stdbool.h>
#include <stdint.h>

#define FDP_CLOCK_BINS 64
#define FDP_CLOCK_BIN_NS INT64_C(125000000) /* 8 s in all: crystals hold still so long */
#define FDP_CLOCK_LEAST 4                   /* exchanges before anything is said */
#define FDP_CLOCK_TRIP_MOST_NS INT64_C(1000000000)

/* All ns. Ours: when it left and when the answer arrived. The peer's: when it arrived and when the answer left. */
struct fdp_exchange {
	int64_t left_ns, peer_arrived_ns, peer_left_ns, arrived_ns;
};

struct fdp_clock_bin {
	int64_t epoch; /* at_ns / FDP_CLOCK_BIN_NS; -1: empty */
	int64_t at_ns; /* middle of the exchange, our clock */
	int64_t offset_ns, trip_ns;
};

struct fdp_clock {
	struct fdp_clock_bin bins[FDP_CLOCK_BINS];
	int64_t newest_epoch;
	/* The line: offset_ns + skew * (t - at_ns), and how far the skew may be off. */
	int64_t at_ns, offset_ns, least_trip_ns;
	double skew, skew_error;
	unsigned since;   /* exchanges taken since it began */
	unsigned strange; /* in a row that the line cannot explain */
	uint64_t taken, refused, steps;
};

struct fdp_clock_estimate {
	bool known;
	int64_t offset_ns; /* peer's clock less ours, at the time asked about */
	int64_t error_ns;  /* at most so far off, unequal ways included */
	int64_t trip_ns;   /* the least round trip of the window */
	double skew_ppm;   /* the peer's clock gains so much on ours */
};

void fdp_clock_reset(struct fdp_clock *clock);
/*
 * Takes an exchange. False when its stamps make no sense (an answer before
 * the question, a trip of over a second), when it is older than the window,
 * or when the line cannot explain it.
 */
bool fdp_clock_take(struct fdp_clock *clock, const struct fdp_exchange *exchange);
void fdp_clock_estimate(const struct fdp_clock *clock, int64_t now_ns,
			struct fdp_clock_estimate *out);
/* From one clock to the other; the same time when nothing is known. */
int64_t fdp_clock_to_peer(const struct fdp_clock *clock, int64_t our_ns);
int64_t fdp_clock_to_ours(const struct fdp_clock *clock, int64_t peer_ns);

#endif
