/* Scene files: values, every kind of fault with its line, save and load again, what the hash covers. */
#include "config/scene_file.h"

#include "base/result.h"
#include "tests/unit/unit_config.h"

#include <math.h>

static const char base[] =
	"name = \"room\";\n"
	"model = \"models/room.gltf\";\n"
	"lamps = (\n"
	"	{ name = \"spot\"; kind = \"spot\";\n"
	"	  position = [0.0, 2.0, 0.0]; direction = [0.0, -3.0, 4.0];\n"
	"	  intensity = [10.0, 9.0, 8.0];\n"
	"	  cone_deg = 80.0; penumbra_deg = 10.0; },\n"
	"	{ name = \"bulb\"; kind = \"point\"; position = (1, 2.5, 3);\n"
	"	  intensity = [1, 2, 3]; on = false; },\n"
	"	{ name = \"sun\"; kind = \"directional\"; direction = [0.0, -1.0, 0.0];\n"
	"	  intensity = [3.0, 3.0, 3.0]; },\n"
	"	{ name = \"torch\"; kind = \"spot\"; mount = \"wand\"; intensity = [5.0, 5.0, 5.0]; },\n"
	"	{ name = \"moth\"; kind = \"point\"; mount = \"orbit\"; intensity = [1.0, 1.0, 1.0];\n"
	"	  orbit_center = [0.0, 1.5, 0.0]; orbit_radius_m = 0.7; orbit_period_s = -7.5; }\n"
	");\n"
	"cameras = ( { name = \"door\"; position = [0.0, 1.6, 3.0];\n"
	"	target = [0.0, 1.2, 0.0]; vfov_deg = 45.0; pixels = [320, 240]; } );\n"
	"gi = { method = \"lpv\"; lpv = { mode = \"thesis\"; lattice = 24; steps = 12; incremental = 0.9;\n"
	"	rsm_pixels = 64; link_rays = 77; albedo_override = [0.5, 0.4, 0.3]; };\n"
	"	budget_ms = 3.5; surfels = { spacing_m = 0.2; links = 512; gathers = 2; taps = 32; probes = 5; }; };\n"
	"materials = ( { material = \"tall box\"; kind = \"mirror\"; reflectance = [0.9, 0.8, 0.7]; },\n"
	"	{ material = \"back\"; kind = \"conductor\"; reflectance = [0.5, 0.5, 0.5]; roughness = 0.3; },\n"
	"	{ material = \"wood\"; kind = \"phong\"; reflectance = [0.5, 0.4, 0.3]; specular = [0.1, 0.1, 0.1];\n"
	"	  shininess = 40.0; sides = \"two\"; },\n"
	"	{ material = \"paint\"; kind = \"measured\"; file = \"paint.brdf\"; },\n"
	"	{ material = \"tube\"; emission = [17.0, 12.0, 4.0]; } );\n"
	"environment = { kind = \"image\"; file = \"sky.exr\"; scale = 2.0; heading_deg = 30.0; upper_only = true; };\n"
	"medium = { absorption_per_m = 0.01; scattering_per_m = 0.02; };\n"
	"tone = { curve = \"linear\"; exposure = 0.5; ambient = \"dark\"; gamma_display = 2.5; };\n"
	"room = { position = [1.0, 0.0, -2.0]; heading_deg = 90.0; };\n"
	"background = [0.1, 0.2, 0.3]; near_m = 0.1; far_m = 50.0; shadow_pixels = 512;\n"
	"model_scale = 0.01; emission_scale = 3.5; double_sided = true;\n";

struct fault {
	const char *find, *replace, *mark, *key, *message;
	unsigned errors; /* 0: a warning only */
};

/* Of the environment above, to be replaced. */
#define PICTURE "kind = \"image\"; file = \"sky.exr\"; scale = 2.0; heading_deg = 30.0; upper_only = true"

static const struct fault faults[] = {
	{ "model = \"models/room.gltf\"", "modell = \"x\"", "modell", "modell",
	  "did you mean \"model\"?", 2 },
	{ "cone_deg = 80.0", "cone = 80.0", "cone =", "lamps[0].cone", "did you mean \"cone_deg\"?", 1 },
	{ "lattice = 24", "lattice = 24; lattices = 2", "lattices", "gi.lpv.lattices",
	  "did you mean \"lattice\"?", 1 },
	{ "model = \"models/room.gltf\"", "model = 7", "model = 7", "model",
	  "expected a string \"...\", found a whole number", 1 },
	{ "lattice = 24", "lattice = 24.5", "lattice = 24.5", "gi.lpv.lattice",
	  "expected a whole number, found a number with a fraction", 1 },
	{ "on = false", "on = \"no\"", "on = \"no", "lamps[1].on",
	  "expected true or false, found a string \"no\"", 1 },
	{ "tone = { curve = \"linear\"; exposure = 0.5; ambient = \"dark\"; gamma_display = 2.5; }",
	  "tone = ( )", "tone =", "tone", "expected a group { }, found a list ( )", 1 },
	{ "intensity = [10.0, 9.0, 8.0]", "intensity = 10.0", "intensity = 10.0", "lamps[0].intensity",
	  "expected 3 numbers [ ], found a number with a fraction", 1 },
	{ "intensity = [10.0, 9.0, 8.0]", "intensity = [10.0, 9.0, -8.0]", "intensity = [10.0",
	  "lamps[0].intensity", "-8 is outside 0 to 1000000000 W/sr", 1 },
	{ "intensity = [10.0, 9.0, 8.0]", "intensity = [10.0, 9.0, 1e400]", "intensity = [10.0",
	  "lamps[0].intensity", "is not a finite number", 1 },
	{ "method = \"lpv\";", "method = \"lpv\"; share = \"cluster\";", "gi =", "gi.share",
	  "a lattice is not shared out", 1 },
	{ "method = \"lpv\"", "method = \"surfels\"", "medium =", "medium.scattering_per_m",
	  "surfels and probes carry no light that the air scatters", 1 },
	{ "kind = \"mirror\"; reflectance = [0.9, 0.8, 0.7];", "kind = \"mirror\";", "materials =",
	  "materials[0].reflectance", "is a good mirror", 1 },
	{ "material = \"back\"", "material = \"tall box\"", "{ material = \"tall box\"; kind = \"conductor",
	  "materials[1].material", "is there twice", 1 },
	{ "roughness = 0.3; ", "", "{ material = \"back\"", "materials[1].roughness", "missing", 1 },
	{ "specular = [0.1, 0.1, 0.1];", "specular = [0.6, 0.1, 0.1];", "{ material = \"wood\"",
	  "materials[2].specular", "at most 1 comes back", 1 },
	{ "file = \"paint.brdf\";", "", "{ material = \"paint\"", "materials[3].file", "missing", 1 },
	{ "file = \"sky.exr\";", "", "environment =", "environment.file", "missing", 1 },
	{ "kind = \"image\"; file = \"sky.exr\"", "radiance = [1.0, 1.0, 1.0]; kind = \"image\"; file = \"sky.exr\"",
	  "environment =", "environment.radiance", "not used", 0 },
	{ "lattice = 24", "lattice = 129", "lattice = 129", "gi.lpv.lattice",
	  "129 is outside 8 to 128 cells", 1 },
	{ "mode = \"thesis\"", "mode = \"theses\"", "mode =", "gi.lpv.mode",
	  "\"theses\" is not known, did you mean \"thesis\"?; one of \"repaired\", \"thesis\"", 1 },
	{ "kind = \"point\"", "kind = \"laser\"", "kind = \"laser", "lamps[1].kind",
	  "\"laser\" is not known; one of \"spot\", \"point\", \"directional\"", 1 },
	{ "	  intensity = [10.0, 9.0, 8.0];\n", "", "{ name = \"spot\"", "lamps[0].intensity",
	  "missing; it is radiant intensity", 1 },
	{ "direction = [0.0, -3.0, 4.0]", "direction = [0.0, 0.0, 0.0]", "direction = [0.0, 0.0",
	  "lamps[0].direction", "has no length; a lamp that shines down has", 1 },
	{ " direction = [0.0, -3.0, 4.0];", "", "{ name = \"spot\"", "lamps[0].direction",
	  "missing; say where the light of a spot lamp goes", 1 },
	{ "position = [0.0, 2.0, 0.0];", "", "{ name = \"spot\"", "lamps[0].position",
	  "missing; say where the lamp is", 1 },
	{ "penumbra_deg = 10.0", "penumbra_deg = 41.0", "penumbra_deg", "lamps[0].penumbra_deg",
	  "41 is wider than half the cone of 80", 1 },
	{ "orbit_period_s = -7.5", "orbit_period_s = 0.0", "orbit_period_s", "lamps[4].orbit_period_s",
	  "0 s; a turn takes at least 0.1 s", 1 },
	{ "name = \"bulb\"", "name = \"spot\"", "name = \"spot\"; kind = \"point\"", "lamps[1].name",
	  "lamp \"spot\" is there twice", 1 },
	{ "name = \"bulb\"", "name = \"the bulb\"", "name = \"the", "lamps[1].name",
	  "cannot be a name", 1 },
	{ "target = [0.0, 1.2, 0.0]", "target = [0.0, 1.6, 3.0]", "target", "cameras[0].target",
	  "is where the camera stands", 1 },
	{ "vfov_deg = 45.0", "up = [0.0, 0.0, 0.0]", "up =", "cameras[0].up", "has no length", 1 },
	{ "vfov_deg = 45.0", "up = [0.0, 0.8, 6.0]", "up =", "cameras[0].up",
	  "the camera looks along it", 1 },
	{ "vfov_deg = 45.0", "vfov_deg = 180.0", "vfov_deg", "cameras[0].vfov_deg",
	  "180 is outside 1 to 170 deg", 1 },
	{ "ambient = \"dark\"", "ambient = \"dark\"; gamma_end_to_end = 1.3", "gamma_end",
	  "tone.gamma_end_to_end", "given beside ambient; keep one of the two", 1 },
	{ "far_m = 50.0", "far_m = 0.1", "far_m", "far_m", "0.1 m is not beyond near_m, 0.1 m", 1 },
	{ "on = false", "cone_deg = 20.0", "cone_deg = 20", "lamps[1].cone_deg",
	  "not used: only a spot has a cone", 0 },
	{ "on = false", "orbit_radius_m = 2.0", "orbit_radius_m = 2", "lamps[1].orbit_radius_m",
	  "not used: only for mount = \"orbit\"", 0 },
	{ "orbit_radius_m = 0.7", "position = [0.0, 0.0, 0.0]", "position = [0.0, 0.0",
	  "lamps[4].position", "not used: an orbit is given by its center and radius", 0 },
	{ PICTURE, "kind = \"sky\"; place = [48.0, 11.0]",
	  "environment =",
	  "environment.time", "missing; the sun is given by place and time, or by angles", 1 },
	{ PICTURE, "kind = \"sky\"; place = [48.0, 11.0]; time = \"2026-06-21T12:00Z\"; "
	  "sun_azimuth_deg = 3.0; sun = false",
	  "place",
	  "environment.place", "the sun is given by angles and by place and time", 1 },
	{ PICTURE, "kind = \"sky\"; place = [48.0, 11.0]; time = \"noon\"; sun = false",
	  "time",
	  "environment.time", "\"noon\" is no time from 1900 to 2100; write \"2026-06-21T14:30+02:00\", or Z for UTC", 1 },
	{ PICTURE, "kind = \"sky\"; turbidity = 1.0; sun = false",
	  "turbidity",
	  "environment.turbidity", "1 is outside 1.7 to 10", 1 },
	{ PICTURE, "kind = \"sky\"",
	  "name = \"sun\"",
	  "lamps[2].name", "\"sun\" is the lamp of the sky; give this one another name, or say environment.sun = false", 1 },
	{ PICTURE, "kind = \"constant\"; turbidity = 3.0",
	  "turbidity",
	  "environment.turbidity", "not used: only for kind = \"sky\"", 0 },
	{ PICTURE, "kind = \"image\"; file = \"sky.hdr\"; projection = \"faces\"",
	  "projection",
	  "environment.file", "\"sky.hdr\" has not one *, which stands for px, nx, py, ny, pz and nz", 1 },
	{ PICTURE, "kind = \"sky\"; sun = false; projection = \"cross\"",
	  "projection",
	  "environment.projection", "not used: only kind = \"image\" has a picture", 0 },
	{ "exposure = 0.5", "bias = 0.95", "bias", "tone.bias", "0.95 is outside 0.5 to 0.9", 1 },
	{ "exposure = 0.5", "srgb = true", "ambient", "tone.ambient",
	  "not used: srgb = true encodes with its own curve", 0 },
};

static int parse(const char *text, struct scene_file **out, struct gr_diag *diag)
{
	size_t len = strlen(text);
	char *copy = (char *)unit_copy(text, len);
	int result = scene_file_parse(copy, len, "dir/t.scene", out, diag);

	free(copy);
	return result;
}

static void test_values(void **state)
{
	struct gr_diag diag = { 0 };
	struct scene_file *file;
	vec3 front;
	char *path;

	(void)state;
	if (parse(base, &file, &diag) != GR_OK || diag.count) {
		unit_diag_print(&diag);
		fail();
	}
	assert_int_equal(file->lamp_count, 5);
	assert_int_equal(file->lamps[0].kind, SCENE_LAMP_SPOT);
	assert_float_equal(file->lamps[0].direction[1], -0.6, 1e-7);
	assert_float_equal(file->lamps[0].direction[2], 0.8, 1e-7);
	assert_float_equal(file->lamps[0].cone_rad, 1.3962634, 1e-6);
	assert_float_equal(file->lamps[0].penumbra_rad, 0.17453293, 1e-7);
	assert_true(file->lamps[0].on);
	assert_false(file->lamps[1].on);
	assert_int_equal(file->lamps[1].line, 8);
	assert_float_equal(file->lamps[1].position[1], 2.5, 0);
	assert_int_equal(file->lamps[3].mount, SCENE_MOUNT_WAND);
	assert_float_equal(file->lamps[3].direction[2], -1, 0);
	assert_float_equal(file->lamps[4].orbit_period_s, -7.5, 0);
	assert_int_equal(scene_file_find_camera(file, "door"), 0);
	assert_int_equal(scene_file_find_camera(file, "window"), -1);
	assert_int_equal(file->gi.lpv_mode, SCENE_LPV_THESIS);
	assert_int_equal(file->gi.link_rays, 77);
	/* Thesis, example after table 3.1: dark, display 2.5 gives an exponent of 0.6. */
	assert_float_equal(scene_tone_gamma_encode(&file->tone), 0.6, 1e-6);
	/* Heading 90: the CAVE's front looks to -X of the scene. */
	gr_pose_direction(&file->room, (vec3){ 0, 0, -1 }, front);
	assert_float_equal(front[0], -1, 1e-6);
	path = scene_file_model_path(file);
	assert_string_equal(path, "dir/models/room.gltf");
	free(path);
	scene_file_destroy(&file);
	assert_null(file);
	gr_diag_finish(&diag);
}

/* The least file, and thesis table 3.1. */
static void test_defaults(void **state)
{
	static const struct {
		const char *text;
		float end_to_end;
	} table[] = {
		{ "model = \"m.obj\";", 1.25f },
		{ "model = \"m.obj\"; tone = { ambient = \"dark\"; };", 1.5f },
		{ "model = \"m.obj\"; tone = { ambient = \"dim\"; };", 1.25f },
		{ "model = \"m.obj\"; tone = { ambient = \"light\"; };", 1.125f },
		{ "model = \"m.obj\"; tone = { gamma_end_to_end = 1.0; };", 1.0f },
	};

	(void)state;
	for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
		struct gr_diag diag = { 0 };
		struct scene_file *file;

		assert_int_equal(parse(table[i].text, &file, &diag), GR_OK);
		assert_int_equal(diag.count, 0);
		assert_float_equal(file->tone.gamma_end_to_end, table[i].end_to_end, 0);
		assert_float_equal(file->tone.gamma_display, 2.2, 1e-6);
		assert_int_equal(file->gi.method, SCENE_GI_AUTO);
		assert_int_equal(file->gi.lattice, 32);
		assert_float_equal(file->gi.albedo_override[0], -1, 0);
		assert_float_equal(file->room.q[3], 1, 0);
		assert_int_equal(file->lamp_count + file->camera_count, 0);
		scene_file_destroy(&file);
	}
}

static unsigned check_fault(const struct fault *fault)
{
	char *text = unit_replace(base, fault->find, fault->replace);
	enum gr_severity severity = fault->errors ? GR_DIAG_ERROR : GR_DIAG_WARNING;
	struct gr_diag diag = { 0 };
	struct scene_file *file = (struct scene_file *)&diag;
	char start[256];
	int result = parse(text, &file, &diag);
	unsigned bad = 0;

	snprintf(start, sizeof start, "dir/t.scene:%d: %s: ", unit_line(text, fault->mark), fault->key);
	if (!unit_diag_has(&diag, severity, start, fault->message) || diag.errors != fault->errors ||
	    result != (fault->errors ? GR_ERR_CONFIG : GR_OK) || !file != !!fault->errors) {
		printf("# wanted %s...%s... and %u errors, result %d\n", start, fault->message,
		       fault->errors, result);
		unit_diag_print(&diag);
		bad = 1;
	}
	scene_file_destroy(&file);
	gr_diag_finish(&diag);
	free(text);
	return bad;
}

static void test_faults(void **state)
{
	unsigned bad = 0;

	(void)state;
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
		bad += check_fault(&faults[i]);
	assert_int_equal(bad, 0);
	printf("# %zu kinds of fault, each with its line\n", sizeof faults / sizeof *faults);
}

static void test_too_many(void **state)
{
	char *text = calloc(1, 100000);
	size_t len = (size_t)sprintf(text, "model = \"m.obj\";\nlamps = (");
	struct gr_diag diag = { 0 };
	struct scene_file *file;

	(void)state;
	for (int i = 0; i < SCENE_MAX_LAMPS + 1; i++)
		len += (size_t)sprintf(text + len,
				       "%s{ name = \"l%d\"; kind = \"point\"; position = [0.0, 0.0, 0.0]; "
				       "intensity = [1.0, 1.0, 1.0]; }",
				       i ? "," : "", i);
	sprintf(text + len, ");\n");
	assert_int_equal(parse(text, &file, &diag), GR_ERR_CONFIG);
	assert_int_equal(diag.errors, 1);
	assert_true(unit_diag_has(&diag, GR_DIAG_ERROR, "dir/t.scene:2: lamps: ", "17 entries; at most 16"));
	gr_diag_finish(&diag);
	free(text);
}

static void check_round_trip(const char *text)
{
	char *first = NULL, *second = NULL;
	size_t size;
	FILE *out = open_memstream(&first, &size);
	struct gr_diag diag = { 0 };
	struct scene_file *file, *again;

	assert_int_equal(parse(text, &file, &diag), GR_OK);
	assert_int_equal(scene_file_write(out, file), GR_OK);
	fclose(out);
	gr_diag_finish(&diag);
	if (parse(first, &again, &diag) != GR_OK || diag.warnings) { /* where the sun stands is a note */
		unit_diag_print(&diag);
		fail_msg("%s", first);
	}
	gr_diag_finish(&diag);
	assert_memory_equal(again->hash, file->hash, sizeof file->hash);
	out = open_memstream(&second, &size);
	assert_int_equal(scene_file_write(out, again), GR_OK);
	fclose(out);
	assert_string_equal(first, second);
	scene_file_destroy(&file);
	scene_file_destroy(&again);
	free(first);
	free(second);
}

static void test_round_trip(void **state)
{
	char *text;

	(void)state;
	check_round_trip(base);
	check_round_trip("model = \"m.obj\";");
	check_round_trip("model = \"m.obj\"; environment = { kind = \"sky\"; turbidity = 2.2; sun_azimuth_deg = 17.3; "
			 "sun_elevation_deg = 33.3; heading_deg = -12.5; };");
	check_round_trip("model = \"m.obj\"; environment = { kind = \"sky\"; place = [-33.9, 151.2]; sun = false; "
			 "time = \"2026-06-21T11:00+10:00\"; };");
	check_round_trip("model = \"m.obj\"; environment = { kind = \"image\"; file = \"a*b\"; "
			 "projection = \"faces\"; scale = 0.262; };");
	/* With what is given and not used: warned about, gone afterwards. */
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
		if (!faults[i].errors) {
			text = unit_replace(base, faults[i].find, faults[i].replace);
			check_round_trip(text);
			free(text);
		}
}

/* Directions of any length come back to the same bits. */
static void test_direction_sweep(void **state)
{
	struct unit_random r = unit_random_start("lamp directions");

	(void)state;
	for (int n = 0; n < 500; n++) {
		char direction[200], *text;

		sprintf(direction, "direction = [%.6f, %.6f, %.6f]", unit_random_range(&r, -9, 9),
			unit_random_range(&r, 0.1, 9), unit_random_range(&r, -9, 9));
		text = unit_replace(base, "direction = [0.0, -3.0, 4.0]", direction);
		check_round_trip(text);
		free(text);
	}
}

static void test_hash(void **state)
{
	static const struct {
		const char *find, *replace;
		const char *first; /* the part that differs, NULL: none does */
	} cases[] = {
		{ "name = \"room\"", "name = \"other\"", NULL },
		{ "models/room.gltf", "models/copy.gltf", NULL },
		{ "vfov_deg = 45.0", "vfov_deg = 46.0", NULL },
		{ "intensity = [1, 2, 3]", "intensity = (1, 2.0, 3)", NULL },
		{ "intensity = [1, 2, 3]", "intensity = [1, 2, 4]", "lamps" },
		{ "direction = [0.0, -3.0, 4.0]", "direction = [0.0, -0.6, 0.8]", NULL },
		{ "on = false", "on = true", "lamps" },
		{ "cone_deg = 80.0", "cone_deg = 81.0", "lamps" },
		{ "orbit_radius_m = 0.7", "orbit_radius_m = 0.8", "lamps" },
		{ "lattice = 24", "lattice = 25", "gi" },
		{ "ambient = \"dark\"", "ambient = \"dim\"", "tone" },
		{ "ambient = \"dark\"", "gamma_end_to_end = 1.5", NULL },
		{ "heading_deg = 90.0", "heading_deg = 91.0", "room" },
		{ "emission_scale = 3.5", "emission_scale = 3.6", "emission_scale" },
		{ "double_sided = true", "double_sided = false", "double_sided" },
	};
	struct gr_diag diag = { 0 };
	struct gr_item items[2][SCENE_FILE_ITEMS_MAX];
	struct scene_file *file, *other;
	uint8_t hash[32];
	size_t count, k;

	(void)state;
	assert_int_equal(parse(base, &file, &diag), GR_OK);
	count = scene_file_items(file, items[0], SCENE_FILE_ITEMS_MAX, hash);
	assert_true(count <= SCENE_FILE_ITEMS_MAX);
	assert_memory_equal(hash, file->hash, sizeof hash);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char *text = unit_replace(base, cases[i].find, cases[i].replace);

		assert_int_equal(parse(text, &other, &diag), GR_OK);
		if (!cases[i].first != !memcmp(file->hash, other->hash, 32))
			fail_msg("\"%s\" for \"%s\"", cases[i].replace, cases[i].find);
		assert_int_equal(scene_file_items(other, items[1], SCENE_FILE_ITEMS_MAX, hash), count);
		for (k = 0; k < count && !memcmp(items[0][k].digest, items[1][k].digest, GR_ITEM_DIGEST); k++)
			;
		assert_string_equal(k < count ? items[0][k].name : "", cases[i].first ? cases[i].first : "");
		scene_file_destroy(&other);
		free(text);
	}
	scene_file_destroy(&file);
	gr_diag_finish(&diag);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_values),	   cmocka_unit_test(test_defaults),
		cmocka_unit_test(test_faults),	   cmocka_unit_test(test_too_many),
		cmocka_unit_test(test_round_trip), cmocka_unit_test(test_direction_sweep),
		cmocka_unit_test(test_hash),
	};

	return cmocka_run_group_tests_name("scene file", tests, NULL, NULL);
}
