# tests of record: links base/, protocol/ and record/ alone
RECORD_TEST_CFLAGS = $(TEST_CFLAGS) -D_GNU_SOURCE
RECORD_TEST_LDADD = $(RECORD_LIBS) $(CMOCKA_LIBS)
RECORD_MAKE_SOURCES = tests/unit/record_make.c tests/unit/record_make.h tests/unit/unit.h
RECORD_FILES_SOURCES = tests/unit/record_files.c tests/unit/record_files.h $(RECORD_MAKE_SOURCES)

RECORD_TESTS = \
	tests/unit/test_record \
	tests/unit/test_record_damage \
	tests/unit/test_record_entry \
	tests/unit/test_record_rules \
	tests/unit/test_record_tables
check_PROGRAMS += $(RECORD_TESTS)
TESTS += $(RECORD_TESTS)

tests_unit_test_record_SOURCES = tests/unit/test_record.c $(RECORD_FILES_SOURCES)
tests_unit_test_record_CFLAGS = $(RECORD_TEST_CFLAGS)
tests_unit_test_record_LDADD = $(RECORD_TEST_LDADD)
tests_unit_test_record_damage_SOURCES = tests/unit/test_record_damage.c $(RECORD_FILES_SOURCES)
tests_unit_test_record_damage_CFLAGS = $(RECORD_TEST_CFLAGS)
tests_unit_test_record_damage_LDADD = $(RECORD_TEST_LDADD)
tests_unit_test_record_entry_SOURCES = tests/unit/test_record_entry.c $(RECORD_MAKE_SOURCES)
tests_unit_test_record_entry_CFLAGS = $(RECORD_TEST_CFLAGS)
tests_unit_test_record_entry_LDADD = $(RECORD_TEST_LDADD)
tests_unit_test_record_rules_SOURCES = tests/unit/test_record_rules.c tests/unit/unit.h
tests_unit_test_record_rules_CFLAGS = $(RECORD_TEST_CFLAGS)
tests_unit_test_record_rules_LDADD = $(RECORD_TEST_LDADD)
tests_unit_test_record_tables_SOURCES = tests/unit/test_record_tables.c $(RECORD_FILES_SOURCES)
tests_unit_test_record_tables_CFLAGS = $(RECORD_TEST_CFLAGS)
tests_unit_test_record_tables_LDADD = $(RECORD_TEST_LDADD)

check_PROGRAMS += tests/unit/test_replay_source
TESTS += tests/unit/test_replay_source
tests_unit_test_replay_source_SOURCES = tests/unit/test_replay_source.c $(RECORD_MAKE_SOURCES)
tests_unit_test_replay_source_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_replay_source_LDADD = daemon/libgdaemon.a $(RECORD_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/loopback/walk
tests_loopback_walk_SOURCES = tests/loopback/walk.c
tests_loopback_walk_CFLAGS = $(TEST_CFLAGS)
tests_loopback_walk_LDADD = daemon/libgdaemon.a $(TRACKING_LIBS) $(CONFIG_LIBS) $(RECORD_LIBS)
dist_check_SCRIPTS += tests/loopback/record.sh tests/loopback/replay.sh
TESTS += tests/loopback/record.sh tests/loopback/replay.sh

EXTRA_DIST += \
	tests/fuzz/fuzz_record.c \
	tests/fuzz/corpus/record/damaged tests/fuzz/corpus/record/room \
	tests/fuzz/corpus/record/far-apart \
	tests/fuzz/corpus/record/short \
	tests/fuzz/corpus/record/two

if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_record
tests_fuzz_fuzz_record_SOURCES = tests/fuzz/fuzz_record.c
tests_fuzz_fuzz_record_CFLAGS = $(TEST_CFLAGS)
tests_fuzz_fuzz_record_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_record_LDADD = $(RECORD_LIBS)
endif
