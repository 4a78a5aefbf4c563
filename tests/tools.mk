# tests of tools
check_PROGRAMS += tests/unit/test_unfold tests/unit/test_room tests/unit/test_children
TESTS += tests/unit/test_unfold tests/unit/test_room tests/unit/test_children

tests_unit_test_unfold_SOURCES = tests/unit/test_unfold.c tests/unit/unit.h
tests_unit_test_unfold_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_unfold_LDADD = tools/libgtools.a $(BASE_LIBS) $(CMOCKA_LIBS)

tests_unit_test_room_SOURCES = tests/unit/test_room.c tests/unit/unit.h
tests_unit_test_room_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_room_LDADD = tools/libgtools.a $(BASE_LIBS) $(CMOCKA_LIBS)

tests_unit_test_children_SOURCES = tests/unit/test_children.c tests/unit/unit.h
tests_unit_test_children_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_children_LDADD = tools/libgtools.a $(BASE_LIBS) $(CMOCKA_LIBS)
