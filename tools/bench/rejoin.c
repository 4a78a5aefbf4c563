/*
 * bench-rejoin: a node dies and comes back to a room at full rate whose light of
 * 8 MiB is shared out, so that it needs the state and all slices, and all others
 * the slices of the new division. `make bench-rejoin`; docs/delivery.md.
 */
#include "tools/bench/rejoin.h"

#include "base/clock.h"
#include "base/result.h"
#include "protocol/master.h"
#include "tools/bench/stats.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct figures {
	double shows_ms, whole_ms, megabytes;
	double quiet_p50, quiet_p99, quiet_most, back_p50, back_p99, back_most; /* us */
	double quiet_gap, back_gap; /* longest from one frame's begin to the next, in periods */
	double late;		    /* frames for which another node was late, while it came back */
	double frames;		    /* so many */
};

static struct rejoin_room *make_room(const struct cluster_options *o)
{
	struct rejoin_room *room = cluster_shared(sizeof *room);

	if (!room)
		return NULL;
	room->quiet = (unsigned)o->samples;
	room->most = REJOIN_WARM + room->quiet + 30 * (unsigned)o->hz;
	room->begun_ns = cluster_shared(room->most * sizeof *room->begun_ns);
	room->applied_ns = cluster_shared((size_t)o->nodes * room->most * sizeof *room->applied_ns);
	room->late = cluster_shared(room->most);
	return room->begun_ns && room->applied_ns && room->late ? room : NULL;
}

static void run_end(void *ctx, unsigned end)
{
	struct rejoin_room *room = ctx;

	if (end == room->cluster.node_count)
		rejoin_master(room);
	else
		rejoin_node(room, end);
}

/* From a frame's begin to when the last of the nodes that lived on has it, us; NaN: one has not. */
static double delivery(const struct rejoin_room *room, uint64_t frame)
{
	int64_t last = 0;

	for (unsigned i = 0; i < room->cluster.node_count; i++) {
		const int64_t at = room->applied_ns[i * room->most + frame];

		if (i == REJOIN_VICTIM)
			continue;
		if (!at)
			return NAN;
		last = at > last ? at : last;
	}
	return (double)(last - room->begun_ns[frame]) * 1e-3;
}

/* The frames [first, end). */
static void look_at(const struct rejoin_room *room, uint64_t first, uint64_t end, double out_us[3],
		    double *out_gap, double *out_late)
{
	static double us[REJOIN_FRAMES_MOST];
	size_t count = 0;

	*out_gap = *out_late = 0;
	for (uint64_t f = first; f < end; f++) {
		const double one = delivery(room, f);
		const double gap = (double)(room->begun_ns[f] - room->begun_ns[f - 1]) /
				   (double)room->cluster.period_ns;

		*out_gap = fmax(*out_gap, gap);
		*out_late += room->late[f] || isnan(one);
		if (!isnan(one) && count < REJOIN_FRAMES_MOST)
			us[count++] = one;
	}
	stats_sort(us, count);
	out_us[0] = stats_quantile(us, count, 0.5);
	out_us[1] = stats_quantile(us, count, 0.99);
	out_us[2] = stats_quantile(us, count, 1);
}

static struct figures look(const struct rejoin_room *room)
{
	const uint64_t dies = atomic_load(&room->dies_after), last = atomic_load(&room->last);
	const int64_t back_ns = atomic_load(&room->back_ns);
	uint64_t back = dies;
	double us[3], none;
	int64_t whole_ns = 0;
	struct figures f = { .megabytes = (double)room->bulk_bytes * 1e-6 };

	while (back < last && room->begun_ns[back] < back_ns)
		back++;
	for (unsigned i = 0; i < room->cluster.node_count; i++)
		if (atomic_load(&room->whole_ns[i]) > whole_ns)
			whole_ns = atomic_load(&room->whole_ns[i]);
	f.shows_ms = (double)(atomic_load(&room->shows_ns) - back_ns) * 1e-6;
	f.whole_ms = (double)(whole_ns - back_ns) * 1e-6;
	f.frames = (double)(last - back);
	look_at(room, dies - room->quiet, dies, us, &f.quiet_gap, &none);
	f.quiet_p50 = us[0], f.quiet_p99 = us[1], f.quiet_most = us[2];
	look_at(room, back, last, us, &f.back_gap, &f.late);
	f.back_p50 = us[0], f.back_p99 = us[1], f.back_most = us[2];
	return f;
}

static void start_anew(struct rejoin_room *room)
{
	memset(room->begun_ns, 0, room->most * sizeof *room->begun_ns);
	memset(room->applied_ns, 0,
	       room->cluster.node_count * room->most * sizeof *room->applied_ns);
	memset(room->late, 0, room->most);
	atomic_store(&room->dies_after, 0);
	atomic_store(&room->last, 0);
	atomic_store(&room->back_ns, 0);
	atomic_store(&room->shows_ns, 0);
	for (unsigned i = 0; i < CLUSTER_NODES_MOST; i++)
		atomic_store(&room->whole_ns[i], 0);
}

static void print_row(const char *run, const struct figures *f)
{
	printf("| %s | %.0f | %.0f | %.1f | %.0f | %.0f / %.0f / %.0f | %.0f / %.0f / %.0f | %.2f, "
	       "%.2f | %.0f |\n",
	       run, f->shows_ms, f->whole_ms, f->megabytes, f->frames, f->quiet_p50, f->quiet_p99,
	       f->quiet_most, f->back_p50, f->back_p99, f->back_most, f->quiet_gap, f->back_gap,
	       f->late);
	fflush(stdout);
}

static int run_all(struct rejoin_room *room, const struct cluster_options *o)
{
	static struct figures all[CLUSTER_RUNS_MOST];
	struct figures median;
	char name[16];

	printf("| run | shows after, ms | all have the light after, ms | MB sent | frames | delta, "
	       "alone, p50 / p99 / "
	       "worst, us | while it comes back | longest from frame to frame, periods: alone, "
	       "then | late frames of "
	       "the others |\n|---|---|---|---|---|---|---|---|---|\n");
	for (int run = 0; run < o->runs; run++) {
		start_anew(room);
		if (!cluster_run(&room->cluster))
			return GR_EXIT_RUNTIME;
		all[run] = look(room);
		snprintf(name, sizeof name, "%d", run + 1);
		print_row(name, &all[run]);
	}
	for (size_t at = 0; at < sizeof median; at += sizeof(double)) {
		const double value = cluster_median(all, sizeof *all, at, o->runs);

		memcpy((char *)&median + at, &value, sizeof value);
	}
	print_row("median", &median);
	return GR_EXIT_OK;
}

static int measure(const struct cluster_options *o);

static const struct cluster_bench bench = {
	.name = "bench-rejoin",
	.usage = "bench-rejoin [--nodes N] [--rate HZ] [--frames N] [--runs N] [--loopback 1] "
		 "[--multicast 1]",
	.summary = "A node dies and comes back to a room whose light of 8 MiB is shared out: when "
		   "it shows,\n"
		   "when all have all of the light again, and what the others' frames see of it; "
		   "in network\n"
		   "namespaces where that is allowed, else over loopback.",
	.samples = "frames",
	.samples_most = REJOIN_FRAMES_MOST / 4,
	.nodes_least = 3,
	.port = 29500,
	.group = "239.192.77.5",
	.network = "10.99.4",
	.measure = measure,
	.run = run_end,
};

static int measure(const struct cluster_options *o)
{
	struct rejoin_room *room = make_room(o);
	int status;

	if (!room) {
		fprintf(stderr, "%s: no memory\n", bench.name);
		return GR_EXIT_RUNTIME;
	}
	room->cluster.share_bytes = FDP_SHARE_MAX;
	if (!cluster_begin(&room->cluster, &bench, o, room))
		return GR_EXIT_RUNTIME;
	printf("%d nodes, %d Hz, %s, %s, SCHED_RR %d; a node stays away for %d frames\n\n",
	       o->nodes, o->hz,
	       room->cluster.spaces ? "a namespace and veth each, one bridge" : "loopback",
	       o->multicast ? "multicast" : "unicast", CLUSTER_PRIORITY, REJOIN_AWAY);
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
