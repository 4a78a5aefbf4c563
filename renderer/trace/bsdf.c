#include "renderer/trace/bsdf.h"

#include "renderer/scene/brdf_table.h"

static struct v3 cosine_direction(const float u[2])
{
	float r = sqrtf(u[0]), phi = 2.0f * TRACE_PI * u[1];

	return (struct v3){ r * cosf(phi), r * sinf(phi), sqrtf(larger_of(1.0f - u[0], 0.0f)) };
}

void bsdf_init(struct bsdf *out, const struct scene *scene, const struct scene_material *material,
	       struct v3 diffuse, struct v3 specular, struct v3 facing, struct v3 shading,
	       struct v3 viewer)
{
	float d = v3_most(diffuse), s = v3_most(specular);

	out->kind = material->kind;
	out->facing = facing;
	out->diffuse = diffuse;
	out->specular = specular;
	out->shininess = material->shininess;
	out->alpha = material->alpha;
	out->table = material->kind == MATERIAL_MEASURED ? scene->tables[material->table] : NULL;
	out->lambert = d + s > 0.0f ? d / (d + s) : 1.0f;
	if (material->kind != MATERIAL_PHONG && v3_dot(shading, viewer) <= 0.0f)
		shading = facing;
	out->frame = v3_frame_of(shading);
}

void bsdf_lambert(struct bsdf *out, struct v3 reflectance, struct v3 normal)
{
	*out = (struct bsdf){
		.kind = MATERIAL_PHONG,
		.frame = v3_frame_of(normal),
		.facing = normal,
		.diffuse = reflectance,
		.lambert = 1.0f,
	};
}

/* --- Lambert and normalised Blinn-Phong (seed 004, equation 3.2) --- */

static struct v3 phong_eval(const struct bsdf *b, struct v3 v, struct v3 l, float *out_pdf)
{
	struct v3 f = v3_scale(b->diffuse, 1.0f / TRACE_PI);
	float pdf = b->lambert * l.z * (1.0f / TRACE_PI);

	if (b->lambert < 1.0f) {
		struct v3 sum = v3_add(v, l);
		float length = v3_length(sum);
		struct v3 h = length > 0.0f ? v3_scale(sum, 1.0f / length)
					    : (struct v3){ 0.0f, 0.0f, 1.0f };
		float c = larger_of(h.z, 0.0f), toward = v3_dot(v, h);
		float power = powf(c, b->shininess);

		f = v3_ahead(f, b->specular, (b->shininess + 8.0f) / (8.0f * TRACE_PI) * power);
		/* h is drawn by cos^(m+1); 4 (v.h) is the step from h to the reflected direction */
		if (toward > 0.0f)
			pdf += (1.0f - b->lambert) * (b->shininess + 2.0f) / (2.0f * TRACE_PI) *
			       power * c / (4.0f * toward);
	}
	*out_pdf = pdf;
	return v3_scale(f, l.z);
}

static struct v3 phong_half(const struct bsdf *b, const float u[2])
{
	float c = powf(1.0f - u[0], 1.0f / (b->shininess + 2.0f));
	float s = sqrtf(larger_of(1.0f - c * c, 0.0f)), phi = 2.0f * TRACE_PI * u[1];

	return (struct v3){ s * cosf(phi), s * sinf(phi), c };
}

/* --- Rough conductor: GGX, separable Smith, no Fresnel (shared reference's formula) --- */

static float ggx_d(float alpha, struct v3 h)
{
	float a2 = alpha * alpha;
	float t = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;

	return 1.0f / (TRACE_PI * a2 * t * t);
}

static float ggx_g1(float alpha, struct v3 w)
{
	float slope = (w.x * w.x + w.y * w.y) / (w.z * w.z);

	return 2.0f / (1.0f + sqrtf(1.0f + alpha * alpha * slope));
}

static struct v3 ggx_eval(const struct bsdf *b, struct v3 v, struct v3 l, float *out_pdf)
{
	struct v3 h = v3_unit(v3_add(v, l));
	float d = ggx_d(b->alpha, h), g = ggx_g1(b->alpha, v);

	*out_pdf = d * g / (4.0f * v.z);
	return v3_scale(b->specular, *out_pdf * ggx_g1(b->alpha, l));
}

/* A visible normal (Heitz 2018, "Sampling the GGX Distribution of Visible Normals"). */
static struct v3 ggx_half(float alpha, struct v3 v, const float u[2])
{
	struct v3 s = v3_unit((struct v3){ alpha * v.x, alpha * v.y, v.z });
	struct v3_frame f = v3_frame_of(s);
	float r = sqrtf(u[0]), phi = 2.0f * TRACE_PI * u[1];
	float across = s.x * s.x + s.y * s.y;
	float x, y, mix = 0.5f * (1.0f + s.z);

	if (across > 0.0f) {
		f.u = v3_scale((struct v3){ -s.y, s.x, 0.0f }, 1.0f / sqrtf(across));
		f.v = v3_cross(s, f.u);
	}
	x = r * cosf(phi);
	y = (1.0f - mix) * sqrtf(larger_of(1.0f - x * x, 0.0f)) + mix * r * sinf(phi);
	struct v3 h = v3_from_local(&f, (struct v3){ x, y, sqrtf(larger_of(1.0f - x * x - y * y, 0.0f)) });

	return v3_unit((struct v3){ alpha * h.x, alpha * h.y, larger_of(h.z, 1e-7f) });
}

/* --- a measured table --- */

static struct v3 table_eval(const struct bsdf *b, struct v3 v, struct v3 l, float *out_pdf)
{
	float wi[3], wo[3], f[3];

	v3_put(l, wi);
	v3_put(v, wo);
	brdf_table_evaluate(b->table, wi, wo, f);
	*out_pdf = brdf_table_pdf(b->table, wo, wi);
	return v3_scale(v3_of(f), l.z);
}

static bool table_draw(const struct bsdf *b, struct v3 v, const float u[2], struct v3 *out)
{
	float wi[3], wo[3];

	v3_put(v, wo);
	if (!(brdf_table_sample(b->table, wo, (double)u[0], (double)u[1], wi) > 0.0f))
		return false;
	*out = v3_of(wi);
	return true;
}

/* --- all of them --- */

static struct v3 eval_local(const struct bsdf *b, struct v3 v, struct v3 l, float *out_pdf)
{
	switch (b->kind) {
	case MATERIAL_PHONG:
		return phong_eval(b, v, l, out_pdf);
	case MATERIAL_CONDUCTOR:
		return ggx_eval(b, v, l, out_pdf);
	case MATERIAL_MEASURED:
		return table_eval(b, v, l, out_pdf);
	case MATERIAL_MIRROR:
		break;
	}
	*out_pdf = 0.0f;
	return v3_all(0.0f);
}

struct v3 bsdf_eval(const struct bsdf *b, struct v3 viewer, struct v3 light, float *out_pdf)
{
	struct v3 l = v3_to_local(&b->frame, light);

	*out_pdf = 0.0f;
	if (l.z <= 0.0f || v3_dot(light, b->facing) <= 0.0f)
		return v3_all(0.0f);
	return eval_local(b, v3_to_local(&b->frame, viewer), l, out_pdf);
}

static struct v3 reflect(struct v3 v, struct v3 h)
{
	return v3_sub(v3_scale(h, 2.0f * v3_dot(v, h)), v);
}

static bool draw_local(const struct bsdf *b, struct v3 v, float choose, const float u[2],
		       struct v3 *out)
{
	struct v3 h;

	switch (b->kind) {
	case MATERIAL_PHONG:
		if (choose < b->lambert) {
			*out = cosine_direction(u);
			return true;
		}
		h = phong_half(b, u);
		*out = reflect(v, h);
		return v3_dot(v, h) > 0.0f;
	case MATERIAL_CONDUCTOR:
		*out = reflect(v, ggx_half(b->alpha, v, u));
		return true;
	case MATERIAL_MEASURED:
		return table_draw(b, v, u, out);
	case MATERIAL_MIRROR:
		break;
	}
	return false;
}

bool bsdf_sample(const struct bsdf *b, struct v3 viewer, float choose, const float u[2],
		 struct v3 *out_light, struct v3 *out_weight, float *out_pdf)
{
	struct v3 v = v3_to_local(&b->frame, viewer), l, f;

	*out_pdf = 0.0f;
	if (bsdf_is_mirror(b)) {
		*out_light = v3_from_local(&b->frame, (struct v3){ -v.x, -v.y, v.z });
		*out_weight = b->specular;
		return v3_dot(*out_light, b->facing) > 0.0f && !v3_black(b->specular);
	}
	if (!draw_local(b, v, choose, u, &l) || l.z <= 0.0f)
		return false;
	*out_light = v3_from_local(&b->frame, l);
	if (v3_dot(*out_light, b->facing) <= 0.0f)
		return false;
	f = eval_local(b, v, l, out_pdf);
	if (!(*out_pdf > 0.0f))
		return false;
	*out_weight = v3_scale(f, 1.0f / *out_pdf);
	return !v3_black(*out_weight);
}
