#include "protocol/clock_offset.h"

#include "base/line_fit.h"

#include <math.h>
#include <string.h>

#define SANE_NS (INT64_MAX / 16)  /* 18 years: sums and differences of such stamps cannot overflow */
#define SKEW_MOST 500e-6          /* what the kernel may slew a clock by */
#define SKEW_PRIOR 50e-6          /* what a crystal is off by */
#define SKEW_WANDER 0.2e-6        /* with temperature, within the window */
#define NOISE_LEAST_NS 1000.0     /* of the best exchange */
#define STRANGE_SLACK_NS 1000
#define STRANGE_MOST 3

void fdp_clock_reset(struct fdp_clock *c)
{
	const uint64_t taken = c->taken, refused = c->refused, steps = c->steps;

	*c = (struct fdp_clock){ .newest_epoch = -1, .skew_error = 3 * SKEW_PRIOR,
				 .taken = taken, .refused = refused, .steps = steps };
	for (int i = 0; i < FDP_CLOCK_BINS; i++)
		c->bins[i].epoch = -1;
}

static bool in_window(const struct fdp_clock *c, const struct fdp_clock_bin *bin)
{
	return bin->epoch >= 0 && bin->epoch > c->newest_epoch - FDP_CLOCK_BINS;
}

static double line_at(const struct fdp_clock *c, int64_t at_ns)
{
	return c->skew * (double)(at_ns - c->at_ns);
}

/* Times in s from the newest, offsets in ns from its. */
static void add_bin(struct gr_line_fit *line, const struct fdp_clock *c,
		    const struct fdp_clock_bin *bin, double noise_ns)
{
	/* A longer trip was held up on one way or the other: it may be off by half of that. */
	const double off = noise_ns + 0.5 * (double)(bin->trip_ns - c->least_trip_ns);

	gr_line_fit_add(line, (double)(bin->at_ns - c->at_ns) * 1e-9,
			(double)(bin->offset_ns - c->offset_ns), 1 / (off * off));
}

static void fit(struct fdp_clock *c)
{
	const struct fdp_clock_bin *newest = &c->bins[c->newest_epoch % FDP_CLOCK_BINS];
	struct gr_line_fit line = { 0 };
	double noise_ns, offset, slope, error;

	c->at_ns = newest->at_ns;
	c->offset_ns = newest->offset_ns;
	c->least_trip_ns = newest->trip_ns;
	for (int i = 0; i < FDP_CLOCK_BINS; i++)
		if (in_window(c, &c->bins[i]) && c->bins[i].trip_ns < c->least_trip_ns)
			c->least_trip_ns = c->bins[i].trip_ns;
	noise_ns = fmax(NOISE_LEAST_NS, (double)c->least_trip_ns / 32);
	for (int i = 0; i < FDP_CLOCK_BINS; i++)
		if (in_window(c, &c->bins[i]))
			add_bin(&line, c, &c->bins[i], noise_ns);
	gr_line_fit_solve(&line, SKEW_PRIOR * 1e9, SKEW_MOST * 1e9, &offset, &slope, &error); /* ns/s */
	c->skew = slope * 1e-9;
	c->skew_error = fmin(3 * error * 1e-9, 3 * SKEW_PRIOR) + SKEW_WANDER;
	c->offset_ns += (int64_t)llrint(offset);
}

/*
 * Certain: the truth is within half a trip of each exchange. Of those, the one
 * that says most about now: a short trip long ago, or a longer one just now.
 */
static int64_t error_at(const struct fdp_clock *c, int64_t now_ns)
{
	double least = INFINITY;

	for (int i = 0; i < FDP_CLOCK_BINS; i++) {
		const struct fdp_clock_bin *bin = &c->bins[i];
		double error;

		if (!in_window(c, bin))
			continue;
		error = 0.5 * (double)bin->trip_ns +
			fabs((double)(bin->offset_ns - c->offset_ns) - line_at(c, bin->at_ns)) +
			c->skew_error * fabs((double)(now_ns - bin->at_ns));
		if (error < least) /* fmin is a call, and this runs for each report */
			least = error;
	}
	return least < (double)SANE_NS ? (int64_t)ceil(least) : SANE_NS;
}

/* The truth cannot be in what this exchange allows and in what the line allows. */
static bool contradicts(const struct fdp_clock *c, const struct fdp_clock_bin *bin)
{
	const double gap = fabs((double)(bin->offset_ns - c->offset_ns) - line_at(c, bin->at_ns));

	return gap > 0.5 * (double)bin->trip_ns + (double)error_at(c, bin->at_ns) + STRANGE_SLACK_NS;
}

static bool sane(int64_t ns)
{
	return ns > -SANE_NS && ns < SANE_NS;
}

static bool make_bin(struct fdp_clock_bin *bin, const struct fdp_exchange *e)
{
	int64_t there, back;

	if (!sane(e->left_ns) || !sane(e->arrived_ns) || !sane(e->peer_arrived_ns) ||
	    !sane(e->peer_left_ns) || e->left_ns < 0 || e->arrived_ns < e->left_ns ||
	    e->peer_left_ns < e->peer_arrived_ns)
		return false;
	there = e->peer_arrived_ns - e->left_ns;
	back = e->peer_left_ns - e->arrived_ns;
	bin->trip_ns = there - back;
	bin->offset_ns = there / 2 + back / 2;
	bin->at_ns = e->left_ns + (e->arrived_ns - e->left_ns) / 2;
	bin->epoch = bin->at_ns / FDP_CLOCK_BIN_NS;
	return bin->trip_ns >= 0 && bin->trip_ns <= FDP_CLOCK_TRIP_MOST_NS;
}

/* True when the line has to be drawn anew. */
static bool keep(struct fdp_clock *c, const struct fdp_clock_bin *bin)
{
	struct fdp_clock_bin *old = &c->bins[bin->epoch % FDP_CLOCK_BINS];

	if (old->epoch == bin->epoch && old->trip_ns <= bin->trip_ns)
		return false;
	*old = *bin;
	if (bin->epoch > c->newest_epoch)
		c->newest_epoch = bin->epoch;
	return true;
}

bool fdp_clock_take(struct fdp_clock *c, const struct fdp_exchange *exchange)
{
	struct fdp_clock_bin bin;

	if (!make_bin(&bin, exchange) || bin.epoch <= c->newest_epoch - FDP_CLOCK_BINS) {
		c->refused++;
		return false;
	}
	if (c->since >= FDP_CLOCK_LEAST && contradicts(c, &bin)) {
		c->refused++;
		if (++c->strange < STRANGE_MOST)
			return false;
		c->steps++;
		fdp_clock_reset(c);
	}
	c->strange = 0;
	c->taken++;
	if (c->since < FDP_CLOCK_LEAST)
		c->since++;
	if (keep(c, &bin))
		fit(c);
	return true;
}

void fdp_clock_estimate(const struct fdp_clock *c, int64_t now_ns, struct fdp_clock_estimate *out)
{
	*out = (struct fdp_clock_estimate){ .known = c->since >= FDP_CLOCK_LEAST && sane(now_ns) };
	if (!out->known)
		return;
	out->offset_ns = fdp_clock_to_peer(c, now_ns) - now_ns;
	out->error_ns = error_at(c, now_ns);
	out->trip_ns = c->least_trip_ns;
	out->skew_ppm = c->skew * 1e6;
}

int64_t fdp_clock_to_peer(const struct fdp_clock *c, int64_t our_ns)
{
	if (!c->since || !sane(our_ns))
		return our_ns;
	return our_ns + c->offset_ns + (int64_t)llrint(line_at(c, our_ns));
}

int64_t fdp_clock_to_ours(const struct fdp_clock *c, int64_t peer_ns)
{
	int64_t since_ns;

	if (!c->since || !sane(peer_ns))
		return peer_ns;
	since_ns = peer_ns - c->offset_ns - c->at_ns; /* (1 + skew) times what it is here */
	return c->at_ns + since_ns - (int64_t)llrint(c->skew / (1 + c->skew) * (double)since_ns);
}
