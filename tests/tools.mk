# tests of tools
check_PROGRAMS += tests/unit/test_unfold tests/unit/test_room tests/unit/test_children
TESTS += tests/unit/test_unfold tests/unit/test_room tests/unit/test_children

tests_unit_test_unfold_SOURCES = tests/unit/test_unfold.c tests/unit/unit.h
tests_unit_test_unfold_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_unfold_LDADD = tools/libgtools.a $(BASE_LIBS) $(CMOCKA_LIBS)

tests_unit_test_room_SOURCES = tests/unit/test_room.c tests/unit/unit.h
tests_unit_test_room_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_room_LDADD = tools/libgtools.a $(BASE_LIBS) $(CMOCKA_LIBS)

tests_unit_test_children_SOURCES = tests/unit/test_children.c tests/unit/unit.h
tests_unit_test_children_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_children_LDADD = tools/libgtools.a $(BASE_LIBS) $(CMOCKA_LIBS)

check_PROGRAMS += tests/unit/test_bench_stats
TESTS += tests/unit/test_bench_stats
tests_unit_test_bench_stats_SOURCES = tests/unit/test_bench_stats.c tests/unit/unit.h
tests_unit_test_bench_stats_CFLAGS = $(TEST_CFLAGS)
tests_unit_test_bench_stats_LDADD = tools/libgbench.a $(BASE_LIBS) $(CMOCKA_LIBS) -lm

check_PROGRAMS += tests/unit/test_bench
TESTS += tests/unit/test_bench
tests_unit_test_bench_SOURCES = tests/unit/test_bench.c tests/unit/unit.h tests/unit/gl.h
tests_unit_test_bench_CFLAGS = $(TEST_CFLAGS) $(EPOXY_CFLAGS) $(JSONC_CFLAGS)
tests_unit_test_bench_LDADD = tools/libgbench.a tools/libgtools.a $(RENDERER_LIBS) $(CMOCKA_LIBS) -lm

# The command from outside. Scripts run in the build folder and read $(srcdir).
dist_check_SCRIPTS += tests/command/bake.sh tests/command/check.sh tests/command/demo.sh tests/command/double.sh \
	tests/command/report.sh tests/command/trackers.sh
TESTS += tests/command/bake.sh tests/command/check.sh tests/command/demo.sh tests/command/report.sh \
	tests/command/trackers.sh
EXTRA_DIST += \
	tests/command/lib.sh \
	tests/data/key-missing.cave \
	tests/data/picture.png \
	tests/data/bad/bad-lamp-kind.scene \
	tests/data/bad/empty.cave \
	tests/data/bad/eye-outside.cave \
	tests/data/bad/faults-off-loopback.cave \
	tests/data/bad/host-name.cave \
	tests/data/bad/left-handed.cave \
	tests/data/bad/misspelt-wall-key.cave \
	tests/data/bad/model-truncated.scene \
	tests/data/bad/name-twice.cave \
	tests/data/bad/neither.conf \
	tests/data/bad/no-key-off-loopback.cave \
	tests/data/bad/no-model.scene \
	tests/data/bad/not-a-rectangle.cave \
	tests/data/bad/out-of-range.cave \
	tests/data/bad/parts-overlap.cave \
	tests/data/bad/port-twice.cave \
	tests/data/bad/syntax.cave \
	tests/data/bad/truncated.gltf \
	tests/data/bad/two-faults.scene \
	tests/data/bad/unknown-key.cave \
	tests/data/bad/unknown-material.scene \
	tests/data/bad/unknown-method.scene \
	tests/data/bad/wrong-type.cave

# Caves on loopback, with real daemons on any GL 4.5.
check_PROGRAMS += tests/loopback/picture
tests_loopback_picture_SOURCES = tests/loopback/picture.c
tests_loopback_picture_CFLAGS = $(AM_CFLAGS)
tests_loopback_picture_LDADD = $(RENDERER_LIBS)
dist_check_SCRIPTS += tests/loopback/demo.sh tests/loopback/netns.sh tests/loopback/way.sh \
	tests/loopback/render.sh tests/loopback/share.sh tests/loopback/window.sh
TESTS += tests/loopback/demo.sh tests/loopback/netns.sh tests/loopback/way.sh \
	tests/loopback/render.sh tests/loopback/share.sh tests/loopback/window.sh
EXTRA_DIST += tests/loopback/lib.sh tests/loopback/net.sh tests/data/halves.cave tests/data/loop.scene tests/data/shared.scene
