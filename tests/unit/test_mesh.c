/* A scene on the GPU, and the time that drawing takes. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/mesh.h"
#include "renderer/gl/program.h"
#include "renderer/gl/shaders.h"
#include "renderer/gl/timer.h"
#include "tests/unit/gl.h"

#include <epoxy/gl.h>

#define SIDE 32

/* In place of the library's shaders, but for the material block, which is copied below. */
const struct shader_file shader_files[] = {
	{ "mesh.vert", "#version 450 core\nlayout(location = 0) in vec3 position;\n"
		       "layout(location = 1) in vec3 normal;\nlayout(location = 2) in vec2 uv;\n"
		       "out vec2 at;\nout vec3 facing;\nvoid main()\n{\n\tat = uv;\n\tfacing = normal;\n"
		       "\tgl_Position = vec4(position, 1.0);\n}\n" },
	{ "mesh.frag", "#version 450 core\n"
		       "struct Material { vec4 diffuse, specular, emission; uvec4 flags; };\n"
		       "layout(std430, binding = 0) readonly buffer M { Material materials[]; };\n"
		       "layout(location = 0) uniform int material_index;\n"
		       "layout(binding = 0) uniform sampler2D diffuse_image;\n"
		       "layout(binding = 1) uniform sampler2D emission_image;\n"
		       "in vec2 at;\nin vec3 facing;\nlayout(location = 0) out vec4 color;\n"
		       "void main()\n{\n\tMaterial m = materials[material_index];\n"
		       "\tcolor = vec4(m.diffuse.rgb * texture(diffuse_image, at).rgb * facing.z\n"
		       "\t\t+ m.emission.rgb * texture(emission_image, at).rgb, float(m.flags.x));\n}\n" },
	{ NULL, NULL },
};

/* Left half: one-sided, textured; right half: two-sided, plain, emits. */
static struct scene_vertex vertices[] = {
	{ { -1, -1, 0 }, { 0, 0, 1 }, { 0, 1 } }, { { 0, -1, 0 }, { 0, 0, 1 }, { 1, 1 } },
	{ { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0 } },   { { -1, 1, 0 }, { 0, 0, 1 }, { 0, 0 } },
	{ { 0, -1, 0 }, { 0, 0, 1 }, { 0, 1 } },  { { 1, -1, 0 }, { 0, 0, 1 }, { 1, 1 } },
	{ { 1, 1, 0 }, { 0, 0, 1 }, { 1, 0 } },   { { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0 } },
};
static uint32_t indices[] = { 0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7 };
static struct scene_draw draws[] = { { 0, 6, 0 }, { 6, 6, 1 } };
static struct scene_material materials[] = {
	{ .diffuse = { 1, 1, 1 }, .diffuse_image = 0, .emission_image = -1 },
	{ .diffuse = { 0.2f, 0.4f, 0 }, .emission = { 0, 0, 0.6f }, .diffuse_image = -1,
	  .emission_image = -1, .two_sided = true },
};
static char image_name[] = "half grey";
static uint8_t texels[] = { 188, 188, 188, 255 }; /* sRGB for 0.503 */
static struct scene_image images[] = { { image_name, 1, 1, true, texels } };
static const struct scene scene = {
	.vertices = vertices, .vertex_count = 8, .indices = indices, .index_count = 12,
	.draws = draws, .draw_count = 2, .materials = materials, .material_count = 2,
	.images = images, .image_count = 1,
};

static void read_pixel(int x, uint8_t out[4])
{
	glPixelStorei(GL_PACK_ALIGNMENT, 1);
	glReadPixels(x, SIDE / 2, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, out);
}

static void test_draw(void **state)
{
	struct target *target = gl_target_or_skip(SIDE, SIDE);
	struct gl_mesh *mesh;
	unsigned program;
	uint8_t left[4], right[4];

	(void)state;
	assert_int_equal(gl_mesh_create(&mesh, &scene), GR_OK);
	assert_int_equal(program_create_graphics(&program, "mesh.vert", NULL, "mesh.frag", NULL),
			 GR_OK);
	for (int what = GL_MESH_ALL; what <= GL_MESH_TWO_SIDED; what++) {
		target_bind(target, 0, false);
		target_bind(target, 0, true);
		glViewport(0, 0, SIDE, SIDE);
		glClearColor(1, 0, 1, 0.5f);
		glClear(GL_COLOR_BUFFER_BIT);
		glUseProgram(program);
		gl_mesh_draw(mesh, (enum gl_mesh_what)what);
		read_pixel(4, left);
		read_pixel(SIDE - 4, right);
		if (what == GL_MESH_TWO_SIDED) {
			assert_int_equal(left[1], 0); /* not drawn */
		} else {
			assert_in_range(left[0], 127, 129); /* the texture was decoded to linear */
			assert_int_equal(left[3], 0);
		}
		if (what == GL_MESH_ONE_SIDED) {
			assert_int_equal(right[1], 0);
		} else {
			assert_int_equal(right[0], 51);
			assert_int_equal(right[1], 102);
			assert_int_equal(right[2], 153);
			assert_int_equal(right[3], 255);
		}
		gl_mesh_draw_depth(mesh, (enum gl_mesh_what)what);
	}
	assert_int_equal(glGetError(), GL_NO_ERROR);
	program_destroy(&program);
	gl_mesh_destroy(&mesh);
	assert_null(mesh);
	target_destroy(&target);
}

static void test_timers(void **state)
{
	struct target *target = gl_target_or_skip(256, 256);
	struct timer_stats stats;
	struct timers *timers;

	(void)state;
	assert_int_equal(timers_create(&timers), GR_OK);
	timers_stats(timers, 3, &stats);
	assert_null(stats.name);
	for (int frame = 0; frame < 20; frame++) {
		target_bind(target, 0, false);
		for (int eye = 0; eye < TIMER_SPANS + 2; eye++) { /* two more than are measured */
			timers_begin(timers, 3, "clear");
			glClear(GL_COLOR_BUFFER_BIT);
			timers_end(timers, 3);
		}
		timers_end(timers, 5); /* never begun */
		timers_begin(timers, 99, "no such stage");
		timers_frame(timers);
		if (frame % 4 == 0)
			glFinish();
	}
	glFinish();
	timers_frame(timers);
	timers_stats(timers, 3, &stats);
	printf("# clear: %llu frames, mean %.4f ms, %.4f to %.4f\n",
	       (unsigned long long)stats.count, stats.mean_ms, stats.min_ms, stats.max_ms);
	assert_string_equal(stats.name, "clear");
	assert_in_range(stats.count, 1, 20);
	assert_true(stats.min_ms >= 0 && stats.min_ms <= stats.mean_ms);
	assert_true(stats.mean_ms <= stats.max_ms);
	timers_stats(timers, 5, &stats);
	assert_int_equal(stats.count, 0);
	timers_stats(timers, -1, &stats);
	assert_null(stats.name);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	timers_destroy(&timers);
	target_destroy(&target);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_draw),
		cmocka_unit_test(test_timers),
	};

	gr_log_init("test_mesh", GR_LOG_INFO);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
