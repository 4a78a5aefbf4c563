# tests of renderer/gl, renderer/scene, renderer/image and scenes/
GL_TEST_CFLAGS = $(TEST_CFLAGS) $(EPOXY_CFLAGS) $(OPENEXR_CFLAGS) $(PNG_CFLAGS)
GL_TEST_LIBS = $(RENDERER_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_target tests/unit/test_program
TESTS += tests/unit/test_target tests/unit/test_program tests/unit/window.sh
EXTRA_DIST += tests/unit/window.sh

tests_unit_test_target_SOURCES = tests/unit/test_target.c tests/unit/unit.h tests/unit/gl.h
tests_unit_test_target_CFLAGS = $(GL_TEST_CFLAGS)
tests_unit_test_target_LDADD = $(GL_TEST_LIBS)

tests_unit_test_program_SOURCES = tests/unit/test_program.c tests/unit/unit.h tests/unit/gl.h
tests_unit_test_program_CFLAGS = $(GL_TEST_CFLAGS)
tests_unit_test_program_LDADD = $(GL_TEST_LIBS)

check_PROGRAMS += tests/unit/test_image
TESTS += tests/unit/test_image
tests_unit_test_image_SOURCES = tests/unit/test_image.c tests/unit/unit.h tests/unit/shared.h
tests_unit_test_image_CFLAGS = $(GL_TEST_CFLAGS)
tests_unit_test_image_LDADD = $(GL_TEST_LIBS)

check_PROGRAMS += tests/unit/test_import
TESTS += tests/unit/test_import
tests_unit_test_import_SOURCES = tests/unit/test_import.c tests/unit/unit.h tests/unit/shared.h \
	tests/unit/glb.h
tests_unit_test_import_CFLAGS = $(GL_TEST_CFLAGS) $(ASSIMP_CFLAGS) $(JPEG_CFLAGS)
tests_unit_test_import_LDADD = $(GL_TEST_LIBS)
