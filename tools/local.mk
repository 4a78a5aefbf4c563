# The grotto command. Its parts are a library so that tests can link them.
noinst_LIBRARIES += tools/libgtools.a
tools_libgtools_a_SOURCES = \
	tools/children.c tools/children.h \
	tools/room.c tools/room.h \
	tools/say.c tools/say.h \
	tools/unfold.c tools/unfold.h
tools_libgtools_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS)
