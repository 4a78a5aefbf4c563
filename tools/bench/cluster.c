#include <config.h> /* SCHED_IDLE */

#include "tools/bench/cluster.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "daemon/priority.h"
#include "tools/bench/cluster_net.h"
#include "tools/bench/stats.h"

#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#define OPTIONS_MOST 12

/* The bench's own behind those that all have. */
static size_t list_options(const struct cluster_bench *bench, struct cluster_options *o,
			   struct cli_option list[OPTIONS_MOST])
{
	const struct cli_option shared[] = {
		{ "nodes", 0, CLI_INT, &o->nodes, bench->nodes_least, CLUSTER_NODES_MOST, "N", "beside the master (4)" },
		{ "rate", 0, CLI_INT, &o->hz, 1, 1000, "HZ", "so many a second (120)" },
		{ bench->samples, 0, CLI_INT, &o->samples, 10, bench->samples_most, "N", "in a run (600)" },
		{ "runs", 0, CLI_INT, &o->runs, 1, CLUSTER_RUNS_MOST, "N", "of each kind (5)" },
		{ "loopback", 0, CLI_INT, &o->loopback, 0, 1, "0|1", "never network namespaces (0)" },
		{ "multicast", 0, CLI_INT, &o->multicast, 0, 1, "0|1", "from the master to a group (0)" },
	};
	size_t count = sizeof shared / sizeof *shared;

	memcpy(list, shared, sizeof shared);
	for (size_t i = 0; i < bench->option_count && count < OPTIONS_MOST; i++)
		list[count++] = bench->options[i];
	return count;
}

int cluster_main(const struct cluster_bench *bench, struct cluster_options *o, int argc, char **argv)
{
	struct cli_option list[OPTIONS_MOST];
	const struct cli_table table = { bench->usage, bench->summary, list, list_options(bench, o, list) };
	int words;

	gr_log_init(bench->name, GR_LOG_WARNING);
	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_RUN:
		if (!words)
			return bench->measure(o);
		fprintf(stderr, "'%s' is no option\n", argv[1]);
		break;
	case CLI_WRONG: break;
	}
	fprintf(stderr, "usage: %s\n", bench->usage);
	return GR_EXIT_CONFIG;
}

void *cluster_shared(size_t size)
{
	void *p = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);

	return p == MAP_FAILED ? NULL : p;
}

static void step(struct bench_cluster *c)
{
	pthread_barrier_wait(&c->step);
}

static void make_layout(struct bench_cluster *c, const struct cluster_options *o)
{
	c->layout.nodes = c->nodes;
	c->layout.node_count = c->node_count;
	c->layout.network.mtu = 1500;
	c->layout.network.master_port = c->bench->port;
	c->layout.network.cast = o->multicast ? LAYOUT_MULTICAST : LAYOUT_UNICAST;
	if (o->multicast) {
		snprintf(c->group, sizeof c->group, "%s", c->bench->group);
		c->layout.network.group = c->group;
		c->layout.network.group_port = (uint16_t)(c->bench->port + 100);
		c->layout.network.ttl = 1;
	}
	c->layout.swap.busy_poll_ns = 200 * GR_NS_PER_US;
}

static void give_addresses(struct bench_cluster *c)
{
	for (unsigned i = 0; i <= c->node_count; i++) {
		if (c->spaces)
			snprintf(c->addresses[i], sizeof c->addresses[i], "%s.%u", c->bench->network, i + 1);
		else
			snprintf(c->addresses[i], sizeof c->addresses[i], "127.0.0.1");
	}
	for (unsigned i = 0; i < c->node_count; i++) {
		snprintf(c->nodes[i].name, sizeof c->nodes[i].name, "n%u", i + 1);
		c->nodes[i].address = c->addresses[i];
		c->nodes[i].port = (uint16_t)(c->bench->port + 1 + i);
	}
	if (c->spaces)
		c->layout.network.interface = strcpy(c->interface, "eth0");
	c->layout.network.master_address = c->addresses[c->node_count];
}

static void make_step(struct bench_cluster *c)
{
	pthread_barrierattr_t attr;

	pthread_barrierattr_init(&attr);
	pthread_barrierattr_setpshared(&attr, PTHREAD_PROCESS_SHARED);
	pthread_barrier_init(&c->step, &attr, c->node_count + 2);
	pthread_barrierattr_destroy(&attr);
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

static void live(struct bench_cluster *c, unsigned end)
{
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	if (c->spaces && !cluster_net_leave())
		atomic_store(&c->failed, true);
	step(c); /* in its own namespace */
	step(c); /* connected */
	if (c->spaces && !cluster_net_address(c->addresses[end]))
		atomic_store(&c->failed, true);
	priority_take(CLUSTER_PRIORITY);
	for (;;) {
		step(c);
		if (c->done)
			_exit(0);
		if (!atomic_load(&c->failed))
			c->bench->run(c->room, end);
		step(c);
	}
}

static bool begin_processes(struct bench_cluster *c)
{
	for (int i = 0; i < CLUSTER_SPINNERS; i++) {
		const pid_t pid = fork();

		if (pid == 0)
			spin();
		if (pid < 0)
			return false;
		c->spinners[i] = pid;
	}
	for (unsigned i = 0; i <= c->node_count; i++) {
		const pid_t pid = fork();

		if (pid == 0)
			live(c, i);
		if (pid < 0)
			return false;
		c->ends[i] = pid;
	}
	return true;
}

/* An end that died comes to no barrier: all others, and this, would wait for ever. */
static void end_died(int signal)
{
	static const char text[] = "an end died\n";

	(void)signal;
	(void)!write(STDERR_FILENO, text, sizeof text - 1);
	_exit(GR_EXIT_RUNTIME);
}

static void watch_ends(bool on)
{
	const struct sigaction action = { .sa_handler = on ? end_died : SIG_DFL, .sa_flags = SA_NOCLDSTOP };

	sigaction(SIGCHLD, &action, NULL);
}

bool cluster_begin(struct bench_cluster *cluster, const struct cluster_bench *bench,
		   const struct cluster_options *options, void *room)
{
	cluster->bench = bench;
	cluster->room = room;
	cluster->node_count = (unsigned)options->nodes;
	cluster->period_ns = GR_NS_PER_S / options->hz;
	cluster->spaces = !options->loopback && cluster_net_hub();
	make_layout(cluster, options);
	give_addresses(cluster);
	make_step(cluster);
	if (!begin_processes(cluster)) {
		fprintf(stderr, "%s: cannot begin its processes\n", bench->name);
		atomic_store(&cluster->failed, true);
		cluster_end(cluster);
		return false;
	}
	step(cluster);
	for (unsigned i = 0; cluster->spaces && i <= cluster->node_count; i++)
		if (!cluster_net_connect(i, cluster->ends[i]))
			atomic_store(&cluster->failed, true);
	watch_ends(true);
	step(cluster);
	return true;
}

bool cluster_run(struct bench_cluster *cluster)
{
	cluster->session++;
	atomic_store(&cluster->over, false);
	step(cluster);
	step(cluster);
	if (!atomic_load(&cluster->failed))
		return true;
	fprintf(stderr, "%s: an end could not begin, or its loop failed\n", cluster->bench->name);
	return false;
}

static void reap(pid_t pid, bool killed)
{
	if (pid <= 0)
		return;
	if (killed)
		kill(pid, SIGKILL);
	waitpid(pid, NULL, 0);
}

void cluster_end(struct bench_cluster *cluster)
{
	const bool failed = atomic_load(&cluster->failed);

	cluster->done = true;
	watch_ends(false);
	if (!failed)
		step(cluster);
	for (unsigned i = 0; i <= cluster->node_count; i++)
		reap(cluster->ends[i], failed);
	for (int i = 0; i < CLUSTER_SPINNERS; i++)
		reap(cluster->spinners[i], true);
}

double cluster_median(const void *rows, size_t row_size, size_t offset, int runs)
{
	double values[CLUSTER_RUNS_MOST];
	size_t count = 0;

	for (int i = 0; i < runs; i++) {
		double value;

		memcpy(&value, (const char *)rows + (size_t)i * row_size + offset, sizeof value);
		if (!isnan(value))
			values[count++] = value;
	}
	return stats_spread(values, count).median;
}
