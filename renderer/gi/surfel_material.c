/* What a surface does with a link that meets it. */
#include "renderer/gi/surfel_bake_private.h"

static const float no_override[3] = { -1, -1, -1 };

void bake_albedo(const struct bake *bake, const struct bake_point *point, float out[3])
{
	struct ray_hit hit = { .triangle = point->side / 2, .u = point->u, .v = point->v };
	struct surface_point at;
	float toward[3];

	v3_put(bake->normals[hit.triangle], hit.normal);
	v3_put(v3_scale(bake_normal(bake, point->side), -1), toward);
	surface_at(bake->lookup, &hit, toward, no_override, &at);
	for (int c = 0; c < 3; c++)
		out[c] = fminf(fmaxf(at.albedo[c], 0), 1);
}
