/*
 * Inside of the relit surfels: buffers and programs, for surfels*.c and for
 * tests that look into the light. GL thread only.
 */
#ifndef GROTTO_RENDERER_GI_SURFELS_PRIVATE_H
#define GROTTO_RENDERER_GI_SURFELS_PRIVATE_H

#include "renderer/gi/dispatch.h"
#include "renderer/gi/surfels.h"

#define SURFELS_GROUP 64 /* SURFEL_GROUP in shaders/surfel_block.glsl */
#define SURFELS_RING 4	 /* frames until a check is read back */

/* Uniform and storage buffer bindings; see the shaders. */
enum surfels_binding {
	SURFELS_BINDING_BLOCK = 8,  /* uniform */
	SURFELS_BINDING_WORDS = 8,  /* packed slices */
	SURFELS_BINDING_FOUND = 12, /* what passes write */
	SURFELS_BINDING_DIRECT = 13,
	SURFELS_BINDING_RADIOSITY = 14,
	SURFELS_BINDING_OTHER = 15, /* checks, scales of slices */
};

/*
 * Texture units. What passes only read they read as buffer textures: a GPU does
 * not mind, and a software renderer reads those several times faster than storage.
 */
enum surfels_unit {
	SURFELS_UNIT_SURFELS = 8, /* shading */
	SURFELS_UNIT_LIGHT = 9,
	SURFELS_UNIT_FIRST = 10,
	SURFELS_UNIT_MEMBERS = 11,
	SURFELS_UNIT_KEYS = 12,
	SURFELS_UNIT_RADIOSITY = 8, /* passes */
	SURFELS_UNIT_TEXELS = 9,
	SURFELS_UNIT_BEFORE = 9,
	SURFELS_UNIT_PARTS = 10, /* links or taps: the part that is worked on */
	SURFELS_UNIT_ALBEDO = 11,
	SURFELS_UNIT_EMISSIVE = 12,
	SURFELS_UNIT_FOUND = 13, /* of the light pass; the next two of the gather */
	SURFELS_UNIT_DIRECT = 13,
	SURFELS_UNIT_OTHER = 14,
	SURFELS_UNIT_WAYS = 13,	 /* of the probes' gather */
	SURFELS_UNIT_PROBES = 8, /* shading from probes */
	SURFELS_UNIT_DISTANCE = 9,
	SURFELS_UNIT_ALIVE = 10,
};

/* A buffer that programs write as storage and read as a texture (0: only storage). */
struct surfels_buffer {
	unsigned buffer, texture;
};

/* Surfels in shaders/surfel_block.glsl (std140). */
struct surfels_block {
	float grid[4];
	int32_t cells[4];
	float kernel[4];
	uint32_t counts[4];
};

struct surfels_check {
	uint32_t nonfinite, change, largest, probes_nonfinite;
};

/* A run of surfels: first is a multiple of SURFELS_GROUP. */
struct surfels_run {
	uint32_t first, last; /* one past */
};

/* Work shared with other nodes (surfels_share.c). */
struct surfels_share {
	unsigned index, count; /* count 1: all is done here */
	bool other_slices;     /* set() was called since the last update */
	unsigned programs[3];  /* peak, pack, unpack */
	/*
	 * Two words a surfel: what is in use, and what this node found last; and the
	 * scales of the slices, two words each, this node's newest one last.
	 */
	unsigned used, fresh, scales;
	unsigned used_texture, scales_texture;
	unsigned staging; /* fresh slice with its scales, mapped */
	const volatile uint32_t *staging_map;
	bool staged;	   /* not yet taken */
	bool staged_fresh; /* not yet in use either */
	bool taken;	   /* fresh is to be used from the next update on */
	bool sent_valid;
	uint32_t *sent;	   /* scales, words */
	uint32_t *arrived; /* words of all slices, by surfel */
	uint32_t arrived_scales[SURFELS_SLICES_MAX][2];
	bool has_arrived[SURFELS_SLICES_MAX];
	unsigned char set_hash[8];
};

/* Fixed light in air that changes (surfels_air.c). */
struct surfels_air {
	unsigned program;  /* 0: there is no such light */
	float baked_in;    /* 1/m */
	float more;        /* 1/m, that `emissive` and `other` stand for; so much more than baked_in */
	struct surfels_buffer ways, emissive, other; /* as baked */
};

/* Spherical harmonics on a grid (surfels_probes.c). */
struct surfels_probes {
	unsigned program, check, block; /* check: looks for what is not finite */
	size_t count;
	uint32_t links_each;
	struct dispatch all, each; /* coefficients; probes */
	struct surfels_buffer links, basis, fixed, ways, light, alive;
	unsigned distance; /* texture, octahedral maps with a border of one texel */
};

struct surfels {
	struct gi_method base;
	struct surfels_params params;
	size_t count;
	uint32_t links_each, taps_each;
	int settle_gathers; /* after which a change has settled; the same on all nodes */
	char description[320];
	size_t bytes; /* on the GPU */

	unsigned light, dark_light, gather, gather_medium, smooth, check; /* programs; dark_light: without lamps */
	unsigned block, checks;
	struct surfels_buffer texels;	       /* struct surfel */
	struct surfels_buffer links, taps;     /* in blocks of SURFELS_GROUP surfels; links four a texel */
	uint32_t links_part, taps_part;	       /* surfels whose links and taps a shader sees at once */
	struct surfels_buffer albedo, emissive, other; /* RGBA32F as all that follow */
	struct surfels_buffer direct;	       /* of the lamps, W/m^2 */
	struct surfels_buffer found;	       /* indirect + other: the newest */
	struct surfels_buffer half;	       /* smoothed once */
	struct surfels_buffer shown;	       /* smoothed twice, as shading reads it */
	struct surfels_buffer around_first, around; /* what is summed up for it */
	struct surfels_buffer radiosity[2];    /* [current] is the newest; one dark surfel at the end */
	int current;
	struct surfels_buffer first, members, keys; /* the grid */
	struct surfels_share share;
	struct surfels_probes probes;
	struct surfels_air air;

	/* What the light stands for. */
	bool started, lit;
	uint64_t epoch, version;
	float absorption, scattering;
	int since_change; /* gathers; shared: frames */

	/* Checks come back some frames later. */
	const volatile struct surfels_check *check_map;
	void *fences[SURFELS_RING];
	unsigned ring;
	bool checking; /* a look has begun and not ended */
	struct gi_stats stats;
	uint64_t nonfinite_frames;
};

/* surfels_upload.c: buffers from the set; settle_gathers. */
int surfels_upload(struct surfels *s, const struct surfel_set *set);
void surfels_upload_finish(struct surfels *s);
/* A storage buffer with a texture of that format (0: none); data NULL: zeroed. GR_OK or refused with words. */
int surfels_storage(struct surfels *s, struct surfels_buffer *out, const char *what,
		    unsigned format, size_t bytes, const void *data);
void surfels_storage_finish(struct surfels_buffer *buffer);

/* Texels that hold a surfel's links, four each; what is left over is dark. */
static inline size_t surfels_link_texels(size_t links_each)
{
	return (links_each + 3) / 4;
}

/* surfels.c: passes over a run. */
void surfels_relight(struct surfels *s, struct surfels_run run, bool lamps);
void surfels_gather(struct surfels *s, struct surfels_run run);
void surfels_barrier(void);
/* Runs the program in use over a run; its uniform 0 is the run. */
void surfels_dispatch(unsigned program, struct surfels_run run);

/* surfels_smooth.c: from `found` to `shown`. */
int surfels_smooth_init(struct surfels *s, const struct surfel_set *set);
void surfels_smooth_finish(struct surfels *s);
void surfels_smooth(struct surfels *s);

/*
 * surfels_check.c: looks at the newest light, reads what is there of earlier looks.
 * begin looks at the surfels, end at the probes, when they have been fed; an end
 * without a begin does nothing.
 */
int surfels_check_init(struct surfels *s);
void surfels_check_finish(struct surfels *s);
void surfels_check_begin(struct surfels *s, struct surfels_run run);
void surfels_check_end(struct surfels *s);
void surfels_check_collect(struct surfels *s);

/* surfels_share.c */
extern const struct gi_share_ops surfels_share_ops;
int surfels_share_init(struct surfels *s, const struct surfel_set *set);
void surfels_share_finish(struct surfels *s);
struct surfels_run surfels_share_run(const struct surfels *s, unsigned index);
/* New slices: what is in use, cut and rounded anew. */
void surfels_share_recut(struct surfels *s);
/* Takes what has arrived into use, where the passes work. True when there was any. */
bool surfels_share_apply(struct surfels *s);
/* Own slice as it is in use, where the passes work. */
void surfels_share_restore(struct surfels *s);
/* Rounds the newest result of this node's slice, for take(). */
void surfels_share_pack(struct surfels *s);
uint64_t surfels_share_hash(const struct surfels *s);

/* surfels_air.c: `emissive` and `other` for the air that there is. */
int surfels_air_init(struct surfels *s, const struct surfel_set *set);
void surfels_air_finish(struct surfels *s);
/* Does nothing in air that is as it was. */
void surfels_air_apply(struct surfels *s);
/* What a metre of the present air takes, 1/m. */
float surfels_extinction(const struct surfels *s);

/* surfels_probes.c */
int surfels_probes_init(struct surfels *s, const struct surfel_set *set);
void surfels_probes_finish(struct surfels *s);
void surfels_probes_gather(struct surfels *s);
/* Counts probes whose light is not finite, into the bound check. */
void surfels_probes_check(struct surfels *s);
void surfels_probes_bind(const struct surfels *s);

/* 64 bits of a buffer's first bytes, on top of `before`. Waits. */
uint64_t surfels_hash_buffer(unsigned buffer, size_t bytes, uint64_t before);

#endif
