/* A window or a whole monitor through GLFW. */
#include "renderer/gl/target_private.h"

#include "base/log.h"
#include "base/result.h"

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <stdio.h>
#include <stdlib.h>

struct glfw_backend {
	GLFWwindow *window;
	double wheel; /* notches so far */
	bool initialised;
};

static void glfw_says(int code, const char *text)
{
	gr_warning("glfw 0x%x: %s", (unsigned)code, text);
}

static void glfw_scrolled(GLFWwindow *window, double x, double y)
{
	struct glfw_backend *glfw = glfwGetWindowUserPointer(window);

	(void)x;
	glfw->wheel += y;
}

static int find_monitor(const struct target_params *params, GLFWmonitor **out)
{
	int count = 0;
	GLFWmonitor **monitors = glfwGetMonitors(&count);

	if (params->monitor < 0 || params->monitor >= count) {
		gr_error("monitor %d was asked for, this display has %d (numbered from 0)",
			 params->monitor, count);
		return GR_ERR_RANGE;
	}
	*out = monitors[params->monitor];
	return GR_OK;
}

static void set_hints(const struct target_params *params)
{
	glfwDefaultWindowHints();
	glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_API);
	glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, TARGET_GL_MAJOR);
	glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, TARGET_GL_MINOR);
	glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
	glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, params->debug);
	glfwWindowHint(GLFW_STEREO, params->quad_buffer);
	glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
	/* A wall must stay when another window takes the keyboard. */
	glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);
	glfwWindowHint(GLFW_FOCUS_ON_SHOW, GLFW_FALSE);
	if (params->depth == TARGET_DEPTH_10) {
		glfwWindowHint(GLFW_RED_BITS, 10);
		glfwWindowHint(GLFW_GREEN_BITS, 10);
		glfwWindowHint(GLFW_BLUE_BITS, 10);
		glfwWindowHint(GLFW_ALPHA_BITS, 2);
	}
	glfwWindowHint(GLFW_DEPTH_BITS, 0);
	glfwWindowHint(GLFW_STENCIL_BITS, 0);
}

/* What the window system can do when 4.5 core was refused, for the log. */
static void log_what_is_there(const struct target_params *params, const char *where)
{
	GLFWwindow *window;

	glfwDefaultWindowHints();
	glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
	window = glfwCreateWindow(16, 16, "grotto", NULL, NULL);
	if (!window) {
		gr_error("%s: no OpenGL at all", where);
		return;
	}
	glfwMakeContextCurrent(window);
	if (params->quad_buffer)
		gr_error("%s: no stereo visual with OpenGL %d.%d core for quad-buffered eyes; found %s, %s",
			 where, TARGET_GL_MAJOR, TARGET_GL_MINOR,
			 (const char *)glGetString(GL_VERSION),
			 (const char *)glGetString(GL_RENDERER));
	else
		gr_error("%s: OpenGL %d.%d core is needed, found %s on %s", where, TARGET_GL_MAJOR,
			 TARGET_GL_MINOR, (const char *)glGetString(GL_VERSION),
			 (const char *)glGetString(GL_RENDERER));
	glfwMakeContextCurrent(NULL);
	glfwDestroyWindow(window);
}

static int take_size(struct target *target, const struct target_params *params)
{
	GLFWwindow *window = ((struct glfw_backend *)target->backend)->window;

	glfwPollEvents();
	glfwGetFramebufferSize(window, &target->width, &target->height);
	if (target->width < 1 || target->height < 1) {
		gr_error("%s: the window has no pixels", target->platform);
		return GR_ERR_UNSUPPORTED;
	}
	if (target->width != params->width || target->height != params->height)
		gr_warning("%s: %d x %d pixels asked for, the window has %d x %d", target->platform,
			   params->width, params->height, target->width, target->height);
	return GR_OK;
}

/* What the window system gave, which need not be what was asked for. */
static void take_bits(struct target *target)
{
	GLint bits = 0;

	glGetNamedFramebufferAttachmentParameteriv(0, target->quad_buffer ? GL_BACK_LEFT : GL_BACK,
						   GL_FRAMEBUFFER_ATTACHMENT_RED_SIZE, &bits);
	target->bits = bits > 0 ? bits : 8;
	if (target->depth == TARGET_DEPTH_10 && target->bits < 10)
		gr_warning("%s: 10 bits a band asked for, the window has %d", target->platform,
			   target->bits);
}

static int check_stereo(const struct target *target)
{
	GLboolean stereo = GL_FALSE;

	if (!target->quad_buffer)
		return GR_OK;
	glGetBooleanv(GL_STEREO, &stereo);
	if (stereo)
		return GR_OK;
	gr_error("%s: the window has no right back buffer; quad-buffered eyes need a stereo visual",
		 target->platform);
	return GR_ERR_UNSUPPORTED;
}

static int open_window(struct target *target, const struct target_params *params)
{
	struct glfw_backend *glfw = target->backend;
	GLFWmonitor *monitor = NULL;
	const char *display = getenv("DISPLAY");
	int result;

	snprintf(target->platform, sizeof target->platform, "GLFW %s on %s",
		 params->kind == TARGET_FULLSCREEN ? "monitor" : "window",
		 display ? display : "the default display");
	if (params->kind == TARGET_FULLSCREEN) {
		result = find_monitor(params, &monitor);
		if (result != GR_OK)
			return result;
	}
	set_hints(params);
	glfw->window = glfwCreateWindow(params->width, params->height,
					params->title ? params->title : "grotto", monitor, NULL);
	if (!glfw->window) {
		log_what_is_there(params, target->platform);
		return GR_ERR_UNSUPPORTED;
	}
	glfwSetWindowUserPointer(glfw->window, glfw);
	glfwSetScrollCallback(glfw->window, glfw_scrolled);
	target_input_watch(glfw->window);
	if (monitor)
		glfwSetInputMode(glfw->window, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
	glfwMakeContextCurrent(glfw->window);
	/* The picture changes between two refreshes, never within one. */
	glfwSwapInterval(1);
	result = target_check_version(target->platform);
	if (result == GR_OK)
		result = check_stereo(target);
	if (result == GR_OK)
		result = take_size(target, params);
	if (result == GR_OK)
		take_bits(target);
	return result;
}

static int glfw_open(struct target *target, const struct target_params *params)
{
	struct glfw_backend *glfw = calloc(1, sizeof *glfw);

	if (!glfw)
		return GR_ERR_NOMEM;
	target->backend = glfw;
	/* GLFW asks the environment and has no other way to be told. */
	if (params->display && setenv("DISPLAY", params->display, 1) != 0)
		return GR_ERR_NOMEM;
	glfwSetErrorCallback(glfw_says);
	if (!glfwInit()) {
		const char *display = getenv("DISPLAY");

		gr_error("no window: GLFW cannot open display %s", display ? display : "(DISPLAY is not set)");
		return GR_ERR_UNSUPPORTED;
	}
	glfw->initialised = true;
	return open_window(target, params);
}

static bool glfw_poll(struct target *target)
{
	struct glfw_backend *glfw = target->backend;

	glfwPollEvents();
	return !glfwWindowShouldClose(glfw->window);
}

static void glfw_input(const struct target *target, struct target_input *out)
{
	const struct glfw_backend *glfw = target->backend;

	target_input_read(glfw->window, glfw->wheel, out);
}

static bool glfw_swap(struct target *target)
{
	struct glfw_backend *glfw = target->backend;

	glfwSwapBuffers(glfw->window);
	return glfw_poll(target);
}

static void glfw_close(struct target *target)
{
	struct glfw_backend *glfw = target->backend;

	if (!glfw)
		return;
	if (glfw->window)
		glfwDestroyWindow(glfw->window);
	if (glfw->initialised)
		glfwTerminate();
	free(glfw);
	target->backend = NULL;
}

const struct target_ops target_glfw_ops = {
	.open = glfw_open,
	.swap = glfw_swap,
	.poll = glfw_poll,
	.input = glfw_input,
	.close = glfw_close,
	.offscreen = false,
};
