noinst_LIBRARIES += tracking/libgtracking.a
tracking_libgtracking_a_SOURCES = \
	tracking/align.c tracking/align.h tracking/align_private.h \
	tracking/align_explain.c tracking/align_robust.c \
	tracking/bind.c tracking/bind.h tracking/bind_names.c \
	tracking/device.c tracking/device.h tracking/device_private.h \
	tracking/device_clock.c tracking/device_clock.h \
	tracking/device_publish.c \
	tracking/dtrack.h tracking/dtrack_decode.c tracking/dtrack_device.c \
	tracking/dtrack_report.c \
	tracking/handover.c tracking/handover.h \
	tracking/gamepad.h tracking/gamepad_device.c \
	tracking/hid.c tracking/hid.h tracking/hid_choose.c \
	tracking/hid_descriptor.c tracking/hid_descriptor.h \
	tracking/hid_fields.c tracking/hid_fields.h tracking/hid_values.c \
	tracking/filter.c tracking/filter.h tracking/filter_private.h \
	tracking/filter_exponential.c \
	tracking/filter_fit.c \
	tracking/filter_kalman.c \
	tracking/filter_one_euro.c \
	tracking/history.c \
	tracking/hotplug.c tracking/hotplug.h \
	tracking/hydra.h tracking/hydra_decode.c tracking/hydra_device.c \
	tracking/lever.c tracking/lever.h \
	tracking/liberty.c tracking/liberty.h \
	tracking/imu.c tracking/imu.h \
	tracking/polhemus.h tracking/polhemus_private.h tracking/polhemus_device.c tracking/polhemus_find.c \
	tracking/polhemus_liberty.c tracking/polhemus_viper.c \
	tracking/polhemus_reports.c tracking/polhemus_reports.h \
	tracking/polhemus_stream.c tracking/polhemus_stream.h \
	tracking/dmat3.c tracking/dmat3.h \
	tracking/net.c tracking/net.h \
	tracking/replay.c tracking/replay.h \
	tracking/replay_parse.c \
	tracking/report.c tracking/report.h \
	tracking/rotation.c tracking/rotation.h \
	tracking/sim.c tracking/sim.h \
	tracking/sony.h tracking/sony_decode.c tracking/sony_device.c \
	tracking/sony_report.c \
	tracking/source.c tracking/source.h \
	tracking/spacemouse.h tracking/spacemouse_decode.c tracking/spacemouse_device.c \
	tracking/still.c tracking/still.h \
	tracking/survey.c tracking/survey.h \
	tracking/text.c tracking/text.h \
	tracking/usb.c tracking/usb.h tracking/usb_private.h tracking/usb_pipe.c \
	tracking/viper.c tracking/viper.h \
	tracking/vrpn.h tracking/vrpn_decode.c tracking/vrpn_device.c \
	tracking/vrpn_link.c tracking/vrpn_link.h tracking/vrpn_state.c \
	tracking/window.c tracking/window.h
tracking_libgtracking_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(UDEV_CFLAGS) $(HIDAPI_CFLAGS) $(LIBUSB_CFLAGS) -pthread
