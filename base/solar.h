/*
 * Where the sun is, from place, date and time: the series of Meeus,
 * "Astronomical Algorithms" 1998, chapter 25 (low accuracy), as NOAA's solar
 * calculator uses them. From 1950 to 2050 within 0.01 degrees of the full
 * theory in the sky; tests compare with Meeus' example and with that of NREL's
 * algorithm (Reda and Andreas 2004), which is good to 0.0003 degrees.
 *
 * Pure; any thread.
 */
#ifndef GROTTO_BASE_SOLAR_H
#define GROTTO_BASE_SOLAR_H

#include <stdint.h>

/* The years that dates are taken from. */
#define SOLAR_YEAR_MIN 1900
#define SOLAR_YEAR_MAX 2100

/*
 * "2026-06-21T14:30:00+02:00": ISO 8601 with seconds or without, Z or an offset
 * of at most 14 hours. Seconds since 1970-01-01T00:00Z; GR_ERR_RANGE: no such
 * date or time.
 */
int solar_time(const char *text, int64_t *out_s);

/* Apparent, from the earth's middle, at unix_s seconds since 1970 UTC. Radians. */
void solar_equatorial(double unix_s, double *right_ascension, double *declination);

/*
 * Above the horizon of a place (latitude north, longitude east) and from north over
 * east, radians. As seen: lifted by the refraction of standard air when it is above
 * -0.575 degrees or so, by half a degree at the horizon.
 */
void solar_horizontal(double unix_s, double latitude, double longitude, double *elevation,
		      double *azimuth);

#endif
