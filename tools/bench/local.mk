# The lattice benchmark; its room and its truth serve the accuracy tests, too.
LATTICE_ROOM_SOURCES = tools/bench/room.c tools/bench/room.h \
	tools/bench/truth.c tools/bench/truth.h tools/bench/random.h
LATTICE_BENCH_SOURCES = $(LATTICE_ROOM_SOURCES) tools/bench/lpv_bench.c tools/bench/lpv_bench.h
SURFEL_BENCH_SOURCES = $(LATTICE_ROOM_SOURCES) tools/bench/surfel_cpu.c tools/bench/surfel_cpu.h

SURFEL_RIG_SOURCES = $(LATTICE_BENCH_SOURCES) tools/bench/surfel_rig.c tools/bench/surfel_rig.h

# Cost and error of the lattice; takes a minute, so not a test.
# `grotto bench lattice` starts it.
pkglibexec_PROGRAMS = tools/bench-lattice tools/bench-barrier
tools_bench_lattice_SOURCES = tools/bench/lattice.c $(LATTICE_BENCH_SOURCES)
tools_bench_lattice_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(EPOXY_CFLAGS)
tools_bench_lattice_LDADD = $(RENDERER_LIBS)

# `grotto bench SCENE...`: a library, so that tests can link its parts.
noinst_LIBRARIES += tools/libgbench.a
tools_libgbench_a_SOURCES = \
	tools/bench/axis.c tools/bench/axis.h \
	tools/bench/hand.c tools/bench/hand.h \
	tools/bench/logged.c tools/bench/logged.h \
	tools/bench/measure.c tools/bench/measure.h \
	tools/bench/motion.c tools/bench/motion.h \
	tools/bench/picture.c tools/bench/picture.h \
	tools/bench/plot.c tools/bench/plot.h \
	tools/bench/predict.c tools/bench/predict.h tools/bench/random.h \
	tools/bench/points.c tools/bench/points.h \
	tools/bench/report.h tools/bench/report_json.c tools/bench/report_plot.c \
	tools/bench/report_table.c \
	tools/bench/settings.c tools/bench/settings.h \
	tools/bench/stats.c tools/bench/stats.h \
	tools/bench/svg.c tools/bench/svg.h \
	tools/bench/trackers.c tools/bench/trackers.h \
	tools/bench/truth_store.c tools/bench/truth_store.h \
	tools/bench/truth_traced.c tools/bench/truth_traced.h \
	tools/bench/scenes.c tools/bench/scenes.h
tools_libgbench_a_CPPFLAGS = $(AM_CPPFLAGS)
tools_libgbench_a_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(JSONC_CFLAGS)

# How long surfels take to bake, and their rays beside a bare Embree loop.
pkglibexec_PROGRAMS += tools/bench-bake
tools_bench_bake_SOURCES = tools/bench/bake.c tools/bench/atrium.c tools/bench/atrium.h $(LATTICE_ROOM_SOURCES)
tools_bench_bake_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS)
tools_bench_bake_LDADD = $(RENDERER_LIBS)

# A master and nodes in processes of their own: what the next three have in common.
CLUSTER_SOURCES = \
	tools/bench/cluster.c tools/bench/cluster.h \
	tools/bench/cluster_ends.c tools/bench/cluster_ends.h \
	tools/bench/cluster_net.c tools/bench/cluster_net.h
CLUSTER_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) -pthread
CLUSTER_LIBS = tools/libgbench.a tools/libgtools.a daemon/libgdaemon.a config/libgconfig.a

# Exit skew of the barrier, told and at a time; `grotto bench barrier` starts it.
tools_bench_barrier_SOURCES = \
	tools/bench/barrier.c tools/bench/barrier.h \
	tools/bench/barrier_ends.c $(CLUSTER_SOURCES)
tools_bench_barrier_CFLAGS = $(CLUSTER_CFLAGS)
tools_bench_barrier_LDADD = $(CLUSTER_LIBS) $(PROTOCOL_LIBS) -lpthread -lm

# From the master to the last node, for updates of 200 B, and of 4 KB and 64 KB by a
# parameter more: the protocol is built for these two with the table in ballast/.
# `make bench-delivery`; scripts/results runs them.
DELIVERY_BENCHES = tools/bench-delivery-200 tools/bench-delivery-4k tools/bench-delivery-64k
EXTRA_PROGRAMS = $(DELIVERY_BENCHES)
bench-delivery: $(DELIVERY_BENCHES)
CLEANFILES += $(EXTRA_PROGRAMS)
DISTCLEANFILES = norm_api.h
DELIVERY_SOURCES = \
	tools/bench/delivery.c tools/bench/delivery.h \
	tools/bench/delivery_bare.c tools/bench/delivery_ends.c \
	tools/bench/delivery_loss.c tools/bench/delivery_peer.c \
	tools/bench/peer.c tools/bench/peer.h tools/bench/peer_enet.c \
	tools/bench/peer_norm.c tools/bench/peer_pgm.c tools/bench/peer_tcp.c \
	$(CLUSTER_SOURCES)
DELIVERY_CFLAGS = $(CLUSTER_CFLAGS) $(PEER_CFLAGS)
DELIVERY_LIBS = $(CLUSTER_LIBS) $(PEER_LIBS)
DELIVERY_BALLAST_SOURCES = $(DELIVERY_SOURCES) \
	tools/bench/ballast/protocol/params.def $(protocol_libgprotocol_a_SOURCES)
DELIVERY_BALLAST_CPPFLAGS = -iquote $(top_srcdir)/tools/bench/ballast $(AM_CPPFLAGS)
DELIVERY_BALLAST_CFLAGS = $(DELIVERY_CFLAGS) $(SODIUM_CFLAGS) $(LZO_CFLAGS) $(ISAL_CFLAGS) $(XXHASH_CFLAGS)
DELIVERY_BALLAST_LIBS = $(DELIVERY_LIBS) $(BASE_LIBS) $(LZO_LIBS) $(ISAL_LIBS) $(XXHASH_LIBS) -lpthread -lm
tools_bench_delivery_200_SOURCES = $(DELIVERY_SOURCES)
tools_bench_delivery_200_CFLAGS = $(DELIVERY_CFLAGS)
tools_bench_delivery_200_LDADD = $(DELIVERY_LIBS) $(PROTOCOL_LIBS) -lpthread -lm
tools_bench_delivery_4k_SOURCES = $(DELIVERY_BALLAST_SOURCES)
tools_bench_delivery_4k_CPPFLAGS = $(DELIVERY_BALLAST_CPPFLAGS) -DBALLAST_WORDS=970
tools_bench_delivery_4k_CFLAGS = $(DELIVERY_BALLAST_CFLAGS)
tools_bench_delivery_4k_LDADD = $(DELIVERY_BALLAST_LIBS)
tools_bench_delivery_64k_SOURCES = $(DELIVERY_BALLAST_SOURCES)
tools_bench_delivery_64k_CPPFLAGS = $(DELIVERY_BALLAST_CPPFLAGS) -DBALLAST_WORDS=16000
tools_bench_delivery_64k_CFLAGS = $(DELIVERY_BALLAST_CFLAGS)
tools_bench_delivery_64k_LDADD = $(DELIVERY_BALLAST_LIBS)

# A node that comes back to a room that shares 8 MiB of light; `make bench-rejoin`.
EXTRA_PROGRAMS += tools/bench-rejoin
bench-rejoin: tools/bench-rejoin
tools_bench_rejoin_SOURCES = \
	tools/bench/rejoin.c tools/bench/rejoin.h \
	tools/bench/rejoin_ends.c $(CLUSTER_SOURCES)
tools_bench_rejoin_CFLAGS = $(CLUSTER_CFLAGS)
tools_bench_rejoin_LDADD = $(CLUSTER_LIBS) $(PROTOCOL_LIBS) -lpthread -lm

# Recorded sessions and shared light packed; `make bench-packing`.
EXTRA_PROGRAMS += tools/bench-packing
bench-packing: tools/bench-packing
tools_bench_packing_SOURCES = \
	tools/bench/packing.c tools/bench/packing.h \
	tools/bench/packing_light.c \
	tools/bench/codecs.c tools/bench/codecs.h
tools_bench_packing_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(JSONC_CFLAGS) $(LZO_CFLAGS) $(CODEC_CFLAGS)
tools_bench_packing_LDADD = tools/libgbench.a tools/libgtools.a $(RECORD_LIBS) $(RENDERER_LIBS) \
	$(PROTOCOL_LIBS) $(CONFIG_LIBS) $(JSONC_LIBS) $(CODEC_LIBS)

# From a report's arrival to the filtered pose; `make bench-arrival`.
EXTRA_PROGRAMS += tools/bench-arrival
bench-arrival: tools/bench-arrival
tools_bench_arrival_SOURCES = tools/bench/arrival.c
tools_bench_arrival_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(JSONC_CFLAGS) -pthread
tools_bench_arrival_LDADD = tools/libgbench.a tools/libgtools.a daemon/libgdaemon.a $(TRACKING_LIBS) \
	$(CONFIG_LIBS) $(PROTOCOL_LIBS) $(JSONC_LIBS)
