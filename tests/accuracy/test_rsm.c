/*
 * Reflective shadow maps hand over the light that the lamps reflect, all of
 * it: exitance times area, summed over the texels, equals the closed form. And
 * emissive surfaces become rectangles with their flux.
 */
#include "base/log.h"
#include "base/result.h"
#include "renderer/view/emissive.h"
#include "renderer/view/shadow.h"
#include "tests/accuracy/cornell.h"
#include "tests/unit/gl.h"
#include "tests/unit/unit.h"

#include <epoxy/gl.h>

#define PIXELS 128
#define GREY 0.5f

static const struct scene_material materials[2] = {
	{ .diffuse = { GREY, GREY, GREY }, .diffuse_image = -1, .emission_image = -1,
	  .two_sided = true },
	{ .emission = { 3, 2, 1 }, .diffuse_image = -1, .emission_image = -1 },
};

/* The inside of a box, and in it, high up, a lamp that looks down. */
static const struct quad box[] = {
	{ 0, { { 0, 0, 3 }, { 4, 0, 3 }, { 4, 0, 0 }, { 0, 0, 0 } } },
	{ 0, { { 0, 2.5f, 0 }, { 4, 2.5f, 0 }, { 4, 2.5f, 3 }, { 0, 2.5f, 3 } } },
	{ 0, { { 0, 0, 0 }, { 4, 0, 0 }, { 4, 2.5f, 0 }, { 0, 2.5f, 0 } } },
	{ 0, { { 4, 0, 3 }, { 0, 0, 3 }, { 0, 2.5f, 3 }, { 4, 2.5f, 3 } } },
	{ 0, { { 0, 0, 3 }, { 0, 0, 0 }, { 0, 2.5f, 0 }, { 0, 2.5f, 3 } } },
	{ 0, { { 4, 0, 0 }, { 4, 0, 3 }, { 4, 2.5f, 3 }, { 4, 2.5f, 0 } } },
	{ 1, { { 1, 2.4f, 1 }, { 2, 2.4f, 1 }, { 2, 2.4f, 1.5f }, { 1, 2.4f, 1.5f } } },
};
#define WALLS 6

/* No medium; what the renderer binds for a frame. */
static unsigned bind_frame(const struct scene *scene, float log2_transmittance)
{
	struct frame_block block = { .medium = { log2_transmittance, 0, 0, 0 } };
	unsigned buffer;

	memcpy(block.bounds_min, scene->min, sizeof(scene->min));
	memcpy(block.bounds_max, scene->max, sizeof(scene->max));
	glCreateBuffers(1, &buffer);
	glNamedBufferStorage(buffer, sizeof(block), &block, 0);
	glBindBufferBase(GL_UNIFORM_BUFFER, VIEW_BINDING_FRAME, buffer);
	return buffer;
}

struct sums {
	double flux[3];   /* exitance times area */
	double area;      /* of all texels */
	double solid;     /* area times cosine over squared distance from `origin` */
	size_t texels;
};

static void add_up(const struct rsm_set *set, const float origin[3], struct sums *out)
{
	size_t count = (size_t)set->pixels * (size_t)set->pixels * (size_t)set->layers;
	GLsizei bytes = (GLsizei)(count * 4 * sizeof(float));
	float *p = quads_alloc(count, 4 * sizeof(float)), *e = quads_alloc(count, 4 * sizeof(float));
	float *n = quads_alloc(count, 4 * sizeof(float));

	memset(out, 0, sizeof(*out));
	glGetTextureImage(set->position_area, 0, GL_RGBA, GL_FLOAT, bytes, p);
	glGetTextureImage(set->normal, 0, GL_RGBA, GL_FLOAT, bytes, n);
	glGetTextureImage(set->exitance, 0, GL_RGBA, GL_FLOAT, bytes, e);
	for (size_t k = 0; k < count; k++) {
		double d[3], dd = 0, along = 0;

		if (!(p[4 * k + 3] > 0))
			continue;
		for (int i = 0; i < 3; i++) {
			out->flux[i] += (double)e[4 * k + (size_t)i] * (double)p[4 * k + 3];
			d[i] = (double)origin[i] - (double)p[4 * k + (size_t)i];
			dd += d[i] * d[i];
			along += d[i] * (double)n[4 * k + (size_t)i];
		}
		out->area += (double)p[4 * k + 3];
		out->solid += (double)p[4 * k + 3] * along / pow(dd, 1.5);
		out->texels++;
	}
	free(p);
	free(e);
	free(n);
}

/* Draws the maps of one lamp over `count` quads. */
static void lamp_sums(const struct scene_lamp *lamp, const struct quad *quads, size_t count,
		      float log2_transmittance, struct sums *out)
{
	struct scene_lamp lamps[1] = { *lamp };
	struct scene_file file = quads_file();
	struct shadow_stage *shadow;
	struct render_frame frame;
	struct gl_mesh *mesh;
	struct scene scene;
	struct rsm *rsm;
	unsigned buffer;

	file.lamps = lamps;
	file.lamp_count = 1;
	file.shadow_pixels = 64;
	quads_scene(&scene, quads, count, materials, 2);
	buffer = bind_frame(&scene, log2_transmittance);
	assert_int_equal(gl_mesh_create(&mesh, &scene), GR_OK);
	assert_int_equal(rsm_create(&rsm, PIXELS, shadow_layers(&file), true, false), GR_OK);
	assert_int_equal(shadow_create(&shadow, &file, &scene, mesh, rsm), GR_OK);
	render_frame_init(&frame, &file);
	assert_int_equal(shadow_take(shadow, &frame), SHADOW_LIGHT | SHADOW_MAPS);
	shadow_draw(shadow, false);
	const struct rsm_set *set = rsm_frame(rsm);

	assert_int_equal(set->changed, 1);
	add_up(set, lamp->position, out);
	/* the same lamp again: nothing is drawn */
	assert_int_equal(shadow_take(shadow, &frame), SHADOW_SAME);
	assert_int_equal(rsm_frame(rsm)->changed, 0);
	/* off: nothing is hit */
	frame.lamps[0].on = false;
	assert_true(shadow_take(shadow, &frame) & SHADOW_LIGHT);
	shadow_draw(shadow, false);
	struct sums dark;

	add_up(rsm_frame(rsm), lamp->position, &dark);
	assert_int_equal(dark.texels, 0);
	shadow_destroy(&shadow);
	rsm_destroy(&rsm);
	gl_mesh_destroy(&mesh);
	glDeleteBuffers(1, &buffer);
	quads_free(&scene);
	assert_int_equal(glGetError(), GL_NO_ERROR);
}

static void check(const char *what, double got, double want, double bound)
{
	printf("# %s: %.6g, closed form %.6g, relative error %.2g\n", what, got, want,
	       got / want - 1);
	assert_true(fabs(got / want - 1) < bound);
}

static void spot_on_plane(void **state)
{
	const struct scene_lamp lamp = {
		.name = "spot", .kind = SCENE_LAMP_SPOT, .position = { 0.3f, 2, 0.1f },
		.direction = { 0, -1, 0 }, .intensity = { 10, 20, 30 }, .cone_rad = 1.2f,
		.on = true,
	};
	const struct quad plane = { 0, { { -9, 0, 9 }, { 9, 0, 9 }, { 9, 0, -9 }, { -9, 0, -9 } } };
	struct sums s;

	(void)state;
	lamp_sums(&lamp, &plane, 1, 0, &s);
	/* all that the cone sends: 2 pi (1 - cos) I; the hard rim is as fine as the texels */
	check("spot on a plane, reflected W", s.flux[1],
	      (double)GREY * 20 * 2 * M_PI * (1 - cos(0.6)), 2e-3);
	/* the map is the square round the cone: a side of 2 h tan */
	check("its square of the plane, m^2", s.area, pow(4 * tan(0.6), 2), 1e-4);
}

static void point_in_box(void **state)
{
	const struct scene_lamp lamp = {
		.name = "point", .kind = SCENE_LAMP_POINT, .position = { 1.1f, 1.3f, 0.7f },
		.direction = { 0, -1, 0 }, .intensity = { 10, 20, 30 }, .on = true,
	};
	struct sums s;

	(void)state;
	lamp_sums(&lamp, box, WALLS, 0, &s);
	check("point lamp in a closed box, reflected W", s.flux[2],
	      (double)GREY * 30 * 4 * M_PI, 1e-4);
	check("the box's surface, m^2", s.area, 2 * (4 * 3 + 4 * 2.5 + 3 * 2.5), 6e-3);
	check("solid angle of all texels, sr", s.solid, 4 * M_PI, 1e-4);
}

/* A narrow cone, so that all of its light goes the same way. */
static void medium(void **state)
{
	const struct scene_lamp lamp = {
		.name = "spot", .kind = SCENE_LAMP_SPOT, .position = { 0, 4, 0 },
		.direction = { 0, -1, 0 }, .intensity = { 1, 1, 1 }, .cone_rad = 0.02f,
		.on = true,
	};
	const struct quad plane = { 0, { { -9, 0, 9 }, { 9, 0, 9 }, { 9, 0, -9 }, { -9, 0, -9 } } };
	struct sums clear, thick;

	(void)state;
	lamp_sums(&lamp, &plane, 1, 0, &clear);
	lamp_sums(&lamp, &plane, 1, log2f(0.9f), &thick);
	check("sigma 0.1 per metre over 4 m, transmittance", thick.flux[0] / clear.flux[0],
	      pow(0.9, 4), 1e-4);
}

static void sun_on_plane(void **state)
{
	const struct scene_lamp lamp = {
		.name = "sun", .kind = SCENE_LAMP_DIRECTIONAL, .direction = { 0.6f, -0.8f, 0 },
		.intensity = { 1, 2, 3 }, .on = true,
	};
	const struct quad plane = { 0, { { -2, 0, 3 }, { 2, 0, 3 }, { 2, 0, -3 }, { -2, 0, -3 } } };
	struct sums s;

	(void)state;
	lamp_sums(&lamp, &plane, 1, 0, &s);
	check("sun on a plane, reflected W", s.flux[1], (double)GREY * 2 * 0.8 * 24, 1e-2);
}

/* A lamp in a closed box: all it sends is caught. */
static void emissive_in_box(void **state)
{
	const double sent = M_PI * 0.5; /* pi times the lamp's area, per unit of radiance */
	struct emissive_patches patches;
	struct emissive_stage *stage;
	struct gl_mesh *mesh;
	struct scene scene;
	struct rsm *rsm;
	struct sums s;
	unsigned buffer;
	double flux = 0;

	(void)state;
	quads_scene(&scene, box, WALLS + 1, materials, 2);
	buffer = bind_frame(&scene, 0);
	assert_int_equal(emissive_patches(&scene, &patches), GR_OK);
	check("flux of the emissive triangles, W", patches.flux[0], 3 * sent, 1e-6);
	assert_int_equal(patches.count, PATCHES_MAX);
	assert_int_equal(patches.group_count, PATCH_GROUPS_MAX);
	for (int i = 0; i < patches.count; i++) {
		const struct emissive_patch *p = &patches.patches[i];

		flux += M_PI * 4 * (double)glm_vec3_norm((float *)p->u) *
			(double)glm_vec3_norm((float *)p->v) * (double)p->radiance[0];
		assert_true(fabs((double)p->radiance[0] - 3) < 1e-4);
		assert_true(p->normal[1] < -0.9999f);
		assert_true(fabs((double)p->origin[1] - 2.399) < 1e-5);
	}
	check("flux of the rectangles, W", flux, 3 * sent, 1e-5);
	assert_int_equal(gl_mesh_create(&mesh, &scene), GR_OK);
	assert_int_equal(rsm_create(&rsm, PIXELS, emissive_layers(&patches), false, true), GR_OK);
	assert_int_equal(emissive_create(&stage, &patches, &scene, mesh, 64, rsm, 0), GR_OK);
	assert_true(emissive_wants(stage, false));
	emissive_draw(stage);
	assert_false(emissive_wants(stage, false));
	assert_true(emissive_wants(stage, true));
	add_up(rsm_frame(rsm), patches.patches[0].origin, &s);
	/* the walls see the whole lamp, its maps see the walls from four points of it */
	check("emissive lamp in a closed box, reflected W", s.flux[0],
	      (double)GREY * 3 * sent, 1e-2);
	emissive_destroy(&stage);
	rsm_destroy(&rsm);
	gl_mesh_destroy(&mesh);
	glDeleteBuffers(1, &buffer);
	quads_free(&scene);
	assert_int_equal(glGetError(), GL_NO_ERROR);
}

/* A ball of many emissive triangles keeps its flux, and its patches look outwards. */
static void emissive_ball(void **state)
{
	enum { RINGS = 12, SECTORS = 24 };
	static struct quad quads[RINGS * SECTORS];
	struct emissive_patches patches;
	struct scene scene;
	double flux = 0;

	(void)state;
	for (int r = 0; r < RINGS; r++)
		for (int k = 0; k < SECTORS; k++)
			for (int c = 0; c < 4; c++) {
				/* clear of the poles, where a quad would be a triangle */
				float t = 0.02f + ((float)M_PI - 0.04f) *
							  (float)(r + (c == 0 || c == 1)) / RINGS;
				float p = 2 * (float)M_PI * (float)(k + (c == 0 || c == 3)) / SECTORS;
				struct quad *q = &quads[r * SECTORS + k];

				q->material = 1;
				q->at[c][0] = 0.4f * sinf(t) * cosf(p);
				q->at[c][1] = 0.4f * cosf(t);
				q->at[c][2] = 0.4f * sinf(t) * sinf(p);
			}
	quads_scene(&scene, quads, RINGS * SECTORS, materials, 2);
	assert_int_equal(emissive_patches(&scene, &patches), GR_OK);
	for (int i = 0; i < patches.count; i++) {
		const struct emissive_patch *p = &patches.patches[i];
		float out = glm_vec3_dot((float *)p->centre, (float *)p->normal);
		float far = glm_vec3_norm((float *)p->origin);

		flux += M_PI * 4 * (double)glm_vec3_norm((float *)p->u) *
			(double)glm_vec3_norm((float *)p->v) * (double)p->radiance[1];
		assert_true(out > 0.25f);
		assert_true(far > 0.39f && far < 0.405f);
	}
	check("a ball of 576 triangles, W", flux, patches.flux[1], 1e-4);
	check("against the sphere, W", patches.flux[1], 2 * M_PI * 4 * M_PI * 0.16, 0.03);
	quads_free(&scene);
}

int main(void)
{
	struct target *target = gl_target_or_skip(16, 16);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(spot_on_plane), cmocka_unit_test(point_in_box),
		cmocka_unit_test(medium),        cmocka_unit_test(sun_on_plane),
		cmocka_unit_test(emissive_in_box), cmocka_unit_test(emissive_ball),
	};
	int failed;

	gr_log_init("test_rsm", GR_LOG_WARNING);
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	target_destroy(&target);
	return failed;
}
