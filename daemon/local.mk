# What daemon/ adds to the build: what the two daemons share, and the daemons.
noinst_LIBRARIES += daemon/libgdaemon.a
daemon_libgdaemon_a_SOURCES = \
	daemon/control.c daemon/control.h \
	daemon/frame_stats.c daemon/frame_stats.h \
	daemon/histogram.c daemon/histogram.h \
	daemon/json.c daemon/json.h \
	daemon/loop.c daemon/loop.h \
	daemon/master_settings.c daemon/master_settings.h \
	daemon/master_state.c daemon/master_state.h \
	daemon/node_frame.c daemon/node_frame.h \
	daemon/notify.c daemon/notify.h \
	daemon/options.c daemon/options.h \
	daemon/privileges.c daemon/privileges.h \
	daemon/socket.c daemon/socket.h
daemon_libgdaemon_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(SYSTEMD_CFLAGS)
