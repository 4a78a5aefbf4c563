# tests of Polhemus' trackers; MOCK_* are tests/tracking.mk's
POLHEMUS_TESTS = tests/unit/test_polhemus_decode tests/unit/test_polhemus_stream
check_PROGRAMS += $(POLHEMUS_TESTS)
TESTS += $(POLHEMUS_TESTS)
tests_unit_test_polhemus_decode_SOURCES = tests/unit/test_polhemus_decode.c \
	tests/unit/polhemus_make.h tests/unit/unit.h
tests_unit_test_polhemus_decode_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_polhemus_decode_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)
tests_unit_test_polhemus_stream_SOURCES = tests/unit/test_polhemus_stream.c \
	tests/unit/polhemus_make.h tests/unit/unit.h
tests_unit_test_polhemus_stream_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_polhemus_stream_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

POLHEMUS_MOCKED = tests/unit/test_polhemus_usb tests/unit/test_polhemus_life
POLHEMUS_MOCKS = tests/unit/polhemus_fixture.h tests/unit/polhemus_make.h \
	tests/unit/mock_polhemus.c tests/unit/mock_polhemus.h \
	tests/unit/mock_usb.c tests/unit/mock_usb.h $(MOCK_SOURCES)
if HAVE_UMOCKDEV
check_PROGRAMS += $(POLHEMUS_MOCKED)
TESTS += $(POLHEMUS_MOCKED)
endif
tests_unit_test_polhemus_usb_SOURCES = tests/unit/test_polhemus_usb.c $(POLHEMUS_MOCKS)
tests_unit_test_polhemus_usb_CFLAGS = $(MOCK_CFLAGS)
tests_unit_test_polhemus_usb_LDADD = $(MOCK_LIBS)
tests_unit_test_polhemus_life_SOURCES = tests/unit/test_polhemus_life.c $(POLHEMUS_MOCKS)
tests_unit_test_polhemus_life_CFLAGS = $(MOCK_CFLAGS)
tests_unit_test_polhemus_life_LDADD = $(MOCK_LIBS)

# Fuzzers: see tests/config.mk.
EXTRA_DIST += \
	tests/fuzz/fuzz_polhemus.h tests/fuzz/fuzz_viper.c tests/fuzz/fuzz_liberty.c \
	tests/fuzz/corpus/viper/joined \
	tests/fuzz/corpus/viper/bytewise \
	tests/fuzz/corpus/viper/lost \
	tests/fuzz/corpus/viper/mode \
	tests/fuzz/corpus/viper/rate \
	tests/fuzz/corpus/viper/long \
	tests/fuzz/corpus/viper/poses \
	tests/fuzz/corpus/viper/replies \
	tests/fuzz/corpus/liberty/joined \
	tests/fuzz/corpus/liberty/bytewise \
	tests/fuzz/corpus/liberty/short \
	tests/fuzz/corpus/liberty/sizes \
	tests/fuzz/corpus/liberty/poses \
	tests/fuzz/corpus/liberty/text
if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_viper tests/fuzz/fuzz_liberty
tests_fuzz_fuzz_viper_SOURCES = tests/fuzz/fuzz_viper.c tests/fuzz/fuzz_polhemus.h
tests_fuzz_fuzz_viper_CFLAGS = $(TEST_CFLAGS)
tests_fuzz_fuzz_viper_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_viper_LDADD = $(TRACKING_LIBS)
tests_fuzz_fuzz_liberty_SOURCES = tests/fuzz/fuzz_liberty.c tests/fuzz/fuzz_polhemus.h
tests_fuzz_fuzz_liberty_CFLAGS = $(TEST_CFLAGS)
tests_fuzz_fuzz_liberty_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_liberty_LDADD = $(TRACKING_LIBS)
endif
