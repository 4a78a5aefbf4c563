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
 * is traced once (fixed_emissive + fixed_other). So links carry reflected light
 * only. A link ends where it meets a diffuse surface; off mirrors and glossy
 * ones it goes on, by chance t, and `albedo` is what is reflected diffusely
 * over 1 - t: so all links weigh the same.
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
#define SURFEL_SH 9           /* coefficients of three bands, real, orthonormal: 1, y, z, x, xy, yz, 3z^2-1, xz, x^2-y^2 */

/* As the GPU reads it, 32 bytes. */
struct surfel {
	float position[3]; /* scene, metres */
	uint32_t normal;   /* unit, octahedral, two 16 bit signed normalised: x in the low half */
	/*
	 * How far one sees along the surface in SURFEL_SECTORS directions; a wall
	 * on the surface ends it, and beyond it the surfel is not heard. The ends
	 * are the corners of a polygon with straight sides, so that a straight
	 * wall is met exactly. Direction k is (x, y) on |x| + |y| = 1 in the axes
	 * of surfel_frame, at the k-th of 16 equal steps from (1, 0) by way of
	 * (0, 1); the length |x| + |y| at its end, over sqrt(2) radius_m, is
	 * reach / 255. 255: there is no end. Never 0. 1 in all: a surfel in a cavity so
	 * thin that another surface of its side lies within its plane's tolerance (the
	 * inside of a thin wall); it is not heard outside of it.
	 */
	uint8_t reach[SURFEL_SECTORS];
};

struct surfel_tap {
	float position[3]; /* a point of the patch */
	uint32_t normal;   /* there */
};

/*
 * Cells of a grid over the scene; a dense one, or hashed where that is too
 * large. A cell's number is x + size[0] (y + size[1] z), below 2^32 - 1; its
 * slot is that number, or, hashed, surfel_grid_slot's or the first after it (the
 * first slot follows the last) with its key; an empty one ends the search.
 * A position outside of the grid has no cell.
 */
struct surfel_grid {
	float origin[3], cell_m;
	int32_t size[3];
	uint32_t slots;    /* of the hash table, a power of two; 0: dense, slots are cell numbers */
	uint32_t *keys;    /* hashed: cell number + 1 of each slot, 0 empty */
	uint32_t *first;   /* slots + 1 or cells + 1 places in `members` */
	uint32_t *members; /* surfels that reach into the cell, in rising order */
	size_t member_count;
};

/*
 * Probes stand in a grid, x fastest, the first at `origin`, half a cell inside
 * of the scene's bounds. Those inside of solid things are dead.
 */
struct surfel_probes {
	float origin[3], cell_m;
	int32_t size[3]; /* probes along each axis */
	size_t count;
	uint32_t links_each;
	float (*directions)[3]; /* links_each unit directions, spread evenly over the sphere; the same for all */
	uint32_t *links;        /* count x links_each */
	/*
	 * Radiance that does not change, SH, as fixed_other: of the environment, and of
	 * emissive surfaces by way of mirrors; what they send straight here shading adds.
	 */
	float (*fixed)[SURFEL_SH][3];
	float (*fixed_way)[2]; /* as the set's, of it */
	/*
	 * Distances to the surfaces around, metres, none more than two cells, for
	 * visibility: mean and mean square a texel. Texel (x, y) holds the directions
	 * whose octahedral map falls on it: (x + 1/2) / SURFEL_PROBE_SIDE is 0..1 for -1..1.
	 */
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
	float (*albedo)[3];  /* diffuse reflectance as links need it (above), mean over the patch; 0..1 */
	/*
	 * E_fixed, W/m^2, in two: what emissive surfaces send straight here, which
	 * shading adds by itself, and all else that does not change (the
	 * environment; emissive surfaces by way of mirrors), which shading takes
	 * from the surfels together with E_indirect.
	 */
	float (*fixed_emissive)[3], (*fixed_other)[3];
	/*
	 * How far these have come through the air, weighed by what arrives: mean in
	 * metres and variance of the first, and of the second. For air that is not what
	 * it was when they were baked, which took `extinction` a metre (surfel_thinned).
	 */
	float (*fixed_way)[4];
	float extinction; /* 1/m */
	uint32_t *links;     /* count x links_each: a surfel, or SURFEL_NONE */
	struct surfel_tap *taps; /* count x taps_each */
	struct surfel_grid grid;
	struct surfel_probes probes; /* count 0: none asked for */

	/* How it was made. */
	size_t rays;
	double seconds, ray_seconds; /* all of it; the surfels' links alone */
	int threads;
};

void surfel_set_destroy(struct surfel_set **set);
/* Order-dependent 64 bit hash of all data that light depends on. */
uint64_t surfel_set_hash(const struct surfel_set *set);
size_t surfel_set_bytes(const struct surfel_set *set);
/* All arrays in a fixed order, for what treats them alike; returns the sum of their bytes. */
#define SURFEL_PARTS 17
struct surfel_part {
	const void *data;
	size_t bytes;
};
size_t surfel_set_parts(const struct surfel_set *set, struct surfel_part out[SURFEL_PARTS]);

/*
 * The share of fixed light that is left in air that takes `more` a metre than when it
 * was baked; above 1 in less. Lengths of ways are taken to have a gamma distribution of
 * that mean and variance, for which this is exact. shaders/surfel_air.glsl has the same.
 */
float surfel_thinned(const float way[2], float more);
/* Mean and variance from a sum of what has arrived, and that times its way, and its square. */
void surfel_way_of(double light, double way, double way2, float out[2]);

/* Octahedral normals (Cigolle et al. 2014), 16 bit each. */
uint32_t surfel_normal_pack(const float normal[3]);
void surfel_normal_unpack(uint32_t packed, float out[3]);
/* Axes across a unit normal (Duff et al. 2017); the shaders have the same. */
void surfel_frame(const float normal[3], float u[3], float v[3]);

/*
 * How far a point is on its way from surfel i to the end of its sight: up to 1
 * it is seen, beyond it is behind a wall.
 */
float surfel_sight(const struct surfel_set *set, size_t i, const float position[3]);
/*
 * Weights of reconstruction, the same as shaders/gi_surfels.glsl has: what
 * surfel i counts at a point of a surface. 0 where it is not heard: too far,
 * another side, another plane, or behind a wall. With d the way from the
 * surfel, n and m the two normals, s surfel_sight:
 *
 *   (1 - d^2/R^2)^2 max(0, 2 n.m - 1)^2 max(0, 1 - (d.(n+m)/2 / (SURFEL_PLANE spacing))^2)^2 fade(s)
 *
 * fade falls from 1 to SURFEL_FADE on the last SURFEL_FADE_FROM..1 of sight, so
 * that its end is not seen, and is SURFEL_BEHIND up to SURFEL_SIGHT_MOST: what
 * stands closer to a wall than reach can tell hears something.
 */
#define SURFEL_PLANE 0.1f
#define SURFEL_FADE_FROM 0.6f
#define SURFEL_FADE 0.05f
#define SURFEL_BEHIND 1e-4f
#define SURFEL_SIGHT_MOST 1.05f
float surfel_weight(const struct surfel_set *set, size_t i, const float position[3],
		    const float normal[3]);
/* Fills set->grid from surfels, radius and bounds. GR_OK, GR_ERR_NOMEM. */
int surfel_grid_build(struct surfel_set *set, const float min[3], const float max[3]);
static inline uint32_t surfel_grid_slot(uint32_t cell, uint32_t slots)
{
	uint32_t x = cell * UINT32_C(0x9e3779b1);

	return (x ^ (x >> 15)) & (slots - 1);
}
/* Surfels whose radius reaches into the cell of a position; returns their number. */
size_t surfel_set_cell(const struct surfel_set *set, const float position[3],
		       const uint32_t **out_members);

#endif
