/*
 * bench-delivery: how long an update takes from the master to the last node,
 * with loss and without, beside bare datagrams of the same size in the same run
 * (at no loss: the floor), the same signed, and beside others' ways. One program
 * for each size of update.
 */
#include "tools/bench/delivery.h"

#include "base/clock.h"
#include "base/result.h"
#include "tools/bench/stats.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define WARM 60
#define PLAIN_BYTES 200 /* of an update without ballast */
#define LATE_US 8333.3  /* a frame at 120 Hz */

struct options {
	struct cluster_options cluster; /* first: what measure() is given */
	int peers;
	const char *loss, *parity;
};

/* In the order of the table; `word` is the option's. */
static const struct kind_of_loss {
	const char *word;
	struct delivery_loss loss;
} losses[] = {
	{ "0", { "0 %", 0, 0, 0 } }, { "1", { "1 %", 10, 0, 0 } }, { "5", { "5 %", 50, 0, 0 } },
	/* The kernel counts in jiffies: 4 ms become 4 to 8. */
	{ "burst", { "bursts", 2, 4, 0 } },
	{ "runs", { "5 % in runs of 4", 50, 0, 4 } },
};
#define LOSSES (sizeof losses / sizeof *losses)

static const char *const parities[] = {
	[FDP_PARITY_AUTO] = "auto", [FDP_PARITY_OFF] = "off", [FDP_PARITY_ON] = "on",
};
#define PARITIES (sizeof parities / sizeof *parities)

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

void delivery_note(struct delivery_room *room, unsigned way, unsigned node, uint64_t update)
{
	if (update < room->updates)
		room->arrived_ns[way][(size_t)node * room->updates + update] =
			gr_clock_now(&gr_clock_monotonic);
}

static void run_end(void *ctx, unsigned end)
{
	struct delivery_room *room = ctx;
	const bool master = end == room->cluster.node_count;

	/* What is lost is lost at the ingress of each, before it is anybody's. */
	if (room->cluster.spaces && !delivery_lose(&room->loss))
		atomic_store(&room->cluster.failed, true);
	if (atomic_load(&room->cluster.failed))
		return;
	if (room->way >= DELIVERY_PEER && master)
		delivery_peer_sender(room);
	else if (room->way >= DELIVERY_PEER)
		delivery_peer_receiver(room, end);
	else if (master)
		delivery_master(room);
	else
		delivery_node(room, end);
}

struct figures {
	double p50, p99, most; /* us; NaN: none came */
	double late;           /* updates that came later than LATE_US, in a million */
	double missed;         /* that did not reach all, of the protocol while they were the newest */
	double bytes;          /* an update, sent to all; NaN: not counted */
};

static struct figures look(const struct delivery_room *room, unsigned way)
{
	static double took[DELIVERY_UPDATES_MOST];
	struct figures f = { .bytes = NAN };
	size_t count = 0, late = 0;

	for (unsigned u = 0; u < room->updates; u++) {
		int64_t last = 0;
		bool all = true;

		for (unsigned i = 0; i < room->cluster.node_count; i++) {
			const int64_t at = room->arrived_ns[way][(size_t)i * room->updates + u];

			all = all && at;
			last = at > last ? at : last;
		}
		if (!all)
			continue;
		took[count] = (double)(last - room->sent_ns[way][u]) * 1e-3;
		late += took[count++] > LATE_US;
	}
	f.missed = (double)(room->updates - count) * 1e6 / (double)room->updates;
	f.late = (double)late * 1e6 / (double)room->updates;
	stats_sort(took, count);
	f.p50 = stats_quantile(took, count, 0.5);
	f.p99 = stats_quantile(took, count, 0.99);
	f.most = stats_quantile(took, count, 1);
	if (way == DELIVERY_FDP)
		f.bytes = (double)room->bytes_out / (double)room->updates;
	return f;
}

static const char *way_name(unsigned way)
{
	static const char *const names[] = {
		[DELIVERY_BARE] = "bare UDP", [DELIVERY_SIGNED] = "bare UDP, signed", [DELIVERY_FDP] = "FDP",
	};

	return way < DELIVERY_PEER ? names[way] : peers[way - DELIVERY_PEER]->name;
}

static bool built(unsigned way)
{
	return way < DELIVERY_PEER || peers[way - DELIVERY_PEER]->open;
}

/* floor: NaN where it was not measured. */
static void print_row(const struct delivery_room *room, const struct cluster_options *o, unsigned way,
		      const struct figures *f, double floor)
{
#define MEDIAN(member) cluster_median(f, sizeof *f, offsetof(struct figures, member), o->runs)
	printf("| %zu | %d | %d | %s | %s | ", room->update_bytes, o->nodes, o->hz, room->loss.name, way_name(way));
	if (!built(way)) {
		printf("not built | | | | |\n");
		return;
	}
	if (isnan(MEDIAN(p50)))
		printf("none came | ");
	else
		printf("%.0f / %.0f / %.0f | ", MEDIAN(p50), MEDIAN(p99), MEDIAN(most));
	if (isnan(floor) || isnan(MEDIAN(p50)))
		printf("- | ");
	else
		printf("%.2f / %.2f | ", MEDIAN(p50) / floor, MEDIAN(p99) / floor);
	printf("%.0f | %.0f | ", MEDIAN(late), MEDIAN(missed));
	if (way == DELIVERY_FDP)
		printf("%.0f ", MEDIAN(bytes));
	printf("|\n");
	fflush(stdout);
#undef MEDIAN
}

/* One run of each way, each with sockets of its own. */
static bool run_ways(struct delivery_room *room, unsigned ways)
{
	for (unsigned way = DELIVERY_FDP; way < ways; way++) {
		if (!built(way))
			continue;
		room->way = way;
		atomic_store(&room->here, 0);
		atomic_store(&room->arrivals, 0);
		if (!cluster_run(&room->cluster))
			return false;
	}
	return true;
}

/* All runs at one loss, and their rows; *floor: what ratios are to, set where nothing is lost. */
static bool run_loss(struct delivery_room *room, const struct cluster_options *o, unsigned ways,
		     double *floor)
{
	static struct figures f[DELIVERY_WAYS][CLUSTER_RUNS_MOST];

	for (int run = 0; run < o->runs; run++) {
		for (int way = 0; way < DELIVERY_WAYS; way++)
			memset(room->arrived_ns[way], 0, (size_t)o->nodes * room->updates * sizeof(int64_t));
		if (!run_ways(room, ways))
			return false;
		for (unsigned way = 0; way < ways; way++)
			f[way][run] = look(room, way);
	}
	if (!room->loss.permille)
		*floor = cluster_median(f[DELIVERY_BARE], sizeof **f, offsetof(struct figures, p50), o->runs);
	for (unsigned way = 0; way < ways; way++)
		print_row(room, o, way, f[way], *floor);
	return true;
}

static int run_all(struct delivery_room *room, const struct options *o)
{
	const unsigned ways = o->peers && room->cluster.spaces ? DELIVERY_WAYS : DELIVERY_PEER;
	double floor = NAN;

	printf("| bytes | nodes | Hz | loss | who | p50 / p99 / worst, us | in floor's p50 | over 8.3 ms, ppm | "
	       "missed, ppm | bytes an update |\n|---|---|---|---|---|---|---|---|---|---|\n");
	for (size_t k = 0; k < LOSSES; k++) {
		/* Loopback loses nothing by itself. */
		if (!room->cluster.spaces && losses[k].loss.permille && !losses[k].loss.run)
			continue;
		if (strcmp(o->loss, "all") != 0 && strcmp(o->loss, losses[k].word) != 0)
			continue;
		room->loss = losses[k].loss;
		/* The peers' datagrams are not ours to drop. */
		if (!run_loss(room, &o->cluster, room->loss.run ? DELIVERY_PEER : ways, &floor))
			return GR_EXIT_RUNTIME;
	}
	return GR_EXIT_OK;
}

static bool known_loss(const char *word)
{
	bool known = !strcmp(word, "all");

	for (size_t k = 0; k < LOSSES; k++)
		known = known || !strcmp(word, losses[k].word);
	if (!known)
		fprintf(stderr, "--loss %s: it is 0, 1, 5, burst, runs or all\n", word);
	return known;
}

static bool known_parity(const char *word, enum fdp_parity *out)
{
	for (size_t k = 0; k < PARITIES; k++) {
		if (strcmp(parities[k], word) != 0)
			continue;
		*out = (enum fdp_parity)k;
		return true;
	}
	fprintf(stderr, "--parity %s: it is auto, off or on\n", word);
	return false;
}

static int measure(const struct cluster_options *cluster);

static struct cluster_bench make_bench(const struct cli_option *options, size_t count)
{
	return (struct cluster_bench){
		.name = "bench-delivery",
		.usage = "bench-delivery-SIZE [--nodes N] [--rate HZ] [--updates N] [--runs N] [--loopback 1] "
			 "[--multicast 1] [--peers 1] [--loss 0|1|5|burst|runs|all] "
			 "[--parity auto|off|on]",
		.summary = "How long an update of SIZE takes from the master to the last node, beside bare datagrams\n"
			   "and with --peers beside TCP, ENet, NORM and OpenPGM, with loss and without; in network\n"
			   "namespaces where that is allowed, else over loopback.",
		.samples = "updates", .samples_most = DELIVERY_UPDATES_MOST, .nodes_least = 1,
		.options = options, .option_count = count,
		.port = 29300, .group = "239.192.78.1", .network = "10.98.0",
		.measure = measure, .run = run_end,
	};
}

static int measure(const struct cluster_options *cluster)
{
	const struct options *o = (const struct options *)cluster;
	const struct cluster_bench bench = make_bench(NULL, 0);
	struct delivery_room *room;
	enum fdp_parity parity;
	int status;

	if (!known_loss(o->loss) || !known_parity(o->parity, &parity))
		return GR_EXIT_CONFIG;
	room = make_room(cluster);
	if (!room) {
		fprintf(stderr, "%s: no memory\n", bench.name);
		return GR_EXIT_RUNTIME;
	}
	room->parity = parity;
	if (!cluster_begin(&room->cluster, &bench, cluster, room))
		return GR_EXIT_RUNTIME;
	printf("%u updates after %u, medians of %d runs, %s, %s, SCHED_RR %d\n\n", room->updates, room->warm,
	       cluster->runs, cluster->multicast ? "multicast" : "unicast", room->cluster.spaces ?
	       "a namespace and veth each, one bridge, loss by nftables at ingress" : "loopback, no loss",
	       CLUSTER_PRIORITY);
	fflush(stdout);
	status = run_all(room, o);
	cluster_end(&room->cluster);
	return status;
}

int main(int argc, char **argv)
{
	struct options o = { .cluster = CLUSTER_DEFAULTS, .loss = "all", .parity = parities[FDP_PARITY_AUTO] };
	const struct cli_option own[] = {
		{ "peers", 0, CLI_INT, &o.peers, 0, 1, "0|1", "others' ways, too, in namespaces (0)" },
		{ "loss", 0, CLI_TEXT, &o.loss, 0, 0, "KIND", "0, 1 or 5 percent, burst, runs or all (all)" },
		{ "parity", 0, CLI_TEXT, &o.parity, 0, 0, "WHEN", "FDP's parity fragments: auto, off or on (auto)" },
	};
	const struct cluster_bench bench = make_bench(own, sizeof own / sizeof *own);

	return cluster_main(&bench, &o.cluster, argc, argv);
}
