#include "renderer/gl/swap_group.h"

#include "base/result.h"

#include <stdio.h>

/* libepoxy may be built without GLX. */
#if __has_include(<epoxy/glx.h>) && __has_include(<X11/Xlib.h>)

#include <epoxy/egl.h>
#include <epoxy/glx.h>

#define GROUP 1
#define BARRIER 1

/* Asked of EGL first: where the window is not GLX's there may be no libGLX to ask. */
static Display *current_display(void)
{
	return eglGetCurrentContext() == EGL_NO_CONTEXT ? glXGetCurrentDisplay() : NULL;
}

int swap_group_join(char *why, size_t size)
{
	Display *display = current_display();
	const GLXDrawable drawable = display ? glXGetCurrentDrawable() : None;
	GLuint groups = 0, barriers = 0;

	if (!display || drawable == None) {
		snprintf(why, size, "the window is not GLX's");
		return GR_ERR_UNSUPPORTED;
	}
	if (!epoxy_has_glx_extension(display, DefaultScreen(display), "GLX_NV_swap_group")) {
		snprintf(why, size, "the driver has no GLX_NV_swap_group");
		return GR_ERR_UNSUPPORTED;
	}
	if (!glXQueryMaxSwapGroupsNV(display, DefaultScreen(display), &groups, &barriers) ||
	    groups < GROUP || barriers < BARRIER) {
		snprintf(why, size, "the driver has %u swap groups and %u barriers; is there a sync board?",
			 groups, barriers);
		return GR_ERR_UNSUPPORTED;
	}
	if (!glXJoinSwapGroupNV(display, drawable, GROUP)) {
		snprintf(why, size, "the driver does not let the window into swap group %d", GROUP);
		return GR_ERR_UNSUPPORTED;
	}
	if (!glXBindSwapBarrierNV(display, GROUP, BARRIER)) {
		glXJoinSwapGroupNV(display, drawable, 0);
		snprintf(why, size, "the driver does not bind swap group %d to a barrier", GROUP);
		return GR_ERR_UNSUPPORTED;
	}
	return GR_OK;
}

void swap_group_leave(void)
{
	Display *display = current_display();

	if (!display || !epoxy_has_glx_extension(display, DefaultScreen(display), "GLX_NV_swap_group"))
		return;
	glXBindSwapBarrierNV(display, GROUP, 0);
	glXJoinSwapGroupNV(display, glXGetCurrentDrawable(), 0);
}

#else

int swap_group_join(char *why, size_t size)
{
	snprintf(why, size, "built without GLX");
	return GR_ERR_UNSUPPORTED;
}

void swap_group_leave(void)
{
}

#endif
