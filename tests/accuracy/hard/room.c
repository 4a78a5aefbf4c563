#include "tests/accuracy/hard/room.h"

#include "tests/unit/unit.h"

#include <math.h>

const float hard_room[3] = { 4, 3, 4 };

void hard_walls(struct model *model, int material)
{
	model_box(model, material, (float[3]){ 0, 0, 0 }, hard_room, true);
}

void hard_block(struct model *model, int material, bool inside_out)
{
	model_box(model, material, (float[3]){ 0.9f, 0, 0.9f }, (float[3]){ 1.7f, 1.1f, 1.7f },
		  inside_out);
}

void hard_plain(struct model *model)
{
	hard_walls(model, model_material(model, "wall", 0.6f, 0.55f, 0.5f));
	hard_block(model, model_material(model, "block", 0.3f, 0.5f, 0.6f), false);
}

static void write_lamps(const struct hard_scene *scene, FILE *file)
{
	static const double at[HARD_LAMPS][3] = { { 2.4, 2.8, 2.2 }, { 1.2, 2.7, 3.1 } };
	static const char *const names[HARD_LAMPS] = { "lamp", "other" };
	double s = (double)scene->scale;
	bool any = false;

	for (int k = 0; k < HARD_LAMPS; k++) {
		double power = (double)scene->intensity[k] * s * s;

		if (!(power > 0))
			continue;
		fprintf(file,
			"%s{ name = \"%s\"; kind = \"spot\"; position = [%.9g, %.9g, %.9g];\n"
			"direction = [-0.2, -1.0, -0.1]; cone_deg = 80.0; penumbra_deg = 20.0; radius_m = 0.0;\n"
			"intensity = [%.9g, %.9g, %.9g]; }\n",
			any ? ", " : "lamps = ( ", names[k], at[k][0] * s, at[k][1] * s, at[k][2] * s, power,
			power, power);
		any = true;
	}
	if (any)
		fprintf(file, ");\n");
}

void hard_write_scene(const struct hard_scene *scene, const char *path, const char *model)
{
	double s = (double)scene->scale;
	FILE *file = fopen(path, "w");

	assert_non_null(file);
	fprintf(file, "name = \"hard\";\nmodel = \"%s\";\nmodel_scale = %.9g;\n", model, s);
	fprintf(file, "near_m = %.9g;\nfar_m = %.9g;\nshadow_pixels = 256;\n",
		fmin(fmax(0.05 * s, 0.001), 100), fmin(fmax(20 * s, 1), 1e6));
	write_lamps(scene, file);
	fprintf(file,
		"cameras = ( { name = \"in\"; position = [%.9g, %.9g, %.9g]; target = [%.9g, %.9g, %.9g];\n"
		"vfov_deg = 75.0; pixels = [%d, %d]; } );\n",
		3.7 * s, 2.2 * s, 3.7 * s, 1.5 * s, 0.9 * s, 1.5 * s, HARD_PIXELS, HARD_PIXELS);
	fprintf(file,
		"gi = { method = \"surfels\"; surfels = { spacing_m = %.9g; links = 128; gathers = %d; "
		"probes = 8; };\nlpv = { lattice = 16; steps = %d; rsm_pixels = 64; }; };\n%s\n",
		0.35 * s, scene->gathers, scene->steps, scene->more ? scene->more : "");
	assert_int_equal(fclose(file), 0);
}

void hard_points(float scale, struct renderer_point points[HARD_POINTS])
{
	static const float share[3] = { 0.15f, 0.5f, 0.85f };

	for (int w = 0; w < HARD_WALLS; w++)
		for (int k = 0; k < 9; k++) {
			struct renderer_point *p = &points[9 * w + k];
			int axis = w / 2, first = (axis + 1) % 3, second = (axis + 2) % 3;

			memset(p, 0, sizeof *p);
			p->position[axis] = w % 2 ? hard_room[axis] * scale : 0;
			p->position[first] = hard_room[first] * share[k % 3] * scale;
			p->position[second] = hard_room[second] * share[k / 3] * scale;
			p->normal[axis] = w % 2 ? -1 : 1;
		}
}

double hard_mean(const struct image *image)
{
	size_t values = (size_t)image->width * (size_t)image->height * 3;
	double sum = 0;

	for (size_t k = 0; k < values; k++) {
		assert_true(isfinite(image->data[k]) && image->data[k] >= 0);
		sum += (double)image->data[k];
	}
	return sum / (double)values;
}
