# tests of config/: links nothing but base/ and config/
check_PROGRAMS += tests/unit/test_options
TESTS += tests/unit/test_options

tests_unit_test_options_SOURCES = tests/unit/test_options.c tests/unit/unit.h tests/unit/unit_config.h
tests_unit_test_options_CFLAGS = $(TEST_CFLAGS) $(LIBCONFIG_CFLAGS)
tests_unit_test_options_LDADD = $(CONFIG_LIBS) $(CMOCKA_LIBS)

LAYOUT_TEXT_SOURCES = tests/unit/layout_text.h tests/unit/unit.h tests/unit/unit_config.h
check_PROGRAMS += tests/unit/test_layout
TESTS += tests/unit/test_layout
tests_unit_test_layout_SOURCES = tests/unit/test_layout.c $(LAYOUT_TEXT_SOURCES)
tests_unit_test_layout_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_layout_LDADD = $(CONFIG_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_layout_items
TESTS += tests/unit/test_layout_items
tests_unit_test_layout_items_SOURCES = tests/unit/test_layout_items.c $(LAYOUT_TEXT_SOURCES)
tests_unit_test_layout_items_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_layout_items_LDADD = $(CONFIG_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_layout_trackers
TESTS += tests/unit/test_layout_trackers
tests_unit_test_layout_trackers_SOURCES = tests/unit/test_layout_trackers.c $(LAYOUT_TEXT_SOURCES)
tests_unit_test_layout_trackers_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_layout_trackers_LDADD = $(CONFIG_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_layout_edit
TESTS += tests/unit/test_layout_edit
tests_unit_test_layout_edit_SOURCES = tests/unit/test_layout_edit.c $(LAYOUT_TEXT_SOURCES)
tests_unit_test_layout_edit_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_layout_edit_LDADD = $(CONFIG_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_layout_networks
TESTS += tests/unit/test_layout_networks
tests_unit_test_layout_networks_SOURCES = tests/unit/test_layout_networks.c $(LAYOUT_TEXT_SOURCES)
tests_unit_test_layout_networks_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_layout_networks_LDADD = $(CONFIG_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_layout_walls
TESTS += tests/unit/test_layout_walls
tests_unit_test_layout_walls_SOURCES = tests/unit/test_layout_walls.c $(LAYOUT_TEXT_SOURCES)
tests_unit_test_layout_walls_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_layout_walls_LDADD = $(CONFIG_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_scene_file
TESTS += tests/unit/test_scene_file
tests_unit_test_scene_file_SOURCES = tests/unit/test_scene_file.c tests/unit/unit.h \
	tests/unit/unit_config.h
tests_unit_test_scene_file_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_scene_file_LDADD = $(CONFIG_LIBS) $(CMOCKA_LIBS)

# Fuzzers: ./configure --enable-fuzzers CC=clang, then for example
#   make tests/fuzz/fuzz_layout && tests/fuzz/fuzz_layout -max_total_time=60 CORPUS
# where CORPUS is a copy of tests/fuzz/corpus/layout. What crashes stays there.
EXTRA_DIST += \
	tests/fuzz/corpus/layout/cave4.cave \
	tests/fuzz/corpus/layout/devices.cave \
	tests/fuzz/corpus/layout/full.cave \
	tests/fuzz/corpus/layout/faults.cave \
	tests/fuzz/corpus/scene/faults.scene \
	tests/fuzz/corpus/scene/full.scene \
	tests/fuzz/corpus/scene/sky.scene
if FUZZERS
check_PROGRAMS += tests/fuzz/fuzz_layout tests/fuzz/fuzz_scene_file
endif
tests_fuzz_fuzz_layout_SOURCES = tests/fuzz/fuzz_layout.c
tests_fuzz_fuzz_layout_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS)
tests_fuzz_fuzz_layout_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_layout_LDADD = $(CONFIG_LIBS)
tests_fuzz_fuzz_scene_file_SOURCES = tests/fuzz/fuzz_scene_file.c
tests_fuzz_fuzz_scene_file_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS)
tests_fuzz_fuzz_scene_file_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_scene_file_LDADD = $(CONFIG_LIBS)
