/*
 * Where a node draws: an EGL context without a display, or a GLFW window.
 * One context per process, current on the thread that created it; all GL
 * work happens on that thread.
 */
#ifndef GROTTO_RENDERER_GL_TARGET_H
#define GROTTO_RENDERER_GL_TARGET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum target_kind { TARGET_HEADLESS, TARGET_WINDOW, TARGET_FULLSCREEN };

/* Of a band of the final picture. */
enum target_depth { TARGET_DEPTH_8, TARGET_DEPTH_10, TARGET_DEPTH_FLOAT };

struct target_params {
	enum target_kind kind;
	const char *title;
	const char *display; /* X display, NULL for the environment's; is put into the environment */
	int width, height;   /* of the whole surface, both eyes of side-by-side included */
	int gpu;             /* EGL device index, -1: the first that gives GL 4.5 */
	int monitor;
	bool quad_buffer; /* ask for a stereo visual; refused when there is none */
	enum target_depth depth; /* RGBA8, RGB10_A2, RGBA16F; the last only headless. A window may have less: target_bits */
	bool debug;       /* KHR_debug messages go to the log */
};

struct target;
/*
 * OpenGL 4.5 core or GR_ERR_UNSUPPORTED, with what was found in the log.
 * GR_ERR_RANGE for a GPU or monitor that is not there. Headless tries
 * EGL_EXT_platform_device, then EGL_MESA_platform_surfaceless; a GPU that is
 * named by number is not replaced by another.
 */
int target_create(struct target **out, const struct target_params *params);
void target_destroy(struct target **target);
/* Framebuffer to draw the final picture of an eye into: 0 in a window, an FBO of
 * the depth headless (readable after the frame). eye 1 differs only with quad_buffer. */
unsigned target_framebuffer(const struct target *target, int eye);
/*
 * Binds that framebuffer for drawing (or for reading), and in a quad-buffered
 * window chooses the eye's back buffer, which the framebuffer's name cannot say.
 */
void target_bind(const struct target *target, int eye, bool read);
/* Framebuffers or back buffers: 2 with quad_buffer. */
int target_eyes(const struct target *target);
/* Bits of a band: 8, 10, or 16 for float. */
int target_bits(const struct target *target);
void target_size(const struct target *target, int *width, int *height);
/* Shows what was drawn. Headless: nothing but GL_FLUSH. False when the window was closed. */
bool target_swap(struct target *target);
/*
 * From the next target_swap on the driver swaps with the windows of all machines
 * that have joined (NV_swap_group). GR_OK, or GR_ERR_UNSUPPORTED with the reason.
 */
int target_barrier_join(struct target *target, char *why, size_t size);
void target_barrier_leave(struct target *target);
/* Takes what the window system says while nothing is shown. False when the window was closed. */
bool target_poll(struct target *target);
/*
 * Keyboard and mouse, as target_swap or target_poll found them. Keys and mouse
 * buttons are buttons of the hand by their number (target_input.c).
 */
struct target_input {
	uint32_t buttons;
	float axes[2];    /* arrow keys: -1..1, right and up + */
	float pointer[2]; /* -1..1 across the window, right and up + */
	float wheel;      /* turned so far, notches, away from the person + */
};
/* False without a window: *out untouched. */
bool target_input(const struct target *target, struct target_input *out);
/* "llvmpipe (LLVM 15.0.6, 256 bits)", for log and summary. */
const char *target_renderer_name(const struct target *target);
const char *target_platform_name(const struct target *target);

#endif
