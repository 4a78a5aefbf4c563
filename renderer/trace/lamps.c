#include "renderer/trace/lamps.h"

#include <string.h>

static bool shines(const struct frame_lamp *lamp, enum scene_lamp_kind kind)
{
	struct v3 intensity = v3_of(lamp->intensity);

	return lamp->on && v3_finite(intensity) && !v3_black(intensity) &&
	       v3_finite(v3_of(lamp->direction)) &&
	       (kind == SCENE_LAMP_DIRECTIONAL || v3_finite(v3_of(lamp->position)));
}

static void fill(struct trace_lamp *out, const struct scene_lamp *file,
		 const struct frame_lamp *lamp, bool soft)
{
	float penumbra = cosf(larger_of(0.5f * file->cone_rad - file->penumbra_rad, 0.0f));

	memset(out, 0, sizeof *out);
	out->kind = file->kind;
	out->position = v3_of(lamp->position);
	out->direction = v3_of(lamp->direction);
	out->intensity = v3_of(lamp->intensity);
	out->umbra = cosf(0.5f * file->cone_rad);
	out->widen = penumbra > out->umbra ? 1.0f / (penumbra - out->umbra) : 0.0f;
	if (!soft)
		return;
	if (file->kind != SCENE_LAMP_DIRECTIONAL && file->radius_m > 0.0f) {
		out->radius = file->radius_m;
		out->radiance = v3_scale(out->intensity,
					 1.0f / (TRACE_PI * out->radius * out->radius));
	} else if (file->kind == SCENE_LAMP_DIRECTIONAL && file->angle_rad > 0.0f) {
		float sine = sinf(0.5f * file->angle_rad);

		out->radius = cosf(0.5f * file->angle_rad);
		out->radiance = v3_scale(out->intensity, 1.0f / (TRACE_PI * sine * sine));
	}
}

void lamps_init(struct lamps *out, const struct scene_file *file, const struct render_frame *frame,
		bool soft)
{
	memset(out, 0, sizeof *out);
	for (int pass = 0; pass < 2; pass++) {
		for (size_t i = 0; i < file->lamp_count && i < SCENE_MAX_LAMPS; i++) {
			struct trace_lamp *lamp = &out->lamps[out->count];

			if (!shines(&frame->lamps[i], file->lamps[i].kind))
				continue;
			fill(lamp, &file->lamps[i], &frame->lamps[i], soft);
			if ((lamp->radius > 0.0f) == (pass == 0))
				out->count++;
		}
		if (pass == 0)
			out->extended = out->count;
	}
}

/* to: unit, from the lit point to the lamp. */
static float cone(const struct trace_lamp *lamp, struct v3 to)
{
	float c = -v3_dot(lamp->direction, to);

	if (lamp->kind != SCENE_LAMP_SPOT)
		return 1.0f;
	if (lamp->widen == 0.0f)
		return c > lamp->umbra ? 1.0f : 0.0f;
	return smaller_of(larger_of((c - lamp->umbra) * lamp->widen, 0.0f), 1.0f);
}

/* 1 - cosine of the angle that a sphere's half covers; 2: from inside. */
static float cap_of(const struct trace_lamp *lamp, float distance)
{
	float sine2 = lamp->radius * lamp->radius / (distance * distance);

	if (lamp->kind == SCENE_LAMP_DIRECTIONAL)
		return 1.0f - lamp->radius;
	if (sine2 >= 1.0f)
		return 2.0f;
	return sine2 / (1.0f + sqrtf(1.0f - sine2)); /* 1 - cos, without cancellation */
}

static struct v3 cap_direction(struct v3 axis, float cap, const float u[2])
{
	struct v3_frame f = v3_frame_of(axis);
	float down = u[0] * cap, phi = 2.0f * TRACE_PI * u[1];
	float sine = sqrtf(larger_of(down * (2.0f - down), 0.0f));

	return v3_from_local(&f, (struct v3){ sine * cosf(phi), sine * sinf(phi), 1.0f - down });
}

struct lamp_light lamp_light(const struct trace_lamp *lamp, struct v3 from, const float u[2])
{
	struct lamp_light out = { .distance = INFINITY };
	struct v3 to, axis;
	float metres = 0.0f, cap;

	if (lamp->kind == SCENE_LAMP_DIRECTIONAL) {
		axis = v3_scale(lamp->direction, -1.0f);
	} else {
		to = v3_sub(lamp->position, from);
		metres = v3_length(to);
		axis = metres > 0.0f ? v3_scale(to, 1.0f / metres) : (struct v3){ 0.0f, 1.0f, 0.0f };
	}
	out.direction = axis;
	if (lamp->radius == 0.0f) {
		out.irradiance = lamp->intensity;
		if (lamp->kind == SCENE_LAMP_DIRECTIONAL)
			return out;
		out.distance = metres;
		out.irradiance = metres > 0.0f ? v3_scale(lamp->intensity, cone(lamp, axis) / (metres * metres))
					       : v3_all(0.0f);
		return out;
	}
	cap = cap_of(lamp, metres);
	out.direction = cap_direction(axis, cap, u);
	out.pdf = 1.0f / (2.0f * TRACE_PI * cap);
	out.irradiance = v3_scale(lamp->radiance, cone(lamp, axis) / out.pdf);
	if (lamp->kind != SCENE_LAMP_DIRECTIONAL) {
		/* to where the ray meets the sphere's near side; 0 inside */
		float along = metres * v3_dot(out.direction, axis);
		float inside = lamp->radius * lamp->radius - (metres * metres - along * along);

		out.distance = cap >= 2.0f ? 0.0f : along - sqrtf(larger_of(inside, 0.0f));
	}
	return out;
}

bool lamp_met(const struct trace_lamp *lamp, struct v3 from, struct v3 direction, float distance,
	      struct v3 *out_radiance, float *out_pdf)
{
	struct v3 to = v3_sub(lamp->position, from), axis;
	float cap, metres = 0.0f;

	if (lamp->kind == SCENE_LAMP_DIRECTIONAL) {
		if (isfinite(distance) || -v3_dot(direction, lamp->direction) < lamp->radius)
			return false;
		axis = v3_scale(lamp->direction, -1.0f);
	} else {
		float along = v3_dot(to, direction), near2 = v3_dot(to, to) - along * along;
		float half2 = lamp->radius * lamp->radius - near2;

		metres = v3_length(to);
		if (metres > lamp->radius &&
		    (along <= 0.0f || half2 < 0.0f || along - sqrtf(half2) >= distance))
			return false;
		axis = metres > 0.0f ? v3_scale(to, 1.0f / metres) : (struct v3){ 0.0f, 1.0f, 0.0f };
	}
	cap = cap_of(lamp, metres);
	*out_radiance = v3_scale(lamp->radiance, cone(lamp, axis));
	*out_pdf = 1.0f / (2.0f * TRACE_PI * cap);
	return true;
}
