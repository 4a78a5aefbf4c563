# tests of gi
GI_TEST_SOURCES = tests/accuracy/room.c tests/accuracy/room.h \
	tests/accuracy/truth.c tests/accuracy/truth.h
GI_GL_TEST_SOURCES = $(GI_TEST_SOURCES) tests/accuracy/lpv_bench.c tests/accuracy/lpv_bench.h

check_PROGRAMS += tests/unit/test_lattice_math tests/accuracy/test_lpv_gl
TESTS += tests/unit/test_lattice_math tests/accuracy/test_lpv_gl
tests_unit_test_lattice_math_SOURCES = tests/unit/test_lattice_math.c tests/unit/unit.h \
	$(GI_TEST_SOURCES)
tests_unit_test_lattice_math_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_lattice_math_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

tests_accuracy_test_lpv_gl_SOURCES = tests/accuracy/test_lpv_gl.c tests/unit/unit.h \
	$(GI_GL_TEST_SOURCES)
tests_accuracy_test_lpv_gl_CFLAGS = $(TEST_CFLAGS) $(EPOXY_CFLAGS)
tests_accuracy_test_lpv_gl_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/accuracy/test_holes
TESTS += tests/accuracy/test_holes
tests_accuracy_test_holes_SOURCES = tests/accuracy/test_holes.c tests/unit/unit.h \
	tests/unit/shared.h
tests_accuracy_test_holes_CFLAGS = $(TEST_CFLAGS) $(EPOXY_CFLAGS) $(OPENEXR_CFLAGS)
tests_accuracy_test_holes_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm

# Cost and error of the lattice; takes a minute, so not a test.
# `grotto bench lattice` starts it.
pkglibexec_PROGRAMS = tools/bench-lattice
tools_bench_lattice_SOURCES = tools/bench_lattice.c $(GI_GL_TEST_SOURCES)
tools_bench_lattice_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(EPOXY_CFLAGS)
tools_bench_lattice_LDADD = $(RENDERER_LIBS)
