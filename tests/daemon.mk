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

check_PROGRAMS += tests/unit/test_node_plan
TESTS += tests/unit/test_node_plan
tests_unit_test_node_plan_SOURCES = tests/unit/test_node_plan.c tests/unit/unit.h
tests_unit_test_node_plan_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_node_plan_LDADD = $(DAEMON_PART_LIBS)

check_PROGRAMS += tests/unit/test_node_light
TESTS += tests/unit/test_node_light
tests_unit_test_node_light_SOURCES = tests/unit/test_node_light.c tests/unit/unit.h tests/unit/gl.h \
	daemon/node_light.c daemon/node_light.h
tests_unit_test_node_light_CFLAGS = $(TEST_CFLAGS) $(CGLM_CFLAGS) $(SODIUM_CFLAGS)
tests_unit_test_node_light_LDADD = daemon/libgdaemon.a $(RENDERER_LIBS) $(SYSTEMD_LIBS) $(CMOCKA_LIBS) -lpthread

check_PROGRAMS += tests/unit/test_dropped
TESTS += tests/unit/test_dropped
tests_unit_test_dropped_SOURCES = tests/unit/test_dropped.c tests/unit/unit.h
tests_unit_test_dropped_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_dropped_LDADD = daemon/libgdaemon.a $(PROTOCOL_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_send_queue
TESTS += tests/unit/test_send_queue
tests_unit_test_send_queue_SOURCES = tests/unit/test_send_queue.c tests/unit/unit.h
tests_unit_test_send_queue_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_send_queue_LDADD = $(DAEMON_PART_LIBS)

check_PROGRAMS += tests/unit/test_faults
TESTS += tests/unit/test_faults
tests_unit_test_faults_SOURCES = tests/unit/test_faults.c tests/unit/unit.h
tests_unit_test_faults_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_faults_LDADD = $(DAEMON_PART_LIBS)

tests_unit_test_socket_SOURCES = tests/unit/test_socket.c tests/unit/unit.h
tests_unit_test_socket_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_socket_LDADD = $(DAEMON_PART_LIBS)

check_PROGRAMS += tests/unit/test_saved_state
TESTS += tests/unit/test_saved_state
tests_unit_test_saved_state_SOURCES = tests/unit/test_saved_state.c tests/unit/unit.h
tests_unit_test_saved_state_CFLAGS = $(TEST_CFLAGS) $(SODIUM_CFLAGS)
tests_unit_test_saved_state_LDADD = daemon/libgdaemon.a renderer/libgrenderer.a $(PROTOCOL_LIBS) $(CONFIG_LIBS) \
	$(CMOCKA_LIBS) -lpthread

check_PROGRAMS += tests/unit/test_master_adapt
TESTS += tests/unit/test_master_adapt
tests_unit_test_master_adapt_SOURCES = tests/unit/test_master_adapt.c tests/unit/unit.h
tests_unit_test_master_adapt_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_master_adapt_LDADD = daemon/libgdaemon.a $(PROTOCOL_LIBS) $(RENDERER_LIBS) $(CONFIG_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_hand
TESTS += tests/unit/test_hand
tests_unit_test_hand_SOURCES = tests/unit/test_hand.c tests/unit/unit.h
tests_unit_test_hand_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_hand_LDADD = $(tests_unit_test_master_state_LDADD)

check_PROGRAMS += tests/unit/test_master_state
TESTS += tests/unit/test_master_state
tests_unit_test_master_state_SOURCES = tests/unit/test_master_state.c tests/unit/unit.h
tests_unit_test_master_state_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_master_state_LDADD = daemon/libgdaemon.a $(TRACKING_LIBS) $(PROTOCOL_LIBS) $(RENDERER_LIBS) \
	$(CMOCKA_LIBS)

# Real daemons over UDP on loopback; they skip (77) where there is no OpenGL 4.5.
check_PROGRAMS += tests/loopback/ask tests/loopback/stranger
tests_loopback_ask_SOURCES = tests/loopback/ask.c
tests_loopback_stranger_SOURCES = tests/loopback/stranger.c tests/unit/unit.h
tests_loopback_stranger_CFLAGS = $(TEST_CFLAGS) $(SODIUM_CFLAGS)
tests_loopback_stranger_LDADD = $(PROTOCOL_LIBS)

check_PROGRAMS += tests/loopback/costs
tests_loopback_costs_SOURCES = tests/loopback/costs.c
tests_loopback_costs_CFLAGS = $(AM_CFLAGS) $(SODIUM_CFLAGS)
tests_loopback_costs_LDADD = $(RENDERER_LIBS)
if HAVE_X11
check_PROGRAMS += tests/loopback/type
tests_loopback_type_SOURCES = tests/loopback/type.c
tests_loopback_type_CFLAGS = $(AM_CFLAGS) $(X11_CFLAGS)
tests_loopback_type_LDADD = $(X11_LIBS)
else
EXTRA_DIST += tests/loopback/type.c
endif
dist_check_SCRIPTS += tests/loopback/adapt.sh tests/loopback/hand.sh tests/loopback/window_input.sh
TESTS += tests/loopback/adapt.sh tests/loopback/hand.sh tests/loopback/window_input.sh

dist_check_SCRIPTS += tests/loopback/plan.sh
TESTS += tests/loopback/plan.sh

check_PROGRAMS += tests/loopback/forger
tests_loopback_forger_SOURCES = tests/loopback/forger.c tests/unit/unit.h
tests_loopback_forger_CFLAGS = $(TEST_CFLAGS) $(SODIUM_CFLAGS)
tests_loopback_forger_LDADD = $(PROTOCOL_LIBS)
dist_check_SCRIPTS += tests/loopback/forged.sh
TESTS += tests/loopback/forged.sh
dist_check_SCRIPTS += tests/loopback/frames.sh tests/loopback/survive.sh tests/loopback/hostile.sh \
	tests/loopback/group.sh tests/loopback/share_survives.sh tests/loopback/kills.sh \
	tests/loopback/barrier.sh tests/loopback/faults.sh tests/loopback/pace.sh \
	tests/loopback/standby.sh
TESTS += tests/loopback/frames.sh tests/loopback/survive.sh tests/loopback/hostile.sh \
	tests/loopback/group.sh tests/loopback/share_survives.sh tests/loopback/kills.sh \
	tests/loopback/barrier.sh tests/loopback/faults.sh tests/loopback/pace.sh \
	tests/loopback/standby.sh
EXTRA_DIST += tests/loopback/room.sh tests/loopback/room.cave.in tests/loopback/cell.scene

check_PROGRAMS += tests/unit/test_trackers
TESTS += tests/unit/test_trackers
tests_unit_test_trackers_SOURCES = tests/unit/test_trackers.c tests/unit/unit.h
tests_unit_test_trackers_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_trackers_LDADD = daemon/libgdaemon.a $(TRACKING_LIBS) $(CONFIG_LIBS) \
	$(PROTOCOL_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_network_trackers
TESTS += tests/unit/test_network_trackers
tests_unit_test_network_trackers_SOURCES = tests/unit/test_network_trackers.c tests/unit/mock_vrpn.h \
	tests/unit/net_device.h tests/unit/vrpn_bytes.h tests/unit/unit.h tests/unit/unit_config.h
tests_unit_test_network_trackers_CFLAGS = $(TEST_CFLAGS) -pthread
tests_unit_test_network_trackers_LDADD = $(tests_unit_test_trackers_LDADD)

# The command beside a controller that the test plays.
check_PROGRAMS += tests/unit/test_calibrate_device
TESTS += tests/unit/test_calibrate_device
tests_unit_test_calibrate_device_SOURCES = tests/unit/test_calibrate_device.c tests/unit/align_room.h \
	tests/unit/mock_dtrack.h \
	tests/unit/net_device.h tests/unit/unit.h tests/unit/unit_config.h
tests_unit_test_calibrate_device_CFLAGS = $(TEST_CFLAGS) -pthread
tests_unit_test_calibrate_device_LDADD = $(tests_unit_test_trackers_LDADD)

check_PROGRAMS += tests/unit/test_tracker_devices
TESTS += tests/unit/test_tracker_devices
tests_unit_test_tracker_devices_SOURCES = tests/unit/test_tracker_devices.c tests/unit/fake_device.h tests/unit/unit.h
tests_unit_test_tracker_devices_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_tracker_devices_LDADD = daemon/libgdaemon.a $(TRACKING_LIBS) $(CONFIG_LIBS) \
	$(PROTOCOL_LIBS) $(CMOCKA_LIBS)

EXTRA_DIST += tests/fuzz/fuzz_control.c \
	tests/fuzz/corpus/control/cut \
	tests/fuzz/corpus/control/gathers \
	tests/fuzz/corpus/control/set \
	tests/fuzz/corpus/control/wrong
if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_control
tests_fuzz_fuzz_control_SOURCES = tests/fuzz/fuzz_control.c
tests_fuzz_fuzz_control_CFLAGS = $(TEST_CFLAGS) $(CGLM_CFLAGS)
tests_fuzz_fuzz_control_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_control_LDADD = daemon/libgdaemon.a renderer/libgrenderer.a $(PROTOCOL_LIBS) $(CONFIG_LIBS) $(SYSTEMD_LIBS) -lm
endif

# Fuzzer: see tests/protocol.mk.
EXTRA_DIST += tests/fuzz/fuzz_saved_state.c tests/fuzz/corpus/saved_state/good
if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_saved_state
tests_fuzz_fuzz_saved_state_SOURCES = tests/fuzz/fuzz_saved_state.c
tests_fuzz_fuzz_saved_state_CFLAGS = $(TEST_CFLAGS) $(SODIUM_CFLAGS)
tests_fuzz_fuzz_saved_state_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_saved_state_LDADD = daemon/libgdaemon.a renderer/libgrenderer.a $(PROTOCOL_LIBS) $(CONFIG_LIBS) -lm
endif
