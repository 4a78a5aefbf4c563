# `grotto doctor`: a library, so that tests can link its judges.
noinst_LIBRARIES += tools/libgdoctor.a
tools_libgdoctor_a_SOURCES = \
	tools/doctor/checks.c tools/doctor/doctor.h \
	tools/doctor/checks_gl.c \
	tools/doctor/checks_net.c \
	tools/doctor/checks_way.c \
	tools/doctor/finding.c tools/doctor/finding.h \
	tools/doctor/firewall.c tools/doctor/firewall.h \
	tools/doctor/link.c tools/doctor/link.h \
	tools/doctor/listen.c \
	tools/doctor/machine.c tools/doctor/machine.h \
	tools/doctor/room.c tools/doctor/room.h \
	tools/doctor/sockets.c tools/doctor/sockets.h \
	tools/doctor/sysfile.c tools/doctor/sysfile.h \
	tools/doctor/way.c tools/doctor/way.h
tools_libgdoctor_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(EPOXY_CFLAGS) $(JSONC_CFLAGS) $(SODIUM_CFLAGS)

# It opens sockets as the daemons do, by their own code.
DOCTOR_LIBS = tools/libgdoctor.a tools/libgtools.a daemon/libgdaemon.a
