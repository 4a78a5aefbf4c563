# What daemon/ adds to the build: what the two daemons share, and the daemons.
noinst_LIBRARIES += daemon/libgdaemon.a
daemon_libgdaemon_a_SOURCES = \
	daemon/control.c daemon/control.h \
	daemon/dropped.c daemon/dropped.h \
	daemon/faults.c daemon/faults.h daemon/faults_control.c \
	daemon/frame_stats.c daemon/frame_stats.h \
	daemon/hand.c daemon/hand.h daemon/hand_private.h \
	daemon/hand_color.c daemon/hand_color.h \
	daemon/hand_lighting.c daemon/hand_navigation.c daemon/hand_params.c \
	daemon/histogram.c daemon/histogram.h \
	daemon/json.c daemon/json.h \
	daemon/frame_source.h \
	daemon/live_source.c daemon/live_source.h \
	daemon/loop.c daemon/loop.h \
	daemon/master_input.h \
	daemon/master_params.h \
	daemon/master_adapt.c daemon/master_adapt.h \
	daemon/master_settings.c daemon/master_settings.h \
	daemon/master_state.c daemon/master_state.h \
	daemon/node_frame.c daemon/node_frame.h \
	daemon/node_plan.c daemon/node_plan.h \
	daemon/notify.c daemon/notify.h \
	daemon/options.c daemon/options.h \
	daemon/recorder.c daemon/recorder.h \
	daemon/replay_check.c daemon/replay_check.h \
	daemon/replay_source.c daemon/replay_source.h \
	daemon/priority.c daemon/priority.h \
	daemon/privileges.c daemon/privileges.h \
	daemon/send_queue.c daemon/send_queue.h \
	daemon/saved_state.c daemon/saved_state.h \
	daemon/socket.c daemon/socket.h \
	daemon/state_keeper.c daemon/state_keeper.h \
	daemon/swap_wait.c daemon/swap_wait.h \
	daemon/tracker_devices.c daemon/tracker_devices.h daemon/tracker_devices_private.h \
	daemon/tracker_pads.c \
	daemon/tracker_filter.c daemon/tracker_filter.h \
	daemon/tracker_stats.c daemon/tracker_stats.h \
	daemon/trackers.c daemon/trackers.h \
	daemon/trackers_report.c
daemon_libgdaemon_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(LIBCONFIG_CFLAGS) $(SYSTEMD_CFLAGS)

DAEMON_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(SODIUM_CFLAGS) $(SYSTEMD_CFLAGS) -pthread
DAEMON_LIBS = daemon/libgdaemon.a $(RECORD_LIBS) $(TRACKING_LIBS) $(RENDERER_LIBS) \
	$(SYSTEMD_LIBS) -lpthread

sbin_PROGRAMS += daemon/grotto-master daemon/grotto-node

daemon_grotto_master_SOURCES = \
	daemon/master.c daemon/master.h daemon/master_private.h \
	daemon/master_events.c \
	daemon/master_main.c \
	daemon/master_pace.c daemon/master_pace.h \
	daemon/master_record.c \
	daemon/master_save.c \
	daemon/master_report.c \
	daemon/master_role.c \
	daemon/room_files.c daemon/room_files.h
daemon_grotto_master_CFLAGS = $(DAEMON_CFLAGS)
daemon_grotto_master_LDADD = $(DAEMON_LIBS)

daemon_grotto_node_SOURCES = \
	daemon/node.c daemon/node.h \
	daemon/node_control.c daemon/node_control.h \
	daemon/node_glance.c daemon/node_glance.h \
	daemon/node_input.c daemon/node_input.h \
	daemon/node_light.c daemon/node_light.h \
	daemon/node_main.c \
	daemon/node_report.c \
	daemon/node_share.c daemon/node_share.h \
	daemon/node_swap.c daemon/node_swap.h \
	daemon/node_vitals.c daemon/node_vitals.h \
	daemon/pictures.c daemon/pictures.h \
	daemon/room_files.c daemon/room_files.h
daemon_grotto_node_CFLAGS = $(DAEMON_CFLAGS)
daemon_grotto_node_LDADD = $(DAEMON_LIBS)
