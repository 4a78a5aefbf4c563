/*
 * How one tracker does, for people: rate and evenness over whole seconds, age,
 * drop-outs. Pure; times are of one clock, handed in.
 */
#ifndef GROTTO_DAEMON_TRACKER_STATS_H
#define GROTTO_DAEMON_TRACKER_STATS_H

#include "tracking/source.h"

/* A body that nothing was heard of for so long has dropped out. */
#define TRACKER_SILENT_NS (100 * INT64_C(1000000))

struct tracker_stats {
	uint64_t heard;	   /* reports or samples, ever */
	int64_t heard_ns;  /* arrival of the last */
	int64_t round_ns;  /* arrival of the first of the round under way */
	uint32_t round;	   /* sensors that were heard in it */
	uint64_t dropouts; /* times that a body was lost, or nothing came for TRACKER_SILENT_NS */
	bool tracked[TRACK_BODIES];
	float battery; /* 0..1; negative: not known */
	/* Of the last whole second. */
	double rate_hz, jitter_ms; /* jitter: standard deviation of the time between two arrivals */
	/* The second under way. */
	int64_t window_ns;
	uint64_t window_heard;
	double mean_ms, squares_ms2;
};

void tracker_stats_init(struct tracker_stats *stats);
/*
 * Something arrived, of this sensor. What a device says of all its sensors at
 * once is one arrival: a round ends when a sensor is heard that was heard in it.
 */
void tracker_stats_heard(struct tracker_stats *stats, unsigned sensor, int64_t arrived_ns);
/* It was, or made, a sample of a body. */
void tracker_stats_sample(struct tracker_stats *stats, enum track_body body, bool valid);
/* Once a frame: ends seconds, and finds silence. */
void tracker_stats_tick(struct tracker_stats *stats, int64_t now_ns);

#endif
