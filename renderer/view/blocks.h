/*
 * The blocks that the view's shaders read, byte for byte (std140),
 * and where they are bound. Bindings 0 (materials) and from 8 on (global
 * illumination) belong to others.
 */
#ifndef GROTTO_RENDERER_VIEW_BLOCKS_H
#define GROTTO_RENDERER_VIEW_BLOCKS_H

#include <stdint.h>

enum view_binding {
	/* uniform buffers: what all pixels read alike is read once, not once a pixel */
	VIEW_BINDING_FRAME = 1,
	VIEW_BINDING_LAMPS = 3,
	VIEW_BINDING_LAMP_LAYERS = 4,
	VIEW_BINDING_PATCHES = 5,
	/* storage buffer */
	VIEW_BINDING_COUNTERS = 7,
};

enum view_unit {
	VIEW_UNIT_GBUFFER = 0, /* five */
	VIEW_UNIT_LAMP_COMPARE = 5,
	VIEW_UNIT_LAMP_DEPTH = 6,
	VIEW_UNIT_PATCH_DEPTH = 7,
	VIEW_UNIT_BACKDROP = 15, /* those between belong to the global illumination */
};

/* Layers of the largest block: sixteen cubes. The shaders' arrays have fixed sizes. */
#define VIEW_LAYERS_MAX 96

/* Frame in shaders/medium.glsl. */
struct frame_block {
	float medium[4]; /* log2 transmittance per metre: extinction, absorption */
	float bounds_min[4], bounds_max[4];
	float background[4]; /* radiance; a: 1 when only from above the horizon */
};

/* Lamp in shaders/lamp.glsl. */
struct lamp_record {
	float position[4];
	float direction[4];
	float intensity[4]; /* a: surfaces nearer than this get what is there, metres */
	float cone[4];
	int32_t maps[4];
};

/* MapLayer in shaders/shadow.glsl. */
struct map_layer {
	float clip[16];  /* scene to clip space, x and y -1..1, depth 1 (near) .. 0 (far) */
	float extent[4]; /* half width at distance 1, or metres; pixels; 1 perspective;
			  * change of depth per 1/distance, ortho: per metre towards the eye */
	float range[4];  /* near, far, how far points are lifted off their surface; metres */
};

/* Patch in shaders/patch.glsl. */
struct patch_record {
	float centre[4];
	float u[4], v[4];
	float normal[4];
	float origin[4];
	float radiance[4];
	int32_t maps[4];
};

#endif
