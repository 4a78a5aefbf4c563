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

check_PROGRAMS += tests/unit/test_import_files
TESTS += tests/unit/test_import_files
tests_unit_test_import_files_SOURCES = tests/unit/test_import_files.c tests/unit/unit.h \
	tests/unit/shared.h tests/unit/glb.h
tests_unit_test_import_files_CFLAGS = $(GL_TEST_CFLAGS) $(ASSIMP_CFLAGS) $(JPEG_CFLAGS)
tests_unit_test_import_files_LDADD = $(GL_TEST_LIBS)

EXTRA_DIST += tests/data/crash.fbx
check_PROGRAMS += tests/unit/test_isolate
TESTS += tests/unit/test_isolate
tests_unit_test_isolate_SOURCES = tests/unit/test_isolate.c tests/unit/unit.h
tests_unit_test_isolate_CFLAGS = $(GL_TEST_CFLAGS)
tests_unit_test_isolate_LDADD = $(GL_TEST_LIBS)

check_PROGRAMS += tests/unit/test_mesh
TESTS += tests/unit/test_mesh
tests_unit_test_mesh_SOURCES = tests/unit/test_mesh.c tests/unit/unit.h tests/unit/gl.h
tests_unit_test_mesh_CFLAGS = $(GL_TEST_CFLAGS)
tests_unit_test_mesh_LDADD = $(GL_TEST_LIBS)

check_PROGRAMS += tests/unit/test_environment
TESTS += tests/unit/test_environment
tests_unit_test_environment_SOURCES = tests/unit/test_environment.c tests/unit/unit.h tests/unit/shared.h
tests_unit_test_environment_CFLAGS = $(GL_TEST_CFLAGS)
tests_unit_test_environment_LDADD = $(GL_TEST_LIBS)

check_PROGRAMS += tests/unit/test_light_pictures
TESTS += tests/unit/test_light_pictures
tests_unit_test_light_pictures_SOURCES = tests/unit/test_light_pictures.c tests/unit/unit.h tests/unit/shared.h
tests_unit_test_light_pictures_CFLAGS = $(GL_TEST_CFLAGS)
tests_unit_test_light_pictures_LDADD = $(GL_TEST_LIBS)

check_PROGRAMS += tests/unit/test_brdf
TESTS += tests/unit/test_brdf
tests_unit_test_brdf_SOURCES = tests/unit/test_brdf.c tests/unit/unit.h tests/unit/shared.h
tests_unit_test_brdf_CFLAGS = $(GL_TEST_CFLAGS)
tests_unit_test_brdf_LDADD = $(GL_TEST_LIBS)

check_PROGRAMS += tests/unit/test_compare
TESTS += tests/unit/test_compare
tests_unit_test_compare_SOURCES = tests/unit/test_compare.c tests/unit/unit.h tests/unit/shared.h
tests_unit_test_compare_CFLAGS = $(GL_TEST_CFLAGS)
tests_unit_test_compare_LDADD = $(GL_TEST_LIBS)

check_PROGRAMS += tests/unit/test_surfaces
TESTS += tests/unit/test_surfaces
tests_unit_test_surfaces_SOURCES = tests/unit/test_surfaces.c tests/unit/unit.h tests/unit/glb.h
tests_unit_test_surfaces_CFLAGS = $(GL_TEST_CFLAGS)
tests_unit_test_surfaces_LDADD = $(GL_TEST_LIBS)

if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_projector tests/fuzz/fuzz_brdf tests/fuzz/fuzz_exr tests/fuzz/fuzz_glb tests/fuzz/fuzz_scene_block \
	tests/fuzz/fuzz_texture
endif
tests_fuzz_fuzz_projector_SOURCES = tests/fuzz/fuzz_projector.c
tests_fuzz_fuzz_projector_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS)
tests_fuzz_fuzz_projector_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_projector_LDADD = $(RENDERER_LIBS)
tests_fuzz_fuzz_brdf_SOURCES = tests/fuzz/fuzz_brdf.c
tests_fuzz_fuzz_brdf_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS)
tests_fuzz_fuzz_brdf_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_brdf_LDADD = $(RENDERER_LIBS)
tests_fuzz_fuzz_exr_SOURCES = tests/fuzz/fuzz_exr.c
tests_fuzz_fuzz_exr_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS)
tests_fuzz_fuzz_exr_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_exr_LDADD = $(RENDERER_LIBS)
tests_fuzz_fuzz_glb_SOURCES = tests/fuzz/fuzz_glb.c
tests_fuzz_fuzz_glb_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(ASSIMP_CFLAGS)
tests_fuzz_fuzz_glb_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_glb_LDADD = $(RENDERER_LIBS)
tests_fuzz_fuzz_scene_block_SOURCES = tests/fuzz/fuzz_scene_block.c
tests_fuzz_fuzz_scene_block_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS)
tests_fuzz_fuzz_scene_block_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_scene_block_LDADD = $(RENDERER_LIBS)
tests_fuzz_fuzz_texture_SOURCES = tests/fuzz/fuzz_texture.c
tests_fuzz_fuzz_texture_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(ASSIMP_CFLAGS)
tests_fuzz_fuzz_texture_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_texture_LDADD = $(RENDERER_LIBS)

# What the fuzzers of renderer/scene and renderer/image start from.
EXTRA_DIST += \
	tests/fuzz/corpus/brdf/small.brdf \
	tests/fuzz/corpus/brdf/cut.brdf \
	tests/fuzz/corpus/exr/zip-float.exr \
	tests/fuzz/corpus/exr/planes.hdr \
	tests/fuzz/corpus/exr/runs.hdr \
	tests/fuzz/corpus/projector/table \
	tests/fuzz/corpus/glb/image-type.glb \
	tests/fuzz/corpus/glb/textured.glb \
	tests/fuzz/corpus/texture/baseline.jpg \
	tests/fuzz/corpus/texture/progressive.jpg \
	tests/fuzz/corpus/texture/rgb.png

check_PROGRAMS += tests/unit/test_timer
TESTS += tests/unit/test_timer
tests_unit_test_timer_SOURCES = tests/unit/test_timer.c tests/unit/unit.h tests/unit/gl.h
tests_unit_test_timer_CFLAGS = $(TEST_CFLAGS) $(EPOXY_CFLAGS)
tests_unit_test_timer_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)
