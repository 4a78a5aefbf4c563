/*
 * From the samples of one body to its pose at a time to come: a gate for what
 * no body does, a filter, and the way on from the last sample to the time at
 * which the light leaves the walls.
 *
 *   none         the last sample; velocity: a line fitted through the last 50 ms
 *   one-euro     Casiez, Roussel, Vogel, CHI 2012: a low pass whose cut-off rises
 *                with the speed
 *   exponential  LaViola, VR 2003: double exponential smoothing; orientation by
 *                the logarithm of quaternions
 *   kalman       white-noise acceleration, for a body that rests, one that moves
 *                softly and one that moves quickly, weighed by how well each
 *                foresaw the samples (interacting multiple models, Blom and
 *                Bar-Shalom 1988); orientation by a multiplicative error state
 *                (Markley 2003)
 *
 * All constants are in seconds and metres, so that 60 and 1000 samples a second
 * are filtered alike. State is a struct of the caller's; nothing is allocated.
 * Thread: one. Poses: T_room_body.
 */
#ifndef GROTTO_TRACKING_FILTER_H
#define GROTTO_TRACKING_FILTER_H

#include "base/pose.h"
#include "tracking/rotation.h"

#include <stdbool.h>
#include <stdint.h>

enum track_filter_kind {
	TRACK_FILTER_NONE,
	TRACK_FILTER_ONE_EURO,
	TRACK_FILTER_EXPONENTIAL,
	TRACK_FILTER_KALMAN,
};
#define TRACK_FILTER_KINDS 4
/* "none", "one-euro", "exponential", "kalman". Never NULL. */
const char *track_filter_name(enum track_filter_kind kind);

/* Constants for one of position (metres) and orientation (radians): units are m or rad. */
struct track_filter_tune {
	double noise;      /* standard deviation of a sample, per axis; kalman */
	double rest, move; /* spectral density of the acceleration, unit^2/s^3; kalman */
	double cutoff_hz;  /* at rest; one-euro */
	double beta;       /* by how many Hz the cut-off rises for each unit a second; one-euro */
	double slope_hz;   /* cut-off of the velocity; one-euro */
	double tau_s;      /* exponential */
	/*
	 * A sample is refused that lies further than gate + gate_speed * dt from
	 * where the body was expected. gate 0: none is.
	 */
	double gate, gate_speed;
};

struct track_filter_params {
	enum track_filter_kind kind;
	struct track_filter_tune position, orientation;
	double gate_hold_s; /* refused samples that agree for so long are where the body is */
	double ahead_s;     /* along the velocity for so long; then back to the last good pose */
	double decay_s;     /* how fast: see track_filter_at */
	double gap_s;       /* after so long without a sample the filter starts anew */
	double blend_s;     /* from what was shown to what is seen again */
};
/* For a hand or head with 0.3 mm and 0.1 degrees of noise; no device needs more to begin with. */
struct track_filter_params track_filter_defaults(enum track_filter_kind kind);

/* Position and velocity along three axes; for turns, relative to a reference. */
struct track_axes {
	double x[3], v[3];
};

/* One model of the Kalman filter; the covariance is the same for all axes. */
struct track_model {
	struct track_axes mean;
	double xx, xv, vv;
	double weight;
};
#define TRACK_MODELS 3

#define TRACK_FIT_SAMPLES 64
struct track_fit {
	int64_t time_ns[TRACK_FIT_SAMPLES];
	double p[TRACK_FIT_SAMPLES][3];
	struct rotation q[TRACK_FIT_SAMPLES];
	uint64_t count; /* ever */
};

struct track_filter {
	struct track_filter_params params;
	bool begun;
	int64_t time_ns; /* of the last sample that counted */
	/* What comes out at time_ns. */
	double p[3], v[3];
	struct rotation q;
	double w[3]; /* rad/s in the body's frame */
	union {
		struct track_fit fit;
		struct {
			double p[3];
			struct rotation q;
		} last; /* one-euro: the sample itself */
		struct {
			double p1[3], p2[3];
			struct rotation q1, q2;
		} smooth; /* exponential: once and twice */
		struct {
			struct track_model position[TRACK_MODELS], orientation[TRACK_MODELS];
		} kalman;
	} of;
	/* Samples that the gate refused, since when and the last. */
	int64_t refused_since_ns, refused_ns;
	double refused_p[3];
	struct rotation refused_q;
	bool refusing;
	/* Seen again: what was shown less what is seen, and when. */
	double blend_p[3], blend_q[3];
	int64_t blend_from_ns;
	bool blending;
	uint64_t gated, restarts; /* samples refused; times begun anew */
};

void track_filter_init(struct track_filter *filter, const struct track_filter_params *params);
/*
 * A sample that is later than the last. GR_OK; GR_NOTHING: the gate refuses it;
 * GR_ERR_FORMAT: no pose; GR_ERR_RANGE: not later. Only GR_OK changes what comes
 * out.
 */
int track_filter_add(struct track_filter *filter, int64_t time_ns, const struct gr_pose *pose);
/*
 * Where the body is at time_ns. A time t after the last sample it is moved along
 * its velocity by g(t) seconds: g = t up to ahead_s; from there on g bends back
 * without a jump of the velocity and comes to nothing, as (ahead + (1 +
 * ahead / decay) (t - ahead)) exp(-(t - ahead) / decay). Earlier than the last
 * sample: by g = t, for at most ahead_s. False, and out untouched, before the
 * first sample.
 */
bool track_filter_at(const struct track_filter *filter, int64_t time_ns, struct gr_pose *out);

#endif
