# The lattice benchmark; its room and its truth serve the accuracy tests, too.
LATTICE_ROOM_SOURCES = tools/bench/room.c tools/bench/room.h \
	tools/bench/truth.c tools/bench/truth.h
LATTICE_BENCH_SOURCES = $(LATTICE_ROOM_SOURCES) tools/bench/lpv_bench.c tools/bench/lpv_bench.h

# Cost and error of the lattice; takes a minute, so not a test.
# `grotto bench lattice` starts it.
pkglibexec_PROGRAMS = tools/bench-lattice
tools_bench_lattice_SOURCES = tools/bench/lattice.c $(LATTICE_BENCH_SOURCES)
tools_bench_lattice_CFLAGS = $(AM_CFLAGS) $(CGLM_CFLAGS) $(EPOXY_CFLAGS)
tools_bench_lattice_LDADD = $(RENDERER_LIBS)
