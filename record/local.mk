# Session records: format, writer, reader. Uses base, protocol (states) alone.
noinst_LIBRARIES += record/libgrecord.a
record_libgrecord_a_SOURCES = \
	record/csv.c record/csv.h record/csv_frames.c record/csv_private.h \
	record/entry.c \
	record/format.c record/format.h \
	record/output.c record/output.h \
	record/player.c record/player.h \
	record/reader.c record/reader.h \
	record/ring.c record/ring.h \
	record/rules.c record/rules.h \
	record/states.c record/states.h \
	record/survey.c record/survey.h \
	record/writer.c record/writer.h
record_libgrecord_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(SODIUM_CFLAGS) -pthread

RECORD_LIBS = record/libgrecord.a $(PROTOCOL_LIBS) -lpthread
