/*
 * The text that the driver gets: a root file with its #include lines replaced,
 * each file once, #line directives that carry a file number, and `defines`
 * right after #version. Pure: no GL.
 */
#ifndef GROTTO_RENDERER_GL_SHADER_TEXT_H
#define GROTTO_RENDERER_GL_SHADER_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#define SHADER_TEXT_FILES 32

struct shader_text {
	char *text; /* NUL terminated */
	size_t len, size;
	const char *names[SHADER_TEXT_FILES]; /* by the number in #line */
	int files;
};

/*
 * `#include "x.glsl"` takes that file; `#include WORD` takes the one that
 * `defines` gives WORD ("#define WORD "x.glsl"\n"), so that a pass can be built
 * with one of several methods. GR_OK; GR_ERR_FORMAT with a log line that says
 * which file and line; GR_ERR_NOMEM.
 */
int shader_text_init(struct shader_text *out, const char *root, const char *defines);
void shader_text_finish(struct shader_text *text);
/*
 * Copies a driver's log with file numbers turned into names where a line
 * starts with one: "1:12(3): error" and "1(12) : error". Caller frees.
 */
char *shader_text_name_log(const struct shader_text *text, const char *log);

#endif
