/*
 * A device's clock on the master's: a device says when, by its own clock, and
 * the report arrives at some time by ours. Arrival is later by a delay that
 * varies and is never less than some least one, so the smallest differences of
 * the two, over some seconds, are the device's clock plus that least delay; a
 * line under them has the clock's drift as its slope. (One-way form of the
 * minimum filter of NTP, RFC 5905; Moon, Skelly, Towsley, "Estimation and
 * removal of clock skew from network delay measurements", INFOCOM 1999.)
 *
 * The least delay itself cannot be seen: what the device needs to measure and
 * send at its quickest is in the times. The layout's latency_ms takes it off.
 *
 * A mapped time is never after the report's arrival, and a burst that was held
 * up is spread out again as it was measured. Pure, fixed size; times are
 * handed in.
 */
#ifndef GROTTO_TRACKING_DEVICE_CLOCK_H
#define GROTTO_TRACKING_DEVICE_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

#define TRACK_CLOCK_BINS 32
#define TRACK_CLOCK_BIN_NS INT64_C(250000000)	/* 8 s in all */
#define TRACK_CLOCK_STEP_NS INT64_C(1000000000) /* off by more: the device's clock was set */

struct track_clock_bin {
	int64_t epoch;	  /* arrived_ns / TRACK_CLOCK_BIN_NS; -1: empty */
	int64_t at_ns;	  /* arrival of the report of least difference in it */
	int64_t ahead_ns; /* arrival less device's time of that report */
};

struct track_clock {
	struct track_clock_bin bins[TRACK_CLOCK_BINS];
	int64_t newest;		 /* epoch; -1: nothing was ever taken */
	int64_t at_ns, ahead_ns; /* the line: ahead_ns + drift * (t - at_ns) */
	double drift;		 /* our seconds less the device's, per second of ours */
	uint64_t steps;		 /* times that it began anew */
};

void track_clock_init(struct track_clock *clock);
/*
 * Takes the times of one report and returns the device's by our clock, at most
 * arrived_ns. *stepped (may be NULL): the device's clock was set, and the
 * estimate began anew with this report.
 */
int64_t track_clock_map(struct track_clock *clock, int64_t device_ns, int64_t arrived_ns,
			bool *stepped);
/* The device's clock gains so much on ours, parts per million. */
double track_clock_drift_ppm(const struct track_clock *clock);

#endif
