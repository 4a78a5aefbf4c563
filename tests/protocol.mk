# tests of protocol/: links base/ and protocol/ alone
PROTOCOL_TEST_CFLAGS = $(TEST_CFLAGS) $(SODIUM_CFLAGS) $(LZO_CFLAGS)
PROTOCOL_TEST_LDADD = $(PROTOCOL_LIBS) $(CMOCKA_LIBS)

# A simulated cluster, and a light that it shares out.
CLUSTER_SIM_SOURCES = tests/unit/cluster_sim.c tests/unit/cluster_sim.h \
	tests/unit/cluster_sim_assert.c tests/unit/cluster_sim_daemons.c \
	tests/unit/cluster_sim_net.c tests/unit/cluster_sim_private.h tests/unit/unit.h
SHARE_ROOM_SOURCES = tests/unit/share_room.c tests/unit/share_room.h $(CLUSTER_SIM_SOURCES)

# The same with longer states: the protocol built for bench-delivery's table.
CLUSTER_BALLAST_SOURCES = $(CLUSTER_SIM_SOURCES) \
	tools/bench/ballast/protocol/params.def $(protocol_libgprotocol_a_SOURCES)
CLUSTER_BALLAST_CPPFLAGS = -iquote $(top_srcdir)/tools/bench/ballast $(AM_CPPFLAGS)
CLUSTER_BALLAST_CFLAGS = $(PROTOCOL_TEST_CFLAGS) $(ISAL_CFLAGS) $(XXHASH_CFLAGS)
CLUSTER_BALLAST_LDADD = $(BASE_LIBS) $(LZO_LIBS) $(ISAL_LIBS) $(XXHASH_LIBS) $(CMOCKA_LIBS)

PROTOCOL_TESTS = \
	tests/unit/test_clock_offset \
	tests/unit/test_cluster \
	tests/unit/test_cluster_day \
	tests/unit/test_cluster_hostile \
	tests/unit/test_fragment \
	tests/unit/test_joints \
	tests/unit/test_key \
	tests/unit/test_pace \
	tests/unit/test_pack \
	tests/unit/test_parity \
	tests/unit/test_repair \
	tests/unit/test_weather_4k \
	tests/unit/test_weather_64k \
	tests/unit/test_params \
	tests/unit/test_peer \
	tests/unit/test_share \
	tests/unit/test_share_hostile \
	tests/unit/test_share_weather \
	tests/unit/test_standby \
	tests/unit/test_trust \
	tests/unit/test_swap \
	tests/unit/test_way \
	tests/unit/test_input \
	tests/unit/test_window \
	tests/unit/test_wire
check_PROGRAMS += $(PROTOCOL_TESTS)
TESTS += $(PROTOCOL_TESTS)

tests_unit_test_clock_offset_SOURCES = tests/unit/test_clock_offset.c tests/unit/unit.h
tests_unit_test_clock_offset_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_clock_offset_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_cluster_SOURCES = tests/unit/test_cluster.c $(CLUSTER_SIM_SOURCES)
tests_unit_test_cluster_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_cluster_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_cluster_day_SOURCES = tests/unit/test_cluster_day.c $(CLUSTER_SIM_SOURCES)
tests_unit_test_cluster_day_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_cluster_day_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_cluster_hostile_SOURCES = tests/unit/test_cluster_hostile.c $(CLUSTER_SIM_SOURCES)
tests_unit_test_cluster_hostile_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_cluster_hostile_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_fragment_SOURCES = tests/unit/test_fragment.c tests/unit/unit.h
tests_unit_test_fragment_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_fragment_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_joints_SOURCES = tests/unit/test_joints.c tests/unit/skinned.c tests/unit/skinned.h \
	tests/unit/shared.h tests/unit/unit.h
tests_unit_test_joints_CFLAGS = $(PROTOCOL_TEST_CFLAGS) $(ASSIMP_CFLAGS)
tests_unit_test_joints_LDADD = $(PROTOCOL_TEST_LDADD) $(ASSIMP_LIBS)
tests_unit_test_key_SOURCES = tests/unit/test_key.c tests/unit/unit.h
tests_unit_test_key_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_key_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_pace_SOURCES = tests/unit/test_pace.c $(CLUSTER_SIM_SOURCES)
tests_unit_test_pace_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_pace_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_parity_SOURCES = tests/unit/test_parity.c tests/unit/unit.h
tests_unit_test_parity_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_parity_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_repair_SOURCES = tests/unit/test_repair.c $(CLUSTER_BALLAST_SOURCES)
tests_unit_test_repair_CPPFLAGS = $(CLUSTER_BALLAST_CPPFLAGS) -DBALLAST_WORDS=970
tests_unit_test_repair_CFLAGS = $(CLUSTER_BALLAST_CFLAGS)
tests_unit_test_repair_LDADD = $(CLUSTER_BALLAST_LDADD)
tests_unit_test_weather_4k_SOURCES = tests/unit/test_weather.c $(CLUSTER_BALLAST_SOURCES)
tests_unit_test_weather_4k_CPPFLAGS = $(CLUSTER_BALLAST_CPPFLAGS) -DBALLAST_WORDS=970
tests_unit_test_weather_4k_CFLAGS = $(CLUSTER_BALLAST_CFLAGS)
tests_unit_test_weather_4k_LDADD = $(CLUSTER_BALLAST_LDADD)
tests_unit_test_weather_64k_SOURCES = tests/unit/test_weather.c $(CLUSTER_BALLAST_SOURCES)
tests_unit_test_weather_64k_CPPFLAGS = $(CLUSTER_BALLAST_CPPFLAGS) -DBALLAST_WORDS=16000
tests_unit_test_weather_64k_CFLAGS = $(CLUSTER_BALLAST_CFLAGS)
tests_unit_test_weather_64k_LDADD = $(CLUSTER_BALLAST_LDADD)
tests_unit_test_pack_SOURCES = tests/unit/test_pack.c tests/unit/unit.h
tests_unit_test_pack_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_pack_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_params_SOURCES = tests/unit/test_params.c tests/unit/unit.h
tests_unit_test_params_CFLAGS = $(PROTOCOL_TEST_CFLAGS) \
	-DPROTOCOL_DOC='"$(top_srcdir)/docs/protocol.md"'
tests_unit_test_params_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_peer_SOURCES = tests/unit/test_peer.c tests/unit/unit.h
tests_unit_test_peer_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_peer_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_share_SOURCES = tests/unit/test_share.c $(SHARE_ROOM_SOURCES)
tests_unit_test_share_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_share_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_share_hostile_SOURCES = tests/unit/test_share_hostile.c $(SHARE_ROOM_SOURCES)
tests_unit_test_share_hostile_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_share_hostile_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_share_weather_SOURCES = tests/unit/test_share_weather.c $(SHARE_ROOM_SOURCES)
tests_unit_test_share_weather_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_share_weather_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_standby_SOURCES = tests/unit/test_standby.c tests/unit/masters_sim.c \
	tests/unit/masters_sim.h tests/unit/unit.h
tests_unit_test_standby_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_standby_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_trust_SOURCES = tests/unit/test_trust.c $(CLUSTER_SIM_SOURCES)
tests_unit_test_trust_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_trust_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_swap_SOURCES = tests/unit/test_swap.c $(CLUSTER_SIM_SOURCES)
tests_unit_test_swap_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_swap_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_way_SOURCES = tests/unit/test_way.c $(CLUSTER_SIM_SOURCES)
tests_unit_test_way_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_way_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_input_SOURCES = tests/unit/test_input.c $(CLUSTER_SIM_SOURCES)
tests_unit_test_input_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_input_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_window_SOURCES = tests/unit/test_window.c $(SHARE_ROOM_SOURCES)
tests_unit_test_window_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_window_LDADD = $(PROTOCOL_TEST_LDADD)
tests_unit_test_wire_SOURCES = tests/unit/test_wire.c tests/unit/unit.h
tests_unit_test_wire_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_unit_test_wire_LDADD = $(PROTOCOL_TEST_LDADD)

# Fuzzers: ./configure --enable-fuzzers CC=clang, then for example
#   make tests/fuzz/fuzz_delta && tests/fuzz/fuzz_delta -max_total_time=60 CORPUS
# where CORPUS is a copy of tests/fuzz/corpus/delta. What crashes stays there.
EXTRA_DIST += \
	tests/fuzz/fuzz_datagram_master.c tests/fuzz/fuzz_datagram_node.c \
	tests/fuzz/fuzz_delta.c tests/fuzz/fuzz_key.c tests/fuzz/fuzz_pair.h \
	tests/fuzz/fuzz_reassembly.c tests/fuzz/fuzz_stranger.c \
	tests/fuzz/corpus/reassembly/honest \
	tests/fuzz/corpus/reassembly/lies \
	tests/fuzz/corpus/reassembly/parity \
	tests/fuzz/corpus/reassembly/parity-lies \
	tests/fuzz/corpus/stranger/ack \
	tests/fuzz/corpus/stranger/beacon \
	tests/fuzz/corpus/stranger/short \
	tests/fuzz/corpus/datagram/ack \
	tests/fuzz/corpus/datagram/announce \
	tests/fuzz/corpus/datagram/announce-slices \
	tests/fuzz/corpus/datagram/beacon \
	tests/fuzz/corpus/datagram/input \
	tests/fuzz/corpus/datagram/join \
	tests/fuzz/corpus/datagram/lack \
	tests/fuzz/corpus/datagram/nack \
	tests/fuzz/corpus/datagram/slice \
	tests/fuzz/corpus/datagram/snapshot \
	tests/fuzz/corpus/datagram/welcome \
	tests/fuzz/corpus/delta/empty \
	tests/fuzz/corpus/delta/two \
	tests/fuzz/corpus/key/good \
	tests/fuzz/corpus/key/short

if FUZZERS
noinst_PROGRAMS += tests/fuzz/fuzz_datagram_master tests/fuzz/fuzz_datagram_node \
	tests/fuzz/fuzz_delta tests/fuzz/fuzz_key
tests_fuzz_fuzz_datagram_master_SOURCES = tests/fuzz/fuzz_datagram_master.c
tests_fuzz_fuzz_datagram_master_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_fuzz_fuzz_datagram_master_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_datagram_master_LDADD = $(PROTOCOL_LIBS)
tests_fuzz_fuzz_datagram_node_SOURCES = tests/fuzz/fuzz_datagram_node.c
tests_fuzz_fuzz_datagram_node_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_fuzz_fuzz_datagram_node_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_datagram_node_LDADD = $(PROTOCOL_LIBS)
tests_fuzz_fuzz_delta_SOURCES = tests/fuzz/fuzz_delta.c
tests_fuzz_fuzz_delta_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_fuzz_fuzz_delta_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_delta_LDADD = $(PROTOCOL_LIBS)
noinst_PROGRAMS += tests/fuzz/fuzz_reassembly tests/fuzz/fuzz_stranger
tests_fuzz_fuzz_reassembly_SOURCES = tests/fuzz/fuzz_reassembly.c
tests_fuzz_fuzz_reassembly_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_fuzz_fuzz_reassembly_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_reassembly_LDADD = $(PROTOCOL_LIBS)
tests_fuzz_fuzz_stranger_SOURCES = tests/fuzz/fuzz_stranger.c
tests_fuzz_fuzz_stranger_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_fuzz_fuzz_stranger_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_stranger_LDADD = $(PROTOCOL_LIBS)
tests_fuzz_fuzz_key_SOURCES = tests/fuzz/fuzz_key.c
tests_fuzz_fuzz_key_CFLAGS = $(PROTOCOL_TEST_CFLAGS)
tests_fuzz_fuzz_key_LDFLAGS = $(AM_LDFLAGS) -fsanitize=fuzzer
tests_fuzz_fuzz_key_LDADD = $(PROTOCOL_LIBS)
endif
