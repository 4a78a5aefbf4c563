/*
 * Truth for the tests: indirect irradiance by path tracing (Embree), diffuse
 * surfaces, one spotlight. And the spotlight's light on the surfaces as a set
 * of points, laid out like a reflective shadow map.
 */
#ifndef GROTTO_TOOLS_BENCH_TRUTH_H
#define GROTTO_TOOLS_BENCH_TRUTH_H

#include "renderer/gi/surface.h"
#include "renderer/scene/scene.h"
#include "renderer/trace/rays.h"

#include <stddef.h>
#include <stdint.h>

struct truth_spot {
	float position[3], direction[3]; /* unit */
	float intensity[3];		 /* W/sr inside the cone */
	float half_angle;		 /* radians */
};

struct truth {
	const struct scene *scene;
	struct rays *rays;
	struct surface_lookup *lookup;
	struct truth_spot spot;
};
int truth_init(struct truth *out, const struct scene *scene, const struct truth_spot *spot);
void truth_finish(struct truth *truth);

/* The spot's irradiance on a surface point. */
void truth_direct(const struct truth *truth, const float position[3], const float normal[3],
		  float out[3]);

struct truth_texel {
	float position[3], area, normal[3], exitance[3];
};
/* pixels x pixels texels on a square map around the cone; area 0: nothing there. */
void truth_map(const struct truth *truth, int pixels, struct truth_texel *out);

struct truth_sample {
	float position[3], normal[3];
	double area;		   /* m^2 that it stands for */
	double irradiance[3];	   /* indirect, W/m^2 */
	double standard_error;	   /* of the mean over the bands */
};
/*
 * Points spread evenly over all surfaces that see the room (front sides), at
 * least margin metres from other surfaces. Returns how many.
 */
size_t truth_points(const struct truth *truth, uint64_t seed, float margin,
		    struct truth_sample *out, size_t count);
void truth_trace(const struct truth *truth, uint64_t seed, int paths,
		 struct truth_sample *samples, size_t count);

struct truth_error {
	double bias;  /* (mean - truth)/truth, over area and bands */
	double nrmse; /* root of the mean square error over mean truth */
	double shape; /* the same after the best factor */
	double noise; /* of the truth, as nrmse */
};
/* found: 3 floats per sample. */
struct truth_error truth_compare(const struct truth_sample *samples, const float *found,
				 size_t count);

#endif
