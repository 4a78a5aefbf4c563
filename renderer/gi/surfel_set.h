/*
 * Relit surfels, what is computed once from the static scene: where they are,
 * what lights them, and how a point of a surface finds those around it. Plain
 * data; made by surfel_bake.h, kept by surfel_file.h, used by surfels.c.
 *
 * A surfel stands for a patch of a surface: the points that are nearer to it
 * than to any other of its side. All surfaces have some, both sides of those
 * that are two-sided. Its irradiance is the mean over its patch.
 *
 * The light that a patch reflects, B = albedo (E_lamps + E_fixed + E_indirect)
 * [W/m^2], is radiance B/pi in every direction. A link is a cosine-distributed
 * ray from a point of the patch, so E_indirect = 1/links sum of the linked
 * surfels' B. (The Division's relit probes; Silvennoinen and Lehtinen 2017;
 * seed 003's transfer vectors with surfaces for a sky.)
 *
 * Light of emissive surfaces and of the environment does not change; E_fixed
 * is traced once (fixed_emissive + fixed_other). So links carry reflected light only. A link ends where it
 * meets a diffuse surface; off mirrors and glossy ones it goes on.
 *
 * Not thread safe.
 */
#ifndef GROTTO_RENDERER_GI_SURFEL_SET_H
#define GROTTO_RENDERER_GI_SURFEL_SET_H

#include <stddef.h>
#include <stdint.h>

#define SURFEL_SECTORS 16     /* of the directions across a surfel's normal */
#define SURFEL_NONE UINT32_MAX /* a link that brings nothing: out of the scene, onto an unlit back, absorbed */
#define SURFEL_PROBE_SIDE 16  /* texels along a side of a probe's map of distances, octahedral */
#define SURFEL_SH 9           /* coefficients of three bands */

/* As the GPU reads it, 32 bytes. */
struct surfel {
	float position[3]; /* scene, metres */
	uint32_t normal;   /* unit, octahedral, two 16 bit signed normalised: x in the low half */
	/*
	 * How far one sees along the surface, as a share of `radius` (255: all of
	 * it), in SURFEL_SECTORS directions; between them 1/reach is linear.
	 * Sector 0 is the first axis of surfel_frame, and on to the second. A wall
	 * on the surface stops it: beyond, the surfel is not heard.
	 */
	uint8_t reach[SURFEL_SECTORS];
};

struct surfel_tap {
	float position[3]; /* a point of the patch */
	uint32_t normal;   /* there */
};

/* Cells of a grid over the scene; a dense one, or hashed where that is too large: see surfel_set_cell. */
struct surfel_grid {
	float origin[3], cell_m;
	int32_t size[3];
	uint32_t slots;    /* of the hash table, a power of two; 0: dense, slots are cell numbers */
	uint32_t *keys;    /* hashed: cell number + 1 of each slot, 0 empty */
	uint32_t *first;   /* slots + 1 or cells + 1 places in `members` */
	uint32_t *members; /* surfels that reach into the cell, in rising order */
	size_t member_count;
};

/* Probes stand in a grid: x fastest. Those inside of solid things are dead. */
struct surfel_probes {
	float origin[3], cell_m;
	int32_t size[3]; /* probes along each axis */
	size_t count;
	uint32_t links_each;
	float (*directions)[3]; /* links_each unit directions, spread evenly over the sphere; the same for all */
	uint32_t *links;        /* count x links_each */
	float (*fixed)[SURFEL_SH][3]; /* radiance of emissive surfaces and environment, SH */
	/* Distances to the surfaces around, metres, for visibility: mean and mean square a texel. */
	float (*distance)[SURFEL_PROBE_SIDE * SURFEL_PROBE_SIDE][2];
	uint8_t *alive;
};

struct surfel_set {
	float spacing_m; /* least distance between two of one side */
	float radius_m;  /* how far a surfel is heard */
	size_t count;
	uint32_t links_each, taps_each;
	struct surfel *surfels;
	float *area;         /* m^2, of each patch */
	float (*albedo)[3];  /* diffuse reflectance, mean over the patch */
	/*
	 * E_fixed, W/m^2, in two: what emissive surfaces send straight here, which
	 * shading adds by itself, and all else that does not change (the
	 * environment; emissive surfaces by way of mirrors), which shading takes
	 * from the surfels together with E_indirect.
	 */
	float (*fixed_emissive)[3], (*fixed_other)[3];
	uint32_t *links;     /* count x links_each: a surfel, or SURFEL_NONE */
	struct surfel_tap *taps; /* count x taps_each */
	struct surfel_grid grid;
	struct surfel_probes probes; /* count 0: none asked for */

	/* How it was made. */
	size_t rays;
	double seconds, ray_seconds; /* all of it; tracing, all threads together */
	int threads;
};

void surfel_set_destroy(struct surfel_set **set);
/* Order-dependent 64 bit hash of all data that light depends on. */
uint64_t surfel_set_hash(const struct surfel_set *set);
size_t surfel_set_bytes(const struct surfel_set *set);

/* Octahedral normals (Cigolle et al. 2014), 16 bit each. */
uint32_t surfel_normal_pack(const float normal[3]);
void surfel_normal_unpack(uint32_t packed, float out[3]);
/* Axes across a unit normal (Duff et al. 2017); the shaders have the same. */
void surfel_frame(const float normal[3], float u[3], float v[3]);

/*
 * Weights of reconstruction, the same as shaders/gi_surfels.glsl has: what
 * surfel i counts at a point of a surface. 0 where it is not heard: too far,
 * another side, another plane, or behind a wall.
 */
float surfel_weight(const struct surfel_set *set, size_t i, const float position[3],
		    const float normal[3]);
/* Surfels whose radius reaches into the cell of a position; returns their number. */
size_t surfel_set_cell(const struct surfel_set *set, const float position[3],
		       const uint32_t **out_members);

#endif
