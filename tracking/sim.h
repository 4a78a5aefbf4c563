/*
 * A simulated visitor: walks about, looks around, points with the wand, and
 * now and then presses one of its first three buttons. Deterministic: the pose
 * is a pure function of (params, time); noise, drop-outs and buttons are a pure
 * function of (seed, sample number). Sample n is of time n / rate, and a source
 * begins with the newest sample that is there at the first poll; of a caller
 * that comes late it keeps the last second.
 *
 * During a drop-out the samples go on, as not valid.
 */
#ifndef GROTTO_TRACKING_SIM_H
#define GROTTO_TRACKING_SIM_H

#include "tracking/source.h"

struct track_sim_params {
	struct gr_pose start_head, start_wand; /* T_room_body at time 0 */
	vec3 room_min, room_max; /* the truth stays 0.25 m inside, where start pose and room have that */
	float rate_hz;                         /* samples a second per body, 1..1000 */
	float noise_position_m, noise_angle_rad; /* standard deviation per axis */
	int64_t latency_ns; /* a sample of time t is delivered at t + latency */
	float dropout_per_s; /* drop-outs that begin in a second, mean, per body */
	int64_t dropout_ns;  /* how long one lasts */
	uint32_t seed;
	float walk_radius_m;  /* the furthest from the start; 0 stands still */
	float walk_speed_m_s; /* mean */
	bool head, wand;
};

/* GR_ERR_RANGE with a line in diag when a parameter is outside its range. */
int track_sim_create(struct track_source **out, const struct track_sim_params *params,
		     struct gr_diag *diag);
/* Where the body truly is (no noise, no latency): the truth for tests. */
void track_sim_truth(const struct track_source *source, enum track_body body, int64_t time_ns,
		     struct gr_pose *out);

#endif
