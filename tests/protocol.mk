# tests of protocol/: links base/ and protocol/ alone
PROTOCOL_TEST_CFLAGS = $(TEST_CFLAGS) $(SODIUM_CFLAGS) $(LZO_CFLAGS)
PROTOCOL_TEST_LDADD = $(PROTOCOL_LIBS) $(CMOCKA_LIBS)

PROTOCOL_TESTS = \
	tests/unit/test_cluster \
	tests/unit/test_fragment \
	tests/unit/test_key \
	tests/unit/test_pack \
	tests/unit/test_params \
	tests/unit/test_peer \
	tests/unit/test_wire
check_PROGRAMS += $(PROTOCOL_TESTS)
TESTS += $(PROTOCOL_TESTS)

tests_unit_test_cluster_SOURCES = tests/unit/test_cluster.c \
	tests/unit/cluster_sim.c tests/unit/cluster_sim.h tests/unit/unit.h
tests_unit_test_cluster_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_cluster_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_fragment_SOURCES = tests/unit/test_fragment.c tests/unit/unit.h
tests_unit_test_fragment_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_fragment_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_key_SOURCES = tests/unit/test_key.c tests/unit/unit.h
tests_unit_test_key_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_key_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_pack_SOURCES = tests/unit/test_pack.c tests/unit/unit.h
tests_unit_test_pack_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_pack_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_params_SOURCES = tests/unit/test_params.c tests/unit/unit.h
tests_unit_test_params_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_params_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_peer_SOURCES = tests/unit/test_peer.c tests/unit/unit.h
tests_unit_test_peer_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_peer_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_wire_SOURCES = tests/unit/test_wire.c tests/unit/unit.h
tests_unit_test_wire_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_wire_LDADD = $(PROTOCOL_TEST_LDADD)
