/*
 * bench-barrier: how far apart nodes leave the barrier, when told and at a
 * time, in turns; `grotto bench barrier` starts it. All processes are on one
 * machine and have one CLOCK_MONOTONIC, so what is printed is the truth; beside
 * it what the master believes from its estimates of the nodes' clocks.
 */
#include <config.h> /* SCHED_IDLE */

#include "tools/bench/barrier.h"

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
#define WARM 100
#define BASE_PORT 29100

struct options {
	long nodes, hz, frames, runs, loopback, multicast;
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

static struct barrier_room *make_room(const struct options *o)
{
	struct barrier_room *room = shared(sizeof *room);
	const size_t cells = (size_t)o->nodes * (size_t)o->frames;
	pthread_barrierattr_t attr;

	if (!room)
		return NULL;
	room->node_count = (unsigned)o->nodes;
	room->frames = (unsigned)o->frames;
	room->warm = WARM;
	room->period_ns = GR_NS_PER_S / o->hz;
	room->layout.nodes = room->nodes;
	room->layout.node_count = (size_t)o->nodes;
	room->layout.network.mtu = 1500;
	room->layout.network.master_port = BASE_PORT;
	room->layout.network.cast = o->multicast ? LAYOUT_MULTICAST : LAYOUT_UNICAST;
	if (o->multicast) {
		room->layout.network.group = strcpy(room->group, "239.192.77.1");
		room->layout.network.group_port = BASE_PORT + 100;
		room->layout.network.ttl = 1;
	}
	room->layout.swap.busy_poll_ns = 200 * GR_NS_PER_US;
	room->swap_ns = shared(cells * sizeof *room->swap_ns);
	room->ready_ns = shared(cells * sizeof *room->ready_ns);
	pthread_barrierattr_init(&attr);
	pthread_barrierattr_setpshared(&attr, PTHREAD_PROCESS_SHARED);
	pthread_barrier_init(&room->step, &attr, (unsigned)o->nodes + 2);
	pthread_barrierattr_destroy(&attr);
	return room->swap_ns && room->ready_ns ? room : NULL;
}

/* Before any process is made: they have the same. */
static void give_addresses(struct barrier_room *room, bool spaces)
{
	for (unsigned i = 0; i <= room->node_count; i++) {
		if (spaces)
			snprintf(room->addresses[i], sizeof room->addresses[i], "10.99.0.%u", i + 1);
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
static void live(struct barrier_room *room, unsigned end, bool spaces, long runs)
{
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (spaces && !barrier_net_leave())
		atomic_store(&room->failed, 1);
	pthread_barrier_wait(&room->step); /* in its own namespace */
	pthread_barrier_wait(&room->step); /* connected */
	if (spaces && !barrier_net_address(room->addresses[end]))
		atomic_store(&room->failed, 1);
	priority_take(PRIORITY);
	for (long run = 0; run < 2 * runs; run++) {
		pthread_barrier_wait(&room->step);
		if (!atomic_load(&room->failed)) {
			if (end == room->node_count)
				barrier_master(room);
			else
				barrier_node(room, end);
		}
		pthread_barrier_wait(&room->step);
	}
	_exit(0);
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

		for (unsigned i = 0; i < room->node_count; i++) {
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
	f.p50 = quantile(skew, f.frames, 0.5);
	f.p95 = quantile(skew, f.frames, 0.95);
	f.p99 = quantile(skew, f.frames, 0.99);
	f.most = quantile(skew, f.frames, 1);
	f.enter_p50 = quantile(wait, f.frames, 0.5);
	for (unsigned i = 0; i < room->node_count; i++) {
		const double off = room->clock_off_us[i] < 0 ? -room->clock_off_us[i] : room->clock_off_us[i];

		f.off = off > f.off ? off : f.off;
	}
	return f;
}

static double median(const struct figures *f, long runs, size_t offset)
{
	double values[RUNS_MOST];

	for (long i = 0; i < runs; i++)
		memcpy(&values[i], (const char *)&f[i] + offset, sizeof values[i]);
	return quantile(values, (size_t)runs, 0.5);
}

static void print_medians(const char *how, const struct figures *f, long runs)
{
#define MEDIAN(member) median(f, runs, offsetof(struct figures, member))
	printf("%-9s %8.1f %8.1f %8.1f %9.1f %12.1f %14.1f / %.1f\n", how, MEDIAN(p50), MEDIAN(p95),
	       MEDIAN(p99), MEDIAN(most), MEDIAN(enter_p50), MEDIAN(seen_p50), MEDIAN(seen_p99));
#undef MEDIAN
}

static int run_all(struct barrier_room *room, const struct options *o)
{
	static struct figures told[RUNS_MOST], timed[RUNS_MOST];

	for (long run = 0; run < 2 * o->runs; run++) {
		const bool scheduled = run & 1;
		struct figures f;

		room->swap = scheduled ? FDP_SWAP_AUTO : FDP_SWAP_MESSAGE;
		room->session = (uint64_t)run + 1;
		room->scheduled = room->late = 0;
		atomic_store(&room->over, false);
		memset(room->swap_ns, 0, room->node_count * (size_t)room->frames * sizeof(int64_t));
		memset(room->ready_ns, 0, room->node_count * (size_t)room->frames * sizeof(int64_t));
		pthread_barrier_wait(&room->step);
		pthread_barrier_wait(&room->step);
		if (atomic_load(&room->failed))
			return GR_EXIT_RUNTIME;
		f = look(room);
		*(scheduled ? &timed[run / 2] : &told[run / 2]) = f;
		printf("run %ld, %-9s: exit skew p50 %6.1f p95 %6.1f p99 %6.1f us; %zu frames, %llu with a "
		       "time, %llu late; clocks off by at most %.1f us\n", run / 2 + 1,
		       scheduled ? "at a time" : "told", f.p50, f.p95, f.p99, f.frames,
		       (unsigned long long)room->scheduled, (unsigned long long)room->late, f.off);
		fflush(stdout);
	}
	printf("\nmedians of %ld runs, us      p50      p95      p99   longest\n", o->runs);
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

static int bench(const struct options *o)
{
	struct barrier_room *room = make_room(o);
	const bool spaces = room && !o->loopback && barrier_net_hub();
	pid_t ends[BARRIER_NODES_MOST + 1] = { 0 }, spinners[2] = { 0, 0 };
	int status;

	if (!room) {
		fprintf(stderr, "bench-barrier: no memory\n");
		return GR_EXIT_RUNTIME;
	}
	give_addresses(room, spaces);
	for (int i = 0; i < 2; i++)
		if ((spinners[i] = fork()) == 0)
			spin();
	for (unsigned i = 0; i <= room->node_count; i++)
		if ((ends[i] = fork()) == 0)
			live(room, i, spaces, o->runs);
	pthread_barrier_wait(&room->step);
	for (unsigned i = 0; spaces && i <= room->node_count; i++)
		if (!barrier_net_connect(i, ends[i]))
			atomic_store(&room->failed, 1);
	pthread_barrier_wait(&room->step);
	printf("%u nodes, %ld Hz, %u frames after %u, %s, %s, SCHED_RR %d\n", room->node_count, o->hz,
	       room->frames, room->warm, spaces ? "a namespace and veth each, one bridge" : "loopback",
	       o->multicast ? "multicast" : "unicast", PRIORITY);
	fflush(stdout);
	status = run_all(room, o);
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
		fprintf(stderr, "bench-barrier: an end could not begin, or its loop failed\n");
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
	struct options o = { .nodes = 4, .hz = 120, .frames = 600, .runs = 5 };
	const struct {
		const char *name;
		long least, most, *value;
	} known[] = {
		{ "--nodes", 2, BARRIER_NODES_MOST, &o.nodes }, { "--rate", 1, 1000, &o.hz },
		{ "--frames", 10, BARRIER_FRAMES_MOST, &o.frames }, { "--runs", 1, RUNS_MOST, &o.runs },
		{ "--loopback", 0, 1, &o.loopback },
		{ "--multicast", 0, 1, &o.multicast },
	};
	const size_t count = sizeof known / sizeof *known;

	gr_log_init("bench-barrier", GR_LOG_WARNING);
	for (int i = 1; i < argc; i += 2) {
		size_t k = 0;

		while (k < count && strcmp(argv[i], known[k].name))
			k++;
		if (k < count && i + 1 < argc &&
		    take_number(argv[i + 1], known[k].least, known[k].most, known[k].value))
			continue;
		fprintf(stderr, "bench-barrier: '%s': there are --nodes 2..%d, --rate 1..1000, --frames 10..%d, --runs 1..%d, --loopback 0..1, --multicast 0..1\n",
			argv[i], BARRIER_NODES_MOST, BARRIER_FRAMES_MOST, RUNS_MOST);
		return GR_EXIT_CONFIG;
	}
	return bench(&o);
}
