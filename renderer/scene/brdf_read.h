/*
 * Measured BRDFs as text, in the form of the Cornell University
 * gonioreflectometer: `#` begins a comment; the number of wavelengths, the
 * wavelengths in nm, and then for each sample theta_i phi_i theta_o phi_o in
 * radians and the BRDF in 1/sr at each wavelength. Azimuths are those of the
 * two directions, both away from the surface: the mirror's is phi_i + pi.
 *
 * Values become linear Rec.709 reflectance under D65: the CIE 1931 observer
 * (fits of Wyman, Sloan and Shirley, JCGT 2013) times D65, to RGB, scaled so
 * that a flat spectrum is grey. What falls out of the gamut is cut at 0.
 *
 * Thread safety: pure.
 */
#ifndef GROTTO_RENDERER_SCENE_BRDF_READ_H
#define GROTTO_RENDERER_SCENE_BRDF_READ_H

#include "base/diag.h"

#include <stddef.h>

#define BRDF_MAX_WAVELENGTHS 512
#define BRDF_MAX_SAMPLES 65536
/* 1/sr; a mirror at 89 degrees seen through a tenth of a degree has less. */
#define BRDF_MAX_VALUE 1e6
/* A sample nearer to the horizon than this says nothing that can be used. */
#define BRDF_MAX_THETA 1.57

struct brdf_sample {
	double theta_i, theta_o, phi; /* phi: between the two azimuths, 0..pi */
	double rgb[3];                /* 1/sr, >= 0 */
};

struct brdf_samples {
	struct brdf_sample *samples;
	size_t count;
	size_t wavelengths;
	size_t below_zero; /* values of the text that were below 0 (noise), taken as they are */
	size_t cut;        /* bands of samples that were out of the gamut */
};

/*
 * Text of len bytes; name stands in diag with the line. GR_OK with *out to be
 * finished, GR_ERR_CONFIG, GR_ERR_NOMEM.
 */
int brdf_read(const char *text, size_t len, const char *name, struct brdf_samples *out,
	      struct gr_diag *diag);
void brdf_samples_finish(struct brdf_samples *samples);

/*
 * Weights of `count` wavelengths (nm, rising, within 300..900) for each band;
 * those of a band add up to 1. GR_ERR_RANGE where they say nothing of one.
 */
int brdf_color_weights(const double *nm, size_t count, double (*out)[3]);

#endif
