# Fragments of the renderer: gl + scene + image, trace + gi, view + tone. Each adds
# its sources to RENDERER_SOURCES and its GLSL files to SHADERS.
RENDERER_SOURCES = \
	renderer/alive.h renderer/calibrate.c renderer/calibrate.h renderer/calibrate_room.c renderer/calibrate_room.h \
	renderer/create.c renderer/frame.c renderer/frame.h renderer/irradiance.c renderer/plan_light.c renderer/plan_light.h renderer/read.c \
	renderer/renderer.c renderer/renderer.h renderer/renderer_private.h \
	renderer/share.c

include $(top_srcdir)/renderer/gl/local.mk
include $(top_srcdir)/renderer/gi/local.mk
include $(top_srcdir)/renderer/trace/local.mk
include $(top_srcdir)/renderer/view/local.mk

noinst_LIBRARIES += renderer/libgrenderer.a
renderer_libgrenderer_a_SOURCES = $(RENDERER_SOURCES)
nodist_renderer_libgrenderer_a_SOURCES = renderer/shaders/embedded.c
EXTRA_DIST += $(SHADERS)
renderer_libgrenderer_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(EPOXY_CFLAGS) $(GLFW_CFLAGS) \
	$(ASSIMP_CFLAGS) $(OPENEXR_CFLAGS) $(PNG_CFLAGS) $(SODIUM_CFLAGS) $(JPEG_CFLAGS) $(JSONC_CFLAGS)

# What a program that links each layer needs, lowest last.
BASE_LIBS = base/libgbase.a $(SODIUM_LIBS)
CONFIG_LIBS = config/libgconfig.a $(BASE_LIBS) $(LIBCONFIG_LIBS)
PROTOCOL_LIBS = protocol/libgprotocol.a $(BASE_LIBS) $(LZO_LIBS) $(ISAL_LIBS) $(XXHASH_LIBS)
TRACKING_LIBS = tracking/libgtracking.a $(BASE_LIBS) $(HIDAPI_LIBS) $(LIBUSB_LIBS) $(UDEV_LIBS) -lpthread
RENDERER_LIBS = renderer/libgrenderer.a $(CONFIG_LIBS) $(EPOXY_LIBS) $(GLFW_LIBS) \
	$(ASSIMP_LIBS) $(OPENEXR_LIBS) $(PNG_LIBS) $(JPEG_LIBS) $(JSONC_LIBS) $(EMBREE_LIBS)
