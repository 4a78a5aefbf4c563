#include "base/solar.h"

#include "base/result.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define PI 3.14159265358979323846
#define RAD_PER_DEG (PI / 180)
#define DAY_S 86400

/* Days since 1970-01-01 of a Gregorian date: Hinnant's days_from_civil. */
static int64_t days_from_date(int year, int month, int day)
{
	const int y = month <= 2 ? year - 1 : year;
	const int era = y / 400; /* years from 1900 on */
	const int of_era = y - era * 400;
	const int of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;

	return (int64_t)era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}

static int month_days(int year, int month)
{
	static const int days[12] = { 31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31 };
	const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;

	return days[month - 1] + (month == 2 && leap);
}

/* As many digits, after the character that stands before them (0: none), least to most. */
static bool take(const char **at, char before, int digits, int least, int most, int *out)
{
	if (before && *(*at)++ != before)
		return false;
	*out = 0;
	for (int i = 0; i < digits; i++) {
		char c = *(*at)++;

		if (c < '0' || c > '9')
			return false;
		*out = *out * 10 + c - '0';
	}
	return *out >= least && *out <= most;
}

/* Z or +hh:mm, and nothing after it. */
static bool take_offset(const char *at, int *out_s)
{
	const int sign = *at == '-' ? -1 : 1;
	int hours, minutes;

	*out_s = 0;
	if (!strcmp(at, "Z"))
		return true;
	if (*at != '+' && *at != '-')
		return false;
	at++;
	if (!take(&at, 0, 2, 0, 14, &hours) || !take(&at, ':', 2, 0, 59, &minutes) || *at)
		return false;
	*out_s = sign * (hours * 3600 + minutes * 60);
	return hours * 60 + minutes <= 14 * 60;
}

int solar_time(const char *text, int64_t *out_s)
{
	int year, month, day, hour, minute, second = 0, offset;
	const char *at = text;

	/* each stops at the first character that is wrong, so also at the end */
	if (!take(&at, 0, 4, SOLAR_YEAR_MIN, SOLAR_YEAR_MAX, &year) || !take(&at, '-', 2, 1, 12, &month) ||
	    !take(&at, '-', 2, 1, month_days(year, month), &day) || !take(&at, 'T', 2, 0, 23, &hour) ||
	    !take(&at, ':', 2, 0, 59, &minute))
		return GR_ERR_RANGE;
	if (*at == ':' && !take(&at, ':', 2, 0, 59, &second))
		return GR_ERR_RANGE;
	if (!take_offset(at, &offset))
		return GR_ERR_RANGE;
	*out_s = days_from_date(year, month, day) * DAY_S + hour * 3600 + minute * 60 + second - offset;
	return GR_OK;
}

/* Days since 2000-01-01T12:00. */
static double days_2000(double unix_s)
{
	return unix_s / DAY_S - 10957.5;
}

static double turn_deg(double degrees)
{
	return fmod(degrees, 360) * RAD_PER_DEG;
}

void solar_equatorial(double unix_s, double *right_ascension, double *declination)
{
	/* Julian centuries; the minute between UTC and dynamical time moves the sun by 0.0008 degrees. */
	const double t = days_2000(unix_s) / 36525;
	const double mean_longitude = 280.46646 + t * (36000.76983 + t * 0.0003032);
	const double anomaly = turn_deg(357.52911 + t * (35999.05029 - t * 0.0001537));
	const double center = (1.914602 - t * (0.004817 + t * 0.000014)) * sin(anomaly) +
			      (0.019993 - t * 0.000101) * sin(2 * anomaly) + 0.000289 * sin(3 * anomaly);
	const double node = turn_deg(125.04 - 1934.136 * t);
	const double longitude = turn_deg(mean_longitude + center - 0.00569 - 0.00478 * sin(node));
	const double obliquity = RAD_PER_DEG *
		(23.439291 - t * (0.0130042 + t * (1.64e-7 - t * 5.04e-7)) + 0.00256 * cos(node));

	*right_ascension = atan2(cos(obliquity) * sin(longitude), cos(longitude));
	*declination = asin(sin(obliquity) * sin(longitude));
}

/*
 * Saemundsson's formula for air of 1010 hPa and 10 degrees (Meeus, 16.4), as far below the
 * horizon as refraction lifts the sun's middle to it.
 */
static double refraction(double elevation)
{
	const double deg = elevation / RAD_PER_DEG;

	if (deg < -0.575)
		return 0;
	return RAD_PER_DEG / 60 * 1.02 / tan(RAD_PER_DEG * (deg + 10.3 / (deg + 5.11)));
}

void solar_horizontal(double unix_s, double latitude, double longitude, double *elevation,
		      double *azimuth)
{
	const double days = days_2000(unix_s);
	double right_ascension, declination, hour, sidereal, up, south, west;

	solar_equatorial(unix_s, &right_ascension, &declination);
	sidereal = turn_deg(280.46061837 + 360.98564736629 * days);
	hour = sidereal + longitude - right_ascension;
	south = cos(hour) * sin(latitude) * cos(declination) - cos(latitude) * sin(declination);
	west = sin(hour) * cos(declination);
	up = sin(latitude) * sin(declination) + cos(latitude) * cos(declination) * cos(hour);
	/* atan2, as asin loses digits overhead */
	*elevation = atan2(up, hypot(south, west));
	*elevation += refraction(*elevation);
	*azimuth = atan2(-west, -south);
	if (*azimuth < 0)
		*azimuth += 2 * PI;
}
