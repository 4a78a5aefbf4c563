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
#include "base/pose.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define SCENE_NAME_MAX 32
#define SCENE_MAX_LAMPS 16
#define SCENE_MAX_CAMERAS 32

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

enum scene_gi_method { SCENE_GI_NONE, SCENE_GI_LPV };
enum scene_lpv_mode { SCENE_LPV_REPAIRED, SCENE_LPV_THESIS };

struct scene_gi {
	enum scene_gi_method method;
	enum scene_lpv_mode lpv_mode;
	int lattice;          /* cells along the longest side of the scene: 8..128 */
	int steps;            /* propagation steps a frame */
	float incremental;    /* thesis mode only: lambda_incr, 0..1 */
	int rsm_pixels;       /* side of a reflective shadow map */
	int link_rays;        /* rays per link for its transmittance */
	vec3 albedo_override; /* negative: the materials' own */
};

enum scene_curve { SCENE_CURVE_LINEAR, SCENE_CURVE_REINHARD };

/* Tone curve (thesis eq. 3.3) and encoding gamma (thesis table 3.1). */
struct scene_tone {
	enum scene_curve curve;
	float exposure;       /* factor on radiance before the curve */
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
	float absorption_per_m; /* sigma_a, 1/m: homogeneous medium */
	float scattering_per_m; /* sigma_s, 1/m */
	vec3 background;        /* radiance where no surface is */
	struct scene_tone tone;
	float near_m, far_m;
	int shadow_pixels;
	struct gr_pose room; /* T_scene_room: where the CAVE stands in the scene */
	bool double_sided;   /* treat every material as two-sided */
	uint8_t hash[32];    /* see scene_file_hash; the model's content is hashed by the renderer */
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
/* Index of the camera of that name, or -1. */
int scene_file_find_camera(const struct scene_file *file, const char *name);
/* Exponent of the encoding: end-to-end gamma / display gamma (seed 004, before table 3.1). */
float scene_tone_gamma_encode(const struct scene_tone *tone);

/* Writes a file that loads to the same values. GR_OK, GR_ERR_IO, GR_ERR_NOMEM. */
int scene_file_write(FILE *out, const struct scene_file *file);
/*
 * BLAKE2b-256 of the canonical form of what all machines must agree on:
 * everything but name, paths and cameras. scene_file_load has stored it in hash.
 */
void scene_file_hash(const struct scene_file *file, uint8_t out[32]);

#endif
