noinst_LIBRARIES += config/libgconfig.a
config_libgconfig_a_SOURCES = \
	config/layout.h \
	config/scene_file.h
config_libgconfig_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(LIBCONFIG_CFLAGS) $(SODIUM_CFLAGS)
