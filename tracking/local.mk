noinst_LIBRARIES += tracking/libgtracking.a
tracking_libgtracking_a_SOURCES = \
	tracking/replay.h \
	tracking/sim.h \
	tracking/source.h
tracking_libgtracking_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS)
