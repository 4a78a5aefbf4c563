/* The table that renderer/shaders/embed.awk writes; program.c alone reads it. */
#ifndef GROTTO_RENDERER_GL_SHADERS_H
#define GROTTO_RENDERER_GL_SHADERS_H

struct shader_file {
	const char *name; /* base name; NULL ends the table */
	const char *text;
};

extern const struct shader_file shader_files[];

#endif
