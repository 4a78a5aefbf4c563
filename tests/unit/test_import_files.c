/* Models of files: companions, the other formats, a crash, our scenes and foreign ones. */
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
static char folder[64];

static int set_up(void **state)
{
	(void)state;
	snprintf(folder, sizeof folder, "test_import.%ld", (long)getpid());
	return mkdir(folder, 0700);
}

static const char *inside(const char *name)
{
	static char path[256];

	snprintf(path, sizeof path, "%s/%s", folder, name);
	return path;
}

static int tear_down(void **state)
{
	static const char *const names[] = { "a.gltf", "a.bin", "a.png", "a.jpg", "a.obj", "a.mtl",
					     "a.dae", "my image.png" };

	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		remove(inside(names[i]));
	return rmdir(folder);
}

static void write_file(const char *name, const void *bytes, size_t len)
{
	FILE *file = fopen(inside(name), "wb");

	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, len, file), len);
	fclose(file);
}

static int import_path(const char *path, struct scene **out, char *why, size_t why_size)
{
	struct gr_diag diag = { 0 };
	int result = import_model(path, &plain, out, &diag);

	why[0] = '\0';
	for (size_t i = 0; i < diag.count; i++)
		snprintf(why + strlen(why), why_size - strlen(why), "%s\n", diag.items[i].text);
	gr_diag_finish(&diag);
	return result;
}

static const char textured[] =
	"{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
	"\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
	"\"TEXCOORD_0\":1},\"indices\":2,\"material\":0}]}],"
	"\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0},"
	"\"metallicFactor\":0},\"emissiveFactor\":[1,1,1],\"emissiveTexture\":{\"index\":1}}],"
	"\"textures\":[{\"source\":0},{\"source\":1}],"
	"\"images\":[{\"uri\":\"my%20image.png\"},{\"uri\":\"a.jpg\"}],"
	"\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
	"{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
	"{\"bufferView\":2,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}],"
	"\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":48},"
	"{\"buffer\":0,\"byteOffset\":48,\"byteLength\":32},"
	"{\"buffer\":0,\"byteOffset\":80,\"byteLength\":12}],"
	"\"buffers\":[{\"uri\":\"a.bin\",\"byteLength\":96}]}";

static size_t write_jpeg(const char *path, int width, int height)
{
	struct jpeg_compress_struct info;
	struct jpeg_error_mgr errors;
	unsigned char *bytes = NULL, *row = malloc((size_t)width * 3);
	unsigned long len = 0;
	FILE *file;

	info.err = jpeg_std_error(&errors);
	jpeg_create_compress(&info);
	jpeg_mem_dest(&info, &bytes, &len);
	info.image_width = (JDIMENSION)width;
	info.image_height = (JDIMENSION)height;
	info.input_components = 3;
	info.in_color_space = JCS_RGB;
	jpeg_set_defaults(&info);
	jpeg_start_compress(&info, TRUE);
	memset(row, 200, (size_t)width * 3);
	for (int y = 0; y < height; y++)
		jpeg_write_scanlines(&info, &row, 1);
	jpeg_finish_compress(&info);
	jpeg_destroy_compress(&info);
	file = fopen(path, "wb");
	fwrite(bytes, 1, len, file);
	fclose(file);
	free(bytes);
	free(row);
	return (size_t)len;
}

static void cut_file(const char *name, size_t len)
{
	assert_int_equal(truncate(inside(name), (off_t)len), 0);
}

/* Buffers and textures beside the model; each of them missing, then cut off. */
static void test_companions(void **state)
{
	static const struct glb_quad quad = GLB_QUAD;
	uint8_t rgb[2 * 2 * 3] = { 255, 0, 0, 0, 255, 0, 0, 0, 255, 9, 8, 7 };
	struct scene *scene;
	char why[1024], model[256];
	size_t jpeg;

	(void)state;
	snprintf(model, sizeof model, "%s", inside("a.gltf"));
	write_file("a.gltf", textured, sizeof textured - 1);
	assert_int_equal(import_path(model, &scene, why, sizeof why), GR_ERR_CONFIG);
	assert_non_null(strstr(why, "a.bin"));
	write_file("a.bin", &quad, sizeof quad);
	assert_int_equal(import_path(model, &scene, why, sizeof why), GR_ERR_CONFIG);
	assert_non_null(strstr(why, "my image.png"));
	assert_int_equal(image_write_png(inside("my image.png"), 2, 2, rgb), GR_OK);
	assert_int_equal(import_path(model, &scene, why, sizeof why), GR_ERR_CONFIG);
	assert_non_null(strstr(why, "a.jpg"));
	jpeg = write_jpeg(inside("a.jpg"), 40, 24);
	assert_int_equal(import_path(model, &scene, why, sizeof why), GR_OK);
	assert_int_equal(scene->image_count, 2);
	assert_int_equal(scene->materials[0].diffuse_image, 0);
	assert_int_equal(scene->materials[0].emission_image, 1);
	assert_int_equal(scene->images[0].width, 2);
	assert_true(scene->images[0].srgb);
	assert_memory_equal(scene->images[0].rgba, "\377\0\0\377\0\377\0\377\0\0\377\377\11\10\7\377", 16);
	assert_int_equal(scene->images[1].height, 24);
	assert_in_range(scene->images[1].rgba[5], 199, 201);
	scene_destroy(&scene);
	for (size_t cut = jpeg - 1; cut > 0; cut = cut * 3 / 4) {
		cut_file("a.jpg", cut);
		assert_int_equal(import_path(model, &scene, why, sizeof why), GR_ERR_CONFIG);
		assert_non_null(strstr(why, "a.jpg"));
	}
	write_jpeg(inside("a.jpg"), 40, 24);
	cut_file("my image.png", 60);
	assert_int_equal(import_path(model, &scene, why, sizeof why), GR_ERR_CONFIG);
	assert_non_null(strstr(why, "my image.png"));
	assert_int_equal(image_write_png(inside("my image.png"), 2, 2, rgb), GR_OK);
	cut_file("a.bin", 95);
	assert_int_equal(import_path(model, &scene, why, sizeof why), GR_ERR_CONFIG);
	assert_non_null(strstr(why, "a.bin"));
}

static void test_obj(void **state)
{
	static const char obj[] = "mtllib a.mtl\nusemtl shiny\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
				  "v 0 0 -1\nf 1 2 3 4\nf 1 4 5\n";
	static const char mtl[] = "newmtl shiny\nKd 0.9 0.6 0.3\nKs 0.6 0.6 0.6\nNs 40\nillum 2\n"
				  "Ke 2 1 0\n";
	const struct scene_material *m = NULL;
	struct scene *scene;
	char why[1024];

	(void)state;
	write_file("a.obj", obj, sizeof obj - 1);
	write_file("a.mtl", mtl, sizeof mtl - 1);
	assert_int_equal(import_path(inside("a.obj"), &scene, why, sizeof why), GR_OK);
	assert_int_equal(scene->index_count, 9);
	for (size_t i = 0; i < scene->material_count; i++) {
		if (strcmp(scene->materials[i].name, "shiny") == 0)
			m = &scene->materials[i];
	}
	assert_non_null(m);
	/* 0.9 + 0.6 is more light than came: both shrink by 1.5. */
	assert_vector(m->diffuse, 0.6, 0.4, 0.2);
	assert_vector(m->specular, 0.4, 0.4, 0.4);
	assert_vector(m->emission, 2, 1, 0);
	assert_true(m->shininess == 40.0f);
	/* The edge of 90 degrees stays an edge. */
	for (size_t i = 0; i < scene->vertex_count; i++)
		assert_true(fabsf(scene->vertices[i].normal[2]) > 0.999f ||
			    fabsf(scene->vertices[i].normal[0]) > 0.999f);
	scene_destroy(&scene);
	write_file("a.obj", "f 1 2 3\n", 8);
	assert_int_equal(import_path(inside("a.obj"), &scene, why, sizeof why), GR_ERR_CONFIG);
}

static const char collada[] =
	"<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
	"version=\"1.4.1\"><asset><unit meter=\"1\"/><up_axis>Z_UP</up_axis></asset>"
	"<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"pa\" "
	"count=\"9\">0 0 0 1 0 0 0 0 1</float_array><technique_common><accessor source=\"#pa\" "
	"count=\"3\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" "
	"type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
	"<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
	"<triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
	"<p>0 1 2</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>"
	"<visual_scene id=\"s\"><node id=\"n\"><instance_geometry url=\"#g\"/></node></visual_scene>"
	"</library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";

static void test_collada(void **state)
{
	struct scene *scene;
	char why[1024];

	(void)state;
	write_file("a.dae", collada, sizeof collada - 1);
	assert_int_equal(import_path(inside("a.dae"), &scene, why, sizeof why), GR_OK);
	assert_int_equal(scene->index_count, 3);
	/* Z up there is Y up here. */
	assert_vector(scene->min, 0, 0, 0);
	assert_vector(scene->max, 1, 1, 0);
	scene_destroy(&scene);
	write_file("a.dae", collada, sizeof collada / 2);
	assert_int_equal(import_path(inside("a.dae"), &scene, why, sizeof why), GR_ERR_CONFIG);
	assert_int_equal(import_path(inside("none.fbx"), &scene, why, sizeof why), GR_ERR_CONFIG);
	assert_non_null(strstr(why, "No such file"));
}

/* assimp 5.2.5 follows a null pointer there; it does so in a child, and this process goes on. */
static void test_crash(void **state)
{
	const char *source = getenv("srcdir") ? getenv("srcdir") : ".";
	struct scene *scene;
	char path[512], why[1024];

	(void)state;
	snprintf(path, sizeof path, "%s/tests/data/crash.fbx", source);
	if (import_path(path, &scene, why, sizeof why) == GR_OK) {
		scene_destroy(&scene);
		printf("# this assimp reads crash.fbx\n");
		return;
	}
	printf("# %s", why);
	assert_non_null(strstr(why, "crash.fbx"));
	if (aiGetVersionMajor() == 5 && aiGetVersionMinor() == 2)
		assert_non_null(strstr(why, "crash (signal"));
	assert_int_equal(import_path("model.blend", &scene, why, sizeof why), GR_ERR_CONFIG);
	assert_non_null(strstr(why, "No such file"));
	write_file("a.bin", "glTF", 4);
	assert_int_equal(import_path(inside("a.bin"), &scene, why, sizeof why), GR_ERR_CONFIG);
	assert_non_null(strstr(why, "of no known form"));
}

static void test_own_scenes(void **state)
{
	static const struct {
		const char *name;
		size_t triangles;
		bool emissive;
	} scenes[] = {
		{ "cornell", 38, true }, { "cornell-spot", 30, false }, { "box", 66, false },
		{ "grotto", 300, true },
	};
	const char *source = getenv("srcdir") ? getenv("srcdir") : ".";

	(void)state;
	for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
		struct scene *scene;
		char path[512], why[1024];

		snprintf(path, sizeof path, "%s/scenes/%s.gltf", source, scenes[i].name);
		if (import_path(path, &scene, why, sizeof why) != GR_OK)
			fail_msg("%s", why);
		assert_int_equal(scene->index_count, scenes[i].triangles * 3);
		assert_int_equal(scene->dropped_degenerate + scene->dropped_nonfinite +
				 scene->dropped_index, 0);
		assert_int_equal(scene->emissive, scenes[i].emissive);
		scene_destroy(&scene);
	}
}

static void test_foreign(void **state)
{
	static const struct {
		const char *name;
		size_t triangles;
	} models[] = {
		{ "reference/scenes/models/sponza_part.glb", 33663 },
		{ "reference/scenes/models/stanford_bunny_lowres.glb", 3674 },
		{ "reference/scenes/models/stanford_dragon_res3.glb", 46540 },
		{ "reference/scenes/characters/CesiumMan/CesiumMan.gltf", 4672 },
		{ "reference/scenes/characters/RiggedFigure/RiggedFigure.gltf", 256 },
		{ "reference/renders/a_cornell/scene.glb", 38 },
		{ "reference/renders/b1_mirror_block/scene.glb", 38 },
		{ "reference/renders/b2_mirror_backwall/scene.glb", 38 },
		{ "reference/renders/c_spot/scene.glb", 30 },
		{ "reference/renders/d1_room_preetham/scene.glb", 36 },
		{ "reference/renders/d2_room_constant/scene.glb", 36 },
		{ "reference/renders/e1_ggx_backwall/scene.glb", 38 },
		{ "reference/renders/e2_ggx_floor/scene.glb", 38 },
		{ "reference/renders/f1_objects_constant_env/scene.glb", 16140 },
		{ "reference/renders/f2_objects_probe/scene.glb", 16140 },
	};
	char path[1024], why[1024];
	size_t found = 0;

	(void)state;
	for (size_t i = 0; i < sizeof models / sizeof models[0]; i++) {
		struct scene *scene;

		if (!shared_file(models[i].name, path))
			continue;
		found++;
		if (import_path(path, &scene, why, sizeof why) != GR_OK)
			fail_msg("%s", why);
		printf("# %s: %zu triangles, %zu vertices, %zu materials, %zu textures, dropped %zu\n",
		       models[i].name, scene->index_count / 3, scene->vertex_count,
		       scene->material_count, scene->image_count,
		       scene->dropped_degenerate + scene->dropped_nonfinite + scene->dropped_index);
		if (models[i].triangles)
			assert_int_equal(scene->index_count / 3, models[i].triangles);
		scene_destroy(&scene);
	}
	if (!found)
		skip();
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_companions), cmocka_unit_test(test_obj),
		cmocka_unit_test(test_collada),    cmocka_unit_test(test_crash),
		cmocka_unit_test(test_own_scenes), cmocka_unit_test(test_foreign),
	};

	gr_log_init("test_import_files", GR_LOG_INFO);
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
