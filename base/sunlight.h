/*
 * Sunlight at the ground: the sun's spectrum through the atmosphere of Preetham,
 * Shirley and Smits 1999, "A Practical Analytic Model for Daylight", appendix A.1
 * (Rayleigh, aerosol by turbidity after Angstrom, ozone 0.35 cm, water vapour
 * 2 cm), 380 to 750 nm in steps of 10 nm. Mixed gases absorb beyond 750 nm only.
 *
 * Pure; any thread.
 */
#ifndef GROTTO_BASE_SUNLIGHT_H
#define GROTTO_BASE_SUNLIGHT_H

/* Full angle of the disc at the mean distance, radians. */
#define SUNLIGHT_ANGLE 0.009306

/*
 * Irradiance of a surface that faces the sun, per band (base/photometry.h); 0 at
 * and below the horizon. A low sun's colour leaves the bands' triangle: what would
 * be below 0 is 0. turbidity 1 (air alone) to 30; above 10 is hardly measured.
 */
void sunlight_irradiance(double turbidity, double elevation, double rgb[3]);
/* The same above the atmosphere. */
void sunlight_outside(double rgb[3]);

/* CIE 1931 XYZ, Y in lm per unit area, to linear Rec. 709 per band in W. */
void sunlight_from_xyz(const double xyz[3], double rgb[3]);

#endif
