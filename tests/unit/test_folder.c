/* Foreign scenes: what is understood becomes ours, what is not is named. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/photometry.h"
#include "base/result.h"
#include "renderer/scene/environment.h"
#include "renderer/scene/sky.h"
#include "tests/accuracy/folder/agreement.h"
#include "tests/accuracy/folder/folder.h"
#include "tests/accuracy/folder/work.h"
#include "tests/unit/shared.h"

#include <math.h>

static char work[1024];

#define QUAD "[[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]]"
#define CAMERA "{\"name\":\"c\",\"position\":[0,0,3],\"direction\":[0,0,-1],\"vfov_deg\":40}"

static void write_scene(const char *text)
{
	char path[1100];
	FILE *out;

	snprintf(path, sizeof path, "%s/scene.json", work);
	out = fopen(path, "w");
	assert_non_null(out);
	fputs(text, out);
	fclose(out);
}

static int open_scene(const char *text, struct folder *folder, char why[2048])
{
	struct gr_diag diag = { 0 };
	int result;

	write_scene(text);
	result = folder_open(folder, work, work, &diag);
	why[0] = '\0';
	for (size_t i = 0; i < diag.count; i++)
		snprintf(why + strlen(why), 2048 - strlen(why), "%s\n", diag.items[i].text);
	assert_true((result == GR_OK) == (diag.errors == 0));
	gr_diag_finish(&diag);
	return result;
}

static const struct scene_material *find(const struct scene *scene, const char *name)
{
	for (size_t i = 0; i < scene->material_count; i++)
		if (strcmp(scene->materials[i].name, name) == 0)
			return &scene->materials[i];
	fail_msg("no material %s", name);
	return NULL;
}

/* Quads and a sphere become a model of their own. */
static void understood(void **state)
{
	static const char text[] =
		"{\"name\":\"test\",\"axes\":\"\",\"max_bounces\":7,\"resolution\":[64,32],"
		"\"materials\":{\"a \\\"b\\\"\":{\"type\":\"diffuse\",\"reflectance\":[0.5,0.25,1]},"
		"\"m\":{\"type\":\"mirror\",\"reflectance\":[0.9,0.9,0.9]},"
		"\"g\":{\"type\":\"ggx\",\"roughness\":0.5,\"reflectance\":[0.8,0.8,0.8]},"
		"\"l\":{\"type\":\"emitter\",\"radiance\":[3,2,1]},"
		"\"unused\":{\"type\":\"diffuse\",\"reflectance\":[0,0,0]}},"
		"\"objects\":[{\"name\":\"o\",\"material\":\"a \\\"b\\\"\",\"quads\":" QUAD "},"
		"{\"material\":\"m\",\"quads\":" QUAD "},{\"material\":\"g\",\"quads\":" QUAD "},"
		"{\"material\":\"l\",\"sphere\":{\"center\":[1,2,3],\"radius\":2}}],"
		"\"lights\":[{\"type\":\"portal\",\"anything\":1},"
		"{\"type\":\"spot\",\"position\":[0,1,2],\"direction\":[0,-2,0],\"full_cone_deg\":50,"
		"\"blend\":0,\"power_W\":4000,\"color\":[1,0.5,0]},"
		"{\"type\":\"sun\",\"position\":[0,9,0],\"direction\":[0,-1,0],\"irradiance\":10,"
		"\"color\":[1,1,0.5]}],"
		"\"environment\":{\"type\":\"constant\",\"radiance\":[1,1,1],\"upper_only\":true},"
		"\"cameras\":[" CAMERA "]}";
	static const float up[3] = { 0, 1, 0 };
	const struct scene_lamp *lamps;
	struct folder f;
	char why[2048];
	float sky[3];

	(void)state;
	if (open_scene(text, &f, why) != GR_OK)
		fail_msg("%s", why);
	assert_int_equal(f.max_bounces, 7);
	assert_true(f.width == 64 && f.height == 32 && !f.diffuse && f.surrounded);
	assert_string_equal(f.cameras[0], "c");
	assert_true(f.file->cameras[0].target[2] == 2);
	assert_true(find(f.scene, "a \"b\"")->diffuse[1] == 0.25f);
	assert_true(find(f.scene, "a \"b\"")->two_sided);
	assert_int_equal(find(f.scene, "m")->kind, MATERIAL_MIRROR);
	assert_true(find(f.scene, "g")->alpha == 0.25f);
	assert_true(find(f.scene, "l")->emission[0] == 3 && f.scene->emissive);
	assert_int_equal(f.scene->index_count, 3 * (6 + 128 * (2 * 64 - 2)));
	assert_true(fabsf(f.scene->max[0] - 3) < 1e-5f && fabsf(f.scene->max[1] - 4) < 1e-5f);
	lamps = f.file->lamps;
	assert_int_equal(f.file->lamp_count, 2);
	assert_true(fabs((double)lamps[0].intensity[1] - 4000 / (4 * M_PI) / 2) < 1e-2);
	assert_true(fabs((double)lamps[0].cone_rad - 50 * M_PI / 180) < 1e-5 && lamps[0].radius_m == 0);
	assert_true(lamps[1].kind == SCENE_LAMP_DIRECTIONAL && lamps[1].intensity[2] == 5);
	environment_radiance(f.scene->environment, up, sky);
	assert_true(sky[0] == 1);
	folder_close(&f);
}

static void refused(const char *text, const char *words)
{
	struct folder f;
	char why[2048];

	assert_int_equal(open_scene(text, &f, why), GR_ERR_CONFIG);
	if (!strstr(why, words))
		print_message("%s", why);
	assert_non_null(strstr(why, words));
}

/* A scene with one part of it changed. */
static void refused_part(const char *material, const char *object, const char *more,
			 const char *words)
{
	char text[2048];

	snprintf(text, sizeof text,
		 "{\"name\":\"t\",\"materials\":{\"a\":%s},\"objects\":[%s],%s\"cameras\":[" CAMERA "]}",
		 material ? material : "{\"type\":\"diffuse\",\"reflectance\":[0,0,0]}",
		 object ? object : "{\"material\":\"a\",\"quads\":" QUAD "}", more ? more : "");
	refused(text, words);
}

static void refusals(void **state)
{
	(void)state;
	refused("", "scene");
	refused("[1]", "no JSON object");
	refused("{\"name\":\"t\"", "no JSON object");
	refused("{}", "\"materials\" is missing");
	refused_part(NULL, NULL, "\"fog\":1,", "\"fog\" is not known here");
	refused_part("{\"type\":\"velvet\"}", NULL, NULL, "type \"velvet\" is not known");
	refused_part("{\"type\":\"diffuse\",\"reflectance\":[0,0]}", NULL, NULL,
		     "materials.a.reflectance: 3 finite numbers");
	refused_part("{\"type\":\"mirror\",\"reflectance\":[0,0,0],\"tint\":1}", NULL, NULL,
		     "\"tint\" is not known");
	refused_part("{\"type\":\"diffuse\",\"reflectance\":[2,0,0]}", NULL, NULL, "reflectance");
	refused_part(NULL, "{\"material\":\"b\",\"quads\":" QUAD "}", NULL,
		     "material \"b\" is not among the materials");
	refused_part(NULL, "{\"material\":\"a\",\"torus\":{}}", NULL, "\"torus\" is not known");
	refused_part(NULL, "{\"material\":\"a\"}", NULL, "neither quads nor a sphere");
	refused_part(NULL, "{\"material\":\"a\",\"quads\":[[[0,0,0],[1,0,0],[1,1,0]]]}", NULL,
		     "no four corners");
	refused_part(NULL, "{\"material\":\"a\",\"quads\":[[[0,0,0],[1,0,0],[1,1,0],[0,1,\"x\"]]]}", NULL,
		     "3 finite numbers");
	refused_part(NULL, "{\"glb\":\"no.glb\"}", NULL, "no.glb");
	refused_part(NULL, "{\"glb\":\"scene.json\"}", NULL, "scene.json");
	refused_part(NULL, NULL, "\"lights\":[{\"type\":\"laser\"}],", "type \"laser\" is not known");
	refused_part(NULL, NULL, "\"lights\":[{\"type\":\"spot\",\"blend\":0.5}],", "blend 0.5");
	refused_part(NULL, NULL, "\"environment\":{\"type\":\"hosek\"},", "type \"hosek\" is not known");
	refused_part(NULL, NULL, "\"environment\":{\"type\":\"latlong\",\"file\":\"no.exr\"},", "no.exr");
	refused_part(NULL, NULL,
		     "\"environment\":{\"type\":\"preetham\",\"turbidity\":3,\"sun_direction\":[0,-1,0]},",
		     "below the horizon");
	refused_part(NULL, NULL, "\"max_bounces\":-1,", "max_bounces");
	refused_part(NULL, NULL, "\"resolution\":[1e9,4],", "resolution");
}

/* Published luminances of the sky, and the pictures of it. */
static void skies(void **state)
{
	char path[1024], line[512];
	double worst = 0;
	int lines = 0;
	FILE *csv;

	(void)state;
	if (!shared_file("reference/sky/samples.csv", path))
		skip();
	csv = fopen(path, "r");
	assert_non_null(csv);
	while (fgets(line, sizeof line, csv)) {
		double turbidity, sun_at, elevation, d[3], want[3], got[3];
		struct sky sky;

		if (sscanf(line, "%*[^,],%lf,%lf,%lf,%*f,%lf,%lf,%lf,%lf,%lf,%lf", &turbidity, &sun_at,
			   &elevation, &d[0], &d[1], &d[2], &want[0], &want[1], &want[2]) != 9 ||
		    elevation < 3)
			continue;
		const double sun[3] = { cos(sun_at * M_PI / 180), sin(sun_at * M_PI / 180), 0 };

		sky_init(&sky, turbidity, sun);
		sky_radiance(&sky, d, got);
		for (int c = 0; c < 3; c++) /* 1.0 is 16.667 kcd/m^2 */
			worst = fmax(worst, fabs(got[c] * 0.06 / 1000 * GR_LUMENS_PER_WATT / want[c] - 1));
		lines++;
	}
	fclose(csv);
	printf("# Preetham's sky: %d directions above 3 degrees, worst relative difference %.2e\n", lines,
	       worst);
	assert_true(lines > 100);
	assert_true(worst < 6e-3);
}

/* Two noisy pictures of the same agree as their noise says; a shift of a per cent is seen. */
static void noise_is_told(void **state)
{
	struct unit_random random = { 77 };
	struct image a, b, error;
	struct agreement g;

	(void)state;
	assert_int_equal(image_create(&a, 128, 128, 3), GR_OK);
	assert_int_equal(image_create(&b, 128, 128, 3), GR_OK);
	assert_int_equal(image_create(&error, 128, 128, 3), GR_OK);
	for (int i = 0; i < 3 * 128 * 128; i++) {
		double n[2] = { 0 };

		for (int k = 0; k < 24; k++) /* near to normal, variance 1 */
			n[k % 2] += unit_random_range(&random, -0.5, 0.5);
		a.data[i] = (float)(1 + 0.05 * n[0]);
		b.data[i] = (float)(1 + 0.05 * n[1]);
		error.data[i] = 0.05f;
	}
	assert_int_equal(agreement_of(&a, &error, &b, &error, 8, &g), GR_OK);
	printf("# noise of 5 %% a pixel: blocks differ by %.4f, noise %.4f, within %.3f and %.3f, chi2 %.2f\n",
	       g.blocks, g.noise, g.within_pixels, g.within_blocks, g.chi2);
	assert_true(fabs(g.blocks / g.noise - 1) < 0.1 && fabs(g.chi2 - 1) < 0.15);
	assert_true(fabs(g.noise / g.their_noise - sqrt(2)) < 1e-3);
	assert_true(g.within_pixels > 0.99 && g.within_blocks > 0.99);
	for (int i = 0; i < 3 * 128 * 128; i++)
		a.data[i] *= 1.01f;
	assert_int_equal(agreement_of(&a, &error, &b, &error, 8, &g), GR_OK);
	assert_true(fabs(g.ratio - 1.01) < 4 * g.ratio_error && g.ratio_error < 1e-3 && g.chi2 > 1.5);
	image_finish(&a);
	image_finish(&b);
	image_finish(&error);
}

static int set_up(void **state)
{
	(void)state;
	return work_make(work) ? 0 : -1;
}

static int tear_down(void **state)
{
	(void)state;
	work_remove(work);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(understood), cmocka_unit_test(refusals), cmocka_unit_test(skies),
		cmocka_unit_test(noise_is_told),
	};

	gr_log_init("test_folder", GR_LOG_ERROR);
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
