/*
 * One global-illumination method behind one interface. A method knows the
 * scene and the lamps' reflective shadow maps, and neither the other methods
 * nor the wall that is drawn. update() is view independent and runs once a
 * frame; what shading needs is bound by bind() and read by the GLSL that the
 * method contributes.
 *
 * GL thread only.
 */
#ifndef GROTTO_RENDERER_GI_GI_H
#define GROTTO_RENDERER_GI_GI_H

#include "renderer/frame.h"
#include "renderer/scene/scene.h"

#include <stdbool.h>
#include <stdint.h>

/*
 * Reflective shadow maps of this frame, one layer a map (seed 004 section
 * 3.3.1, algorithm 2), square. A spot has one map, a point lamp six, a
 * directional lamp one, an emissive surface as many as the shadow stage
 * chose. The textures belong to the view's shadow stage.
 *
 *   position_area  RGBA32F  scene position of the texel's surface point; a: the surface
 *                           area that the texel covers (m^2), 0 where nothing was hit
 *   normal         RGBA16F  unit normal towards the lamp's side
 *   exitance       RGBA32F  radiant exitance of the reflected light there, W/m^2 per band
 *                           (direct irradiance times diffuse reflectance, medium included)
 */
struct rsm_set {
	unsigned position_area, normal, exitance; /* GL_TEXTURE_2D_ARRAY */
	int pixels;                               /* side of a layer */
	int layers;
	uint32_t changed; /* 1: some layer differs from the last frame */
	uint64_t version; /* grows with every change */
};

/* A scene's emissive triangles emit into the lattice, too. */
struct gi_stats {
	bool ran;             /* something was computed this frame */
	bool steady;          /* nothing changes any more; work has stopped */
	int steps;            /* propagation steps done this frame */
	uint64_t nonfinite;   /* cells found NaN or Inf: an error, reported once a second */
	double residual;      /* largest change since the frame before (after a restart: of the last step) over the largest value, some frames old; -1 unknown */
};

struct gi_method;
struct gi_method_ops {
	const char *name;
	/* Why it runs, for the node's log. */
	const char *(*describe)(const struct gi_method *method);
	/* Injects, propagates; frame->gi_epoch changed: from zero to the steady state. */
	int (*update)(struct gi_method *method, const struct render_frame *frame,
		      const struct rsm_set *rsm);
	/* Binds what shader_name's function reads: texture units and buffers from 8 on. */
	void (*bind)(const struct gi_method *method);
	/*
	 * GLSL file that defines: vec3 gi_irradiance(vec3 position, vec3 normal)
	 * (W/m^2 per band at a surface point with that unit normal).
	 */
	const char *shader_name;
	void (*stats)(const struct gi_method *method, struct gi_stats *out);
	/* Order-dependent 64 bit hash of the whole light field, bit-equal on equal nodes. Slow: reads back. */
	uint64_t (*hash)(const struct gi_method *method);
	void (*destroy)(struct gi_method *method);
};

struct gi_method {
	const struct gi_method_ops *ops;
};

/* Light propagation volumes (renderer/gi/lpv.h); scene is used during the call only. */
int gi_lpv_create(struct gi_method **out, const struct scene *scene, const struct scene_file *file);

#endif
