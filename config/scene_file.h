/*
 * A scene file: which model, which lamps, which cameras for stills, how the
 * light is computed, how it is shown. Read from a libconfig file; every key
 * is in the option table (config/options.h), and docs/scene.md is made from
 * that table.
 *
 * Frame: scene (glTF axes, metres). Radiometric units per RGB band:
 * radiant intensity W/sr (spot, point), irradiance W/m^2 (directional).
 */
#ifndef GROTTO_CONFIG_SCENE_FILE_H
#define GROTTO_CONFIG_SCENE_FILE_H

#include "base/diag.h"
#include "base/item.h"
#include "base/pose.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define SCENE_NAME_MAX 32
#define SCENE_MAX_LAMPS 16
#define SCENE_MAX_CAMERAS 32
#define SCENE_MAX_MATERIALS 256 /* entries of `materials` */

enum scene_lamp_kind { SCENE_LAMP_SPOT, SCENE_LAMP_POINT, SCENE_LAMP_DIRECTIONAL };

/* What carries a lamp about. */
enum scene_lamp_mount {
	SCENE_MOUNT_FIXED,
	SCENE_MOUNT_WAND, /* a torch in the hand: position and direction are in the wand frame */
	SCENE_MOUNT_HEAD,
	SCENE_MOUNT_ORBIT, /* circles about orbit_center with orbit_period_s */
};

struct scene_lamp {
	char name[SCENE_NAME_MAX];
	enum scene_lamp_kind kind;
	enum scene_lamp_mount mount;
	vec3 position;       /* scene, metres (or the mount's frame) */
	vec3 direction;      /* unit, where the light goes */
	vec3 intensity;      /* W/sr, directional: W/m^2 on a surface facing it */
	float cone_rad;      /* spot: full angle of the cone */
	float penumbra_rad;  /* spot: width of the soft rim inside the cone, 0 = hard edge */
	float radius_m;      /* spot, point: of the source, for the soft edge of its shadows */
	float angle_rad;     /* directional: full angle of the source, likewise; 0..pi/2 */
	bool on;
	bool of_sky; /* the sun of the environment: not among the file's lamps */
	vec3 orbit_center;
	float orbit_radius_m, orbit_period_s;
	int line;
};

struct scene_camera {
	char name[SCENE_NAME_MAX];
	vec3 position, target, up;
	float vfov_rad;
	int pixels[2];
	int line;
};

/*
 * What the scene file says of a material of the model, instead of the model.
 * Vectors and numbers that are not given are NaN (the first component of a
 * vector): what the model says stays.
 */
enum scene_surface_kind {
	SCENE_SURFACE_DIFFUSE,   /* Lambert: reflectance */
	SCENE_SURFACE_PHONG,     /* Lambert and normalised Blinn-Phong: reflectance, specular, shininess */
	SCENE_SURFACE_MIRROR,    /* perfect: reflectance, no Fresnel */
	SCENE_SURFACE_CONDUCTOR, /* rough: GGX, alpha = roughness^2, separable Smith, reflectance, no Fresnel */
	SCENE_SURFACE_MEASURED,  /* a table of a goniometer: file */
	SCENE_SURFACE_AS_MODEL,
};
enum scene_sides { SCENE_SIDES_AS_MODEL, SCENE_SIDES_ONE, SCENE_SIDES_TWO };

struct scene_surface {
	char *material; /* its name in the model */
	enum scene_surface_kind kind;
	enum scene_sides sides;
	vec3 reflectance, specular; /* 0..1 */
	float roughness, shininess;
	vec3 emission; /* W/(m^2 sr); emission_scale does not apply */
	char *file;    /* NULL, absolute, or beside the scene file */
	int line;
};

/* What lights the scene from all around, and is seen where no surface is. */
enum scene_environment_kind {
	SCENE_ENVIRONMENT_NONE,
	SCENE_ENVIRONMENT_CONSTANT,
	SCENE_ENVIRONMENT_IMAGE,
	SCENE_ENVIRONMENT_SKY,
};
/* How a picture shows all directions; renderer/scene/environment_cube.h has the last two. */
enum scene_projection { SCENE_PROJECTION_LATLONG, SCENE_PROJECTION_CROSS, SCENE_PROJECTION_FACES };
struct scene_environment {
	enum scene_environment_kind kind;
	vec3 radiance;     /* constant: W/(m^2 sr) */
	char *file;        /* image: OpenEXR or Radiance; of faces six, the name with a * */
	enum scene_projection projection;
	float scale;       /* image: W/(m^2 sr) of a pixel that is 1 */
	float heading_rad; /* image: turned about +Y; sky: where north is, 0 -Z, a quarter turn -X */
	bool upper_only;   /* nothing comes from directions with y <= 0; always so of a sky */
	/* sky: Preetham 1999, renderer/scene/sky.h */
	float turbidity;
	bool sun;                                 /* is a lamp of the file, with of_sky */
	float sun_elevation_rad, sun_azimuth_rad; /* from north over east; unless there is a time */
	float place[2];                           /* latitude north, longitude east, radians */
	char *time;                               /* ISO 8601; NULL: by angles */
	int64_t time_s;                           /* the same since 1970 UTC */
	vec3 to_sun;                              /* scene, unit, from all that */
};

enum scene_gi_method { SCENE_GI_NONE, SCENE_GI_LPV, SCENE_GI_SURFELS, SCENE_GI_PROBES, SCENE_GI_AUTO };
/* Whether each node computes all of the light, or its share of it (docs/architecture.md). */
enum scene_gi_share { SCENE_SHARE_LOCAL, SCENE_SHARE_CLUSTER };
enum scene_lpv_mode { SCENE_LPV_REPAIRED, SCENE_LPV_THESIS };

struct scene_gi {
	enum scene_gi_method method;
	enum scene_gi_share share;
	float budget_ms; /* auto: what the light may take a frame */
	enum scene_lpv_mode lpv_mode;
	int lattice;          /* cells along the longest side of the scene: 8..128 */
	int steps;            /* propagation steps a frame */
	float incremental;    /* thesis mode only: lambda_incr, 0..1 */
	int rsm_pixels;       /* side of a reflective shadow map */
	int link_rays;        /* rays per link for its transmittance */
	vec3 albedo_override; /* negative: the materials' own */
	/* surfels and probes */
	float spacing_m;      /* of the surfels; 0: from the scene's area */
	int links;            /* of a surfel: 16..4096 */
	int gathers;          /* a frame: 1..16 */
	int taps;             /* of direct light on a surfel: 16..64 */
	int probes;           /* cells of the probe grid along the longest side of the scene: 1..64 */
};

/* In the order of the parameter TONE_CURVE. */
enum scene_curve { SCENE_CURVE_LINEAR, SCENE_CURVE_REINHARD, SCENE_CURVE_DRAGO, SCENE_CURVE_PATTANAIK };
#define SCENE_CURVES 4
/* Whether the eye of the last two gets used to what it looks at, and how: renderer/tone/adapt.h. */
enum scene_adapt { SCENE_ADAPT_FIXED, SCENE_ADAPT_PATTANAIK, SCENE_ADAPT_EXPONENTIAL };

/* Tone curve (renderer/tone/curve.h) and encoding gamma (thesis table 3.1). */
struct scene_tone {
	enum scene_curve curve;
	float exposure;       /* factor on radiance before the curve */
	float adaptation;     /* drago, pattanaik: what the eye is used to, at first unless fixed, cd/m^2 */
	enum scene_adapt adapt;
	float adapt_s;        /* exponential: until 1/e of a change is left */
	float luminance_max;  /* drago: what becomes white, cd/m^2 */
	float bias;           /* drago: 0.5..0.9 */
	float gamma_display;  /* of the display, 2.2 */
	float gamma_end_to_end; /* dark 1.5, dim 1.25, light 1.125 */
	bool srgb;            /* encode with the sRGB curve instead of the power law */
};

struct scene_file {
	char *path;
	char name[SCENE_NAME_MAX];
	char *model; /* absolute, or relative to the scene file */
	float model_scale;
	struct scene_lamp *lamps;
	size_t lamp_count;
	struct scene_camera *cameras;
	size_t camera_count;
	struct scene_gi gi;
	struct scene_surface *surfaces;
	size_t surface_count;
	struct scene_environment environment;
	float absorption_per_m; /* sigma_a, 1/m: homogeneous medium */
	float scattering_per_m; /* sigma_s, 1/m */
	vec3 background;        /* radiance where no surface is; lights nothing. An environment replaces it */
	struct scene_tone tone;
	float near_m, far_m;
	int shadow_pixels;
	struct gr_pose room; /* T_scene_room: where the CAVE stands in the scene */
	bool double_sided;   /* treat every material as two-sided */
	uint8_t hash[32];    /* see scene_file_items; the model's content is hashed by the renderer */
	float emission_scale; /* radiance in W/(m^2 sr) of a material whose emission is 1 */
	float room_heading_rad; /* as the file gives it; room.q follows from it */
};

/* As layout_load. */
int scene_file_load(const char *path, struct scene_file **out, struct gr_diag *diag);
/* The same from memory; path stands in messages and for what is relative to it. */
int scene_file_parse(const char *text, size_t len, const char *path, struct scene_file **out,
		     struct gr_diag *diag);
void scene_file_destroy(struct scene_file **file);
/* The model's path as it can be opened. Caller frees. */
char *scene_file_model_path(const struct scene_file *file);
/* Any file that it names, likewise. Caller frees. */
char *scene_file_beside(const struct scene_file *file, const char *name);
/* Index of the camera of that name, or -1. */
int scene_file_find_camera(const struct scene_file *file, const char *name);
/* Exponent of the encoding: end-to-end gamma / display gamma (seed 004, before table 3.1). */
float scene_tone_gamma_encode(const struct scene_tone *tone);

/* Writes a file that loads to the same values. GR_OK, GR_ERR_IO, GR_ERR_NOMEM. */
int scene_file_write(FILE *out, const struct scene_file *file);
/*
 * What all machines must agree on, as layout_items: everything but name, paths
 * and cameras. scene_file_load has stored the BLAKE2b-256 of it in hash.
 */
#define SCENE_FILE_ITEMS_MAX 13
size_t scene_file_items(const struct scene_file *file, struct gr_item *items, size_t room,
			uint8_t hash[32]);

#endif
