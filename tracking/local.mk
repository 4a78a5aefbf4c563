noinst_LIBRARIES += tracking/libgtracking.a
tracking_libgtracking_a_SOURCES = \
	tracking/history.c \
	tracking/replay.c tracking/replay.h \
	tracking/replay_parse.c \
	tracking/sim.c tracking/sim.h \
	tracking/source.c tracking/source.h
tracking_libgtracking_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS)
