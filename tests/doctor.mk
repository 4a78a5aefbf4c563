# tests of grotto doctor
check_PROGRAMS += tests/unit/test_doctor
TESTS += tests/unit/test_doctor
tests_unit_test_doctor_SOURCES = tests/unit/test_doctor.c tests/unit/unit.h
tests_unit_test_doctor_CFLAGS = $(TEST_CFLAGS) $(JSONC_CFLAGS) $(CGLM_CFLAGS)
tests_unit_test_doctor_LDADD = $(DOCTOR_LIBS) $(CONFIG_LIBS) $(JSONC_LIBS) $(CMOCKA_LIBS)

# Needs no OpenGL; without network namespaces of its own a part of it is left out.
dist_check_SCRIPTS += tests/command/doctor.sh
TESTS += tests/command/doctor.sh
