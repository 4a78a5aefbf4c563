# tests of tracking
TRACKING_TESTS = tests/unit/test_tracking tests/unit/test_sim tests/unit/test_replay \
	tests/unit/test_device
check_PROGRAMS += $(TRACKING_TESTS)
TESTS += $(TRACKING_TESTS)

tests_unit_test_tracking_SOURCES = tests/unit/test_tracking.c tests/unit/visitor.h tests/unit/unit.h
tests_unit_test_tracking_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_tracking_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

tests_unit_test_sim_SOURCES = tests/unit/test_sim.c tests/unit/visitor.h tests/unit/unit.h
tests_unit_test_sim_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_sim_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

tests_unit_test_replay_SOURCES = tests/unit/test_replay.c tests/unit/unit.h
tests_unit_test_replay_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_replay_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

tests_unit_test_device_SOURCES = tests/unit/test_device.c tests/unit/fake_device.h tests/unit/unit.h
tests_unit_test_device_CFLAGS = $(TEST_CFLAGS) -pthread
tests_unit_test_device_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

EXTRA_DIST += \
	tests/fuzz/fuzz_replay.c \
	tests/fuzz/corpus/replay/bad.log \
	tests/fuzz/corpus/replay/good.log

if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_replay
tests_fuzz_fuzz_replay_SOURCES = tests/fuzz/fuzz_replay.c
tests_fuzz_fuzz_replay_CFLAGS = $(TEST_CFLAGS)
tests_fuzz_fuzz_replay_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_replay_LDADD = $(TRACKING_LIBS)
endif
