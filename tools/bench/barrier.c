/*
 * bench-barrier: how far apart nodes leave the barrier, when told and at a
 * time, in turns; `grotto bench barrier` starts it. What is printed is the truth,
 * by the clock that all ends have; beside it what the master believes from its
 * estimates of the nodes' clocks.
 */
#include "tools/bench/barrier.h"

#include "base/result.h"
#include "tools/bench/stats.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define WARM 100

static struct barrier_room *make_room(const struct cluster_options *o)
{
	struct barrier_room *room = cluster_shared(sizeof *room);
	const size_t cells = (size_t)o->nodes * (size_t)o->samples;

	if (!room)
		return NULL;
	room->frames = (unsigned)o->samples;
	room->warm = WARM;
	room->swap_ns = cluster_shared(cells * sizeof *room->swap_ns);
	room->ready_ns = cluster_shared(cells * sizeof *room->ready_ns);
	return room->swap_ns && room->ready_ns ? room : NULL;
}

static void run_end(void *ctx, unsigned end)
{
	struct barrier_room *room = ctx;

	if (end == room->cluster.node_count)
		barrier_master(room);
	else
		barrier_node(room, end);
}

struct figures {
	double p50, p95, p99, most, enter_p50, seen_p50, seen_p99, off;
	size_t frames;
};

static struct figures look(const struct barrier_room *room)
{
	static double skew[BARRIER_FRAMES_MOST], wait[BARRIER_FRAMES_MOST];
	struct figures f = { .seen_p50 = room->seen_p50_us, .seen_p99 = room->seen_p99_us };

	for (unsigned k = 0; k < room->frames; k++) {
		int64_t first = INT64_MAX, last = 0, ready = 0;

		for (unsigned i = 0; i < room->cluster.node_count; i++) {
			const int64_t at = room->swap_ns[i * room->frames + k];

			first = at < first ? at : first;
			last = at > last ? at : last;
			if (room->ready_ns[i * room->frames + k] > ready)
				ready = room->ready_ns[i * room->frames + k];
		}
		if (first <= 0)
			continue; /* one that missed it */
		skew[f.frames] = (double)(last - first) * 1e-3;
		wait[f.frames++] = (double)(last - ready) * 1e-3;
	}
	stats_sort(skew, f.frames);
	stats_sort(wait, f.frames);
	f.p50 = stats_quantile(skew, f.frames, 0.5);
	f.p95 = stats_quantile(skew, f.frames, 0.95);
	f.p99 = stats_quantile(skew, f.frames, 0.99);
	f.most = stats_quantile(skew, f.frames, 1);
	f.enter_p50 = stats_quantile(wait, f.frames, 0.5);
	for (unsigned i = 0; i < room->cluster.node_count; i++)
		f.off = fmax(f.off, fabs(room->clock_off_us[i]));
	return f;
}

static void print_medians(const char *how, const struct figures *f, int runs)
{
#define MEDIAN(member) cluster_median(f, sizeof *f, offsetof(struct figures, member), runs)
	printf("%-9s %8.1f %8.1f %8.1f %9.1f %12.1f %14.1f / %.1f\n", how, MEDIAN(p50), MEDIAN(p95),
	       MEDIAN(p99), MEDIAN(most), MEDIAN(enter_p50), MEDIAN(seen_p50), MEDIAN(seen_p99));
#undef MEDIAN
}

static int run_all(struct barrier_room *room, const struct cluster_options *o)
{
	static struct figures told[CLUSTER_RUNS_MOST], timed[CLUSTER_RUNS_MOST];
	const size_t times_bytes = (size_t)o->nodes * room->frames * sizeof(int64_t);

	for (int run = 0; run < 2 * o->runs; run++) {
		const bool scheduled = run & 1;
		struct figures f;

		room->swap = scheduled ? FDP_SWAP_AUTO : FDP_SWAP_MESSAGE;
		room->scheduled = room->late = 0;
		memset(room->swap_ns, 0, times_bytes);
		memset(room->ready_ns, 0, times_bytes);
		if (!cluster_run(&room->cluster))
			return GR_EXIT_RUNTIME;
		f = look(room);
		*(scheduled ? &timed[run / 2] : &told[run / 2]) = f;
		printf("run %d, %-9s: exit skew p50 %6.1f p95 %6.1f p99 %6.1f us; %zu frames, %llu with a "
		       "time, %llu late; clocks off by at most %.1f us\n", run / 2 + 1,
		       scheduled ? "at a time" : "told", f.p50, f.p95, f.p99, f.frames,
		       (unsigned long long)room->scheduled, (unsigned long long)room->late, f.off);
		fflush(stdout);
	}
	printf("\nmedians of %d runs, us      p50      p95      p99   longest\n", o->runs);
	printf("%-9s %8s %8s %8s %9s %12s %14s\n", "", "skew", "skew", "skew", "skew", "last ready",
	       "as the master");
	printf("%-9s %8s %8s %8s %9s %12s %14s\n", "", "p50", "p95", "p99", "most", "to out, p50",
	       "sees it, 50/99");
	print_medians("told", told, o->runs);
	print_medians("at a time", timed, o->runs);
	printf("%-9s %8d %8d   (version 1.7, TCP, four nodes, 120 Hz, on a machine like this one)\n", "Collage",
	       26, 67);
	return GR_EXIT_OK;
}

static int measure(const struct cluster_options *o);

static const struct cluster_bench bench = {
	.name = "bench-barrier",
	.usage = "grotto bench barrier [--nodes N] [--rate HZ] [--frames N] [--runs N] [--loopback 1] [--multicast 1]",
	.summary = "How far apart nodes that draw nothing leave the swap barrier, told and at a time, in\n"
		   "turns; in network namespaces where that is allowed, else over loopback.",
	.samples = "frames", .samples_most = BARRIER_FRAMES_MOST, .nodes_least = 2,
	.port = 29100, .group = "239.192.77.1", .network = "10.99.0",
	.measure = measure, .run = run_end,
};

static int measure(const struct cluster_options *o)
{
	struct barrier_room *room = make_room(o);
	int status;

	if (!room) {
		fprintf(stderr, "%s: no memory\n", bench.name);
		return GR_EXIT_RUNTIME;
	}
	if (!cluster_begin(&room->cluster, &bench, o, room))
		return GR_EXIT_RUNTIME;
	printf("%d nodes, %d Hz, %u frames after %u, %s, %s, SCHED_RR %d\n", o->nodes, o->hz, room->frames,
	       room->warm, room->cluster.spaces ? "a namespace and veth each, one bridge" : "loopback",
	       o->multicast ? "multicast" : "unicast", CLUSTER_PRIORITY);
	fflush(stdout);
	status = run_all(room, o);
	cluster_end(&room->cluster);
	return status;
}

int main(int argc, char **argv)
{
	struct cluster_options options = CLUSTER_DEFAULTS;

	return cluster_main(&bench, &options, argc, argv);
}
