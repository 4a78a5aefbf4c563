# tests of trackers that come by the network
NETWORK_TESTS = tests/unit/test_text tests/unit/test_dtrack \
	tests/unit/test_dtrack_device tests/unit/test_vrpn tests/unit/test_vrpn_device
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

tests_unit_test_vrpn_SOURCES = tests/unit/test_vrpn.c tests/unit/vrpn_bytes.h tests/unit/unit.h
tests_unit_test_vrpn_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_vrpn_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

tests_unit_test_vrpn_device_SOURCES = tests/unit/test_vrpn_device.c tests/unit/mock_vrpn.h \
	tests/unit/net_device.h tests/unit/vrpn_bytes.h tests/unit/unit.h
tests_unit_test_vrpn_device_CFLAGS = $(TEST_CFLAGS) -pthread
tests_unit_test_vrpn_device_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

# Fuzzers, see tests/config.mk.
EXTRA_DIST += \
	tests/fuzz/fuzz_dtrack.c \
	tests/fuzz/corpus/dtrack/every \
	tests/fuzz/corpus/dtrack/refused \
	tests/fuzz/corpus/dtrack/lost \
	tests/fuzz/corpus/dtrack/midnight \
	tests/fuzz/corpus/dtrack/numbers \
	tests/fuzz/corpus/dtrack/twice \
	tests/fuzz/fuzz_vrpn.c \
	tests/fuzz/corpus/vrpn/datagrams \
	tests/fuzz/corpus/vrpn/buttons \
	tests/fuzz/corpus/vrpn/cookie \
	tests/fuzz/corpus/vrpn/rests \
	tests/fuzz/corpus/vrpn/faults \
	tests/fuzz/corpus/vrpn/session

if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_dtrack tests/fuzz/fuzz_vrpn
tests_fuzz_fuzz_dtrack_SOURCES = tests/fuzz/fuzz_dtrack.c
tests_fuzz_fuzz_dtrack_CFLAGS = $(TEST_CFLAGS)
tests_fuzz_fuzz_dtrack_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_dtrack_LDADD = $(TRACKING_LIBS)
tests_fuzz_fuzz_vrpn_SOURCES = tests/fuzz/fuzz_vrpn.c tests/unit/vrpn_bytes.h
tests_fuzz_fuzz_vrpn_CFLAGS = $(TEST_CFLAGS)
tests_fuzz_fuzz_vrpn_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_vrpn_LDADD = $(TRACKING_LIBS)
endif
