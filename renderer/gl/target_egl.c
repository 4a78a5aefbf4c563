/*
 * OpenGL without a display. EGL_EXT_platform_device reaches a GPU by its
 * number with no X server or compositor and is what render nodes have;
 * EGL_MESA_platform_surfaceless is what remains in containers without devices.
 */
#include "renderer/gl/target_private.h"

#include "base/log.h"
#include "base/result.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <stdio.h>
#include <stdlib.h>

#define MAX_DEVICES 32

struct egl_backend {
	EGLDisplay display;
	EGLContext context;
};

static const char *egl_reason(void)
{
	switch (eglGetError()) {
	case EGL_SUCCESS:
		return "no reason given";
	case EGL_NOT_INITIALIZED:
		return "not initialised (no driver, or no right to open the device)";
	case EGL_BAD_ALLOC:
		return "out of resources";
	case EGL_BAD_MATCH:
		return "this version or profile is not offered";
	case EGL_BAD_ATTRIBUTE:
		return "an attribute is not known";
	case EGL_BAD_CONFIG:
		return "no such configuration";
	case EGL_BAD_DISPLAY:
		return "no such display";
	case EGL_BAD_PARAMETER:
		return "a parameter is not accepted";
	default:
		return "EGL error";
	}
}

static EGLContext create_context(EGLDisplay display, EGLConfig config, bool versioned, bool debug)
{
	const EGLint wanted[] = {
		EGL_CONTEXT_MAJOR_VERSION, TARGET_GL_MAJOR,
		EGL_CONTEXT_MINOR_VERSION, TARGET_GL_MINOR,
		EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
		EGL_CONTEXT_OPENGL_DEBUG, debug ? EGL_TRUE : EGL_FALSE,
		EGL_NONE,
	};
	const EGLint any[] = { EGL_NONE };

	return eglCreateContext(display, config, EGL_NO_CONTEXT, versioned ? wanted : any);
}

static void close_display(struct egl_backend *egl)
{
	if (egl->display == EGL_NO_DISPLAY)
		return;
	eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
	if (egl->context != EGL_NO_CONTEXT)
		eglDestroyContext(egl->display, egl->context);
	eglTerminate(egl->display);
	egl->display = EGL_NO_DISPLAY;
	egl->context = EGL_NO_CONTEXT;
}

/* Says what a driver without 4.5 does offer, through a context of any version. */
static void log_what_is_there(struct egl_backend *egl, EGLConfig config, const char *where,
			      const char *reason)
{
	egl->context = create_context(egl->display, config, false, false);
	if (egl->context != EGL_NO_CONTEXT &&
	    eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->context))
		target_check_version(where);
	else
		gr_warning("%s: no OpenGL %d.%d core context: %s", where, TARGET_GL_MAJOR,
			   TARGET_GL_MINOR, reason);
}

/* Takes the display over: on failure it is closed. */
static int use_display(struct egl_backend *egl, EGLDisplay display, bool debug, const char *where)
{
	static const EGLint attributes[] = {
		EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE,
	};
	EGLConfig config = NULL;
	EGLint major, minor, count = 0;

	if (display == EGL_NO_DISPLAY || !eglInitialize(display, &major, &minor)) {
		gr_notice("%s: %s", where, egl_reason());
		return GR_ERR_UNSUPPORTED;
	}
	egl->display = display;
	if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context")) {
		gr_notice("%s: EGL %d.%d without EGL_KHR_surfaceless_context", where, major, minor);
	} else if (!eglBindAPI(EGL_OPENGL_API)) {
		gr_notice("%s: EGL %d.%d without desktop OpenGL", where, major, minor);
	} else if (!eglChooseConfig(display, attributes, &config, 1, &count) || count < 1) {
		gr_notice("%s: no configuration that can draw OpenGL", where);
	} else {
		egl->context = create_context(display, config, true, debug);
		if (egl->context == EGL_NO_CONTEXT)
			log_what_is_there(egl, config, where, egl_reason());
		else if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->context))
			gr_notice("%s: context cannot be made current: %s", where, egl_reason());
		else if (target_check_version(where) == GR_OK)
			return GR_OK;
	}
	close_display(egl);
	return GR_ERR_UNSUPPORTED;
}

static const char *device_name(EGLDeviceEXT device)
{
	const char *extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
	const char *name = NULL;

	if (extensions && epoxy_extension_in_string(extensions, "EGL_EXT_device_drm"))
		name = eglQueryDeviceStringEXT(device, EGL_DRM_DEVICE_FILE_EXT);
	if (!name && extensions && epoxy_extension_in_string(extensions, "EGL_MESA_device_software"))
		name = "software";
	return name ? name : "unnamed";
}

static int try_devices(struct target *target, const struct target_params *params)
{
	struct egl_backend *egl = target->backend;
	EGLDeviceEXT devices[MAX_DEVICES];
	EGLint count = 0;

	if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") ||
	    !(epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
	      epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base"))) {
		gr_notice("EGL device platform: not offered by this EGL");
		return GR_ERR_UNSUPPORTED;
	}
	if (!eglQueryDevicesEXT(MAX_DEVICES, devices, &count) || count < 1) {
		gr_notice("EGL device platform: no devices");
		return GR_ERR_UNSUPPORTED;
	}
	if (params->gpu >= count) {
		gr_error("EGL device %d was asked for, there are %d (0 to %d)", params->gpu,
			 (int)count, (int)count - 1);
		return GR_ERR_RANGE;
	}
	for (int i = 0; i < count; i++) {
		if (params->gpu >= 0 && i != params->gpu)
			continue;
		snprintf(target->platform, sizeof target->platform, "EGL device %d (%s)", i,
			 device_name(devices[i]));
		if (use_display(egl,
				eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL),
				params->debug, target->platform) == GR_OK)
			return GR_OK;
	}
	return GR_ERR_UNSUPPORTED;
}

static int try_surfaceless(struct target *target, const struct target_params *params)
{
	snprintf(target->platform, sizeof target->platform, "EGL surfaceless");
	if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless")) {
		gr_notice("%s: not offered by this EGL", target->platform);
		return GR_ERR_UNSUPPORTED;
	}
	return use_display(target->backend,
			   eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA,
						    EGL_DEFAULT_DISPLAY, NULL),
			   params->debug, target->platform);
}

static int egl_open(struct target *target, const struct target_params *params)
{
	struct egl_backend *egl = calloc(1, sizeof *egl);
	int result;

	if (!egl)
		return GR_ERR_NOMEM;
	egl->display = EGL_NO_DISPLAY;
	egl->context = EGL_NO_CONTEXT;
	target->backend = egl;
	result = try_devices(target, params);
	/* A GPU that was asked for by number is not replaced by another. */
	if (result == GR_ERR_UNSUPPORTED && params->gpu < 0)
		result = try_surfaceless(target, params);
	if (result != GR_OK)
		gr_error("no OpenGL %d.%d core without a display; the lines above say what was tried",
			 TARGET_GL_MAJOR, TARGET_GL_MINOR);
	return result;
}

static bool egl_swap(struct target *target)
{
	(void)target;
	glFlush();
	return true;
}

static void egl_close(struct target *target)
{
	struct egl_backend *egl = target->backend;

	if (!egl)
		return;
	close_display(egl);
	free(egl);
	target->backend = NULL;
}

const struct target_ops target_egl_ops = {
	.open = egl_open,
	.swap = egl_swap,
	.close = egl_close,
	.offscreen = true,
};
