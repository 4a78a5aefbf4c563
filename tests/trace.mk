# tests of renderer/trace
TRACE_TEST_SHARED = tests/accuracy/closed.h tests/accuracy/cornell.h tests/unit/shared.h tests/unit/unit.h

check_PROGRAMS += tests/accuracy/test_reference_closed
TESTS += tests/accuracy/test_reference_closed
tests_accuracy_test_reference_closed_SOURCES = tests/accuracy/test_reference_closed.c \
	$(TRACE_TEST_SHARED)
tests_accuracy_test_reference_closed_CFLAGS = $(TEST_CFLAGS)
tests_accuracy_test_reference_closed_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_trace
TESTS += tests/unit/test_trace
tests_unit_test_trace_SOURCES = tests/unit/test_trace.c tests/unit/unit.h
tests_unit_test_trace_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_trace_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/accuracy/test_reference_cases
TESTS += tests/accuracy/test_reference_cases
tests_accuracy_test_reference_cases_SOURCES = tests/accuracy/test_reference_cases.c \
	$(TRACE_TEST_SHARED) $(LATTICE_ROOM_SOURCES)
tests_accuracy_test_reference_cases_CFLAGS = $(TEST_CFLAGS)
tests_accuracy_test_reference_cases_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/accuracy/test_reference_speed
TESTS += tests/accuracy/test_reference_speed
tests_accuracy_test_reference_speed_SOURCES = tests/accuracy/test_reference_speed.c $(TRACE_TEST_SHARED)
tests_accuracy_test_reference_speed_CFLAGS = $(TEST_CFLAGS)
tests_accuracy_test_reference_speed_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)

# Files of sums, from outside
if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_film
endif
tests_fuzz_fuzz_film_SOURCES = tests/fuzz/fuzz_film.c
tests_fuzz_fuzz_film_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS)
tests_fuzz_fuzz_film_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_film_LDADD = $(RENDERER_LIBS)
EXTRA_DIST += tests/fuzz/corpus/film/denormal-mean.film tests/fuzz/corpus/film/huge-sums.film tests/fuzz/corpus/film/two-pixels.film

dist_check_SCRIPTS += tests/command/reference.sh
TESTS += tests/command/reference.sh
