/*
 * bench-delivery: how long an update takes from the master to the last node,
 * with loss and without, beside bare datagrams of the same size in the same run
 * (at no loss: the floor). One program for each size of update. All processes are
 * on one machine and have one CLOCK_MONOTONIC.
 */
#include <config.h> /* SCHED_IDLE */

#include "tools/bench/barrier.h"
#include "tools/bench/delivery.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "daemon/priority.h"

#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#define RUNS_MOST 50
#define PRIORITY 5
#define WARM 60
#define BASE_PORT 29300

struct options {
	long nodes, hz, updates, runs, loopback, multicast;
};

static int compare(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static double quantile(double *values, size_t count, double q)
{
	qsort(values, count, sizeof *values, compare);
	return count ? values[(size_t)(q * (double)(count - 1))] : 0;
}

static void *shared(size_t size)
{
	void *p = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);

	return p == MAP_FAILED ? NULL : p;
}

static struct delivery_room *make_room(const struct options *o)
{
	struct delivery_room *room = shared(sizeof *room);
	const size_t cells = (size_t)o->nodes * (size_t)o->updates;
	pthread_barrierattr_t attr;

	if (!room)
		return NULL;
	room->node_count = (unsigned)o->nodes;
#ifdef PARAM_BALLAST
	room->update_bytes = 4 * PARAM_BALLAST + 200;
#else
	room->update_bytes = 200;
#endif
	room->updates = (unsigned)o->updates;
	room->warm = WARM;
	room->period_ns = GR_NS_PER_S / o->hz;
	room->layout.nodes = room->nodes;
	room->layout.node_count = (size_t)o->nodes;
	room->layout.network.mtu = 1500;
	room->layout.network.master_port = BASE_PORT;
	room->layout.network.cast = o->multicast ? LAYOUT_MULTICAST : LAYOUT_UNICAST;
	if (o->multicast) {
		room->layout.network.group = strcpy(room->group, "239.192.78.1");
		room->layout.network.group_port = BASE_PORT + 100;
		room->layout.network.ttl = 1;
	}
	for (int way = 0; way < DELIVERY_WAYS; way++) {
		room->sent_ns[way] = shared((size_t)o->updates * sizeof(int64_t));
		room->arrived_ns[way] = shared(cells * sizeof(int64_t));
		if (!room->sent_ns[way] || !room->arrived_ns[way])
			return NULL;
	}
	pthread_barrierattr_init(&attr);
	pthread_barrierattr_setpshared(&attr, PTHREAD_PROCESS_SHARED);
	pthread_barrier_init(&room->step, &attr, (unsigned)o->nodes + 2);
	pthread_barrierattr_destroy(&attr);
	return room;
}

/* Before any process is made: they have the same. */
static void give_addresses(struct delivery_room *room, bool spaces)
{
	for (unsigned i = 0; i <= room->node_count; i++) {
		if (spaces)
			snprintf(room->addresses[i], sizeof room->addresses[i], "10.98.0.%u", i + 1);
		else
			snprintf(room->addresses[i], sizeof room->addresses[i], "127.0.0.1");
		if (i == room->node_count)
			break;
		snprintf(room->nodes[i].name, sizeof room->nodes[i].name, "n%u", i + 1);
		room->nodes[i].address = room->addresses[i];
		room->nodes[i].port = (uint16_t)(BASE_PORT + 1 + i);
	}
	if (spaces)
		room->layout.network.interface = strcpy(room->interface, "eth0");
	room->layout.network.master_address = room->addresses[room->node_count];
}

/* A processor that never halts: waking a virtual one costs more than what is measured. */
static void spin(void)
{
	const struct sched_param param = { .sched_priority = 0 };

	prctl(PR_SET_PDEATHSIG, SIGKILL);
	sched_setscheduler(0, SCHED_IDLE, &param);
	for (;;)
		;
}

/* An end lives through all runs: end node_count is the master. */
static void live(struct delivery_room *room, unsigned end, bool spaces, long runs)
{
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (spaces && !barrier_net_leave())
		atomic_store(&room->failed, 1);
	pthread_barrier_wait(&room->step); /* in its own namespace */
	pthread_barrier_wait(&room->step); /* connected */
	if (spaces && !barrier_net_address(room->addresses[end]))
		atomic_store(&room->failed, 1);
	priority_take(PRIORITY);
	for (long run = 0; run < runs; run++) {
		pthread_barrier_wait(&room->step);
		/* What is lost is lost at the ingress of each, before it is anybody's. */
		if (spaces && !delivery_lose(room->loss_permille))
			atomic_store(&room->failed, 1);
		if (!atomic_load(&room->failed)) {
			if (end == room->node_count)
				delivery_master(room);
			else
				delivery_node(room, end);
		}
		pthread_barrier_wait(&room->step);
	}
	_exit(0);
}

struct figures {
	double p50, p99, most;
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

		for (unsigned i = 0; i < room->node_count; i++) {
			const int64_t at = room->arrived_ns[way][(size_t)i * room->updates + u];

			all = all && at;
			last = at > last ? at : last;
		}
		if (all)
			took[count++] = (double)(last - room->sent_ns[way][u]) * 1e-3;
	}
	f.missed = (double)(room->updates - count) * 1e6 / (double)room->updates;
	f.p50 = quantile(took, count, 0.5);
	f.p99 = quantile(took, count, 0.99);
	f.most = quantile(took, count, 1);
	f.bytes = (double)room->bytes_out / (double)room->updates;
	return f;
}

static double median(const struct figures *f, long runs, size_t offset)
{
	double values[RUNS_MOST];

	for (long i = 0; i < runs; i++)
		memcpy(&values[i], (const char *)&f[i] + offset, sizeof values[i]);
	return quantile(values, (size_t)runs, 0.5);
}

static void print_row(const struct delivery_room *room, const struct options *o,
		      const struct figures *f, const struct figures *bare, const struct figures *lossless)
{
#define MEDIAN(of, member) median(of, o->runs, offsetof(struct figures, member))
	const double floor = MEDIAN(lossless, p50);

	printf("| %llu | %u | %ld | %s | %g %% | %.0f / %.0f / %.0f | %.2f / %.2f | %.0f / %.0f / %.0f | "
	       "%.0f | %.0f | %.0f |\n",
	       (unsigned long long)room->update_bytes, room->node_count, o->hz,
	       o->multicast ? "multicast" : "unicast", (double)room->loss_permille / 10, MEDIAN(f, p50),
	       MEDIAN(f, p99), MEDIAN(f, most), floor > 0 ? MEDIAN(f, p50) / floor : 0,
	       floor > 0 ? MEDIAN(f, p99) / floor : 0, MEDIAN(bare, p50), MEDIAN(bare, p99),
	       MEDIAN(bare, most), MEDIAN(f, missed), MEDIAN(bare, missed), MEDIAN(f, bytes));
	fflush(stdout);
#undef MEDIAN
}

static const unsigned losses[] = { 0, 10, 50 }; /* permille */
#define LOSSES (sizeof losses / sizeof *losses)

static int run_all(struct delivery_room *room, const struct options *o, bool spaces)
{
	static struct figures fdp[RUNS_MOST], bare[RUNS_MOST], lossless[RUNS_MOST];

	printf("| bytes | nodes | Hz | way | loss | FDP p50 / p99 / worst, us | in floor's p50 | bare p50 / "
	       "p99 / worst, us | FDP missed, ppm | bare missed, ppm | FDP bytes an update |\n"
	       "|---|---|---|---|---|---|---|---|---|---|---|\n");
	for (size_t k = 0; k < LOSSES; k++) {
		for (long run = 0; run < o->runs; run++) {
			room->loss_permille = spaces ? losses[k] : 0;
			room->session = k * RUNS_MOST + (uint64_t)run + 1;
			atomic_store(&room->over, false);
			for (int way = 0; way < DELIVERY_WAYS; way++)
				memset(room->arrived_ns[way], 0,
				       (size_t)room->node_count * room->updates * sizeof(int64_t));
			pthread_barrier_wait(&room->step);
			pthread_barrier_wait(&room->step);
			if (atomic_load(&room->failed))
				return GR_EXIT_RUNTIME;
			fdp[run] = look(room, DELIVERY_FDP);
			bare[run] = look(room, DELIVERY_BARE);
			if (!k)
				lossless[run] = bare[run];
		}
		if (!k || spaces)
			print_row(room, o, fdp, bare, lossless);
	}
	return GR_EXIT_OK;
}

static int bench(const struct options *o)
{
	struct delivery_room *room = make_room(o);
	const bool spaces = room && !o->loopback && barrier_net_hub();
	pid_t ends[DELIVERY_NODES_MOST + 1] = { 0 }, spinners[2] = { 0, 0 };
	int status;

	if (!room) {
		fprintf(stderr, "bench-delivery: no memory\n");
		return GR_EXIT_RUNTIME;
	}
	give_addresses(room, spaces);
	for (int i = 0; i < 2; i++)
		if ((spinners[i] = fork()) == 0)
			spin();
	for (unsigned i = 0; i <= room->node_count; i++)
		if ((ends[i] = fork()) == 0)
			live(room, i, spaces, (long)LOSSES * o->runs);
	pthread_barrier_wait(&room->step);
	for (unsigned i = 0; spaces && i <= room->node_count; i++)
		if (!barrier_net_connect(i, ends[i]))
			atomic_store(&room->failed, 1);
	pthread_barrier_wait(&room->step);
	printf("%u updates after %u, medians of %ld runs, %s, SCHED_RR %d\n\n", room->updates, room->warm,
	       o->runs, spaces ? "a namespace and veth each, one bridge, loss by nftables at ingress" :
	       "loopback, no loss", PRIORITY);
	fflush(stdout);
	status = run_all(room, o, spaces);
	for (unsigned i = 0; i <= room->node_count; i++) {
		if (status != GR_EXIT_OK)
			kill(ends[i], SIGKILL);
		waitpid(ends[i], NULL, 0);
	}
	for (int i = 0; i < 2; i++) {
		kill(spinners[i], SIGKILL);
		waitpid(spinners[i], NULL, 0);
	}
	if (status != GR_EXIT_OK)
		fprintf(stderr, "bench-delivery: an end could not begin, or its loop failed\n");
	return status;
}

static bool take_number(const char *text, long least, long most, long *out)
{
	char *end;

	errno = 0;
	*out = strtol(text, &end, 10);
	return !errno && end != text && !*end && *out >= least && *out <= most;
}

int main(int argc, char **argv)
{
	struct options o = { .nodes = 4, .hz = 120, .updates = 600, .runs = 5 };
	const struct {
		const char *name;
		long least, most, *value;
	} known[] = {
		{ "--nodes", 2, DELIVERY_NODES_MOST, &o.nodes }, { "--rate", 1, 1000, &o.hz },
		{ "--updates", 10, DELIVERY_UPDATES_MOST, &o.updates }, { "--runs", 1, RUNS_MOST, &o.runs },
		{ "--loopback", 0, 1, &o.loopback },
		{ "--multicast", 0, 1, &o.multicast },
	};
	const size_t count = sizeof known / sizeof *known;

	gr_log_init("bench-delivery", GR_LOG_WARNING);
	for (int i = 1; i < argc; i += 2) {
		size_t k = 0;

		while (k < count && strcmp(argv[i], known[k].name))
			k++;
		if (k < count && i + 1 < argc &&
		    take_number(argv[i + 1], known[k].least, known[k].most, known[k].value))
			continue;
		fprintf(stderr, "bench-delivery: '%s': there are --nodes 2..%d, --rate 1..1000, --updates 10..%d, --runs 1..%d, --loopback 0..1, --multicast 0..1\n",
			argv[i], DELIVERY_NODES_MOST, DELIVERY_UPDATES_MOST, RUNS_MOST);
		return GR_EXIT_CONFIG;
	}
	return bench(&o);
}
