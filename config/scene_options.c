#include "config/scene_options.h"

#define RAD_PER_DEG 0.017453292519943295

static const char *const kind_choices[] = { "spot", "point", "directional", NULL };
static const char *const mount_choices[] = { "fixed", "wand", "head", "orbit", NULL };
static const char *const method_choices[] = { "none", "lpv", "surfels", "probes", "auto", NULL };
static const char *const share_choices[] = { "local", "cluster", NULL };
static const char *const surface_choices[] = { "diffuse", "phong", "mirror", "conductor", "measured", "model", NULL };
static const char *const sides_choices[] = { "model", "one", "two", NULL };
static const char *const environment_choices[] = { "none", "constant", "image", NULL };
static const char *const mode_choices[] = { "repaired", "thesis", NULL };
static const char *const curve_choices[] = { "linear", "reinhard", NULL };
static const char *const ambient_choices[] = { "dark", "dim", "light", NULL };

/* A dark room darkens what is seen in it: the brighter the room, the smaller the exponent. */
const float scene_ambient_gamma[3] = { 1.5f, 1.25f, 1.125f };

#define AT(type, member) .offset = offsetof(struct type, member)

static const struct option lamp_options[] = {
	{ .key = "name", .type = OPTION_NAME, .required = true, AT(scene_form_lamp, lamp.name),
	  .help = "the lamp's name: letters, digits, '_', '-', '.'" },
	{ .key = "kind", .type = OPTION_CHOICE, .required = true, .choices = kind_choices,
	  AT(scene_form_lamp, lamp.kind),
	  .help = "a cone from a point, a point that shines everywhere, or parallel light" },
	{ .key = "mount", .type = OPTION_CHOICE, .choices = mount_choices, .standard = "fixed",
	  AT(scene_form_lamp, lamp.mount),
	  .help = "what carries it; on wand and head, position and direction are in that frame" },
	{ .key = "position", .type = OPTION_FLOAT, .count = 3, .min = -1e5, .max = 1e5,
	  .unit = "m", .standard = "0 0 0", AT(scene_form_lamp, lamp.position),
	  .help = "where it is; not for directional" },
	{ .key = "direction", .type = OPTION_FLOAT, .count = 3, .min = -1e5, .max = 1e5,
	  .standard = "0 0 -1", AT(scene_form_lamp, lamp.direction),
	  .help = "where its light goes, of any length; not for point" },
	{ .key = "intensity", .type = OPTION_FLOAT, .required = true, .count = 3, .min = 0,
	  .max = 1e9, .unit = "W/sr", AT(scene_form_lamp, lamp.intensity),
	  .help = "radiant intensity in red, green and blue; for directional the irradiance in W/m2 of a surface that faces it" },
	{ .key = "cone_deg", .type = OPTION_FLOAT, .min = 1, .max = 170, .unit = "deg",
	  .scale = RAD_PER_DEG, .standard = "60", AT(scene_form_lamp, lamp.cone_rad),
	  .help = "spot: the full angle of its cone" },
	{ .key = "penumbra_deg", .type = OPTION_FLOAT, .min = 0, .max = 85, .unit = "deg",
	  .scale = RAD_PER_DEG, .standard = "0", AT(scene_form_lamp, lamp.penumbra_rad),
	  .help = "spot: width of the soft rim inside the cone; 0 is a hard edge" },
	{ .key = "radius_m", .type = OPTION_FLOAT, .min = 0, .max = 10, .unit = "m",
	  .standard = "0.02", AT(scene_form_lamp, lamp.radius_m),
	  .help = "radius of the source, for the soft edge of its shadows; not for directional" },
	{ .key = "angle_deg", .type = OPTION_FLOAT, .min = 0, .max = 90, .unit = "deg",
	  .scale = RAD_PER_DEG, .standard = "0.53", AT(scene_form_lamp, lamp.angle_rad),
	  .help = "directional: full angle that the source fills in the sky, for the soft edge of its shadows; the sun 0.53" },
	{ .key = "on", .type = OPTION_BOOL, .standard = "true", AT(scene_form_lamp, lamp.on),
	  .help = "whether it shines at the start" },
	{ .key = "orbit_center", .type = OPTION_FLOAT, .count = 3, .min = -1e5, .max = 1e5,
	  .unit = "m", .standard = "0 0 0", AT(scene_form_lamp, lamp.orbit_center),
	  .help = "orbit: the middle of its level circle" },
	{ .key = "orbit_radius_m", .type = OPTION_FLOAT, .min = 0, .max = 1e4, .unit = "m",
	  .standard = "1", AT(scene_form_lamp, lamp.orbit_radius_m),
	  .help = "orbit: radius of the circle" },
	{ .key = "orbit_period_s", .type = OPTION_FLOAT, .min = -1e5, .max = 1e5, .unit = "s",
	  .standard = "10", AT(scene_form_lamp, lamp.orbit_period_s),
	  .help = "orbit: time for one turn, counter-clockwise from above; negative turns the other way" },
	{ .key = NULL },
};

static const struct option camera_options[] = {
	{ .key = "name", .type = OPTION_NAME, .required = true,
	  AT(scene_form_camera, camera.name),
	  .help = "the camera's name, as in grotto render --camera NAME" },
	{ .key = "position", .type = OPTION_FLOAT, .required = true, .count = 3, .min = -1e5,
	  .max = 1e5, .unit = "m", AT(scene_form_camera, camera.position),
	  .help = "where it stands" },
	{ .key = "target", .type = OPTION_FLOAT, .required = true, .count = 3, .min = -1e5,
	  .max = 1e5, .unit = "m", AT(scene_form_camera, camera.target),
	  .help = "a point that it looks at" },
	{ .key = "up", .type = OPTION_FLOAT, .count = 3, .min = -1e5, .max = 1e5,
	  .standard = "0 1 0", AT(scene_form_camera, camera.up),
	  .help = "the direction that is up in its picture" },
	{ .key = "vfov_deg", .type = OPTION_FLOAT, .min = 1, .max = 170, .unit = "deg",
	  .scale = RAD_PER_DEG, .standard = "60", AT(scene_form_camera, camera.vfov_rad),
	  .help = "angle from the lower to the upper edge of its picture" },
	{ .key = "pixels", .type = OPTION_INT, .count = 2, .min = 16, .max = 16384,
	  .unit = "pixels", .standard = "512 512", AT(scene_form_camera, camera.pixels),
	  .help = "width and height of its picture" },
	{ .key = NULL },
};

static const struct option lpv_options[] = {
	{ .key = "mode", .type = OPTION_CHOICE, .choices = mode_choices, .standard = "repaired",
	  AT(scene_form_lpv, gi.lpv_mode),
	  .help = "the repaired propagation, or the thesis' own for comparison" },
	{ .key = "lattice", .type = OPTION_INT, .min = 8, .max = 128, .unit = "cells",
	  .standard = "32", AT(scene_form_lpv, gi.lattice),
	  .help = "cells along the longest side of the scene" },
	{ .key = "steps", .type = OPTION_INT, .min = 1, .max = 128, .standard = "8",
	  AT(scene_form_lpv, gi.steps), .help = "propagation steps a frame" },
	{ .key = "incremental", .type = OPTION_FLOAT, .min = 0, .max = 1, .standard = "0.8",
	  AT(scene_form_lpv, gi.incremental),
	  .help = "thesis mode: share of the last frame's light that is kept" },
	{ .key = "rsm_pixels", .type = OPTION_INT, .min = 16, .max = 2048, .unit = "pixels",
	  .standard = "128", AT(scene_form_lpv, gi.rsm_pixels),
	  .help = "side of a lamp's reflective shadow map" },
	{ .key = "link_rays", .type = OPTION_INT, .min = 1, .max = 4096, .standard = "32",
	  AT(scene_form_lpv, gi.link_rays),
	  .help = "rays that measure how much of a link between two cells is open" },
	{ .key = "albedo_override", .type = OPTION_FLOAT, .count = 3, .min = -1, .max = 1,
	  .standard = "-1 -1 -1", AT(scene_form_lpv, gi.albedo_override),
	  .help = "reflectance of all surfaces for indirect light; negative takes the materials' own" },
	{ .key = NULL },
};

static const struct option surfels_options[] = {
	{ .key = "spacing_m", .type = OPTION_FLOAT, .min = 0, .max = 1000, .unit = "m",
	  .standard = "0", AT(scene_form_surfels, gi.spacing_m),
	  .help = "distance between surfels; 0 takes one that gives some thousands of them" },
	{ .key = "links", .type = OPTION_INT, .min = 16, .max = 4096, .standard = "256",
	  AT(scene_form_surfels, gi.links),
	  .help = "rays that find what lights a surfel; twice as many halve the square of the noise" },
	{ .key = "gathers", .type = OPTION_INT, .min = 1, .max = 16, .standard = "1",
	  AT(scene_form_surfels, gi.gathers),
	  .help = "bounces that are added a frame while the light changes" },
	{ .key = "taps", .type = OPTION_INT, .min = 16, .max = 64, .standard = "64",
	  AT(scene_form_surfels, gi.taps),
	  .help = "points of a surfel at which the lamps' light is looked up" },
	{ .key = "probes", .type = OPTION_INT, .min = 1, .max = 64, .unit = "cells",
	  .standard = "8", AT(scene_form_surfels, gi.probes),
	  .help = "probes for what moves: cells of their grid along the longest side of the scene" },
	{ .key = NULL },
};

static const struct option gi_options[] = {
	{ .key = "method", .type = OPTION_CHOICE, .choices = method_choices, .standard = "auto",
	  AT(scene_form_gi, method),
	  .help = "how indirect light is computed; auto chooses from what the scene holds and from budget_ms" },
	{ .key = "share", .type = OPTION_CHOICE, .choices = share_choices, .standard = "local",
	  AT(scene_form_gi, share),
	  .help = "surfels and probes: each node computes all of the light, or a part of it for all" },
	{ .key = "budget_ms", .type = OPTION_FLOAT, .min = 0.1, .max = 10000, .unit = "ms",
	  .standard = "8", AT(scene_form_gi, budget_ms),
	  .help = "auto: what indirect light may take of a frame" },
	{ .key = "surfels", .type = OPTION_GROUP, AT(scene_form_gi, surfels), .group = surfels_options,
	  .help = "settings of surfels and probes" },
	{ .key = "lpv", .type = OPTION_GROUP, AT(scene_form_gi, lpv), .group = lpv_options,
	  .help = "settings of light propagation volumes" },
	{ .key = NULL },
};

#define AT_SURFACE(member) AT(scene_form_surface, surface.member)

static const struct option surface_options[] = {
	{ .key = "material", .type = OPTION_STRING, .required = true, AT_SURFACE(material),
	  .help = "the material's name in the model" },
	{ .key = "kind", .type = OPTION_CHOICE, .choices = surface_choices, .standard = "model",
	  AT_SURFACE(kind),
	  .help = "what it reflects: Lambert; Lambert and Blinn-Phong; a perfect mirror; a rough conductor (GGX, alpha = roughness^2, separable Smith, no Fresnel); a measured table; or as the model says" },
	{ .key = "sides", .type = OPTION_CHOICE, .choices = sides_choices, .standard = "model",
	  AT_SURFACE(sides), .help = "whether the back reflects and emits, too" },
	{ .key = "reflectance", .type = OPTION_FLOAT, .count = 3, .min = 0, .max = 1,
	  AT_SURFACE(reflectance), .help = "diffuse, or of the mirror or conductor; instead of the model's colour and texture" },
	{ .key = "specular", .type = OPTION_FLOAT, .count = 3, .min = 0, .max = 1,
	  AT_SURFACE(specular), .help = "phong: reflectance of the highlight" },
	{ .key = "shininess", .type = OPTION_FLOAT, .min = 0, .max = 16384, AT_SURFACE(shininess),
	  .help = "phong: exponent" },
	{ .key = "roughness", .type = OPTION_FLOAT, .min = 0.01, .max = 1, AT_SURFACE(roughness),
	  .help = "conductor: 0.01 nearly a mirror, 1 rough" },
	{ .key = "emission", .type = OPTION_FLOAT, .count = 3, .min = 0, .max = 1e9,
	  .unit = "W/(m2 sr)", AT_SURFACE(emission),
	  .help = "radiance that it emits, instead of the model's; emission_scale does not apply" },
	{ .key = "file", .type = OPTION_STRING, AT_SURFACE(file),
	  .help = "measured: the table, as the Cornell goniometer's text files" },
	{ .key = NULL },
};

#define AT_ENVIRONMENT(member) AT(scene_form_environment, environment.member)

static const struct option environment_options[] = {
	{ .key = "kind", .type = OPTION_CHOICE, .choices = environment_choices, .standard = "none",
	  AT_ENVIRONMENT(kind), .help = "nothing, the same from everywhere, or a picture" },
	{ .key = "radiance", .type = OPTION_FLOAT, .count = 3, .min = 0, .max = 1e9,
	  .unit = "W/(m2 sr)", .standard = "0 0 0", AT_ENVIRONMENT(radiance),
	  .help = "constant: what comes from every direction" },
	{ .key = "file", .type = OPTION_STRING, AT_ENVIRONMENT(file),
	  .help = "image: OpenEXR, latitude-longitude: the middle is +X, three quarters along +Z, the top row +Y" },
	{ .key = "scale", .type = OPTION_FLOAT, .min = 0, .max = 1e9, .standard = "1",
	  AT_ENVIRONMENT(scale), .help = "image: radiance in W/(m2 sr) of a pixel that is 1" },
	{ .key = "heading_deg", .type = OPTION_FLOAT, .min = -360, .max = 360, .unit = "deg",
	  .scale = RAD_PER_DEG, .standard = "0", AT_ENVIRONMENT(heading_rad),
	  .help = "image: turned about +Y, counter-clockwise from above" },
	{ .key = "upper_only", .type = OPTION_BOOL, .standard = "false", AT_ENVIRONMENT(upper_only),
	  .help = "nothing comes from below the horizon" },
	{ .key = NULL },
};

static const struct option medium_options[] = {
	{ .key = "absorption_per_m", .type = OPTION_FLOAT, .min = 0, .max = 100, .unit = "1/m",
	  .standard = "0", AT(scene_form_medium, absorption_per_m),
	  .help = "absorption coefficient of the air" },
	{ .key = "scattering_per_m", .type = OPTION_FLOAT, .min = 0, .max = 100, .unit = "1/m",
	  .standard = "0", AT(scene_form_medium, scattering_per_m),
	  .help = "scattering coefficient of the air" },
	{ .key = NULL },
};

static const struct option tone_options[] = {
	{ .key = "curve", .type = OPTION_CHOICE, .choices = curve_choices, .standard = "reinhard",
	  AT(scene_form_tone, tone.curve), .help = "no curve, or L/(1+L)" },
	{ .key = "exposure", .type = OPTION_FLOAT, .min = 1e-9, .max = 1e9, .standard = "1",
	  AT(scene_form_tone, tone.exposure), .help = "factor on radiance before the curve" },
	{ .key = "ambient", .type = OPTION_CHOICE, .choices = ambient_choices,
	  AT(scene_form_tone, ambient),
	  .help = "light around the display, sets gamma_end_to_end: dark 1.5, dim 1.25 (without either key), light 1.125" },
	{ .key = "gamma_end_to_end", .type = OPTION_FLOAT, .min = 0.5, .max = 3,
	  AT(scene_form_tone, tone.gamma_end_to_end),
	  .help = "from scene to eye, instead of ambient" },
	{ .key = "gamma_display", .type = OPTION_FLOAT, .min = 1.5, .max = 4, .standard = "2.2",
	  AT(scene_form_tone, tone.gamma_display),
	  .help = "of the display; pictures are encoded with gamma_end_to_end / gamma_display" },
	{ .key = "srgb", .type = OPTION_BOOL, .standard = "false", AT(scene_form_tone, tone.srgb),
	  .help = "encode with the sRGB curve instead; the gammas are not used then" },
	{ .key = NULL },
};

static const struct option room_options[] = {
	{ .key = "position", .type = OPTION_FLOAT, .count = 3, .min = -1e5, .max = 1e5,
	  .unit = "m", .standard = "0 0 0", AT(scene_form_room, position),
	  .help = "the middle of the CAVE's floor in the scene" },
	{ .key = "heading_deg", .type = OPTION_FLOAT, .min = -360, .max = 360, .unit = "deg",
	  .scale = RAD_PER_DEG, .standard = "0", AT(scene_form_room, heading_rad),
	  .help = "where the CAVE's front looks in the scene; 0 is -Z, 90 is -X" },
	{ .key = NULL },
};

const struct option scene_options[] = {
	{ .key = "name", .type = OPTION_NAME, .standard = "scene", AT(scene_form, name),
	  .help = "the scene's name in logs and summaries" },
	{ .key = "model", .type = OPTION_STRING, .required = true, AT(scene_form, model),
	  .help = "the model: glTF 2.0, OBJ, FBX or Collada, absolute or beside this file" },
	{ .key = "model_scale", .type = OPTION_FLOAT, .min = 1e-6, .max = 1e6, .standard = "1",
	  AT(scene_form, model_scale), .help = "metres per unit of the model" },
	{ .key = "emission_scale", .type = OPTION_FLOAT, .min = 0, .max = 1e9, .standard = "1",
	  AT(scene_form, emission_scale),
	  .help = "radiance in W/(m2 sr) of a material whose emission is 1" },
	{ .key = "double_sided", .type = OPTION_BOOL, .standard = "false",
	  AT(scene_form, double_sided), .help = "draw and light both sides of every surface" },
	{ .key = "background", .type = OPTION_FLOAT, .count = 3, .min = 0, .max = 1e6,
	  .unit = "W/(m2 sr)", .standard = "0 0 0", AT(scene_form, background),
	  .help = "radiance where no surface is" },
	{ .key = "near_m", .type = OPTION_FLOAT, .min = 0.001, .max = 100, .unit = "m",
	  .standard = "0.05", AT(scene_form, near_m), .help = "nearest that is drawn" },
	{ .key = "far_m", .type = OPTION_FLOAT, .min = 0.01, .max = 1e6, .unit = "m",
	  .standard = "200", AT(scene_form, far_m), .help = "farthest that is drawn" },
	{ .key = "shadow_pixels", .type = OPTION_INT, .min = 16, .max = 8192, .unit = "pixels",
	  .standard = "1024", AT(scene_form, shadow_pixels), .help = "side of a lamp's shadow map" },
	{ .key = "lamps", .type = OPTION_LIST, .count = SCENE_MAX_LAMPS, AT(scene_form, lamps),
	  .size = sizeof(struct scene_form_lamp),
	  .count_offset = offsetof(struct scene_form, lamp_count), .group = lamp_options,
	  .help = "the list of lamps; surfaces that emit come with the model's materials" },
	{ .key = "cameras", .type = OPTION_LIST, .count = SCENE_MAX_CAMERAS,
	  AT(scene_form, cameras), .size = sizeof(struct scene_form_camera),
	  .count_offset = offsetof(struct scene_form, camera_count), .group = camera_options,
	  .help = "the list of cameras for stills" },
	{ .key = "materials", .type = OPTION_LIST, .count = SCENE_MAX_MATERIALS,
	  AT(scene_form, surfaces), .size = sizeof(struct scene_form_surface),
	  .count_offset = offsetof(struct scene_form, surface_count), .group = surface_options,
	  .help = "the list of materials that are not as the model says" },
	{ .key = "environment", .type = OPTION_GROUP, AT(scene_form, environment),
	  .group = environment_options, .help = "light from all around; replaces background" },
	{ .key = "gi", .type = OPTION_GROUP, AT(scene_form, gi), .group = gi_options,
	  .help = "indirect light" },
	{ .key = "medium", .type = OPTION_GROUP, AT(scene_form, medium), .group = medium_options,
	  .help = "the air: homogeneous, scatters alike in all directions" },
	{ .key = "tone", .type = OPTION_GROUP, AT(scene_form, tone), .group = tone_options,
	  .help = "from radiance to pixels" },
	{ .key = "room", .type = OPTION_GROUP, AT(scene_form, room), .group = room_options,
	  .help = "where the CAVE stands in the scene" },
	{ .key = NULL },
};
