/* Models in: what they become, and what happens to those that are broken. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/image/image.h"
#include "renderer/scene/import.h"
#include "tests/unit/glb.h"
#include "tests/unit/shared.h"

#include <assimp/version.h>
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#include <jpeglib.h>

static const struct import_options plain = { .scale = 1.0f, .emission_scale = 1.0f };
/* Imports from an exact-size copy; a refusal must have said why, naming the file. */
static int import_copy(const uint8_t *bytes, size_t len, const char *name,
		       const struct import_options *options, struct scene **out, char *why,
		       size_t why_size)
{
	struct gr_diag diag = { 0 };
	uint8_t *copy = unit_copy(bytes, len);
	int result = import_bytes(copy, len, name, options, out, &diag);

	if (result == GR_ERR_CONFIG) {
		assert_true(diag.errors > 0);
		assert_null(*out);
	}
	if (why) {
		why[0] = '\0';
		for (size_t i = 0; i < diag.count; i++)
			snprintf(why + strlen(why), why_size - strlen(why), "%s\n", diag.items[i].text);
	}
	gr_diag_finish(&diag);
	free(copy);
	return result;
}

static int import_quad(const struct glb_quad *quad, const char *node, const char *material,
		       const char *more, const struct import_options *options, struct scene **out,
		       char *why, size_t why_size)
{
	size_t len;
	uint8_t *bytes = glb_of_quad(quad, node, material, more, &len);
	int result = import_copy(bytes, len, "quad.glb", options, out, why, why_size);

	free(bytes);
	return result;
}

static struct scene *good_quad(const char *node, const char *material, const char *more)
{
	static const struct glb_quad quad = GLB_QUAD;
	struct scene *scene;
	char why[512];
	int result = import_quad(&quad, node, material, more, &plain, &scene, why, sizeof why);

	if (result != GR_OK)
		print_message("%s", why);
	assert_int_equal(result, GR_OK);
	return scene;
}

static void test_quad(void **state)
{
	struct scene *scene = good_quad("", "", "");

	(void)state;
	assert_int_equal(scene->index_count, 6);
	assert_int_equal(scene->draw_count, 1);
	assert_int_equal(scene->draws[0].index_count, 6);
	for (size_t v = 0; v < scene->vertex_count; v++) {
		assert_vector(scene->vertices[v].normal, 0, 0, 1);
		/* The quad's uv is glTF's: 0 0 is its upper left corner. */
		assert_true(scene->vertices[v].uv[0] == scene->vertices[v].position[0]);
		assert_true(scene->vertices[v].uv[1] == 1.0f - scene->vertices[v].position[1]);
	}
	assert_vector(scene->min, 0, 0, 0);
	assert_vector(scene->max, 1, 1, 0);
	assert_false(scene->emissive);
	scene_destroy(&scene);
	assert_null(scene);
}

static void test_nodes(void **state)
{
	struct scene *scene;
	const float *n;

	(void)state;
	/* A mirror: fronts stay fronts. */
	scene = good_quad(",\"scale\":[-2,1,1],\"translation\":[0,0,3]", "", "");
	assert_vector(scene->min, -2, 0, 3);
	assert_vector(scene->max, 0, 1, 3);
	for (size_t i = 0; i < scene->index_count; i += 3) {
		const float *a = scene->vertices[scene->indices[i]].position;
		const float *b = scene->vertices[scene->indices[i + 1]].position;
		const float *c = scene->vertices[scene->indices[i + 2]].position;
		float z = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);

		n = scene->vertices[scene->indices[i]].normal;
		assert_true(z * n[2] > 0);
		assert_vector(n, 0, 0, 1);
	}
	scene_destroy(&scene);
	/* A quarter turn about Y takes +Z to +X; uneven scale keeps normals upright. */
	scene = good_quad(",\"rotation\":[0,0.70710678,0,0.70710678],\"scale\":[3,5,7]", "", "");
	assert_vector(scene->vertices[0].normal, 1, 0, 0);
	assert_vector(scene->min, 0, 0, -3);
	scene_destroy(&scene);
}

static void test_materials(void **state)
{
	struct import_options options = { .scale = 2, .emission_scale = 10, .double_sided = true };
	static const struct glb_quad quad = GLB_QUAD;
	const struct scene_material *m;
	struct scene *scene;

	(void)state;
	scene = good_quad("", ",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.2,0.4,0.8,1],"
			      "\"metallicFactor\":0}", "");
	m = &scene->materials[0];
	assert_string_equal(m->name, "m");
	assert_vector(m->diffuse, 0.2, 0.4, 0.8); /* roughness 1, no metal: Lambert */
	assert_vector(m->specular, 0, 0, 0);
	assert_false(m->two_sided);
	scene_destroy(&scene);

	scene = good_quad("", ",\"doubleSided\":true,\"pbrMetallicRoughness\":{\"baseColorFactor\":"
			      "[0.5,0.5,0.5,1],\"metallicFactor\":0,\"roughnessFactor\":0.5}", "");
	m = &scene->materials[0];
	assert_vector(m->specular, 0.04, 0.04, 0.04);
	assert_vector(m->diffuse, 0.48, 0.48, 0.48);
	assert_true(fabsf(m->shininess - 30.0f) < 1e-4f); /* alpha = 1/4: 2 * 16 - 2 */
	assert_true(m->two_sided);
	scene_destroy(&scene);

	scene = good_quad("", ",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0.8,0.3,1],"
			      "\"roughnessFactor\":0}", "");
	m = &scene->materials[0];
	assert_vector(m->diffuse, 0, 0, 0);
	assert_vector(m->specular, 1, 0.8, 0.3);
	assert_true(m->shininess == IMPORT_MAX_SHININESS);
	scene_destroy(&scene);

	assert_int_equal(import_quad(&quad, "",
				     ",\"emissiveFactor\":[1,0.5,0.25],\"extensions\":{"
				     "\"KHR_materials_emissive_strength\":{\"emissiveStrength\":8},"
				     "\"KHR_materials_specular\":{\"specularColorFactor\":[0,0,0]}},"
				     "\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0.1}",
				     "", &options, &scene, NULL, 0), GR_OK);
	m = &scene->materials[0];
	assert_vector(m->emission, 80, 40, 20);
	assert_vector(m->specular, 0, 0, 0);
	assert_vector(m->diffuse, 1, 1, 1);
	assert_true(m->two_sided);
	assert_true(scene->emissive);
	assert_vector(scene->max, 2, 2, 0);
	scene_destroy(&scene);
}

static void test_dropped(void **state)
{
	struct glb_quad quad = GLB_QUAD;
	struct scene *scene;
	char why[512];

	(void)state;
	quad.positions[1][2] = NAN; /* in the first triangle alone */
	assert_int_equal(import_quad(&quad, "", "", "", &plain, &scene, why, sizeof why), GR_OK);
	assert_int_equal(scene->dropped_nonfinite, 1);
	assert_int_equal(scene->index_count, 3);
	assert_non_null(strstr(why, "1 with NaN"));
	scene_destroy(&scene);

	quad = (struct glb_quad)GLB_QUAD;
	quad.positions[3][0] = INFINITY;
	quad.indices[1] = 0; /* two corners are one */
	assert_int_equal(import_quad(&quad, "", "", "", &plain, &scene, why, sizeof why),
			 GR_ERR_CONFIG);
	assert_non_null(strstr(why, "no triangle"));

	quad = (struct glb_quad)GLB_QUAD;
	quad.positions[2][1] = 0; /* the first lies on a line */
	assert_int_equal(import_quad(&quad, "", "", "", &plain, &scene, why, sizeof why), GR_OK);
	assert_int_equal(scene->dropped_degenerate, 1);
	scene_destroy(&scene);

	quad = (struct glb_quad)GLB_QUAD;
	quad.indices[4] = 4; /* one beyond the last */
	assert_int_equal(import_quad(&quad, "", "", "", &plain, &scene, why, sizeof why), GR_OK);
	assert_int_equal(scene->dropped_index, 1);
	assert_int_equal(scene->index_count, 3);
	scene_destroy(&scene);
	quad.indices[4] = 65535;
	quad.indices[0] = 40000;
	assert_int_equal(import_quad(&quad, "", "", "", &plain, &scene, NULL, 0), GR_ERR_CONFIG);
	/* Finite in the file, beyond float once placed. */
	quad = (struct glb_quad)GLB_QUAD;
	quad.positions[1][0] = 3e38f;
	assert_int_equal(import_quad(&quad, ",\"scale\":[10,1,1]", "", "", &plain, &scene, NULL, 0),
			 GR_OK);
	assert_int_equal(scene->dropped_nonfinite, 1);
	scene_destroy(&scene);
}

static void test_refused(void **state)
{
	static const struct {
		const char *node, *material, *more, *why;
	} bad[] = {
		{ ",\"children\":[0]", "", "", "two parents" },
		{ ",\"children\":[7]", "", "", "nodes[0].children[0]" },
		{ ",\"mesh\":1", "", "", "mesh" },
		{ "", ",\"emissiveFactor\":[1,1,1],\"extensions\":{\"KHR_materials_emissive_strength\":"
		      "{\"emissiveStrength\":1e39}}", "", "no finite" },
		{ "", ",\"emissiveFactor\":[1,1,1],\"extensions\":{\"KHR_materials_emissive_strength\":"
		      "{\"emissiveStrength\":-1}}", "", "negative" },
		{ "", ",\"emissiveFactor\":[1,1,1],\"extensions\":{\"KHR_materials_emissive_strength\":"
		      "{\"emissiveStrength\":\"x\"}}", "", "no finite" },
		{ "", "", ",\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]", "draco" },
		{ "", ",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}",
		  ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"gone.png\"}]", "gone.png" },
		{ "", ",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}",
		  ",\"textures\":[{\"source\":0}],\"images\":[{\"bufferView\":0,"
		  "\"mimeType\":\"image/png\"}]", "neither PNG nor JPEG" },
		/* This one alone crashed assimp 5.2.5. */
		{ "", ",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}",
		  ",\"textures\":[{\"source\":0}],\"images\":[{\"bufferView\":0,"
		  "\"mimeType\":\"image-png\"}]", "images[0].mimeType" },
		{ "", "", ",\"textures\":[{\"source\":0}]", "textures[0].source" },
		{ "", "", ",\"textures\":[{}]", "textures[0].source: is missing" },
		{ "", "", ",\"textures\":{}", "textures: must be a list" },
		{ "", "", ",\"images\":[{\"uri\":7}]", "images[0].uri: must be a string" },
		{ "", "", ",\"images\":[{\"uri\":\"data:image/png;base64,%%\"}]", "base64" },
		{ "", "", ",\"images\":[{}]", "either a uri or a bufferView" },
		{ "", "", ",\"images\":[null]", "images[0]: must be an object" },
		{ ",\"scale\":[1,2]", "", "", "nodes[0].scale: has another number" },
		{ ",\"scale\":[1,2,\"x\"]", "", "", "nodes[0].scale[2]: must be a number" },
		{ ",\"scale\":[1,2,1e39]", "", "", "nodes[0].scale[2]: must be a number" },
		{ ",\"children\":\"x\"", "", "", "nodes[0].children: must be a list" },
		{ ",\"children\":[0.5]", "", "", "nodes[0].children[0]: must be a whole" },
		{ ",\"mesh\":null", "", "", "nodes[0].mesh: must be a whole" },
		{ "", ",\"doubleSided\":1", "", "materials[0].doubleSided" },
		{ "", ",\"alphaMode\":\"GLASS\"", "", "materials[0].alphaMode" },
		{ "", ",\"emissiveTexture\":{\"index\":0}", "", "the file has no textures" },
		{ "", "", ",\"scene\":1", "scene: must be a whole number from 0 to 0" },
		{ "", "", ",\"scenes\":[]", "scene" },
		{ "", "", ",\"scenes\":[{\"nodes\":[0,0]}]", "named twice" },
		{ "", "", ",\"asset\":{\"version\":\"1.0\"}", "glTF 2.0 is read" },
	};
	static const struct glb_quad quad = GLB_QUAD;
	struct scene *scene;
	char why[1024];

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		assert_int_equal(import_quad(&quad, bad[i].node, bad[i].material, bad[i].more, &plain,
					     &scene, why, sizeof why), GR_ERR_CONFIG);
		if (!strstr(why, bad[i].why))
			print_message("case %zu, wanted %s: %s", i, bad[i].why, why);
		assert_non_null(strstr(why, bad[i].why));
		assert_non_null(strstr(why, strcmp(bad[i].why, "gone.png") == 0 ? "gone.png" : "quad.glb"));
	}
}

static void test_cut(void **state)
{
	static const struct glb_quad quad = GLB_QUAD;
	struct scene *scene;
	size_t len;
	uint8_t *bytes = glb_of_quad(&quad, "", "", "", &len);

	(void)state;
	for (size_t cut = 1; cut < len; cut++)
		assert_int_equal(import_copy(bytes, cut, "cut.glb", &plain, &scene, NULL, 0),
				 GR_ERR_CONFIG);
	assert_int_equal(import_copy(bytes, len, "cut.glb", &plain, &scene, NULL, 0), GR_OK);
	scene_destroy(&scene);
	printf("# %zu bytes, refused at every shorter length\n", len);
	free(bytes);
}

/* A buffer that promises more than there is, views and accessors that reach too far. */
static void test_lengths(void **state)
{
	static const struct {
		const char *from, *to;
	} changes[] = {
		{ "\"buffers\":[{\"byteLength\":96}", "\"buffers\":[{\"byteLength\":97}" },
		{ "\"byteOffset\":80,\"byteLength\":12", "\"byteOffset\":80,\"byteLength\":32" },
		{ "\"byteOffset\":48,\"byteLength\":32", "\"byteOffset\":-8,\"byteLength\":32" },
		{ "\"count\":6,\"type\":\"SCALAR\"", "\"count\":7,\"type\":\"SCALAR\"" },
		{ "\"count\":6,\"type\":\"SCALAR\"", "\"count\":0,\"type\":\"SCALAR\"" },
		{ "5126,\"count\":4,\"type\":\"VEC2\"", "5126,\"count\":3,\"type\":\"VEC2\"" },
		{ "5126,\"count\":4,\"type\":\"VEC2\"", "5126,\"count\":4,\"type\":\"VEC3\"" },
		{ "5126,\"count\":4,\"type\":\"VEC2\"", "5127,\"count\":4,\"type\":\"VEC2\"" },
		{ "{\"bufferView\":0,\"comp", "{\"bufferView\":3,\"comp" },
		{ "\"POSITION\":0", "\"POSITION\":9" },
		{ "\"indices\":2", "\"indices\":3" },
		{ "\"material\":0", "\"material\":5" },
		{ "\"mesh\":0", "\"mesh\":1" },
		{ "\"byteOffset\":0,\"byteLength\":48", "\"byteOffset\":0,\"byteLength\":1e9" },
	};
	static const struct glb_quad quad = GLB_QUAD;

	(void)state;
	for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++) {
		struct scene *scene;
		size_t len, head;
		uint8_t *good = glb_of_quad(&quad, "", "", "", &len), *bad;
		char json[4096], *at;

		good[len - 1] = 0;
		head = 0;
		memcpy(&head, good + 12, 4);
		memcpy(json, good + 20, head);
		json[head] = '\0';
		at = strstr(json, changes[i].from);
		assert_non_null(at);
		memmove(at + strlen(changes[i].to), at + strlen(changes[i].from),
			strlen(at + strlen(changes[i].from)) + 1);
		memcpy(at, changes[i].to, strlen(changes[i].to));
		free(good);
		bad = glb_pack(json, &quad, sizeof quad, &len);
		if (import_copy(bad, len, "lengths.glb", &plain, &scene, NULL, 0) != GR_ERR_CONFIG)
			fail_msg("accepted: %s", changes[i].to);
		free(bad);
	}
}

static void test_changed(void **state)
{
	static const struct glb_quad quad = GLB_QUAD;
	struct unit_random random = unit_random_start("changed models");
	int rounds = getenv("GROTTO_LONG") ? 20000 : 1500, accepted = 0;
	size_t len;
	uint8_t *bytes = glb_of_quad(&quad, ",\"scale\":[1,2,3]", ",\"emissiveFactor\":[1,0,0]", "",
				     &len);

	(void)state;
	for (int i = 0; i < rounds; i++) {
		uint8_t *copy = unit_copy(bytes, len);
		struct scene *scene;

		for (uint32_t k = unit_random_u32(&random) % 4; k < 4; k++)
			copy[unit_random_u32(&random) % len] = (uint8_t)unit_random_u32(&random);
		if (import_copy(copy, len, "changed.glb", &plain, &scene, NULL, 0) == GR_OK) {
			accepted++;
			for (size_t v = 0; v < scene->vertex_count; v++)
				assert_true(isfinite(scene->vertices[v].position[0] +
						     scene->vertices[v].position[1] +
						     scene->vertices[v].position[2]));
			for (size_t k = 0; k < scene->index_count; k++)
				assert_true(scene->indices[k] < scene->vertex_count);
			scene_destroy(&scene);
		}
		free(copy);
	}
	printf("# %d changed models: %d still imported\n", rounds, accepted);
	free(bytes);
}

static void test_hash(void **state)
{
	struct scene *a = good_quad("", "", ""), *b = good_quad("", "", "");
	struct scene *moved = good_quad(",\"translation\":[0,0,0.001]", "", "");
	struct scene *painted = good_quad("", ",\"doubleSided\":true", "");

	(void)state;
	assert_memory_equal(a->hash, b->hash, 32);
	assert_memory_not_equal(a->hash, moved->hash, 32);
	assert_memory_not_equal(a->hash, painted->hash, 32);
	scene_destroy(&a);
	scene_destroy(&b);
	scene_destroy(&moved);
	scene_destroy(&painted);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_quad),       cmocka_unit_test(test_nodes),
		cmocka_unit_test(test_materials),  cmocka_unit_test(test_dropped),
		cmocka_unit_test(test_refused),    cmocka_unit_test(test_cut),
		cmocka_unit_test(test_lengths),    cmocka_unit_test(test_changed),
		cmocka_unit_test(test_hash),
	};

	gr_log_init("test_import", GR_LOG_INFO);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
