/*
 * Inside of the surfel baker: its steps, in order, each in a file of its own.
 * All return GR_OK, GR_NOTHING (stopped) or an error.
 */
#ifndef GROTTO_RENDERER_GI_SURFEL_BAKE_PRIVATE_H
#define GROTTO_RENDERER_GI_SURFEL_BAKE_PRIVATE_H

#include "renderer/gi/surfel_bake.h"
#include "renderer/trace/crew.h"
#include "renderer/trace/medium.h"
#include "renderer/trace/world.h"

#include <stdatomic.h>

/* Points a surfel's patch has about. */
#define BAKE_POINTS_EACH 64
/* Cosine of the largest angle between the normals of a patch. */
#define BAKE_SAME_SIDE 0.7f
/* Sight along a surface is from this far above it, of the spacing: lower steps are none. */
#define BAKE_LIFT 0.1f
/* How far a surfel is heard, in spacings. */
#define BAKE_RADIUS 2.0f

struct bake_point {
	struct v3 position;
	uint32_t side; /* triangle * 2, + 1 on its back */
	float u, v;    /* in the triangle, as struct ray_hit's */
	float area;    /* m^2 that it stands for */
	float lift;    /* m above the surface from which sight is looked for */
	bool covered;  /* by a surface of the same side, within a plane's tolerance */
	uint32_t patch; /* surfel */
};

/* Buckets of a spatial hash: items in cells of a cube grid, found by cell. */
struct bake_cell {
	uint64_t key; /* of its place, 0: empty */
	uint32_t first, count;
};
struct bake_cells {
	float cell_m;
	size_t slot_count; /* power of two */
	struct bake_cell *slots;
	uint32_t *items;
};

/* What a hit looks up, in the order of the cells' items: close together in memory. */
struct bake_near {
	struct v3 position, normal;
	uint32_t side, patch;
	float clear_m; /* around it, from where its patch's surfel is surely seen; -1: nowhere surely */
};

/* What a ray meets there, and a side's cells from a corner along the two edges (surfel_map.c). */
struct bake_face {
	uint32_t first;
	unsigned corner : 2, meets : 2, across : 14, along : 14;
};

struct bake {
	const struct scene *scene;
	const struct scene_file *file; /* may be NULL */
	struct surfel_bake_params params;
	struct gr_diag *diag;
	int threads;

	struct world world;
	struct medium air;       /* takes what it scatters, too: that comes from the lattice alone */
	size_t triangle_count;
	struct v3 *normals;      /* of each triangle's front; 0 0 0: not a triangle */
	float *areas;            /* of each triangle, m^2 */
	bool *two_sided;         /* of each triangle */
	uint32_t *piece_order;   /* triangles sorted by connected piece */
	uint32_t *piece_first;   /* places in it */
	size_t piece_count;
	float min[3], max[3];    /* of real triangles */
	double area;             /* of all sides */

	float spacing, radius;
	float lift;              /* most */
	float offset;            /* of a ray's start off its surface */

	struct bake_point *points;
	size_t point_count;
	float point_area;        /* mean */
	struct bake_cells cells; /* of the points */
	struct bake_near *near;  /* of each of its items; once all belong to surfels */
	uint32_t *chosen;        /* points that are surfels */
	size_t chosen_count;
	struct bake_cells surfel_cells;
	uint32_t *patch_first;   /* surfels + 1 places in patch_points */
	uint32_t *patch_points;  /* sorted by patch; in one, by place */
	float *patch_sums;       /* area of the patch up to each */

	uint32_t (*sobol)[3];    /* of each link of a surfel, not yet scrambled */
	struct bake_face *faces; /* of each side: the fronts, and then the backs */
	_Atomic uint32_t *map;   /* cells of the faces */
	_Atomic uint32_t *map_beyond; /* of those that a wall parts, what is on its other side */

	struct surfel_set *set;

	/* progress */
	const char *stage;
	double stage_from, stage_to; /* shares of all the work */
	int64_t started_ns;
};

static inline struct v3 bake_normal(const struct bake *bake, uint32_t side)
{
	struct v3 n = bake->normals[side / 2];

	return side & 1 ? v3_scale(n, -1.0f) : n;
}

/* surfel_surface.c: triangles, sides, pieces, bounds. */
int bake_surface(struct bake *bake);
/* surfel_points.c: fills points for about `surfels` surfels of this spacing. */
int bake_points(struct bake *bake);
/*
 * surfel_patches.c. Adds surfels such that each of the points (only NULL: all)
 * has one of those just added near. GR_ERR_RANGE: they would be more than
 * SURFEL_MOST.
 */
int bake_choose(struct bake *bake, const uint32_t *only, size_t only_count);
int bake_sort_chosen(struct bake *bake);
/* To which surfel each point belongs. */
int bake_assign(struct bake *bake);
/* The nearest surfel of the same surface, seen from there; after bake_assign has begun. */
uint32_t bake_nearest_surfel(const struct bake *bake, const struct bake_point *p);
/* Nothing between two points, lifted off their surface. */
bool bake_sees(const struct bake *bake, const struct bake_point *a, const struct bake_point *b);
/* surfel_patch_data.c: points by patch; area, albedo, taps. */
int bake_patch_data(struct bake *bake);
/* A point of patch i at a share 0..1 of its area. */
uint32_t bake_patch_point(const struct bake *bake, size_t i, float share);
/*
 * surfel_reach.c: the set's surfels of the chosen points, and its grid; then the
 * points at which no surfel is heard. Caller frees *out.
 */
int bake_reach(struct bake *bake);
int bake_unheard(struct bake *bake, uint32_t **out, size_t *out_count);
/* surfel_material.c: diffuse reflectance at a point, as links need it. */
void bake_albedo(const struct bake *bake, const struct bake_point *point, float out[3]);
/* Where a ray's way ended, and the fixed light that it brings by way of mirrors. */
struct bake_end {
	uint32_t surfel; /* SURFEL_NONE: brings no reflected light */
	bool back;       /* met an unlit back at once */
	float light[3];  /* W/(m^2 sr) */
	float way, way2; /* mean of its bands times the metres that it has come, and their squares */
};
/*
 * Follows a ray until it ends on a diffuse surface, is absorbed or leaves the
 * scene; key: of its random numbers.
 */
void bake_follow(const struct bake *bake, struct v3 from, struct v3 way, uint64_t key,
		 struct bake_end *out);
/* A direction about a normal, by the cosine. */
struct v3 bake_cosine(struct v3 normal, const float u[2]);
/*
 * surfel_owner.c: the surfel whose patch holds a place on a side, SURFEL_NONE: none.
 * The other one says too whether places around, on the same side, all see what makes
 * the position belong to its surfel; false: it is in doubt.
 */
uint32_t bake_surfel_at(const struct bake *bake, struct v3 position, uint32_t side);
uint32_t bake_surfel_around(const struct bake *bake, struct v3 position, uint32_t side,
			    const struct v3 *rim, int rim_count, bool *out_whole);
/* Whether a place is seen from a surfel, as its reach has it. */
bool bake_reaches(const struct bake *bake, uint32_t surfel, struct v3 position);
/* What a ray meets on a side: nothing that reflects; what every link ends at; the rest. */
enum bake_meets { BAKE_NOTHING, BAKE_PLAIN, BAKE_GLOSSY };
enum bake_meets bake_meets(const struct bake *bake, uint32_t side);
/*
 * surfel_map.c: for rays by the thousand, the same from a map that remembers. First
 * all of a batch are looked up, so that memory is asked for early; then each read.
 */
struct bake_place {
	enum bake_meets meets;
	uint32_t side, cell, at;
	bool looks_up; /* for this ray or for its cell */
	size_t slot;   /* of the points around, then */
};
/* Places that are expected at once: what memory is asked for stays in the caches. */
#define BAKE_PLACES 32
int bake_map(struct bake *bake);
void bake_map_finish(struct bake *bake);
void bake_map_expect(const struct bake *bake, size_t count, const struct ray_start *rays,
		     const struct ray_met *met, struct bake_place *out);
/* Of a place that meets BAKE_PLAIN. */
uint32_t bake_map_read(const struct bake *bake, const struct ray_start *ray,
		       const struct ray_met *met, const struct bake_place *place);
/* surfel_start.c: the links' rays, at most BAKE_LINKS_AT_ONCE of a surfel, from link `first` on. */
#define BAKE_LINKS_AT_ONCE 256
struct bake_links_rays {
	uint32_t count;
	struct ray_start ray[BAKE_LINKS_AT_ONCE];
};
int bake_link_tables(struct bake *bake);
void bake_link_rays(const struct bake *bake, size_t i, uint32_t first, struct bake_links_rays *out);
/* surfel_links.c: all links, and what mirrors show surfels; again, the same anew. */
int bake_links(struct bake *bake);
/*
 * surfel_fixed.c; after the links, which bring what mirrors show, and its ways as sums in
 * the last two of fixed_way.
 */
int bake_fixed(struct bake *bake);
/* surfel_probes.c */
int bake_probes(struct bake *bake);

/* surfel_cells.c: position(ctx, i) of `count` items. GR_OK, GR_ERR_NOMEM. */
int bake_cells_build(struct bake_cells *out, float cell_m, size_t count,
		     struct v3 (*position)(const void *ctx, size_t i), const void *ctx);
void bake_cells_finish(struct bake_cells *cells);
/* Items of the cell `step` cells away from that of a position. */
size_t bake_cells_at(const struct bake_cells *cells, struct v3 position, const int step[3],
		     const uint32_t **out_items);
/* The slot from which a position's cell will be looked for; memory is asked for it. */
size_t bake_cells_expect(const struct bake_cells *cells, struct v3 position);
/* m^2, from a position to the cell a step of -1, 0 or 1 away. */
float bake_cells_square(const struct bake_cells *cells, struct v3 position, const int step[3]);

/* Lengths that go with a spacing. */
void bake_set_spacing(struct bake *bake, float spacing);
/* Surfels among the points such that every point hears one. */
int bake_place(struct bake *bake);
/* All that the baker holds, its set too. */
void bake_finish(struct bake *bake);
/* As surfel_bake; `then` sees the baker before it goes: for measuring. NULL: none. */
int bake_then(struct surfel_set **out, const struct scene *scene, const struct scene_file *file,
	      const struct surfel_bake_params *params, struct gr_diag *diag,
	      void (*then)(struct bake *bake, void *ctx), void *ctx);

/* Says how much of the stage is done; false: stop. */
bool bake_told(struct bake *bake, double done);
/* Runs work over items on all threads, with progress. */
int bake_run(struct bake *bake, size_t items, size_t portion, crew_work work, void *ctx);

#endif
