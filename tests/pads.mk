# tests of gamepads, Sony's pads and SpaceMouse; MOCK_* are tests/tracking.mk's
PADS_TESTS = tests/unit/test_hid_descriptor tests/unit/test_sony tests/unit/test_imu \
	tests/unit/test_spacemouse
check_PROGRAMS += $(PADS_TESTS)
TESTS += $(PADS_TESTS)

tests_unit_test_hid_descriptor_SOURCES = tests/unit/test_hid_descriptor.c tests/unit/hid_items.h \
	tests/unit/unit.h
tests_unit_test_hid_descriptor_CFLAGS = $(TEST_CFLAGS) $(HIDAPI_CFLAGS)
tests_unit_test_hid_descriptor_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)
tests_unit_test_sony_SOURCES = tests/unit/test_sony.c tests/unit/sony_bytes.h tests/unit/unit.h
tests_unit_test_sony_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_sony_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)
tests_unit_test_imu_SOURCES = tests/unit/test_imu.c tests/unit/unit.h
tests_unit_test_imu_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_imu_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)
tests_unit_test_spacemouse_SOURCES = tests/unit/test_spacemouse.c tests/unit/unit.h
tests_unit_test_spacemouse_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_spacemouse_LDADD = $(TRACKING_LIBS) $(CMOCKA_LIBS)

if HAVE_UMOCKDEV
check_PROGRAMS += tests/unit/test_pads tests/unit/test_pads_room
TESTS += tests/unit/test_pads tests/unit/test_pads_room
endif
tests_unit_test_pads_SOURCES = tests/unit/test_pads.c tests/unit/pads_fixture.h \
	tests/unit/hid_items.h tests/unit/sony_bytes.h $(MOCK_HID_SOURCES)
tests_unit_test_pads_CFLAGS = $(MOCK_CFLAGS)
tests_unit_test_pads_LDADD = $(MOCK_LIBS)
tests_unit_test_pads_room_SOURCES = tests/unit/test_pads_room.c tests/unit/pads_fixture.h \
	tests/unit/hid_items.h tests/unit/sony_bytes.h tests/unit/unit_config.h $(MOCK_HID_SOURCES)
tests_unit_test_pads_room_CFLAGS = $(MOCK_CFLAGS)
tests_unit_test_pads_room_LDADD = $(tests_unit_test_trackers_LDADD) $(UMOCKDEV_LIBS) -lutil

# Fuzzers: see tests/config.mk.
EXTRA_DIST += \
	tests/fuzz/fuzz_gamepad.c tests/fuzz/fuzz_pads.c \
	tests/fuzz/corpus/gamepad/array \
	tests/fuzz/corpus/gamepad/axes \
	tests/fuzz/corpus/gamepad/bad-end \
	tests/fuzz/corpus/gamepad/bad-endless \
	tests/fuzz/corpus/gamepad/bad-five \
	tests/fuzz/corpus/gamepad/bad-hat \
	tests/fuzz/corpus/gamepad/bad-item \
	tests/fuzz/corpus/gamepad/bad-length \
	tests/fuzz/corpus/gamepad/bad-long \
	tests/fuzz/corpus/gamepad/bad-many \
	tests/fuzz/corpus/gamepad/bad-many-axes \
	tests/fuzz/corpus/gamepad/bad-many-buttons \
	tests/fuzz/corpus/gamepad/bad-many-hats \
	tests/fuzz/corpus/gamepad/bad-maximum \
	tests/fuzz/corpus/gamepad/bad-minimum \
	tests/fuzz/corpus/gamepad/bad-nest \
	tests/fuzz/corpus/gamepad/bad-none \
	tests/fuzz/corpus/gamepad/bad-number0 \
	tests/fuzz/corpus/gamepad/bad-numberless \
	tests/fuzz/corpus/gamepad/bad-open \
	tests/fuzz/corpus/gamepad/bad-order \
	tests/fuzz/corpus/gamepad/bad-pop \
	tests/fuzz/corpus/gamepad/bad-popped \
	tests/fuzz/corpus/gamepad/bad-pushes \
	tests/fuzz/corpus/gamepad/bad-range \
	tests/fuzz/corpus/gamepad/bad-usages \
	tests/fuzz/corpus/gamepad/bad-wide \
	tests/fuzz/corpus/gamepad/dpad \
	tests/fuzz/corpus/gamepad/dualshock4 \
	tests/fuzz/corpus/gamepad/forms \
	tests/fuzz/corpus/gamepad/hat \
	tests/fuzz/corpus/gamepad/named \
	tests/fuzz/corpus/gamepad/pedals \
	tests/fuzz/corpus/gamepad/sliders \
	tests/fuzz/corpus/gamepad/two \
	tests/fuzz/corpus/pads/cap \
	tests/fuzz/corpus/pads/clock-stands \
	tests/fuzz/corpus/pads/dualsense-bluetooth \
	tests/fuzz/corpus/pads/dualsense-bluetooth-sum \
	tests/fuzz/corpus/pads/dualsense-usb \
	tests/fuzz/corpus/pads/dualshock4-bluetooth \
	tests/fuzz/corpus/pads/dualshock4-bluetooth-sum \
	tests/fuzz/corpus/pads/dualshock4-usb \
	tests/fuzz/corpus/pads/long-rest \
	tests/fuzz/corpus/pads/nose-down \
	tests/fuzz/corpus/pads/rest \
	tests/fuzz/corpus/pads/upside-down
if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_gamepad tests/fuzz/fuzz_pads
tests_fuzz_fuzz_gamepad_SOURCES = tests/fuzz/fuzz_gamepad.c
tests_fuzz_fuzz_gamepad_CFLAGS = $(TEST_CFLAGS)
tests_fuzz_fuzz_gamepad_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_gamepad_LDADD = $(TRACKING_LIBS)
tests_fuzz_fuzz_pads_SOURCES = tests/fuzz/fuzz_pads.c tests/unit/sony_bytes.h
tests_fuzz_fuzz_pads_CFLAGS = $(TEST_CFLAGS)
tests_fuzz_fuzz_pads_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_pads_LDADD = $(TRACKING_LIBS)
endif
