# tests of tracking
TRACKING_TESTS = tests/unit/test_tracking tests/unit/test_sim tests/unit/test_replay \
	tests/unit/test_bind tests/unit/test_device tests/unit/test_filter \
	tests/unit/test_hydra_decode tests/unit/test_align tests/unit/test_lever
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

tests_unit_test_bind_SOURCES = tests/unit/test_bind.c tests/unit/unit.h
tests_unit_test_bind_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_bind_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

tests_unit_test_device_SOURCES = tests/unit/test_device.c tests/unit/fake_device.h tests/unit/unit.h
tests_unit_test_device_CFLAGS = $(TEST_CFLAGS) -pthread
tests_unit_test_device_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

tests_unit_test_align_SOURCES = tests/unit/test_align.c tests/unit/align_room.h tests/unit/unit.h
tests_unit_test_align_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_align_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

tests_unit_test_lever_SOURCES = tests/unit/test_lever.c tests/unit/align_room.h tests/unit/unit.h \
	tests/unit/unit_config.h
tests_unit_test_lever_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_lever_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

tests_unit_test_hydra_decode_SOURCES = tests/unit/test_hydra_decode.c tests/unit/hydra_bytes.h tests/unit/unit.h
tests_unit_test_hydra_decode_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_hydra_decode_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

# Real libraries over mocked devices: the program starts itself under umockdev-wrapper.
MOCK_SOURCES = tests/unit/mock_node.c tests/unit/mock_node.h tests/unit/unit.h
MOCK_HID_SOURCES = tests/unit/mock_hid.c tests/unit/mock_hid.h $(MOCK_SOURCES)
MOCK_CFLAGS = $(TEST_CFLAGS) $(UMOCKDEV_CFLAGS) $(HIDAPI_CFLAGS) $(LIBUSB_CFLAGS) -pthread
MOCK_LIBS = $(TRACKING_LIBS) $(CMOCKA_LIBS) $(UMOCKDEV_LIBS) -lutil
MOCKED_TESTS = tests/unit/test_hydra
if HAVE_UMOCKDEV
check_PROGRAMS += $(MOCKED_TESTS)
TESTS += $(MOCKED_TESTS)
endif

tests_unit_test_hydra_SOURCES = tests/unit/test_hydra.c tests/unit/mock_hydra.c tests/unit/mock_hydra.h \
	tests/unit/hydra_bytes.h $(MOCK_HID_SOURCES)
tests_unit_test_hydra_CFLAGS = $(MOCK_CFLAGS)
tests_unit_test_hydra_LDADD = $(MOCK_LIBS)

# A master with mocked devices, and four nodes.
if HAVE_UMOCKDEV
check_PROGRAMS += tests/loopback/bed
endif
tests_loopback_bed_SOURCES = tests/loopback/bed.c tests/unit/mock_hydra.c tests/unit/mock_hydra.h \
	tests/unit/hydra_bytes.h $(MOCK_HID_SOURCES)
tests_loopback_bed_CFLAGS = $(MOCK_CFLAGS)
tests_loopback_bed_LDADD = $(MOCK_LIBS)
dist_check_SCRIPTS += tests/loopback/hydra.sh
TESTS += tests/loopback/hydra.sh

# Measured with the bench's own motions and figures.
tests_unit_test_filter_SOURCES = tests/unit/test_filter.c tests/unit/unit.h \
	tools/bench/hand.c tools/bench/hand.h \
	tools/bench/predict.c tools/bench/predict.h tools/bench/random.h \
	tools/bench/stats.c tools/bench/stats.h
tests_unit_test_filter_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_filter_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

EXTRA_DIST += \
	tests/fuzz/fuzz_hydra.c \
	tests/fuzz/corpus/hydra/docked \
	tests/fuzz/corpus/hydra/constants \
	tests/fuzz/corpus/hydra/middle \
	tests/fuzz/corpus/hydra/flips \
	tests/fuzz/corpus/hydra/short \
	tests/fuzz/fuzz_replay.c \
	tests/fuzz/corpus/replay/bad.log \
	tests/fuzz/corpus/replay/good.log \
	tests/fuzz/fuzz_survey.c \
	tests/fuzz/corpus/survey/kept \
	tests/fuzz/corpus/survey/points \
	tests/fuzz/corpus/survey/wrong

if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_replay tests/fuzz/fuzz_hydra tests/fuzz/fuzz_survey
tests_fuzz_fuzz_survey_SOURCES = tests/fuzz/fuzz_survey.c
tests_fuzz_fuzz_survey_CFLAGS = $(TEST_CFLAGS)
tests_fuzz_fuzz_survey_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_survey_LDADD = $(TRACKING_LIBS)
tests_fuzz_fuzz_hydra_SOURCES = tests/fuzz/fuzz_hydra.c tests/unit/hydra_bytes.h
tests_fuzz_fuzz_hydra_CFLAGS = $(TEST_CFLAGS)
tests_fuzz_fuzz_hydra_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_hydra_LDADD = $(TRACKING_LIBS)
tests_fuzz_fuzz_replay_SOURCES = tests/fuzz/fuzz_replay.c
tests_fuzz_fuzz_replay_CFLAGS = $(TEST_CFLAGS)
tests_fuzz_fuzz_replay_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_replay_LDADD = $(TRACKING_LIBS)
endif
