# tests of view: projection needs no GL
check_PROGRAMS += tests/unit/test_projection
TESTS += tests/unit/test_projection
tests_unit_test_projection_SOURCES = tests/unit/test_projection.c tests/unit/unit.h
tests_unit_test_projection_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_projection_LDADD = renderer/libgrenderer.a $(BASE_LIBS) $(CMOCKA_LIBS) -lm
