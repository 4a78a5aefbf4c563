# The grotto command. Its parts are a library so that tests can link them.
noinst_LIBRARIES += tools/libgtools.a
tools_libgtools_a_SOURCES = \
	tools/ask.c tools/ask.h \
	tools/children.c tools/children.h \
	tools/cli.c tools/cli.h \
	tools/load.c tools/load.h \
	tools/programs.c tools/programs.h \
	tools/progress.c tools/progress.h \
	tools/report.c tools/report.h \
	tools/room.c tools/room.h \
	tools/say.c tools/say.h \
	tools/unfold.c tools/unfold.h
tools_libgtools_a_CPPFLAGS = $(AM_CPPFLAGS) -DGROTTO_SBINDIR='"$(sbindir)"' \
	-DGROTTO_PKGLIBEXECDIR='"$(pkglibexecdir)"'
tools_libgtools_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(JSONC_CFLAGS)

bin_PROGRAMS += tools/grotto
tools_grotto_SOURCES = \
	tools/command.h \
	tools/grotto.c \
	tools/bake.c \
	tools/bench.c \
	tools/calibrate.c tools/calibrate.h \
	tools/calibrate_ask.c tools/calibrate_read.c tools/calibrate_solve.c \
	tools/check.c \
	tools/demo.c tools/demo.h \
	tools/demo_plan.c tools/demo_plan.h \
	tools/demo_room.c \
	tools/demo_run.c \
	tools/demo_summary.c \
	tools/doctor.c \
	tools/faults.c \
	tools/key.c \
	tools/plan.c tools/plan.h \
	tools/record.c tools/record_export.c tools/record_info.c tools/record_info.h \
	tools/reference.c tools/reference.h \
	tools/reference_picture.c \
	tools/reference_points.c \
	tools/reference_view.c \
	tools/render.c \
	tools/replay.c \
	tools/status.c \
	tools/trackers.c tools/trackers_print.c tools/trackers_print.h
tools_grotto_CPPFLAGS = $(AM_CPPFLAGS) -DGROTTO_SBINDIR='"$(sbindir)"' \
	-DGROTTO_PKGLIBEXECDIR='"$(pkglibexecdir)"'
tools_grotto_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(JSONC_CFLAGS)
tools_grotto_LDADD = tools/libgbench.a $(DOCTOR_LIBS) $(TRACKING_LIBS) $(RECORD_LIBS) $(RENDERER_LIBS) $(PROTOCOL_LIBS) $(CONFIG_LIBS) $(JSONC_LIBS)
