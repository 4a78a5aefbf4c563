#include "tests/accuracy/folder/scene_text.h"

#include "base/photometry.h"
#include "base/result.h"
#include "renderer/scene/sky.h"
#include "tests/accuracy/folder/model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SKY_WIDTH 2048
/* Its pictures of the sky: 1.0 is 16.667 kcd/m^2. */
#define BLENDER_PER_WATT ((float)(0.06 / 1000 * GR_LUMENS_PER_WATT))
#define MOST_BOUNCES 1024

struct writer {
	struct folder *folder;
	const char *work;
	struct json_walk walk;
	FILE *out;
	int result;
};

/* A file beside scene.json; the caller frees. */
static char *beside(const struct folder *folder, const char *name)
{
	char *path = NULL, *real;

	if (name[0] == '/')
		return strdup(name);
	if (asprintf(&path, "%s/%s", folder->path, name) < 0)
		return NULL;
	real = realpath(path, NULL); /* NULL: it is not there, which who opens it will say */
	if (!real)
		return path;
	free(path);
	return real;
}

static bool used(json_object *objects, const char *material)
{
	for (size_t i = 0; i < json_object_array_length(objects); i++) {
		json_object *name;

		if (json_object_object_get_ex(json_object_array_get_idx(objects, i), "material", &name) &&
		    strcmp(json_object_get_string(name), material) == 0)
			return true;
	}
	return false;
}

static void write_material(struct writer *w, const char *name, json_object *material, bool first)
{
	static const char *const diffuse[] = { "type", "reflectance", NULL };
	static const char *const ggx[] = { "type", "reflectance", "roughness", NULL };
	static const char *const emitter[] = { "type", "radiance", NULL };
	static const double black[3] = { 0 };
	double reflectance[3] = { 0 }, radiance[3], roughness;
	const char *type, *kind = "diffuse";
	char where[128];

	snprintf(where, sizeof where, "materials.%.100s", name);
	type = json_text(&w->walk, where, material, "type");
	if (!type)
		return;
	fprintf(w->out, "%s\n\t{ ", first ? "" : ",");
	write_text(w->out, "material", name);
	fputs("sides = \"two\"; ", w->out);
	if (strcmp(type, "emitter") == 0) {
		json_only(&w->walk, where, material, emitter);
		if (json_numbers(&w->walk, where, material, "radiance", true, 3, radiance))
			write_floats(w->out, "emission", radiance, 3);
	} else if (strcmp(type, "ggx") == 0) {
		kind = "conductor";
		json_only(&w->walk, where, material, ggx);
		if (json_number(&w->walk, where, material, "roughness", true, &roughness))
			write_floats(w->out, "roughness", &roughness, 1);
	} else if (strcmp(type, "mirror") == 0 || strcmp(type, "diffuse") == 0) {
		kind = type;
		json_only(&w->walk, where, material, diffuse);
	} else {
		json_fault(&w->walk, where, "type \"%.64s\" is not known; diffuse, mirror, ggx and emitter are",
			   type);
	}
	if (strcmp(type, "emitter") != 0) {
		json_numbers(&w->walk, where, material, "reflectance", true, 3, reflectance);
		write_floats(w->out, "emission", black, 3);
	}
	w->folder->diffuse = w->folder->diffuse && strcmp(kind, "diffuse") == 0;
	write_text(w->out, "kind", kind);
	write_floats(w->out, "reflectance", reflectance, 3);
	fputs("}", w->out);
}

static void write_materials(struct writer *w, json_object *materials, json_object *objects)
{
	bool first = true;

	fputs("materials = (", w->out);
	json_object_object_foreach(materials, name, material)
	{
		if (!json_object_is_type(material, json_type_object)) {
			json_fault(&w->walk, "materials", "\"%.64s\" is no object", name);
		} else if (used(objects, name)) {
			write_material(w, name, material, first);
			first = false;
		}
	}
	fputs(" );\n", w->out);
}

static void check_objects(struct writer *w, json_object *materials, json_object *objects)
{
	static const char *const known[] = { "name", "material", "quads", "sphere", "glb", NULL };

	if (json_object_array_length(objects) == 0)
		json_fault(&w->walk, "objects", "there is none");
	for (size_t i = 0; i < json_object_array_length(objects); i++) {
		json_object *object = json_object_array_get_idx(objects, i), *name;
		char where[64];

		snprintf(where, sizeof where, "objects[%zu]", i);
		if (!json_object_is_type(object, json_type_object)) {
			json_fault(&w->walk, where, "is no object");
			continue;
		}
		json_only(&w->walk, where, object, known);
		name = json_member(&w->walk, where, object, "material", json_type_string, false);
		if (name && !json_object_object_get_ex(materials, json_object_get_string(name), NULL))
			json_fault(&w->walk, where, "material \"%.64s\" is not among the materials",
				   json_object_get_string(name));
	}
}

/* The one object's own GLB, all Lambert. */
static void write_glb_object(struct writer *w, json_object *object)
{
	const char *name = json_text(&w->walk, "objects[0]", object, "glb");
	char *path = name ? beside(w->folder, name) : NULL;

	if (!path)
		return;
	write_text(w->out, "model", path);
	fputs("\nmaterials = (", w->out);
	if (!model_lambert(path, w->walk.diag, w->out))
		w->walk.failed = true;
	fputs(" );\n", w->out);
	free(path);
}

static void write_model(struct writer *w, json_object *materials, json_object *objects)
{
	char *path = beside(w->folder, "scene.glb");
	size_t glbs = 0;

	check_objects(w, materials, objects);
	for (size_t i = 0; i < json_object_array_length(objects) && !w->walk.failed; i++)
		glbs += json_object_object_get_ex(json_object_array_get_idx(objects, i), "glb", NULL) ? 1 : 0;
	if (!path || w->walk.failed) {
		free(path);
		return;
	}
	if (glbs > 0 && json_object_array_length(objects) == 1) {
		write_glb_object(w, json_object_array_get_idx(objects, 0));
		free(path);
		return;
	}
	if (glbs > 0)
		json_fault(&w->walk, "objects", "a \"glb\" beside other objects is not read");
	if (access(path, R_OK) != 0 && !w->walk.failed) {
		free(path);
		if (asprintf(&path, "%s/model.glb", w->work) < 0)
			return;
		w->result = model_write(&w->walk, objects, path);
	}
	write_text(w->out, "model", path);
	fputs("\n", w->out);
	write_materials(w, materials, objects);
	free(path);
}

static void write_lamp(struct writer *w, json_object *light, size_t index, bool first)
{
	static const char *const spot[] = { "type", "name", "position", "direction", "full_cone_deg",
					    "blend", "power_W", "color", NULL };
	static const char *const sun[] = { "type", "name", "position", "direction", "irradiance",
					   "color", NULL };
	double position[3], direction[3], color[3], strength = 0, blend = 0, cone;
	bool is_sun, is_spot;
	const char *type;
	char where[64];

	snprintf(where, sizeof where, "lights[%zu]", index);
	type = json_text(&w->walk, where, light, "type");
	if (!type)
		return;
	is_sun = strcmp(type, "sun") == 0;
	is_spot = strcmp(type, "spot") == 0;
	if (!is_sun && !is_spot && strcmp(type, "point") != 0) {
		json_fault(&w->walk, where, "type \"%.64s\" is not known; spot, point, sun and portal are",
			   type);
		return;
	}
	json_only(&w->walk, where, light, is_sun ? sun : spot);
	json_numbers(&w->walk, where, light, "color", true, 3, color);
	json_number(&w->walk, where, light, is_sun ? "irradiance" : "power_W", true, &strength);
	json_number(&w->walk, where, light, "blend", false, &blend);
	if (blend != 0)
		json_fault(&w->walk, where, "blend %g: a hard edge, 0, is meant", blend);
	fprintf(w->out, "%s\n\t{ name = \"lamp%zu\"; kind = \"%s\"; ", first ? "" : ",", index,
		is_sun ? "directional" : type);
	if (!is_sun && json_numbers(&w->walk, where, light, "position", true, 3, position))
		write_floats(w->out, "position", position, 3);
	if ((is_sun || is_spot) && json_numbers(&w->walk, where, light, "direction", true, 3, direction))
		write_floats(w->out, "direction", direction, 3);
	if (is_spot && json_number(&w->walk, where, light, "full_cone_deg", true, &cone))
		write_floats(w->out, "cone_deg", &cone, 1);
	for (int i = 0; i < 3; i++)
		color[i] *= is_sun ? strength : strength / (4 * M_PI);
	write_floats(w->out, "intensity", color, 3);
	fprintf(w->out, "%s = 0.0; }", is_sun ? "angle_deg" : "radius_m");
}

static void write_lamps(struct writer *w, json_object *lights)
{
	bool first = true;

	if (!lights)
		return;
	fputs("lamps = (", w->out);
	for (size_t i = 0; i < json_object_array_length(lights); i++) {
		json_object *light = json_object_array_get_idx(lights, i), *type;

		if (json_object_object_get_ex(light, "type", &type) &&
		    strcmp(json_object_get_string(type), "portal") == 0)
			continue; /* steers another's sampling */
		write_lamp(w, light, i, first);
		first = false;
	}
	fputs(" );\n", w->out);
}

static void write_preetham(struct writer *w, json_object *environment)
{
	static const char *const known[] = { "type", "turbidity", "sun_direction", "raw", NULL };
	double turbidity = 0, sun[3] = { 0 }, length;
	bool raw = json_flag(&w->walk, "environment", environment, "raw");
	struct image picture = { 0 };
	struct sky sky;
	char *path = NULL;

	json_only(&w->walk, "environment", environment, known);
	json_number(&w->walk, "environment", environment, "turbidity", true, &turbidity);
	json_numbers(&w->walk, "environment", environment, "sun_direction", true, 3, sun);
	length = sqrt(sun[0] * sun[0] + sun[1] * sun[1] + sun[2] * sun[2]);
	if (!w->walk.failed && !(turbidity >= 1.7 && turbidity <= 20))
		json_fault(&w->walk, "environment", "turbidity %g; 1.7 to 20 is meant", turbidity);
	if (!w->walk.failed && !(length > 1e-6 && sun[1] >= 0))
		json_fault(&w->walk, "environment", "the sun is below the horizon, or nowhere");
	if (w->walk.failed)
		return;
	for (int i = 0; i < 3; i++)
		sun[i] /= length;
	if (asprintf(&path, "%s/sky.exr", w->work) < 0)
		return;
	sky_init(&sky, turbidity, sun);
	w->result = sky_picture(&sky, SKY_WIDTH, SKY_WIDTH / 2, &picture);
	if (w->result == GR_OK) {
		for (int i = 0; i < 3 * picture.width * picture.height; i++)
			picture.data[i] *= BLENDER_PER_WATT;
		w->result = image_write_exr(path, &picture, NULL);
	}
	image_finish(&picture);
	fprintf(w->out, "environment = { kind = \"image\"; upper_only = %s; ", raw ? "false" : "true");
	write_text(w->out, "file", path);
	fputs("};\n", w->out);
	free(path);
}

static void write_latlong(struct writer *w, json_object *environment)
{
	static const char *const known[] = { "type", "file", "scale", NULL };
	const char *name = json_text(&w->walk, "environment", environment, "file");
	char *path = name ? beside(w->folder, name) : NULL;
	double scale = 1;

	json_only(&w->walk, "environment", environment, known);
	json_number(&w->walk, "environment", environment, "scale", false, &scale);
	if (!path)
		return;
	fputs("environment = { kind = \"image\"; ", w->out);
	write_text(w->out, "file", path);
	write_floats(w->out, "scale", &scale, 1);
	fputs("};\n", w->out);
	free(path);
}

static void write_environment(struct writer *w, json_object *environment)
{
	static const char *const black[] = { "type", NULL };
	static const char *const constant[] = { "type", "radiance", "upper_only", NULL };
	const char *type = environment ? json_text(&w->walk, "environment", environment, "type") : "black";
	double radiance[3];

	if (!type)
		return;
	w->folder->surrounded = strcmp(type, "black") != 0;
	if (strcmp(type, "black") == 0) {
		if (environment)
			json_only(&w->walk, "environment", environment, black);
	} else if (strcmp(type, "constant") == 0) {
		json_only(&w->walk, "environment", environment, constant);
		fprintf(w->out, "environment = { kind = \"constant\"; upper_only = %s; ",
			json_flag(&w->walk, "environment", environment, "upper_only") ? "true" : "false");
		if (json_numbers(&w->walk, "environment", environment, "radiance", true, 3, radiance))
			write_floats(w->out, "radiance", radiance, 3);
		fputs("};\n", w->out);
	} else if (strcmp(type, "preetham") == 0) {
		write_preetham(w, environment);
	} else if (strcmp(type, "latlong") == 0) {
		write_latlong(w, environment);
	} else {
		json_fault(&w->walk, "environment",
			   "type \"%.64s\" is not known; black, constant, preetham and latlong are", type);
	}
}

/* Names become those of files. */
static bool is_plain(const char *name)
{
	return name[0] && name[0] != '.' && strlen(name) < 64 && !strchr(name, '/');
}

static void write_camera(struct writer *w, json_object *camera, size_t index)
{
	static const char *const known[] = { "name", "position", "target", "direction", "up",
					     "vfov_deg", NULL };
	double position[3] = { 0 }, target[3], direction[3], up[3], vfov;
	const char *name;
	char where[64];

	snprintf(where, sizeof where, "cameras[%zu]", index);
	json_only(&w->walk, where, camera, known);
	name = json_text(&w->walk, where, camera, "name");
	if (name && !is_plain(name))
		json_fault(&w->walk, where, "name \"%.64s\" is none of a picture", name);
	w->folder->cameras[index] = name ? strdup(name) : NULL;
	fprintf(w->out, "%s\n\t{ name = \"camera%zu\"; pixels = [%d, %d]; ", index ? "," : "", index,
		w->folder->width, w->folder->height);
	if (json_numbers(&w->walk, where, camera, "position", true, 3, position))
		write_floats(w->out, "position", position, 3);
	if (json_numbers(&w->walk, where, camera, "target", false, 3, target)) {
		write_floats(w->out, "target", target, 3);
	} else if (json_numbers(&w->walk, where, camera, "direction", true, 3, direction)) {
		for (int i = 0; i < 3; i++)
			target[i] = position[i] + direction[i];
		write_floats(w->out, "target", target, 3);
	}
	if (json_numbers(&w->walk, where, camera, "up", false, 3, up))
		write_floats(w->out, "up", up, 3);
	if (json_number(&w->walk, where, camera, "vfov_deg", true, &vfov))
		write_floats(w->out, "vfov_deg", &vfov, 1);
	fputs("}", w->out);
}

static void write_cameras(struct writer *w, json_object *root)
{
	json_object *cameras = json_member(&w->walk, NULL, root, "cameras", json_type_array, true);
	double size[2] = { 256, 256 };

	json_numbers(&w->walk, NULL, root, "resolution", false, 2, size);
	if (!(size[0] >= 16 && size[0] <= 4096 && size[1] >= 16 && size[1] <= 4096))
		json_fault(&w->walk, "resolution", "%g x %g; 16 to 4096 are taken", size[0], size[1]);
	if (cameras && (json_object_array_length(cameras) < 1 ||
			json_object_array_length(cameras) > SCENE_MAX_CAMERAS))
		json_fault(&w->walk, "cameras", "%zu; 1 to %d are taken",
			   json_object_array_length(cameras), SCENE_MAX_CAMERAS);
	if (!cameras || w->walk.failed)
		return;
	w->folder->width = (int)size[0];
	w->folder->height = (int)size[1];
	fputs("cameras = (", w->out);
	for (size_t i = 0; i < json_object_array_length(cameras); i++)
		write_camera(w, json_object_array_get_idx(cameras, i), i);
	fputs(" );\n", w->out);
}

static void write_all(struct writer *w, json_object *root)
{
	/* rr_min only steers another's Russian roulette. */
	static const char *const known[] = { "axes", "materials", "objects", "environment", "lights",
					     "resolution", "name", "description", "cameras",
					     "max_bounces", "rr_min", NULL };
	json_object *materials = json_member(&w->walk, NULL, root, "materials", json_type_object, true);
	json_object *objects = json_member(&w->walk, NULL, root, "objects", json_type_array, true);
	json_object *lights = json_member(&w->walk, NULL, root, "lights", json_type_array, false);
	json_object *sky = json_member(&w->walk, NULL, root, "environment", json_type_object, false);
	const char *name = json_text(&w->walk, NULL, root, "name");
	double bounces = 64;

	json_only(&w->walk, NULL, root, known);
	json_number(&w->walk, NULL, root, "max_bounces", false, &bounces);
	if (!(bounces >= 0 && bounces <= MOST_BOUNCES))
		json_fault(&w->walk, "max_bounces", "%g; 0 to %d are taken", bounces, MOST_BOUNCES);
	if (!materials || !objects || w->walk.failed)
		return;
	w->folder->max_bounces = (int)bounces;
	w->folder->diffuse = true;
	snprintf(w->folder->name, sizeof w->folder->name, "%s", name);
	fputs("name = \"folder\";\n", w->out);
	write_model(w, materials, objects);
	write_lamps(w, lights);
	write_environment(w, sky);
	write_cameras(w, root);
	fputs("near_m = 0.01; far_m = 1000.0; shadow_pixels = 2048;\ntone = { srgb = true; "
	      "curve = \"linear\"; };\n", w->out);
}

int scene_text_write(struct folder *folder, const char *work, FILE *out, struct gr_diag *diag)
{
	struct writer w = { .folder = folder, .work = work, .out = out, .walk = { .diag = diag } };
	json_object *root;
	char *path;

	if (asprintf(&path, "%s/scene.json", folder->path) < 0)
		return GR_ERR_NOMEM;
	w.walk.path = path;
	root = json_load(&w.walk);
	if (root)
		write_all(&w, root);
	json_object_put(root);
	free(path);
	if (w.result != GR_OK)
		return w.result;
	return w.walk.failed ? GR_ERR_CONFIG : GR_OK;
}
