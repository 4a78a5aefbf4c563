/*
 * bench-delivery: how long an update takes from the master to the last node,
 * with loss and without, beside bare datagrams of the same size in the same run
 * (at no loss: the floor). One program for each size of update.
 */
#include "tools/bench/delivery.h"

#include "base/result.h"
#include "tools/bench/stats.h"

#include <stdio.h>
#include <string.h>

#define WARM 60
#define PLAIN_BYTES 200 /* of an update without ballast */

static struct delivery_room *make_room(const struct cluster_options *o)
{
	struct delivery_room *room = cluster_shared(sizeof *room);
	const size_t updates = (size_t)o->samples;

	if (!room)
		return NULL;
	room->update_bytes = PLAIN_BYTES + delivery_ballast();
	room->updates = (unsigned)o->samples;
	room->warm = WARM;
	for (int way = 0; way < DELIVERY_WAYS; way++) {
		room->sent_ns[way] = cluster_shared(updates * sizeof(int64_t));
		room->arrived_ns[way] = cluster_shared((size_t)o->nodes * updates * sizeof(int64_t));
		if (!room->sent_ns[way] || !room->arrived_ns[way])
			return NULL;
	}
	return room;
}

static void run_end(void *ctx, unsigned end)
{
	struct delivery_room *room = ctx;

	/* What is lost is lost at the ingress of each, before it is anybody's. */
	if (room->cluster.spaces && !delivery_lose(room->loss_permille))
		atomic_store(&room->cluster.failed, true);
	if (atomic_load(&room->cluster.failed))
		return;
	if (end == room->cluster.node_count)
		delivery_master(room);
	else
		delivery_node(room, end);
}

struct figures {
	double p50, p99, most; /* us; NaN: none came */
	double missed; /* updates that did not reach all while they were the newest, in a million */
	double bytes;  /* an update, sent to all */
};

static struct figures look(const struct delivery_room *room, enum delivery_way way)
{
	static double took[DELIVERY_UPDATES_MOST];
	struct figures f = { .missed = 0 };
	size_t count = 0;

	for (unsigned u = 0; u < room->updates; u++) {
		int64_t last = 0;
		bool all = true;

		for (unsigned i = 0; i < room->cluster.node_count; i++) {
			const int64_t at = room->arrived_ns[way][(size_t)i * room->updates + u];

			all = all && at;
			last = at > last ? at : last;
		}
		if (all)
			took[count++] = (double)(last - room->sent_ns[way][u]) * 1e-3;
	}
	f.missed = (double)(room->updates - count) * 1e6 / (double)room->updates;
	stats_sort(took, count);
	f.p50 = stats_quantile(took, count, 0.5);
	f.p99 = stats_quantile(took, count, 0.99);
	f.most = stats_quantile(took, count, 1);
	f.bytes = (double)room->bytes_out / (double)room->updates;
	return f;
}

static void print_row(const struct delivery_room *room, const struct cluster_options *o,
		      const struct figures *f, const struct figures *bare, const struct figures *lossless)
{
#define MEDIAN(of, member) cluster_median(of, sizeof *(of), offsetof(struct figures, member), o->runs)
	const double floor = MEDIAN(lossless, p50);

	printf("| %zu | %d | %d | %s | %g %% | %.0f / %.0f / %.0f | %.2f / %.2f | %.0f / %.0f / %.0f | "
	       "%.0f | %.0f | %.0f |\n",
	       room->update_bytes, o->nodes, o->hz,
	       o->multicast ? "multicast" : "unicast", (double)room->loss_permille / 10, MEDIAN(f, p50),
	       MEDIAN(f, p99), MEDIAN(f, most), MEDIAN(f, p50) / floor,
	       MEDIAN(f, p99) / floor, MEDIAN(bare, p50), MEDIAN(bare, p99),
	       MEDIAN(bare, most), MEDIAN(f, missed), MEDIAN(bare, missed), MEDIAN(f, bytes));
	fflush(stdout);
#undef MEDIAN
}

/* All runs at one loss, and their row; lossless: what the floor is of. */
static bool run_loss(struct delivery_room *room, const struct cluster_options *o, unsigned permille,
		     struct figures *lossless)
{
	static struct figures fdp[CLUSTER_RUNS_MOST], bare[CLUSTER_RUNS_MOST];

	room->loss_permille = permille;
	for (int run = 0; run < o->runs; run++) {
		for (int way = 0; way < DELIVERY_WAYS; way++)
			memset(room->arrived_ns[way], 0, (size_t)o->nodes * room->updates * sizeof(int64_t));
		if (!cluster_run(&room->cluster))
			return false;
		fdp[run] = look(room, DELIVERY_FDP);
		bare[run] = look(room, DELIVERY_BARE);
		if (!permille)
			lossless[run] = bare[run];
	}
	print_row(room, o, fdp, bare, lossless);
	return true;
}

static int run_all(struct delivery_room *room, const struct cluster_options *o)
{
	static const unsigned losses[] = { 0, 10, 50 }; /* permille */
	static struct figures lossless[CLUSTER_RUNS_MOST];
	/* Loopback loses nothing. */
	const size_t count = room->cluster.spaces ? sizeof losses / sizeof *losses : 1;

	printf("| bytes | nodes | Hz | way | loss | FDP p50 / p99 / worst, us | in floor's p50 | bare p50 / "
	       "p99 / worst, us | FDP missed, ppm | bare missed, ppm | FDP bytes an update |\n"
	       "|---|---|---|---|---|---|---|---|---|---|---|\n");
	for (size_t k = 0; k < count; k++)
		if (!run_loss(room, o, losses[k], lossless))
			return GR_EXIT_RUNTIME;
	return GR_EXIT_OK;
}

static int measure(const struct cluster_options *o);

static const struct cluster_bench bench = {
	.name = "bench-delivery",
	.usage = "bench-delivery-SIZE [--nodes N] [--rate HZ] [--updates N] [--runs N] [--loopback 1] [--multicast 1]",
	.summary = "How long an update of SIZE takes from the master to the last node, beside bare datagrams,\n"
		   "with loss and without; in network namespaces where that is allowed, else over loopback.",
	.samples = "updates", .samples_most = DELIVERY_UPDATES_MOST,
	.port = 29300, .group = "239.192.78.1", .network = "10.98.0",
	.measure = measure, .run = run_end,
};

static int measure(const struct cluster_options *o)
{
	struct delivery_room *room = make_room(o);
	int status;

	if (!room) {
		fprintf(stderr, "%s: no memory\n", bench.name);
		return GR_EXIT_RUNTIME;
	}
	if (!cluster_begin(&room->cluster, &bench, o, room))
		return GR_EXIT_RUNTIME;
	printf("%u updates after %u, medians of %d runs, %s, SCHED_RR %d\n\n", room->updates, room->warm,
	       o->runs, room->cluster.spaces ?
	       "a namespace and veth each, one bridge, loss by nftables at ingress" : "loopback, no loss",
	       CLUSTER_PRIORITY);
	fflush(stdout);
	status = run_all(room, o);
	cluster_end(&room->cluster);
	return status;
}

int main(int argc, char **argv)
{
	return cluster_main(&bench, argc, argv);
}
