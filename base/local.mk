noinst_LIBRARIES += base/libgbase.a
base_libgbase_a_SOURCES = \
	base/clock.c base/clock.h \
	base/cursor.h \
	base/diag.c base/diag.h \
	base/item.h \
	base/line_fit.c base/line_fit.h \
	base/log.c base/log.h \
	base/photometry.h \
	base/plain.c base/plain.h \
	base/pose.c base/pose.h \
	base/result.c base/result.h \
	base/seqlock.h \
	base/solar.c base/solar.h \
	base/sunlight.c base/sunlight.h
base_libgbase_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS)
