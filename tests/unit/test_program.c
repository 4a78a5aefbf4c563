/*
 * Shader text and programs. The test brings its own table of shader files in
 * place of the library's, which a static library allows.
 */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"
#include "renderer/gl/shader_text.h"
#include "renderer/gl/shaders.h"
#include "tests/unit/gl.h"

#include <epoxy/gl.h>

const struct shader_file shader_files[] = {
	{ "full.vert", "// a comment before the version\n#version 450 core\nvoid main()\n{\n"
		       "\tgl_Position = vec4(0.0);\n}\n" },
	{ "fill.comp", "#version 450 core\n#include \"common.glsl\"\n#include METHOD\n"
		       "layout(local_size_x = 1) in;\n"
		       "layout(std430, binding = 3) writeonly buffer Out { int value; };\n"
		       "void main()\n{\n\tvalue = method() + COUNT;\n}\n" },
	{ "common.glsl", "#include \"deep.glsl\"\nint common_value() { return deep(); }\n" },
	{ "deep.glsl", "#include \"common.glsl\"\nint deep() { return 40; }\n" },
	{ "one.glsl", "#include \"common.glsl\"\nint method() { return common_value() + 1; }\n" },
	{ "two.glsl", "int method() { return common_value() + 2; }\n" },
	{ "broken.glsl", "int fine() { return 1; }\nint wrong() { return missing; }\n" },
	{ "broken.comp", "#version 450 core\n#include \"common.glsl\"\n#include \"broken.glsl\"\n"
			 "layout(local_size_x = 1) in;\nvoid main() { wrong(); }\n" },
	{ "absent.comp", "#version 450 core\n#include \"nowhere.glsl\"\nvoid main() { }\n" },
	{ "word.comp", "#version 450 core\n#include UNSET\nvoid main() { }\n" },
	{ "unlinked.vert", "#version 450 core\nvoid other();\nvoid main() { other(); }\n" },
	{ NULL, NULL },
};

static void test_text(void **state)
{
	struct shader_text text;

	(void)state;
	assert_int_equal(shader_text_init(&text, "fill.comp",
					  "#define COUNT 7\n#define METHOD \"one.glsl\"\n"), GR_OK);
	assert_string_equal(text.text,
			    "#version 450 core\n"
			    "#define COUNT 7\n#define METHOD \"one.glsl\"\n"
			    "#line 2 0\n"
			    "#line 1 1\n#line 1 2\n#line 2 2\n" /* common, deep, common again */
			    "int deep() { return 40; }\n#line 2 1\n"
			    "int common_value() { return deep(); }\n#line 3 0\n"
			    "#line 1 3\n#line 2 3\nint method() { return common_value() + 1; }\n"
			    "#line 4 0\n"
			    "layout(local_size_x = 1) in;\n"
			    "layout(std430, binding = 3) writeonly buffer Out { int value; };\n"
			    "void main()\n{\n\tvalue = method() + COUNT;\n}\n");
	assert_int_equal(text.files, 4);
	assert_string_equal(text.names[3], "one.glsl");
	shader_text_finish(&text);
}

static void test_text_refused(void **state)
{
	static const char *const bad[] = { "absent.comp", "word.comp", "no such file", "" };
	struct shader_text text;

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
		assert_int_equal(shader_text_init(&text, bad[i], NULL), GR_ERR_FORMAT);
		assert_null(text.text);
	}
	/* A word is not found by its beginning. */
	assert_int_equal(shader_text_init(&text, "word.comp", "#define UNSETTLED \"one.glsl\"\n"),
			 GR_ERR_FORMAT);
	assert_non_null(shader_source("two.glsl"));
	assert_null(shader_source("three.glsl"));
}

static void test_log_names(void **state)
{
	struct shader_text text;
	char *log;

	(void)state;
	assert_int_equal(shader_text_init(&text, "broken.comp", NULL), GR_OK);
	log = shader_text_name_log(&text, "3:2(27): error: x\n0(4) : error C1\nERROR: 1:2: y\n"
					  "9:1: unknown file\n12 things\nno number");
	assert_string_equal(log, "broken.glsl:2(27): error: x\nbroken.comp(4) : error C1\n"
				 "ERROR: common.glsl:2: y\n9:1: unknown file\n12 things\nno number");
	free(log);
	shader_text_finish(&text);
}

static int run_fill(const char *method)
{
	char defines[128];
	GLuint buffer;
	unsigned program;
	int value = -1;

	snprintf(defines, sizeof defines, "#define COUNT 7\n#define METHOD \"%s\"\n", method);
	assert_int_equal(program_create_compute(&program, "fill.comp", defines), GR_OK);
	glCreateBuffers(1, &buffer);
	glNamedBufferStorage(buffer, sizeof value, &value, 0);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, buffer);
	glUseProgram(program);
	glDispatchCompute(1, 1, 1);
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glGetNamedBufferSubData(buffer, 0, sizeof value, &value);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	glDeleteBuffers(1, &buffer);
	program_destroy(&program);
	assert_int_equal(program, 0);
	return value;
}

static void test_programs(void **state)
{
	struct target *target = gl_target_or_skip(8, 8);
	unsigned program = 99;

	(void)state;
	assert_int_equal(run_fill("one.glsl"), 48);
	assert_int_equal(run_fill("two.glsl"), 49);
	assert_int_equal(program_create_graphics(&program, "full.vert", NULL, NULL, NULL), GR_OK);
	program_destroy(&program);
	printf("# the lines from here on are expected:\n");
	fflush(stdout);
	assert_int_equal(program_create_compute(&program, "broken.comp", NULL), GR_ERR_GL);
	assert_int_equal(program, 0);
	assert_int_equal(program_create_graphics(&program, "unlinked.vert", NULL, NULL, NULL),
			 GR_ERR_GL);
	assert_int_equal(program_create_compute(&program, "absent.comp", NULL), GR_ERR_GL);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	target_destroy(&target);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_text),
		cmocka_unit_test(test_text_refused),
		cmocka_unit_test(test_log_names),
		cmocka_unit_test(test_programs),
	};

	gr_log_init("test_program", GR_LOG_INFO);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
