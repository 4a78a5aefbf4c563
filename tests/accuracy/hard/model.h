/* Models made of triangles that nobody would draw, as glTF files: what import makes of them is part of the test. */
#ifndef GROTTO_TESTS_HARD_MODEL_H
#define GROTTO_TESTS_HARD_MODEL_H

#include <stdbool.h>
#include <stddef.h>

#define MODEL_TRIANGLES 256
#define MODEL_MATERIALS 8

struct model_material {
	const char *name;
	float color[3], emission[3]; /* emission: W/(m^2 sr) at emission_scale 1; above 1 by its strength */
	bool two_sided;
	const char *texture; /* a file beside it, or NULL */
};

struct model_triangle {
	float at[3][3]; /* counter-clockwise seen from the front */
	int material;
};

struct model {
	struct model_material materials[MODEL_MATERIALS];
	size_t material_count;
	struct model_triangle triangles[MODEL_TRIANGLES];
	size_t count;
};

int model_material(struct model *model, const char *name, float r, float g, float b);
void model_triangle(struct model *model, int material, const float a[3], const float b[3],
		    const float c[3]);
/* corner, corner + u, corner + u + v, corner + v; the front is where u x v points. */
void model_quad(struct model *model, int material, const float corner[3], const float u[3],
		const float v[3]);
/* Twelve triangles; their fronts outside, or inside. */
void model_box(struct model *model, int material, const float low[3], const float high[3],
	       bool inside);
/* A binary glTF. */
void model_write(const struct model *model, const char *path);

#endif
