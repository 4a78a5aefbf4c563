# tests of daemon
check_PROGRAMS += tests/unit/test_loop tests/unit/test_control tests/unit/test_daemon_parts \
	tests/unit/test_socket
TESTS += tests/unit/test_loop tests/unit/test_control tests/unit/test_daemon_parts \
	tests/unit/test_socket

DAEMON_PART_LIBS = daemon/libgdaemon.a $(BASE_LIBS) $(SYSTEMD_LIBS) $(CMOCKA_LIBS)

tests_unit_test_loop_SOURCES = tests/unit/test_loop.c tests/unit/unit.h
tests_unit_test_loop_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_loop_LDADD = $(DAEMON_PART_LIBS)

tests_unit_test_control_SOURCES = tests/unit/test_control.c tests/unit/unit.h
tests_unit_test_control_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_control_LDADD = $(DAEMON_PART_LIBS)

tests_unit_test_daemon_parts_SOURCES = tests/unit/test_daemon_parts.c tests/unit/unit.h
tests_unit_test_daemon_parts_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_daemon_parts_LDADD = $(DAEMON_PART_LIBS)

tests_unit_test_socket_SOURCES = tests/unit/test_socket.c tests/unit/unit.h
tests_unit_test_socket_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_socket_LDADD = $(DAEMON_PART_LIBS)

check_PROGRAMS += tests/unit/test_master_state
TESTS += tests/unit/test_master_state
tests_unit_test_master_state_SOURCES = tests/unit/test_master_state.c tests/unit/unit.h
tests_unit_test_master_state_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_master_state_LDADD = daemon/libgdaemon.a $(PROTOCOL_LIBS) $(RENDERER_LIBS) \
	$(CMOCKA_LIBS)
