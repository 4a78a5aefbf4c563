#include "config.h" /* _GNU_SOURCE */

#include "renderer/gl/target_private.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/swap_group.h"

#include <epoxy/gl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __SANITIZE_ADDRESS__
#include <dlfcn.h>
#include <link.h>

/*
 * The driver leaks at exit and is unloaded before the leak checker looks, so
 * that its leaks have no name to be suppressed by. Sanitizer builds keep it.
 */
static int keep_loaded(struct dl_phdr_info *info, size_t size, void *unused)
{
	(void)size;
	(void)unused;
	if (info->dlpi_name && info->dlpi_name[0] == '/')
		dlopen(info->dlpi_name, RTLD_NOW | RTLD_NOLOAD | RTLD_NODELETE);
	return 0;
}
#endif

static const char *gl_text(GLenum name)
{
	const GLubyte *text = glGetString(name);

	return text ? (const char *)text : "(unnamed)";
}

int target_check_version(const char *where)
{
	GLint major = 0, minor = 0, profile = 0;

	glGetIntegerv(GL_MAJOR_VERSION, &major);
	glGetIntegerv(GL_MINOR_VERSION, &minor);
	glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
	while (glGetError() != GL_NO_ERROR) /* an old context knows none of these */
		;
	if (major > TARGET_GL_MAJOR || (major == TARGET_GL_MAJOR && minor >= TARGET_GL_MINOR)) {
		if (profile & GL_CONTEXT_CORE_PROFILE_BIT)
			return GR_OK;
	}
	gr_warning("%s: OpenGL %d.%d core is needed, found %s on %s", where, TARGET_GL_MAJOR,
		   TARGET_GL_MINOR, gl_text(GL_VERSION), gl_text(GL_RENDERER));
	return GR_ERR_UNSUPPORTED;
}

static enum gr_log_level debug_level(GLenum severity)
{
	switch (severity) {
	case GL_DEBUG_SEVERITY_HIGH:
		return GR_LOG_ERROR;
	case GL_DEBUG_SEVERITY_MEDIUM:
		return GR_LOG_WARNING;
	case GL_DEBUG_SEVERITY_LOW:
		return GR_LOG_INFO;
	default:
		return GR_LOG_DEBUG;
	}
}

static void GLAPIENTRY debug_message(GLenum source, GLenum type, GLuint id, GLenum severity,
				     GLsizei length, const GLchar *message, const void *user)
{
	(void)source;
	(void)length;
	(void)user;
	gr_log(type == GL_DEBUG_TYPE_ERROR ? GR_LOG_ERROR : debug_level(severity), "gl %u: %s", id,
	       message);
}

static int create_framebuffers(struct target *target)
{
	static const GLenum formats[] = { GL_RGBA8, GL_RGB10_A2, GL_RGBA16F };
	static const int bits[] = { 8, 10, 16 };
	int count = target->quad_buffer ? 2 : 1;

	target->bits = bits[target->depth];
	for (int i = 0; i < count; i++) {
		GLenum status;

		glCreateRenderbuffers(1, &target->color[i]);
		glNamedRenderbufferStorage(target->color[i], formats[target->depth], target->width,
					   target->height);
		glCreateFramebuffers(1, &target->framebuffer[i]);
		glNamedFramebufferRenderbuffer(target->framebuffer[i], GL_COLOR_ATTACHMENT0,
					       GL_RENDERBUFFER, target->color[i]);
		status = glCheckNamedFramebufferStatus(target->framebuffer[i], GL_FRAMEBUFFER);
		if (status != GL_FRAMEBUFFER_COMPLETE) {
			gr_error("%s: no framebuffer of %d x %d with %d bits a band (status 0x%x)",
				 target->platform, target->width, target->height, target->bits, status);
			return GR_ERR_GL;
		}
	}
	return GR_OK;
}

/* The size is only known to be possible once there is a context to ask. */
static int check_size(const struct target *target)
{
	GLint most = 0, viewport[2] = { 0, 0 };

	glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &most);
	glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
	if (viewport[0] < most)
		most = viewport[0];
	if (viewport[1] < most)
		most = viewport[1];
	if (target->width <= most && target->height <= most)
		return GR_OK;
	gr_error("%s: %d x %d pixels asked for, %s can draw %d a side", target->platform,
		 target->width, target->height, target->renderer, most);
	return GR_ERR_UNSUPPORTED;
}

static int set_up(struct target *target, const struct target_params *params)
{
	int result;

	snprintf(target->renderer, sizeof target->renderer, "%s", gl_text(GL_RENDERER));
	gr_info("%s: %s, OpenGL %s", target->platform, target->renderer, gl_text(GL_VERSION));
	if (params->debug) {
		glEnable(GL_DEBUG_OUTPUT);
		glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
		glDebugMessageCallback(debug_message, NULL);
	}
	result = check_size(target);
	if (result == GR_OK && target->ops->offscreen)
		result = create_framebuffers(target);
	return result;
}

int target_create(struct target **out, const struct target_params *params)
{
	struct target *target;
	int result;

	*out = NULL;
	if (params->width < 1 || params->height < 1)
		return GR_ERR_RANGE;
	if (params->depth == TARGET_DEPTH_FLOAT && params->kind != TARGET_HEADLESS)
		return GR_ERR_RANGE;
	target = calloc(1, sizeof *target);
	if (!target)
		return GR_ERR_NOMEM;
	target->ops = params->kind == TARGET_HEADLESS ? &target_egl_ops : &target_glfw_ops;
	target->width = params->width;
	target->height = params->height;
	target->quad_buffer = params->quad_buffer;
	target->depth = params->depth;
	result = target->ops->open(target, params);
	if (result == GR_OK)
		result = set_up(target, params);
#ifdef __SANITIZE_ADDRESS__
	dl_iterate_phdr(keep_loaded, NULL);
#endif
	if (result == GR_OK)
		*out = target;
	else
		target_destroy(&target);
	return result;
}

void target_destroy(struct target **target)
{
	struct target *t = *target;

	if (!t)
		return;
	for (int i = 0; i < 2; i++) {
		if (t->framebuffer[i])
			glDeleteFramebuffers(1, &t->framebuffer[i]);
		if (t->color[i])
			glDeleteRenderbuffers(1, &t->color[i]);
	}
	t->ops->close(t);
	free(t);
	*target = NULL;
}

unsigned target_framebuffer(const struct target *target, int eye)
{
	return target->framebuffer[target->quad_buffer && eye == 1 ? 1 : 0];
}

void target_bind(const struct target *target, int eye, bool read)
{
	unsigned framebuffer = target_framebuffer(target, eye);

	glBindFramebuffer(read ? GL_READ_FRAMEBUFFER : GL_DRAW_FRAMEBUFFER, framebuffer);
	if (framebuffer == 0 && target->quad_buffer) {
		GLenum buffer = eye == 1 ? GL_BACK_RIGHT : GL_BACK_LEFT;

		if (read)
			glReadBuffer(buffer);
		else
			glDrawBuffer(buffer);
	}
}

int target_eyes(const struct target *target)
{
	return target->quad_buffer ? 2 : 1;
}

int target_bits(const struct target *target)
{
	return target->bits;
}

int target_barrier_join(struct target *target, char *why, size_t size)
{
	if (!target->ops->offscreen)
		return swap_group_join(why, size);
	snprintf(why, size, "it draws into no window");
	return GR_ERR_UNSUPPORTED;
}

void target_barrier_leave(struct target *target)
{
	if (!target->ops->offscreen)
		swap_group_leave();
}

void target_size(const struct target *target, int *width, int *height)
{
	*width = target->width;
	*height = target->height;
}

bool target_swap(struct target *target)
{
	return target->ops->swap(target);
}

bool target_poll(struct target *target)
{
	return !target->ops->poll || target->ops->poll(target);
}

bool target_input(const struct target *target, struct target_input *out)
{
	if (!target->ops->input)
		return false;
	target->ops->input(target, out);
	return true;
}

const char *target_renderer_name(const struct target *target)
{
	return target->renderer;
}

const char *target_platform_name(const struct target *target)
{
	return target->platform;
}
