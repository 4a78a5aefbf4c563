# tests of gi
check_PROGRAMS += tests/unit/test_lattice_math tests/accuracy/test_lpv_gl
TESTS += tests/unit/test_lattice_math tests/accuracy/test_lpv_gl
tests_unit_test_lattice_math_SOURCES = tests/unit/test_lattice_math.c tests/unit/unit.h \
	$(LATTICE_ROOM_SOURCES)
tests_unit_test_lattice_math_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_lattice_math_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

tests_accuracy_test_lpv_gl_SOURCES = tests/accuracy/test_lpv_gl.c tests/unit/unit.h \
	$(LATTICE_BENCH_SOURCES)
tests_accuracy_test_lpv_gl_CFLAGS = $(TEST_CFLAGS) $(EPOXY_CFLAGS)
tests_accuracy_test_lpv_gl_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/accuracy/test_holes
TESTS += tests/accuracy/test_holes
tests_accuracy_test_holes_SOURCES = tests/accuracy/test_holes.c tests/unit/unit.h \
	tests/unit/shared.h
tests_accuracy_test_holes_CFLAGS = $(TEST_CFLAGS) $(EPOXY_CFLAGS) $(OPENEXR_CFLAGS)
tests_accuracy_test_holes_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm

check_PROGRAMS += tests/accuracy/test_surfels
TESTS += tests/accuracy/test_surfels
tests_accuracy_test_surfels_SOURCES = tests/accuracy/test_surfels.c tests/unit/unit.h \
	$(SURFEL_BENCH_SOURCES)
tests_accuracy_test_surfels_CFLAGS = $(TEST_CFLAGS)
tests_accuracy_test_surfels_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

BAKED_ROOM_SOURCES = tests/unit/baked_room.c tests/unit/baked_room.h tests/unit/unit.h \
	$(LATTICE_ROOM_SOURCES)
check_PROGRAMS += tests/unit/test_surfel_file
TESTS += tests/unit/test_surfel_file
tests_unit_test_surfel_file_SOURCES = tests/unit/test_surfel_file.c $(BAKED_ROOM_SOURCES)
tests_unit_test_surfel_file_CFLAGS = $(TEST_CFLAGS) $(SODIUM_CFLAGS)
tests_unit_test_surfel_file_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_surfel_store
TESTS += tests/unit/test_surfel_store
tests_unit_test_surfel_store_SOURCES = tests/unit/test_surfel_store.c $(BAKED_ROOM_SOURCES)
tests_unit_test_surfel_store_CFLAGS = $(TEST_CFLAGS) $(SODIUM_CFLAGS)
tests_unit_test_surfel_store_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_plan tests/unit/test_plan_code
TESTS += tests/unit/test_plan tests/unit/test_plan_code
PLAN_TEST_SOURCES = tests/unit/plan_cases.h tests/unit/unit.h
tests_unit_test_plan_SOURCES = tests/unit/test_plan.c $(PLAN_TEST_SOURCES)
tests_unit_test_plan_code_SOURCES = tests/unit/test_plan_code.c $(PLAN_TEST_SOURCES)
tests_unit_test_plan_code_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_plan_code_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm
tests_unit_test_plan_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_plan_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm

SURFELS_GL_SOURCES = tests/accuracy/surfels_gl.c tests/accuracy/surfels_gl.h tests/unit/unit.h \
	$(SURFEL_RIG_SOURCES)
check_PROGRAMS += tests/accuracy/test_surfels_gl
TESTS += tests/accuracy/test_surfels_gl
tests_accuracy_test_surfels_gl_SOURCES = tests/accuracy/test_surfels_gl.c $(SURFELS_GL_SOURCES)
tests_accuracy_test_surfels_gl_CFLAGS = $(TEST_CFLAGS) $(CGLM_CFLAGS) $(EPOXY_CFLAGS)
tests_accuracy_test_surfels_gl_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm
check_PROGRAMS += tests/accuracy/test_surfels_lamps_gl
TESTS += tests/accuracy/test_surfels_lamps_gl
tests_accuracy_test_surfels_lamps_gl_SOURCES = tests/accuracy/test_surfels_lamps_gl.c $(SURFELS_GL_SOURCES)
tests_accuracy_test_surfels_lamps_gl_CFLAGS = $(TEST_CFLAGS) $(CGLM_CFLAGS) $(EPOXY_CFLAGS)
tests_accuracy_test_surfels_lamps_gl_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm
check_PROGRAMS += tests/accuracy/test_surfels_flicker_gl
TESTS += tests/accuracy/test_surfels_flicker_gl
tests_accuracy_test_surfels_flicker_gl_SOURCES = tests/accuracy/test_surfels_flicker_gl.c $(SURFELS_GL_SOURCES)
tests_accuracy_test_surfels_flicker_gl_CFLAGS = $(TEST_CFLAGS) $(CGLM_CFLAGS) $(EPOXY_CFLAGS)
tests_accuracy_test_surfels_flicker_gl_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm
check_PROGRAMS += tests/accuracy/test_surfels_nonfinite_gl
TESTS += tests/accuracy/test_surfels_nonfinite_gl
tests_accuracy_test_surfels_nonfinite_gl_SOURCES = tests/accuracy/test_surfels_nonfinite_gl.c $(SURFELS_GL_SOURCES)
tests_accuracy_test_surfels_nonfinite_gl_CFLAGS = $(TEST_CFLAGS) $(CGLM_CFLAGS) $(EPOXY_CFLAGS)
tests_accuracy_test_surfels_nonfinite_gl_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm
check_PROGRAMS += tests/accuracy/test_surfels_share_gl
TESTS += tests/accuracy/test_surfels_share_gl
tests_accuracy_test_surfels_share_gl_SOURCES = tests/accuracy/test_surfels_share_gl.c $(SURFELS_GL_SOURCES)
tests_accuracy_test_surfels_share_gl_CFLAGS = $(TEST_CFLAGS) $(CGLM_CFLAGS) $(EPOXY_CFLAGS)
tests_accuracy_test_surfels_share_gl_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm

check_PROGRAMS += tests/unit/test_costs_file
TESTS += tests/unit/test_costs_file
tests_unit_test_costs_file_SOURCES = tests/unit/test_costs_file.c tests/unit/unit.h
tests_unit_test_costs_file_CFLAGS = $(TEST_CFLAGS) $(SODIUM_CFLAGS)
tests_unit_test_costs_file_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_calibrate
TESTS += tests/unit/test_calibrate
tests_unit_test_calibrate_SOURCES = tests/unit/test_calibrate.c tests/unit/unit.h tests/unit/gl.h
tests_unit_test_calibrate_CFLAGS = $(TEST_CFLAGS) $(SODIUM_CFLAGS)
tests_unit_test_calibrate_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm

check_PROGRAMS += tests/unit/test_surfel_bake
TESTS += tests/unit/test_surfel_bake
tests_unit_test_surfel_bake_SOURCES = tests/unit/test_surfel_bake.c tests/unit/unit.h \
	$(LATTICE_ROOM_SOURCES)
tests_unit_test_surfel_bake_CFLAGS = $(TEST_CFLAGS) $(SODIUM_CFLAGS)
tests_unit_test_surfel_bake_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_costs_file tests/fuzz/fuzz_surfel_file
endif
tests_fuzz_fuzz_surfel_file_SOURCES = tests/fuzz/fuzz_surfel_file.c
tests_fuzz_fuzz_surfel_file_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(SODIUM_CFLAGS)
tests_fuzz_fuzz_surfel_file_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_surfel_file_LDADD = $(RENDERER_LIBS)
EXTRA_DIST += tests/fuzz/corpus/surfels/quad.surfels
tests_fuzz_fuzz_costs_file_SOURCES = tests/fuzz/fuzz_costs_file.c
tests_fuzz_fuzz_costs_file_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(SODIUM_CFLAGS)
tests_fuzz_fuzz_costs_file_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_costs_file_LDADD = $(RENDERER_LIBS)
EXTRA_DIST += tests/fuzz/corpus/costs/fuzz.txt
