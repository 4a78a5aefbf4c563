# tests of view: projection needs no GL
check_PROGRAMS += tests/unit/test_projection
TESTS += tests/unit/test_projection
tests_unit_test_projection_SOURCES = tests/unit/test_projection.c tests/unit/unit.h \
	tests/unit/shared.h
tests_unit_test_projection_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_projection_LDADD = renderer/libgrenderer.a $(BASE_LIBS) $(CMOCKA_LIBS) -lm

# the others draw, and skip (77) where there is no OpenGL 4.5
VIEW_TEST_CFLAGS = $(TEST_CFLAGS) $(EPOXY_CFLAGS) $(OPENEXR_CFLAGS) $(PNG_CFLAGS)
VIEW_TEST_SHARED = tests/accuracy/cornell.h tests/unit/unit.h tests/unit/gl.h tests/unit/shared.h
VIEW_TEST_LIBS = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm

check_PROGRAMS += tests/accuracy/test_direct
TESTS += tests/accuracy/test_direct
tests_accuracy_test_direct_SOURCES = tests/accuracy/test_direct.c $(VIEW_TEST_SHARED)
tests_accuracy_test_direct_CFLAGS = $(VIEW_TEST_CFLAGS)
tests_accuracy_test_direct_LDADD = $(VIEW_TEST_LIBS)

check_PROGRAMS += tests/accuracy/test_seam
TESTS += tests/accuracy/test_seam
tests_accuracy_test_seam_SOURCES = tests/accuracy/test_seam.c $(VIEW_TEST_SHARED)
tests_accuracy_test_seam_CFLAGS = $(VIEW_TEST_CFLAGS)
tests_accuracy_test_seam_LDADD = $(VIEW_TEST_LIBS)

# on the CPU alone
check_PROGRAMS += tests/unit/test_projector
TESTS += tests/unit/test_projector
tests_unit_test_projector_SOURCES = tests/unit/test_projector.c tests/unit/unit.h
tests_unit_test_projector_CFLAGS = $(TEST_CFLAGS) $(LIBCONFIG_CFLAGS)
tests_unit_test_projector_LDADD = $(VIEW_TEST_LIBS)

check_PROGRAMS += tests/accuracy/test_curves
TESTS += tests/accuracy/test_curves
tests_accuracy_test_curves_SOURCES = tests/accuracy/test_curves.c tests/unit/unit.h tests/unit/shared.h
tests_accuracy_test_curves_CFLAGS = $(TEST_CFLAGS)
tests_accuracy_test_curves_LDADD = $(VIEW_TEST_LIBS)

check_PROGRAMS += tests/accuracy/test_sky
TESTS += tests/accuracy/test_sky
tests_accuracy_test_sky_SOURCES = tests/accuracy/test_sky.c tests/unit/unit.h tests/unit/shared.h
tests_accuracy_test_sky_CFLAGS = $(TEST_CFLAGS) $(LIBCONFIG_CFLAGS)
tests_accuracy_test_sky_LDADD = $(VIEW_TEST_LIBS)

check_PROGRAMS += tests/accuracy/test_sh
TESTS += tests/accuracy/test_sh
tests_accuracy_test_sh_SOURCES = tests/accuracy/test_sh.c tests/unit/unit.h tests/unit/gl.h tests/unit/shared.h
tests_accuracy_test_sh_CFLAGS = $(VIEW_TEST_CFLAGS)
tests_accuracy_test_sh_LDADD = $(VIEW_TEST_LIBS)

check_PROGRAMS += tests/accuracy/test_tone
TESTS += tests/accuracy/test_tone
tests_accuracy_test_tone_SOURCES = tests/accuracy/test_tone.c $(VIEW_TEST_SHARED)
tests_accuracy_test_tone_CFLAGS = $(VIEW_TEST_CFLAGS)
tests_accuracy_test_tone_LDADD = $(VIEW_TEST_LIBS)

check_PROGRAMS += tests/accuracy/test_stereo
TESTS += tests/accuracy/test_stereo
tests_accuracy_test_stereo_SOURCES = tests/accuracy/test_stereo.c $(VIEW_TEST_SHARED)
tests_accuracy_test_stereo_CFLAGS = $(VIEW_TEST_CFLAGS)
tests_accuracy_test_stereo_LDADD = $(VIEW_TEST_LIBS)

check_PROGRAMS += tests/accuracy/test_hud
TESTS += tests/accuracy/test_hud
tests_accuracy_test_hud_SOURCES = tests/accuracy/test_hud.c $(VIEW_TEST_SHARED)
tests_accuracy_test_hud_CFLAGS = $(VIEW_TEST_CFLAGS)
tests_accuracy_test_hud_LDADD = $(VIEW_TEST_LIBS)

check_PROGRAMS += tests/accuracy/test_rsm
TESTS += tests/accuracy/test_rsm
tests_accuracy_test_rsm_SOURCES = tests/accuracy/test_rsm.c $(VIEW_TEST_SHARED)
tests_accuracy_test_rsm_CFLAGS = $(VIEW_TEST_CFLAGS)
tests_accuracy_test_rsm_LDADD = $(VIEW_TEST_LIBS)

check_PROGRAMS += tests/accuracy/test_backdrop
TESTS += tests/accuracy/test_backdrop
tests_accuracy_test_backdrop_SOURCES = tests/accuracy/test_backdrop.c $(VIEW_TEST_SHARED)
tests_accuracy_test_backdrop_CFLAGS = $(VIEW_TEST_CFLAGS)
tests_accuracy_test_backdrop_LDADD = $(VIEW_TEST_LIBS)

check_PROGRAMS += tests/accuracy/test_gaze
TESTS += tests/accuracy/test_gaze
tests_accuracy_test_gaze_SOURCES = tests/accuracy/test_gaze.c tests/unit/gl.h tests/unit/unit.h
tests_accuracy_test_gaze_CFLAGS = $(VIEW_TEST_CFLAGS)
tests_accuracy_test_gaze_LDADD = $(VIEW_TEST_LIBS)

# scenes and lamps that nobody would have, through every method
HARD_SOURCES = tests/accuracy/hard/model.c tests/accuracy/hard/model.h \
	tests/accuracy/hard/room.c tests/accuracy/hard/room.h tests/unit/glb.h tests/unit/unit.h
check_PROGRAMS += tests/accuracy/test_hard_light tests/accuracy/test_hard_scenes
TESTS += tests/accuracy/test_hard_light tests/accuracy/test_hard_scenes
tests_accuracy_test_hard_light_SOURCES = tests/accuracy/test_hard_light.c $(HARD_SOURCES)
tests_accuracy_test_hard_light_CFLAGS = $(VIEW_TEST_CFLAGS)
tests_accuracy_test_hard_light_LDADD = $(VIEW_TEST_LIBS)
check_PROGRAMS += tests/accuracy/test_hard_air
TESTS += tests/accuracy/test_hard_air
tests_accuracy_test_hard_air_SOURCES = tests/accuracy/test_hard_air.c $(HARD_SOURCES)
tests_accuracy_test_hard_air_CFLAGS = $(VIEW_TEST_CFLAGS)
tests_accuracy_test_hard_air_LDADD = $(VIEW_TEST_LIBS)
tests_accuracy_test_hard_scenes_SOURCES = tests/accuracy/test_hard_scenes.c $(HARD_SOURCES)
tests_accuracy_test_hard_scenes_CFLAGS = $(VIEW_TEST_CFLAGS)
tests_accuracy_test_hard_scenes_LDADD = $(VIEW_TEST_LIBS)
