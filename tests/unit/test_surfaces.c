/* What a scene file says of its model's materials and surroundings. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/image/image.h"
#include "renderer/scene/environment.h"
#include "renderer/scene/scene.h"
#include "tests/unit/glb.h"

#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[64];

static const char *inside(const char *name)
{
	static char path[256];

	snprintf(path, sizeof path, "%s/%s", folder, name);
	return path;
}

static void write_file(const char *name, const void *bytes, size_t len)
{
	FILE *file = fopen(inside(name), "wb");

	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, len, file), len);
	fclose(file);
}

static int set_up(void **state)
{
	static const struct glb_quad quad = GLB_QUAD;
	char table[8192];
	struct image sky;
	size_t len, n;
	uint8_t *bytes;

	(void)state;
	snprintf(folder, sizeof folder, "test_surfaces.%ld", (long)getpid());
	if (mkdir(folder, 0700) != 0)
		return -1;
	bytes = glb_of_quad(&quad, "", ",\"emissiveFactor\":[1,0.5,0.25],"
				       "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.6,0.4,1],"
				       "\"metallicFactor\":0,\"roughnessFactor\":0.5}", "", &len);
	write_file("plate.glb", bytes, len);
	free(bytes);
	n = (size_t)snprintf(table, sizeof table, "3 450 550 650\n");
	for (int i = 0; i < 40; i++)
		n += (size_t)snprintf(table + n, sizeof table - n, "%g 0 %g %g 0.1 0.1 0.1\n",
				      0.1 + 0.03 * i, 0.05 + 0.033 * i, 0.07 * i);
	write_file("grey.brdf", table, n);
	if (image_create(&sky, 4, 2, 3) != GR_OK)
		return -1;
	for (int i = 0; i < 24; i++)
		sky.data[i] = 2;
	n = (size_t)image_write_exr(inside("sky.exr"), &sky, NULL);
	image_finish(&sky);
	return (int)n;
}

static int tear_down(void **state)
{
	static const char *const names[] = { "plate.glb", "grey.brdf", "sky.exr" };

	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		remove(inside(names[i]));
	return rmdir(folder);
}

/* The first words of diag go to `why`. */
static struct scene *load(const char *more, uint8_t hash[32], char why[1024])
{
	struct scene_file *file = NULL;
	struct scene *scene = NULL;
	struct gr_diag diag = { 0 };
	char text[2048], path[256];
	int n = snprintf(text, sizeof text, "model = \"plate.glb\";\n%s", more);

	snprintf(path, sizeof path, "%s/test.scene", folder);
	if (scene_file_parse(text, (size_t)n, path, &file, &diag) == GR_OK &&
	    scene_import(file, &scene, &diag) == GR_OK && hash)
		scene_content_hash(file, scene, hash);
	why[0] = '\0';
	for (size_t i = 0; i < diag.count; i++)
		snprintf(why + strlen(why), 1024 - strlen(why), "%s\n", diag.items[i].text);
	assert_true((scene != NULL) == (diag.errors == 0));
	gr_diag_finish(&diag);
	scene_file_destroy(&file);
	return scene;
}

static struct scene *good(const char *more, uint8_t hash[32])
{
	char why[1024];
	struct scene *scene = load(more, hash, why);

	if (!scene)
		print_message("%s", why);
	assert_non_null(scene);
	return scene;
}

static void equal(const float *got, double a, double b, double c)
{
	assert_true(fabs((double)got[0] - a) < 1e-6 && fabs((double)got[1] - b) < 1e-6 &&
		    fabs((double)got[2] - c) < 1e-6);
}

static void kinds(void **state)
{
	struct scene *s = good("", NULL);
	const struct scene_material *m = &s->materials[0];

	(void)state;
	assert_true(s->emissive && m->kind == MATERIAL_PHONG && m->specular[0] > 0);
	scene_destroy(&s);

	s = good("materials = ( { material = \"m\"; kind = \"diffuse\"; "
		 "emission = [0.0, 0.0, 0.0]; sides = \"two\"; } );", NULL);
	m = &s->materials[0];
	equal(m->diffuse, 0.8 * 0.96, 0.6 * 0.96, 0.4 * 0.96);
	equal(m->specular, 0, 0, 0);
	assert_true(m->two_sided && !s->emissive);
	scene_destroy(&s);

	s = good("materials = ( { material = \"m\"; kind = \"mirror\"; "
		 "reflectance = [0.9, 0.8, 0.7]; emission = [3.0, 2.0, 1.0]; } );", NULL);
	m = &s->materials[0];
	assert_true(m->kind == MATERIAL_MIRROR && s->emissive && !m->two_sided);
	equal(m->diffuse, 0, 0, 0);
	equal(m->specular, 0.9, 0.8, 0.7);
	equal(m->emission, 3, 2, 1);
	scene_destroy(&s);

	s = good("materials = ( { material = \"m\"; kind = \"conductor\"; roughness = 0.5; "
		 "reflectance = [0.9, 0.8, 0.7]; } );", NULL);
	m = &s->materials[0];
	assert_true(m->kind == MATERIAL_CONDUCTOR && fabsf(m->alpha - 0.25f) < 1e-6f &&
		    fabsf(m->shininess - 30) < 1e-4f);
	scene_destroy(&s);

	s = good("materials = ( { material = \"m\"; kind = \"phong\"; shininess = 40.0; "
		 "reflectance = [0.5, 0.5, 0.5]; specular = [0.25, 0.25, 0.25]; } );", NULL);
	m = &s->materials[0];
	equal(m->specular, 0.25, 0.25, 0.25);
	assert_true(m->shininess == 40 && m->kind == MATERIAL_PHONG);
	scene_destroy(&s);

	s = good("materials = ( { material = \"m\"; kind = \"measured\"; file = \"grey.brdf\"; } );",
		 NULL);
	m = &s->materials[0];
	assert_true(m->kind == MATERIAL_MEASURED && m->table == 0 && s->table_count == 1);
	assert_true(fabs((double)m->diffuse[1] - 0.1 * M_PI) < 1e-3);
	scene_destroy(&s);
}

static void refused(const char *more, const char *words)
{
	char why[1024];

	assert_null(load(more, NULL, why));
	if (!strstr(why, words))
		print_message("%s", why);
	assert_non_null(strstr(why, words));
}

static void refusals(void **state)
{
	(void)state;
	refused("\nmaterials = ( { material = \"n\"; } );",
		"test.scene:3: material: the model has no material \"n\"; did you mean \"m\"?; it has \"m\"");
	refused("materials = ( { material = \"m\"; kind = \"measured\"; file = \"no.brdf\"; } );",
		"no.brdf: table cannot be opened");
	refused("materials = ( { material = \"m\"; kind = \"measured\"; file = \"plate.glb\"; } );",
		"no finite number");
	refused("materials = ( { material = \"m\"; reflectance = [1.0, 1.0, 1.0]; } );",
		"at most 1 comes back");
	refused("environment = { kind = \"image\"; file = \"no.exr\"; };",
		"no.exr: picture cannot be opened");
	refused("environment = { kind = \"image\"; file = \"grey.brdf\"; };", "neither OpenEXR nor a Radiance picture");
}

static void surroundings(void **state)
{
	static const float up[3] = { 0, 1, 0 };
	struct scene *s = good("", NULL);
	float got[3];

	(void)state;
	assert_null(s->environment);
	scene_destroy(&s);
	s = good("environment = { kind = \"image\"; file = \"sky.exr\"; scale = 4.0; };", NULL);
	assert_non_null(s->environment);
	environment_radiance(s->environment, up, got);
	assert_true(got[0] == 8);
	scene_destroy(&s);
	s = good("environment = { kind = \"constant\"; radiance = [1.0, 2.0, 3.0]; };", NULL);
	environment_radiance(s->environment, up, got);
	assert_true(got[2] == 3);
	scene_destroy(&s);
}

/* What machines compare follows the content of each file. */
static void hashes(void **state)
{
	static const char *const texts[] = {
		"",
		"environment = { kind = \"image\"; file = \"sky.exr\"; };",
		"environment = { kind = \"constant\"; radiance = [2.0, 2.0, 2.0]; };",
		"materials = ( { material = \"m\"; kind = \"measured\"; file = \"grey.brdf\"; } );",
		"materials = ( { material = \"m\"; sides = \"two\"; } );",
	};
	enum { COUNT = sizeof texts / sizeof texts[0] };
	uint8_t hash[COUNT][32], again[32];
	struct image sky;

	(void)state;
	for (int i = 0; i < COUNT; i++) {
		struct scene *s = good(texts[i], hash[i]);

		scene_destroy(&s);
		s = good(texts[i], again);
		scene_destroy(&s);
		assert_memory_equal(hash[i], again, 32);
		for (int k = 0; k < i; k++)
			assert_memory_not_equal(hash[i], hash[k], 32);
	}
	assert_int_equal(image_create(&sky, 4, 2, 3), GR_OK);
	assert_int_equal(image_write_exr(inside("sky.exr"), &sky, NULL), GR_OK);
	image_finish(&sky);
	struct scene *s = good(texts[1], again);

	scene_destroy(&s);
	assert_memory_not_equal(hash[1], again, 32);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(kinds),
		cmocka_unit_test(refusals),
		cmocka_unit_test(surroundings),
		cmocka_unit_test(hashes),
	};

	gr_log_init("test_surfaces", GR_LOG_ERROR);
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
