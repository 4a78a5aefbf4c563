#include "renderer/gl/program.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/shader_text.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#define LOG_SIZE 16384

/* One log line per line of the driver's log. */
static void log_lines(enum gr_log_level level, const char *text)
{
	while (*text) {
		size_t len = strcspn(text, "\n");

		if (len)
			gr_log(level, "  %.*s", (int)len, text);
		text += len;
		if (*text)
			text++;
	}
}

static void log_compile(const struct shader_text *text, GLuint shader, bool failed)
{
	enum gr_log_level level = failed ? GR_LOG_ERROR : GR_LOG_DEBUG;
	char *log = calloc(1, LOG_SIZE);
	char *named = NULL;

	if (log) {
		glGetShaderInfoLog(shader, LOG_SIZE, NULL, log);
		named = shader_text_name_log(text, log);
	}
	if (failed)
		gr_error("shader %s does not compile:", text->names[0]);
	else if (log && log[0])
		gr_debug("shader %s:", text->names[0]);
	if (log)
		log_lines(level, named ? named : log);
	free(named);
	free(log);
}

static int compile(GLuint *out, GLenum stage, const char *name, const char *defines)
{
	struct shader_text text;
	GLint good = GL_FALSE;
	GLuint shader;
	int result = shader_text_init(&text, name, defines);

	*out = 0;
	if (result != GR_OK)
		return result == GR_ERR_NOMEM ? result : GR_ERR_GL;
	shader = glCreateShader(stage);
	if (shader) {
		const GLchar *source = text.text;
		glShaderSource(shader, 1, &source, NULL);
		glCompileShader(shader);
		glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
		log_compile(&text, shader, !good);
	} else {
		gr_error("shader %s: glCreateShader gave nothing", name);
	}
	shader_text_finish(&text);
	if (!good) {
		glDeleteShader(shader);
		return GR_ERR_GL;
	}
	*out = shader;
	return GR_OK;
}

struct stage {
	GLenum kind;
	const char *name; /* NULL: not there */
};

static int link_stages(unsigned *out_program, const struct stage *stages, size_t count,
		       const char *defines)
{
	GLuint program = glCreateProgram();
	GLint good = GL_FALSE;
	int result = program ? GR_OK : GR_ERR_GL;

	*out_program = 0;
	for (size_t i = 0; i < count && result == GR_OK; i++) {
		GLuint shader;

		if (!stages[i].name)
			continue;
		result = compile(&shader, stages[i].kind, stages[i].name, defines);
		if (result == GR_OK) {
			glAttachShader(program, shader);
			glDeleteShader(shader); /* goes with the program */
		}
	}
	if (result != GR_OK) {
		glDeleteProgram(program);
		return result;
	}
	glLinkProgram(program);
	glGetProgramiv(program, GL_LINK_STATUS, &good);
	if (!good) {
		char *log = calloc(1, LOG_SIZE);

		gr_error("program of %s does not link:", stages[0].name);
		if (log) {
			glGetProgramInfoLog(program, LOG_SIZE, NULL, log);
			log_lines(GR_LOG_ERROR, log);
			free(log);
		}
		glDeleteProgram(program);
		return GR_ERR_GL;
	}
	glObjectLabel(GL_PROGRAM, program, -1, stages[count - 1].name ? stages[count - 1].name
								      : stages[0].name);
	*out_program = program;
	return GR_OK;
}

int program_create_graphics(unsigned *out_program, const char *vertex, const char *geometry,
			    const char *fragment, const char *defines)
{
	const struct stage stages[] = {
		{ GL_VERTEX_SHADER, vertex },
		{ GL_GEOMETRY_SHADER, geometry },
		{ GL_FRAGMENT_SHADER, fragment },
	};

	return link_stages(out_program, stages, 3, defines);
}

int program_create_compute(unsigned *out_program, const char *compute, const char *defines)
{
	const struct stage stages[] = { { GL_COMPUTE_SHADER, compute } };

	return link_stages(out_program, stages, 1, defines);
}

void program_destroy(unsigned *program)
{
	if (*program)
		glDeleteProgram(*program);
	*program = 0;
}
