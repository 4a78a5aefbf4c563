# tests of protocol/: links base/ and protocol/ alone
PROTOCOL_TEST_CFLAGS = $(TEST_CFLAGS) $(SODIUM_CFLAGS) $(LZO_CFLAGS)
PROTOCOL_TEST_LDADD = $(PROTOCOL_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_cluster
TESTS += tests/unit/test_cluster
tests_unit_test_cluster_SOURCES = tests/unit/test_cluster.c \
	tests/unit/cluster_sim.c tests/unit/cluster_sim.h tests/unit/unit.h
tests_unit_test_cluster_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_cluster_LDADD = $(PROTOCOL_TEST_LDADD)
