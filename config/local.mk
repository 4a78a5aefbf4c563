noinst_LIBRARIES += config/libgconfig.a
config_libgconfig_a_SOURCES = \
	config/address.c config/address.h \
	config/canonical.c config/canonical.h \
	config/config_text.c config/config_text.h \
	config/layout.c config/layout.h \
	config/layout_check.c config/layout_check.h \
	config/layout_check_network.c \
	config/layout_check_nodes.c \
	config/layout_check_room.c \
	config/layout_check_tracker_network.c \
	config/layout_check_tracker_pads.c \
	config/layout_check_trackers.c \
	config/layout_check_walls.c \
	config/layout_edit.c config/layout_edit.h \
	config/layout_hand.c \
	config/layout_geometry.c config/layout_geometry.h \
	config/layout_items.c \
	config/layout_options.c config/layout_options.h \
	config/layout_replace.c \
	config/layout_tracker.c \
	config/layout_tracker_network.c \
	config/layout_tracker_options.c \
	config/layout_tracker_pads.c \
	config/layout_write.c \
	config/options.c config/options.h \
	config/options_markdown.c \
	config/options_read.c \
	config/options_value.c config/options_value.h \
	config/options_write.c \
	config/scene_check.c \
	config/scene_file.c config/scene_file.h \
	config/scene_sky.c config/scene_sky.h \
	config/scene_options.c config/scene_options.h \
	config/scene_write.c \
	config/setting_place.c config/setting_place.h \
	config/suggest.c config/suggest.h \
	config/text_changes.c config/text_changes.h
config_libgconfig_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(LIBCONFIG_CFLAGS) $(SODIUM_CFLAGS)

# Prints the option tables for the docs: "make docs-options" after changing one.
noinst_PROGRAMS += config/reference
config_reference_SOURCES = config/reference.c
config_reference_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(LIBCONFIG_CFLAGS)
config_reference_LDADD = $(CONFIG_LIBS)

.PHONY: docs-options
docs-options: config/reference
	config/reference layout $(srcdir)/docs/layout.md
	config/reference scene $(srcdir)/docs/scene.md
