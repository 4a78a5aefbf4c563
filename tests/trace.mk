# tests of renderer/trace
TRACE_TEST_SHARED = tests/accuracy/closed.h tests/accuracy/cornell.h tests/unit/shared.h tests/unit/unit.h

check_PROGRAMS += tests/accuracy/test_reference_closed
TESTS += tests/accuracy/test_reference_closed
tests_accuracy_test_reference_closed_SOURCES = tests/accuracy/test_reference_closed.c \
	$(TRACE_TEST_SHARED)
tests_accuracy_test_reference_closed_CFLAGS = $(TEST_CFLAGS)
tests_accuracy_test_reference_closed_LDADD = $(RENDERER_LIBS) $(CMOCKA_LIBS)
