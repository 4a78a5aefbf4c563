/*
 * A master and nodes that draw nothing, each in a process and, where that is
 * allowed, a network namespace of its own, which live through all runs of a bench;
 * protocol, sockets and priority are the daemons'. All have the one CLOCK_MONOTONIC
 * of this machine: times of different ends may be subtracted. Private to
 * bench-barrier, bench-delivery and bench-rejoin.
 */
#ifndef GROTTO_TOOLS_BENCH_CLUSTER_H
#define GROTTO_TOOLS_BENCH_CLUSTER_H

#include "config/layout.h"
#include "tools/cli.h"

#include <pthread.h>
#include <stdatomic.h>
#include <sys/types.h>

#define CLUSTER_NODES_MOST 16
#define CLUSTER_RUNS_MOST 50
#define CLUSTER_SPINNERS 2
#define CLUSTER_PRIORITY 5 /* SCHED_RR, of every end */

struct cluster_options {
	int nodes, hz, samples, runs;
	int loopback, multicast; /* 0 or 1 */
};
#define CLUSTER_DEFAULTS { .nodes = 4, .hz = 120, .samples = 600, .runs = 5 }

/* What a bench is. */
struct cluster_bench {
	const char *name;    /* of its program */
	const char *usage, *summary;
	const char *samples; /* the option that says how many of them a run has */
	int samples_most, nodes_least;
	const struct cli_option *options; /* of its own, 0 to 6 */
	size_t option_count;
	uint16_t port;       /* the master's; the nodes' and the group's are above it */
	const char *group;   /* with multicast */
	const char *network; /* of the namespaces: "10.99.0" */
	/* All runs; an exit status. The options are those given to cluster_main. */
	int (*measure)(const struct cluster_options *options);
	/* One run, in the process of that end; end node_count is the master. */
	void (*run)(void *room, unsigned end);
};

/* In memory that all processes share; its place in a bench's room. */
struct bench_cluster {
	const struct cluster_bench *bench;
	void *room;
	pthread_barrier_t step; /* all ends and the parent */
	struct layout layout;
	struct layout_node nodes[CLUSTER_NODES_MOST];
	char group[16], interface[8];
	char addresses[CLUSTER_NODES_MOST + 1][16]; /* the last is the master's */
	unsigned node_count;
	int64_t period_ns;
	size_t share_bytes; /* of the light that nodes share out; 0: none is */
	bool spaces;        /* namespaces; else loopback */
	uint64_t session;   /* of this run, from 1 */
	atomic_bool failed; /* an end; nothing more is run */
	atomic_bool over;   /* this run */
	bool done;          /* all runs; changes between two steps */
	pid_t ends[CLUSTER_NODES_MOST + 1], spinners[CLUSTER_SPINNERS]; /* 0: none */
};

/* The main of a bench: its options, then measure(). An exit status. */
int cluster_main(const struct cluster_bench *bench, struct cluster_options *options, int argc, char **argv);

/* Zeroed, for all processes begun later, until the last ends. NULL without memory. */
void *cluster_shared(size_t size);

/*
 * Begins the ends; the cluster is zeroed and shared, as the room is and all that
 * the ends need in it. False, and a line on stderr, when a process could not be begun.
 */
bool cluster_begin(struct bench_cluster *cluster, const struct cluster_bench *bench,
		   const struct cluster_options *options, void *room);
/* One run of all ends, of a session of its own. False, and a line on stderr, when one failed. */
bool cluster_run(struct bench_cluster *cluster);
/* Ends all that was begun. */
void cluster_end(struct bench_cluster *cluster);

/*
 * Median over the runs of the double at `offset` in each row; NaN, which says
 * that a run had nothing to measure, is left out.
 */
double cluster_median(const void *rows, size_t row_size, size_t offset, int runs);

#endif
