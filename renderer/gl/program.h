/*
 * GLSL programs from the embedded shader files (renderer/shaders, built into
 * the library by shaders/embed.awk). "#include "name.glsl"" lines are resolved
 * from the same set; a compile failure logs the driver's words with file and
 * line. All uniforms have explicit locations or live in blocks.
 */
#ifndef GROTTO_RENDERER_GL_PROGRAM_H
#define GROTTO_RENDERER_GL_PROGRAM_H

/* Source text of an embedded file by its base name, or NULL. */
const char *shader_source(const char *name);

/*
 * In a shader file: `#include "name.glsl"`, or `#include WORD` where `defines`
 * has `#define WORD "name.glsl"`; a file is included once. Lines of the form
 * `// check: #define N 26` are the defines with which `make` compiles the file
 * offline (renderer/shaders/check.sh); at run time they are comments.
 *
 * Vertex + optional geometry + fragment shader; geometry may be NULL, fragment
 * NULL for depth only. `defines` is text put after #version ("#define N 26\n"),
 * or NULL. GR_OK with *out_program, or GR_ERR_GL.
 */
int program_create_graphics(unsigned *out_program, const char *vertex, const char *geometry,
			    const char *fragment, const char *defines);
int program_create_compute(unsigned *out_program, const char *compute, const char *defines);
void program_destroy(unsigned *program);

#endif
