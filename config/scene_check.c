#include "config/scene_sky.h"

#include <math.h>
#include <string.h>

static double length(const float *v)
{
	return sqrt((double)v[0] * v[0] + (double)v[1] * v[1] + (double)v[2] * v[2]);
}

/* Leaves what is unit already as it is, so that a written file reads back to the same bits. */
static bool make_unit(float *v)
{
	double len = length(v);

	if (!(len > 1e-6))
		return false;
	if (fabs(len - 1) > 1e-6)
		for (int i = 0; i < 3; i++)
			v[i] = (float)(v[i] / len);
	return true;
}

static void unused(struct options_reader *reader, const config_setting_t *at, const char *key,
		   const char *why)
{
	if (options_given(at, key))
		options_fault(reader, GR_DIAG_WARNING, at, key, "not used: %s", why);
}

static void check_lamp(struct options_reader *reader, struct scene_form_lamp *entry)
{
	struct scene_lamp *lamp = &entry->lamp;

	if ((int)lamp->kind == OPTION_ABSENT) /* reported already */
		return;
	if (!make_unit(lamp->direction))
		options_fault(reader, GR_DIAG_ERROR, entry->at, "direction",
			      "has no length; a lamp that shines down has [0.0, -1.0, 0.0]");
	if (lamp->kind == SCENE_LAMP_SPOT) {
		/* The rim lies inside the cone, on both sides of its axis. */
		if (lamp->penumbra_rad > lamp->cone_rad / 2 + 1e-6f)
			options_fault(reader, GR_DIAG_ERROR, entry->at, "penumbra_deg",
				      "%g is wider than half the cone of %g; the rim lies inside the cone",
				      (double)lamp->penumbra_rad * 57.29577951308232,
				      (double)lamp->cone_rad * 57.29577951308232);
	} else {
		unused(reader, entry->at, "cone_deg", "only a spot has a cone");
		unused(reader, entry->at, "penumbra_deg", "only a spot has a cone");
	}
	if (lamp->kind == SCENE_LAMP_DIRECTIONAL)
		unused(reader, entry->at, "radius_m", "a directional lamp's size is its angle_deg");
	else
		unused(reader, entry->at, "angle_deg", "only a directional lamp has an angle");
	if (lamp->kind != SCENE_LAMP_POINT && !options_given(entry->at, "direction") &&
	    (lamp->mount == SCENE_MOUNT_FIXED || lamp->mount == SCENE_MOUNT_ORBIT))
		options_fault(reader, GR_DIAG_ERROR, entry->at, "direction",
			      "missing; say where the light of a %s lamp goes",
			      lamp->kind == SCENE_LAMP_SPOT ? "spot" : "directional");
	if (lamp->kind != SCENE_LAMP_DIRECTIONAL && lamp->mount == SCENE_MOUNT_FIXED &&
	    !options_given(entry->at, "position"))
		options_fault(reader, GR_DIAG_ERROR, entry->at, "position",
			      "missing; say where the lamp is");
	if (lamp->mount == SCENE_MOUNT_ORBIT) {
		if (!(fabsf(lamp->orbit_period_s) >= 0.1f))
			options_fault(reader, GR_DIAG_ERROR, entry->at, "orbit_period_s",
				      "%g s; a turn takes at least 0.1 s", (double)lamp->orbit_period_s);
		unused(reader, entry->at, "position", "an orbit is given by its center and radius");
	} else {
		unused(reader, entry->at, "orbit_center", "only for mount = \"orbit\"");
		unused(reader, entry->at, "orbit_radius_m", "only for mount = \"orbit\"");
		unused(reader, entry->at, "orbit_period_s", "only for mount = \"orbit\"");
	}
}

static void check_camera(struct options_reader *reader, struct scene_form_camera *entry)
{
	struct scene_camera *camera = &entry->camera;
	double look[3], across[3], len;

	for (int i = 0; i < 3; i++)
		look[i] = (double)camera->target[i] - camera->position[i];
	len = sqrt(look[0] * look[0] + look[1] * look[1] + look[2] * look[2]);
	if (isnan(len))
		return;
	if (len < 1e-6) {
		options_fault(reader, GR_DIAG_ERROR, entry->at, "target",
			      "is where the camera stands; give a point that it looks at");
		return;
	}
	if (!make_unit(camera->up)) {
		options_fault(reader, GR_DIAG_ERROR, entry->at, "up",
			      "has no length; [0.0, 1.0, 0.0] is the usual one");
		return;
	}
	for (int i = 0; i < 3; i++) {
		int j = (i + 1) % 3, k = (i + 2) % 3;

		across[i] = (look[j] * camera->up[k] - look[k] * camera->up[j]) / len;
	}
	if (across[0] * across[0] + across[1] * across[1] + across[2] * across[2] < 1e-6)
		options_fault(reader, GR_DIAG_ERROR, entry->at, "up",
			      "the camera looks along it; give another, such as [0.0, 0.0, -1.0]");
}

static void check_names(struct options_reader *reader, const struct scene_form *form)
{
	for (size_t i = 0; i < form->lamp_count; i++)
		for (size_t j = 0; j < i; j++)
			if (form->lamps[i].lamp.name[0] &&
			    !strcmp(form->lamps[i].lamp.name, form->lamps[j].lamp.name))
				options_fault(reader, GR_DIAG_ERROR, form->lamps[i].at, "name",
					      "lamp \"%s\" is there twice; each needs a name of its own",
					      form->lamps[i].lamp.name);
	for (size_t i = 0; i < form->camera_count; i++)
		for (size_t j = 0; j < i; j++)
			if (form->cameras[i].camera.name[0] &&
			    !strcmp(form->cameras[i].camera.name, form->cameras[j].camera.name))
				options_fault(reader, GR_DIAG_ERROR, form->cameras[i].at, "name",
					      "camera \"%s\" is there twice; each needs a name of its own",
					      form->cameras[i].camera.name);
}

static void check_tone(struct options_reader *reader, struct scene_form_tone *form)
{
	if (form->ambient != OPTION_ABSENT && !isnan(form->tone.gamma_end_to_end))
		options_fault(reader, GR_DIAG_ERROR, form->at, "gamma_end_to_end",
			      "given beside ambient; keep one of the two");
	if (isnan(form->tone.gamma_end_to_end))
		form->tone.gamma_end_to_end =
			scene_ambient_gamma[form->ambient != OPTION_ABSENT ? form->ambient :
									     SCENE_AMBIENT_DEFAULT];
	if (form->tone.srgb) {
		unused(reader, form->at, "ambient", "srgb = true encodes with its own curve");
		unused(reader, form->at, "gamma_end_to_end", "srgb = true encodes with its own curve");
		unused(reader, form->at, "gamma_display", "srgb = true encodes with its own curve");
	}
}

static void check_surface(struct options_reader *reader, struct scene_form_surface *entry)
{
	const struct scene_surface *s = &entry->surface;
	bool phong = s->kind == SCENE_SURFACE_PHONG;

	if ((int)s->kind == OPTION_ABSENT)
		return;
	if (s->kind == SCENE_SURFACE_MEASURED) {
		if (!s->file || !*s->file)
			options_fault(reader, GR_DIAG_ERROR, entry->at, "file",
				      "missing; name the table of the measured material");
		unused(reader, entry->at, "reflectance", "the table says what it reflects");
	} else {
		unused(reader, entry->at, "file", "only kind = \"measured\" has a table");
	}
	if (!phong) {
		unused(reader, entry->at, "specular", "only for kind = \"phong\"");
		unused(reader, entry->at, "shininess", "only for kind = \"phong\"");
	} else if (isnan(s->shininess) || isnan(s->specular[0])) {
		options_fault(reader, GR_DIAG_ERROR, entry->at, isnan(s->shininess) ? "shininess" : "specular",
			      "missing; kind = \"phong\" needs specular and shininess");
	}
	if (phong && !isnan(s->reflectance[0]))
		for (int i = 0; i < 3; i++)
			if (s->reflectance[i] + s->specular[i] > 1 + 1e-6f) {
				options_fault(reader, GR_DIAG_ERROR, entry->at, "specular",
					      "reflectance and specular are %g together; at most 1 comes back",
					      (double)s->reflectance[i] + (double)s->specular[i]);
				break;
			}
	if (s->kind != SCENE_SURFACE_CONDUCTOR)
		unused(reader, entry->at, "roughness", "only for kind = \"conductor\"");
	else if (isnan(s->roughness))
		options_fault(reader, GR_DIAG_ERROR, entry->at, "roughness",
			      "missing; 0.01 is nearly a mirror, 1 rough");
	if ((s->kind == SCENE_SURFACE_MIRROR || s->kind == SCENE_SURFACE_CONDUCTOR) &&
	    isnan(s->reflectance[0]))
		options_fault(reader, GR_DIAG_ERROR, entry->at, "reflectance",
			      "missing; [0.9, 0.9, 0.9] is a good mirror");
}

static void check_surfaces(struct options_reader *reader, const struct scene_form *form)
{
	for (size_t i = 0; i < form->surface_count; i++) {
		const char *name = form->surfaces[i].surface.material;

		if (!form->surfaces[i].at)
			continue;
		check_surface(reader, &form->surfaces[i]);
		for (size_t j = 0; j < i && name; j++)
			if (form->surfaces[j].surface.material &&
			    !strcmp(name, form->surfaces[j].surface.material))
				options_fault(reader, GR_DIAG_ERROR, form->surfaces[i].at, "material",
					      "\"%s\" is there twice; say all of it once", name);
	}
}

static void check_environment(struct options_reader *reader, struct scene_form_environment *form)
{
	const struct scene_environment *e = &form->environment;

	if ((int)e->kind == OPTION_ABSENT)
		return;
	if (e->kind == SCENE_ENVIRONMENT_IMAGE) {
		if (!e->file || !*e->file)
			options_fault(reader, GR_DIAG_ERROR, form->at, "file",
				      "missing; name the picture of the environment");
		else if (e->projection == SCENE_PROJECTION_FACES &&
			 (!strchr(e->file, '*') || strchr(e->file, '*') != strrchr(e->file, '*')))
			options_fault(reader, GR_DIAG_ERROR, form->at, "file",
				      "\"%s\" has not one *, which stands for px, nx, py, ny, pz and nz: "
				      "\"sky_*.hdr\"", e->file);
	} else {
		unused(reader, form->at, "file", "only kind = \"image\" has a picture");
		unused(reader, form->at, "projection", "only kind = \"image\" has a picture");
		unused(reader, form->at, "scale", "only kind = \"image\" has a picture");
		if (e->kind != SCENE_ENVIRONMENT_SKY)
			unused(reader, form->at, "heading_deg", "only a picture or a sky can be turned");
	}
	if (e->kind != SCENE_ENVIRONMENT_CONSTANT)
		unused(reader, form->at, "radiance", "only for kind = \"constant\"");
}

/* What a method cannot do is said before anything starts. */
static void check_gi(struct options_reader *reader, const struct scene_form *form)
{
	bool surfels = form->gi.method == SCENE_GI_SURFELS || form->gi.method == SCENE_GI_PROBES;

	if (surfels && form->medium.scattering_per_m > 0)
		options_fault(reader, GR_DIAG_ERROR, form->medium.at, "scattering_per_m",
			      "surfels and probes carry no light that the air scatters; gi.method = \"lpv\" does");
	if (form->gi.method == SCENE_GI_LPV && form->gi.share == SCENE_SHARE_CLUSTER)
		options_fault(reader, GR_DIAG_ERROR, form->gi.at, "share",
			      "a lattice is not shared out; take gi.method = \"surfels\", or share = \"local\"");
}

void scene_check(struct options_reader *reader, struct scene_form *form)
{
	for (size_t i = 0; i < form->lamp_count; i++)
		if (form->lamps[i].at)
			check_lamp(reader, &form->lamps[i]);
	for (size_t i = 0; i < form->camera_count; i++)
		if (form->cameras[i].at)
			check_camera(reader, &form->cameras[i]);
	check_names(reader, form);
	check_tone(reader, &form->tone);
	check_surfaces(reader, form);
	check_environment(reader, &form->environment);
	scene_sky_check(reader, form);
	check_gi(reader, form);
	if (form->near_m >= form->far_m)
		options_fault(reader, GR_DIAG_ERROR, form->at, "far_m",
			      "%g m is not beyond near_m, %g m", (double)form->far_m,
			      (double)form->near_m);
}
