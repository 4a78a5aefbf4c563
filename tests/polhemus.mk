# tests of Polhemus' trackers; MOCK_* are tests/tracking.mk's
check_PROGRAMS += tests/unit/test_polhemus
TESTS += tests/unit/test_polhemus
tests_unit_test_polhemus_SOURCES = tests/unit/test_polhemus.c tests/unit/polhemus_make.h tests/unit/unit.h
tests_unit_test_polhemus_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_polhemus_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

if HAVE_UMOCKDEV
check_PROGRAMS += tests/unit/test_polhemus_usb
TESTS += tests/unit/test_polhemus_usb
endif
tests_unit_test_polhemus_usb_SOURCES = tests/unit/test_polhemus_usb.c \
	tests/unit/mock_polhemus.c tests/unit/mock_polhemus.h \
	tests/unit/mock_usb.c tests/unit/mock_usb.h tests/unit/polhemus_make.h $(MOCK_SOURCES)
tests_unit_test_polhemus_usb_CFLAGS = $(MOCK_CFLAGS)
tests_unit_test_polhemus_usb_LDADD = $(MOCK_LIBS)

# Fuzzers: see tests/config.mk.
EXTRA_DIST += \
	tests/fuzz/fuzz_polhemus.h tests/fuzz/fuzz_viper.c tests/fuzz/fuzz_liberty.c \
	tests/fuzz/corpus/viper/joined \
	tests/fuzz/corpus/viper/long \
	tests/fuzz/corpus/viper/poses \
	tests/fuzz/corpus/viper/replies \
	tests/fuzz/corpus/liberty/joined \
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
