# tests of config/: links nothing but base/ and config/
check_PROGRAMS += tests/unit/test_options
TESTS += tests/unit/test_options

tests_unit_test_options_SOURCES = tests/unit/test_options.c tests/unit/unit.h tests/unit/unit_config.h
tests_unit_test_options_CFLAGS = $(TEST_CFLAGS) $(LIBCONFIG_CFLAGS)
tests_unit_test_options_LDADD = $(CONFIG_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_layout
TESTS += tests/unit/test_layout
tests_unit_test_layout_SOURCES = tests/unit/test_layout.c tests/unit/unit.h tests/unit/unit_config.h
tests_unit_test_layout_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_layout_LDADD = $(CONFIG_LIBS) $(CMOCKA_LIBS)
