/*
 * What a radiance of ours is to an eye: luminance in cd/m^2.
 *
 * Radiometric values (W/(m^2 sr), W/sr, W/m^2) are per band of red, green and
 * blue; each band stands for a third of the visible spectrum, about 100 nm of
 * 400 to 700 nm, so that white with 1 W/(m^2 sr) in each has 3 W/(m^2 sr) in
 * all. Its luminance is taken as 683 cd/m^2: 683 lm/W, the efficacy at 555 nm
 * that defines the candela, times the bands' weights in the luminance of
 * Rec. 709, which sum to 1. A flat spectrum has 683 x 106.9 nm / 100 nm = 730
 * (the integral of V is 106.9 nm), so watts here are watts within 7 per cent:
 * daylight of 100,000 lx becomes 146 W/m^2 in each band, 439 W/m^2 in all.
 *
 * It is the factor of the tools that write glTF (KHR_lights_punctual), so lamps
 * that come from there by it mean the same here. Radiance counts the whole
 * spectrum in each value, at 179 lm/W: to take a picture that is in its units,
 * multiply by 179 / 683 = 0.262.
 */
#ifndef GROTTO_BASE_PHOTOMETRY_H
#define GROTTO_BASE_PHOTOMETRY_H

#define GR_LUMENS_PER_WATT 683.0

/* Shares of the bands in luminance: Rec. ITU-R BT.709, item 3.2. */
#define GR_LUMINANCE_RED 0.2126
#define GR_LUMINANCE_GREEN 0.7152
#define GR_LUMINANCE_BLUE 0.0722

/* Radiance that an eye sees as alike: grey of this has the same luminance. W/(m^2 sr) per band. */
static inline double gr_grey(const double rgb[3])
{
	return GR_LUMINANCE_RED * rgb[0] + GR_LUMINANCE_GREEN * rgb[1] + GR_LUMINANCE_BLUE * rgb[2];
}

/* cd/m^2 of W/(m^2 sr), and likewise lx of W/m^2, cd of W/sr. */
static inline double gr_luminance(const double rgb[3])
{
	return GR_LUMENS_PER_WATT * gr_grey(rgb);
}

#endif
