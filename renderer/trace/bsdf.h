/*
 * How a surface scatters light: the materials of renderer/scene/scene.h, each
 * with its value, a way to draw directions and the density of that.
 *
 * Directions are the scene's, unit, and point away from the surface. Light
 * arrives only from the viewer's geometric side (a surface shadows itself) and
 * from above the shading normal's horizon, as the renderer draws it.
 *
 * Pure; any thread.
 */
#ifndef GROTTO_RENDERER_TRACE_BSDF_H
#define GROTTO_RENDERER_TRACE_BSDF_H

#include "renderer/scene/scene.h"
#include "renderer/trace/vector.h"

struct bsdf {
	enum scene_material_kind kind;
	struct v3_frame frame; /* about the shading normal */
	struct v3 facing;      /* geometric normal on the viewer's side */
	struct v3 diffuse, specular;
	float shininess, alpha;
	float lambert; /* probability of drawing from the diffuse lobe */
	const struct brdf_table *table;
};

/*
 * facing and shading: unit, on the viewer's side. A shading normal that looks
 * away from the viewer is replaced by the geometric one where the formula has
 * no value there (mirror, conductor, table).
 */
void bsdf_init(struct bsdf *out, const struct scene *scene, const struct scene_material *material,
	       struct v3 diffuse, struct v3 specular, struct v3 facing, struct v3 shading,
	       struct v3 viewer);
/* A Lambert surface of that reflectance. */
void bsdf_lambert(struct bsdf *out, struct v3 reflectance, struct v3 normal);

static inline bool bsdf_is_mirror(const struct bsdf *bsdf)
{
	return bsdf->kind == MATERIAL_MIRROR;
}

/*
 * f times the cosine at the surface, 1/sr; *out_pdf the density, 1/sr, with which
 * bsdf_sample draws `light`. Both 0 for a mirror, which has neither.
 */
struct v3 bsdf_eval(const struct bsdf *bsdf, struct v3 viewer, struct v3 light, float *out_pdf);

/*
 * Draws a direction from three numbers in [0, 1). *out_weight is f cos / pdf.
 * *out_pdf is 0 for a mirror: no other way finds that direction. false: the
 * light is lost (below the surface, or nothing is reflected).
 */
bool bsdf_sample(const struct bsdf *bsdf, struct v3 viewer, float choose, const float u[2],
		 struct v3 *out_light, struct v3 *out_weight, float *out_pdf);

#endif
