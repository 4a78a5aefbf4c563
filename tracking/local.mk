noinst_LIBRARIES += tracking/libgtracking.a
tracking_libgtracking_a_SOURCES = \
	tracking/bind.c tracking/bind.h tracking/bind_names.c \
	tracking/device.c tracking/device.h tracking/device_private.h \
	tracking/device_clock.c tracking/device_clock.h \
	tracking/device_publish.c \
	tracking/dtrack.h tracking/dtrack_decode.c tracking/dtrack_device.c \
	tracking/dtrack_report.c \
	tracking/handover.c tracking/handover.h \
	tracking/hid.c tracking/hid.h \
	tracking/history.c \
	tracking/hotplug.c tracking/hotplug.h \
	tracking/hydra.h tracking/hydra_decode.c tracking/hydra_device.c \
	tracking/net.c tracking/net.h \
	tracking/replay.c tracking/replay.h \
	tracking/replay_parse.c \
	tracking/report.c tracking/report.h \
	tracking/sim.c tracking/sim.h \
	tracking/source.c tracking/source.h \
	tracking/text.c tracking/text.h
tracking_libgtracking_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(UDEV_CFLAGS) $(HIDAPI_CFLAGS) -pthread
