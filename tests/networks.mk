# tests of trackers that come by the network
NETWORK_TESTS = tests/unit/test_text tests/unit/test_dtrack \
	tests/unit/test_dtrack_device
check_PROGRAMS += $(NETWORK_TESTS)
TESTS += $(NETWORK_TESTS)

tests_unit_test_text_SOURCES = tests/unit/test_text.c tests/unit/unit.h
tests_unit_test_text_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_text_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

tests_unit_test_dtrack_SOURCES = tests/unit/test_dtrack.c tests/unit/unit.h
tests_unit_test_dtrack_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_dtrack_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

tests_unit_test_dtrack_device_SOURCES = tests/unit/test_dtrack_device.c tests/unit/net_device.h \
	tests/unit/unit.h
tests_unit_test_dtrack_device_CFLAGS = $(TEST_CFLAGS) -pthread
tests_unit_test_dtrack_device_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

# Fuzzers, see tests/config.mk.
EXTRA_DIST += \
	tests/fuzz/fuzz_dtrack.c \
	tests/fuzz/corpus/dtrack/every \
	tests/fuzz/corpus/dtrack/lost \
	tests/fuzz/corpus/dtrack/midnight \
	tests/fuzz/corpus/dtrack/numbers \
	tests/fuzz/corpus/dtrack/twice

if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_dtrack
tests_fuzz_fuzz_dtrack_SOURCES = tests/fuzz/fuzz_dtrack.c
tests_fuzz_fuzz_dtrack_CFLAGS = $(TEST_CFLAGS)
tests_fuzz_fuzz_dtrack_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_dtrack_LDADD = $(TRACKING_LIBS)
endif
