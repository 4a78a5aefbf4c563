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
	int steps;            /* propagation steps or gathers done this frame */
	uint64_t nonfinite;   /* cells found NaN or Inf: an error, reported once a second */
	uint64_t gpu_bytes;   /* of its buffers and textures on the GPU, without the lamps' maps */
	double residual;      /* largest change since the frame before (after a restart: of the last step) over the largest value, some frames old; -1 unknown */
};

/* Most steps and gathers of a frame, as the parameters have it; refining goes no further. */
#define GI_STEPS_MOST 128
#define GI_GATHERS_MOST 16

/* What a method wants to be given every frame; what none wants is not drawn. */
enum gi_need {
	GI_NEEDS_RSM = 1,   /* reflective shadow maps */
	GI_NEEDS_LAMPS = 2, /* the lamps' values and shadow maps bound as for shading (renderer/view/blocks.h) */
};
struct gi_light {
	const struct rsm_set *rsm; /* NULL without GI_NEEDS_RSM, or without any light */
	bool lamps;                /* bound, with GI_NEEDS_LAMPS; false: the scene has none */
	uint64_t version;          /* grows when lamps or medium changed */
};

struct gi_method;
/*
 * Work that the nodes share out: each computes its slice in update() and hands
 * it on; what arrived before the next update() is used there, its own slice
 * too. So light is a frame late, and the same bytes on every wall.
 */
struct gi_share_ops {
	/*
	 * From the next update() on this node computes slice `index` of `count`.
	 * count 1: all of it. Cheap when nothing changes.
	 */
	int (*set)(struct gi_method *method, unsigned index, unsigned count);
	/* Longest slice in bytes at that count. */
	size_t (*bytes_max)(const struct gi_method *method, unsigned count);
	/*
	 * This node's slice of the last update(), after renderer_finished. GR_OK;
	 * GR_NOTHING with *len 0 when it is as the others have it. After a set()
	 * that changed something, and after a restart of the light, they have
	 * nothing: GR_OK, steady or not.
	 */
	int (*take)(struct gi_method *method, uint8_t *bytes, size_t size, size_t *len);
	/*
	 * A slice of another node; it counts from the next update() on, which runs
	 * even if the light was steady. GR_OK, GR_ERR_FORMAT for bytes that are
	 * none, or of another division than set() said: nothing changes then.
	 */
	int (*put)(struct gi_method *method, const uint8_t *bytes, size_t len);
};

struct gi_method_ops {
	const char *name;
	unsigned needs; /* enum gi_need */
	const struct gi_share_ops *share; /* NULL: each node computes all */
	/* Why it runs, for the node's log. */
	const char *(*describe)(const struct gi_method *method);
	/*
	 * Takes the frame's light and moves on; frame->gi_epoch changed: from zero to
	 * the steady state, on this node alone.
	 */
	int (*update)(struct gi_method *method, const struct render_frame *frame,
		      const struct gi_light *light);
	/* Binds what shader_name's function reads: texture units 8 to 14, buffers from 8 on. */
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
