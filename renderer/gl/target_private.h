/* What target.c and its two backends share. */
#ifndef GROTTO_RENDERER_GL_TARGET_PRIVATE_H
#define GROTTO_RENDERER_GL_TARGET_PRIVATE_H

#include "renderer/gl/target.h"

#define TARGET_GL_MAJOR 4
#define TARGET_GL_MINOR 5

struct target_ops {
	/* Makes an OpenGL 4.5 core context current and sets backend, size and platform. */
	int (*open)(struct target *target, const struct target_params *params);
	bool (*swap)(struct target *target);
	bool (*poll)(struct target *target); /* NULL: nobody can say anything */
	/* NULL: there is no window. */
	void (*input)(const struct target *target, struct target_input *out);
	void (*close)(struct target *target); /* also after a failed open */
	bool offscreen;                       /* draws into framebuffers of its own */
};

struct GLFWwindow;
/* target_input.c: of a window, once; and what is down in it. */
void target_input_watch(struct GLFWwindow *window);
void target_input_read(struct GLFWwindow *window, double wheel, struct target_input *out);

extern const struct target_ops target_egl_ops;
extern const struct target_ops target_glfw_ops;

struct target {
	const struct target_ops *ops;
	void *backend;
	int width, height;
	bool quad_buffer;
	enum target_depth depth;
	int bits;
	unsigned framebuffer[2], color[2]; /* offscreen */
	char platform[96];
	char renderer[160];
};

/*
 * With a context current: GR_OK when it is OpenGL 4.5 core or later, else
 * GR_ERR_UNSUPPORTED after one log line that says what was found on `where`.
 */
int target_check_version(const char *where);

#endif
