#include "config/scene_sky.h"

#include "base/result.h"
#include "base/solar.h"
#include "base/sunlight.h"

#include <math.h>
#include <string.h>

#define DEG_PER_RAD 57.29577951308232

static const char *const of_place[] = { "place", "time" };
static const char *const of_angles[] = { "sun_elevation_deg", "sun_azimuth_deg" };

static void unused(struct options_reader *reader, const config_setting_t *at, const char *key)
{
	if (options_given(at, key))
		options_fault(reader, GR_DIAG_WARNING, at, key, "not used: only for kind = \"sky\"");
}

/* One of the two ways, and whole. */
static bool check_way(struct options_reader *reader, const config_setting_t *at)
{
	int angles = 0, place = 0;

	for (int i = 0; i < 2; i++) {
		angles += options_given(at, of_angles[i]);
		place += options_given(at, of_place[i]);
	}
	if (angles && place) {
		options_fault(reader, GR_DIAG_ERROR, at, of_place[0],
			      "the sun is given by angles and by place and time; keep one of the two");
		return false;
	}
	if (!place)
		return true;
	for (int i = 0; i < 2; i++)
		if (!options_given(at, of_place[i]))
			options_fault(reader, GR_DIAG_ERROR, at, of_place[i],
				      "missing; the sun is given by place and time, or by angles");
	return place == 2;
}

/* From north over east and up, north where the heading says: 0 is -Z. */
static void point(struct scene_environment *e, double elevation, double azimuth)
{
	const double heading = (double)e->heading_rad - azimuth;

	e->to_sun[0] = (float)(-sin(heading) * cos(elevation));
	e->to_sun[1] = (float)sin(elevation);
	e->to_sun[2] = (float)(-cos(heading) * cos(elevation));
}

static void find_sun(struct options_reader *reader, struct scene_form_environment *form)
{
	struct scene_environment *e = &form->environment;
	double elevation = (double)e->sun_elevation_rad, azimuth = (double)e->sun_azimuth_rad;

	if (e->time) {
		if (solar_time(e->time, &e->time_s) != GR_OK) {
			options_fault(reader, GR_DIAG_ERROR, form->at, "time",
				      "\"%s\" is no time from %d to %d; write \"2026-06-21T14:30+02:00\", or Z "
				      "for UTC", e->time, SOLAR_YEAR_MIN, SOLAR_YEAR_MAX);
			return;
		}
		solar_horizontal((double)e->time_s, (double)e->place[0], (double)e->place[1], &elevation,
				 &azimuth);
		options_fault(reader, GR_DIAG_NOTE, form->at, "time",
			      "the sun stands %.2f degrees high, %.2f from north over east",
			      elevation * DEG_PER_RAD, azimuth * DEG_PER_RAD);
	}
	if (elevation <= 0)
		options_fault(reader, GR_DIAG_WARNING, form->at, e->time ? "time" : "sun_elevation_deg",
			      "the sun is %.1f degrees below the horizon; the sky is that of sunset, and has no "
			      "sun", -elevation * DEG_PER_RAD);
	point(e, elevation, azimuth);
}

static void check_sun_lamp(struct options_reader *reader, const struct scene_form *form)
{
	struct scene_lamp sun;

	if (!scene_sky_sun(&form->environment.environment, &sun))
		return;
	if (form->lamp_count == SCENE_MAX_LAMPS)
		options_fault(reader, GR_DIAG_ERROR, form->environment.at, "sun",
			      "the sun is a lamp, and there are %d already; leave one out, or say sun = false",
			      SCENE_MAX_LAMPS);
	for (size_t i = 0; i < form->lamp_count; i++)
		if (!strcmp(form->lamps[i].lamp.name, SCENE_SUN_NAME))
			options_fault(reader, GR_DIAG_ERROR, form->lamps[i].at, "name",
				      "\"%s\" is the lamp of the sky; give this one another name, or say "
				      "environment.sun = false", SCENE_SUN_NAME);
}

void scene_sky_check(struct options_reader *reader, struct scene_form *form)
{
	struct scene_form_environment *sky = &form->environment;

	if (sky->environment.kind != SCENE_ENVIRONMENT_SKY) {
		unused(reader, sky->at, "turbidity");
		for (int i = 0; i < 2; i++) {
			unused(reader, sky->at, of_angles[i]);
			unused(reader, sky->at, of_place[i]);
		}
		return;
	}
	sky->environment.upper_only = true;
	if (!check_way(reader, sky->at))
		return;
	find_sun(reader, sky);
	check_sun_lamp(reader, form);
}

bool scene_sky_sun(const struct scene_environment *environment, struct scene_lamp *out)
{
	const struct scene_environment *e = environment;
	double rgb[3];

	if (e->kind != SCENE_ENVIRONMENT_SKY || !e->sun || !(e->to_sun[1] > 0))
		return false;
	*out = (struct scene_lamp){
		.name = SCENE_SUN_NAME,
		.kind = SCENE_LAMP_DIRECTIONAL,
		.mount = SCENE_MOUNT_FIXED,
		.angle_rad = (float)SUNLIGHT_ANGLE,
		.on = true,
		.of_sky = true,
	};
	sunlight_irradiance((double)e->turbidity, asin((double)e->to_sun[1]), rgb);
	for (int i = 0; i < 3; i++) {
		out->direction[i] = -e->to_sun[i];
		out->intensity[i] = (float)rgb[i];
	}
	return true;
}
