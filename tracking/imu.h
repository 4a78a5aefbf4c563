/*
 * Orientation from a gyroscope and an accelerometer in one case: the explicit
 * complementary filter of Mahony, Hamel, Pflimlin, "Nonlinear complementary
 * filters on the special orthogonal group", IEEE Transactions on Automatic
 * Control 53(5), 2008, section V, without its integral term: the gyroscope's
 * bias comes from times of rest instead, which tell all three parts of it,
 * the one about the vertical too, that gravity cannot see. At rest by a test
 * as in Skog, Handel, Nilsson, Rantakokko, "Zero-velocity detection - an
 * algorithm evaluation", IEEE Transactions on Biomedical Engineering 57(11),
 * 2010: for a whole window neither sensor varies by more than its noise.
 *
 * Nothing holds the heading but the gyroscope: it drifts by what is left of
 * the bias. docs/trackers.md has what was measured.
 *
 * Frame: base, +Y up; the body's axes right handed, +Y out of its top. Pure:
 * times are handed in.
 */
#ifndef GROTTO_TRACKING_IMU_H
#define GROTTO_TRACKING_IMU_H

#include "tracking/rotation.h"

#include <stdbool.h>
#include <stdint.h>

struct track_imu_params {
	double gain_s;	   /* 1/s: how fast the tilt follows gravity; 1 over a time constant */
	double free_g;	   /* gravity is not looked at where the length differs by more from 1 g */
	double rest_s;	   /* length of a window of rest */
	double rest_rad_s; /* the gyroscope's widest swing in it, each axis */
	double rest_g;	   /* and the accelerometer's */
	/*
	 * A mean that is further than this from the bias that is known is a slow,
	 * steady turn; unless it lasts for ten windows, which no hand does.
	 */
	double step_rad_s;
	double bias_most_rad_s; /* further than this from 0 it is no bias */
};
/* For the sensors of pads (0.2 degrees/s and 2 mg of noise) in a hand. */
#define TRACK_IMU_STANDARD                                                                         \
	((struct track_imu_params){ .gain_s = 0.5,                                                 \
				    .free_g = 0.15,                                                \
				    .rest_s = 1,                                                   \
				    .rest_rad_s = 0.04,                                            \
				    .rest_g = 0.03,                                                \
				    .step_rad_s = 0.01,                                            \
				    .bias_most_rad_s = 0.06 })

/* All zero at the start, with `params` set. */
struct track_imu {
	struct track_imu_params params;
	struct rotation T_base_body; /* as it is now */
	double bias_rad_s[3];	     /* taken off the gyroscope's */
	bool started;
	unsigned learnt; /* windows of rest that the bias is the mean of; 0: it is not known */
	unsigned far;	 /* windows in a row whose mean is further from it than a step */
	double age_s;	 /* since it began, or began anew after a gap */
	/* The window that is being watched. */
	double window_s;
	unsigned count;
	double low[6], high[6], sum[3]; /* gyroscope, accelerometer */
};

/*
 * One measurement, that long after the last (s; what is over 0.1 s or below 0
 * counts as 0: there is nothing to fill it with, and the tilt is found anew). gyro: rad/s, right handed.
 * accelerometer: g, of what holds the body up: (0, 1, 0) at rest with its top
 * up. All finite.
 */
void track_imu_add(struct track_imu *imu, const double gyro_rad_s[3], const double accel_g[3],
		   double dt_s);
/* Turns the base so that the body's -Z has the base's heading now; tilt stays. */
void track_imu_recentre(struct track_imu *imu);

#endif
