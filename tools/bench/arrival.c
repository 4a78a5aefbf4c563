/*
 * bench-arrival: how long from a report's arrival to the pose that is made of
 * it. Controllers of A.R.T. DTrack in a process of their own send over UDP; here
 * are the devices' threads, the hand-over, bindings, filters and the question
 * where head and wand are, as a master has them: four rooms of a head and a wand
 * each, so that every device has a filter behind it.
 *
 * A report's number is its place, in micrometres along x: the sender keeps when
 * it sent which.
 */
#include <config.h> /* RUSAGE_THREAD */

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "daemon/trackers.h"
#include "tools/bench/stats.h"
#include "tools/cli.h"

#include <arpa/inet.h>
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#define ROOMS_MOST 8
#define DEVICES_MOST (2 * ROOMS_MOST)
#define REPORTS_MOST 1000000 /* of a device: a metre */
#define PENDING_MOST 65536 /* of one look */
#define NAP_NS (100 * GR_NS_PER_US)
#define FRAME_NS (GR_NS_PER_S / 60)
#define WARM_NS GR_NS_PER_S

struct options {
	int devices, rate_hz, runs;
	float seconds;
};

/* What both processes see. */
struct shared {
	_Atomic bool stop;
	uint16_t ports[DEVICES_MOST + 1]; /* and one of the bare thread, after the devices' */
	_Atomic uint64_t sent;
	_Atomic int64_t sent_ns[DEVICES_MOST + 1][REPORTS_MOST];
};

struct bench {
	const struct options *options;
	struct shared *shared;
	struct bench_room {
		struct bench *of;
		struct layout *layout;
		struct trackers trackers;
	} rooms[ROOMS_MOST];
	int room_count;
	bool counts; /* what comes now is measured */
	/* When those were sent that have come since the last look. */
	int64_t pending_ns[PENDING_MOST];
	size_t pending;
	double *late_us, *handed_us; /* until the pose, until the device's thread had handed it over */
	size_t count, most;
	uint64_t refused;
	struct bare {
		struct shared *shared;
		int fd;
		unsigned number; /* of its port */
		pthread_t thread;
		double *late_us;
		size_t count, most;
		_Atomic bool counts, stop;
	} bare;
};

/* ---- the controllers ---- */

static void send_report(struct shared *s, int fd, unsigned devices, unsigned device, unsigned number,
			double time_s)
{
	const struct sockaddr_in to = { .sin_family = AF_INET,
					.sin_port = htons(s->ports[device]),
					.sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
	char text[200];
	const int len = snprintf(text, sizeof text,
				 "fr %u\r\nts %.6f\r\n6d 1 [0 1.000][%.3f 1500.000 0.000]"
				 "[1.000000 0 0 0 1.000000 0 0 0 1.000000]\r\n",
				 number, time_s, number * 1e-3);

	atomic_store_explicit(&s->sent_ns[device][number], gr_clock_now(&gr_clock_monotonic),
			      memory_order_release);
	if (sendto(fd, text, (size_t)len, 0, (const struct sockaddr *)&to, sizeof to) == len && device < devices)
		atomic_fetch_add_explicit(&s->sent, 1, memory_order_relaxed);
}

/* All devices in turns, evenly over a period. */
static void send_all(struct shared *s, const struct options *o)
{
	const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	const int64_t step_ns = GR_NS_PER_S / o->rate_hz / (o->devices + 1);
	int64_t at_ns = gr_clock_now(&gr_clock_monotonic);

	for (unsigned number = 1; number < REPORTS_MOST && !s->stop; number++)
		for (unsigned device = 0; device <= (unsigned)o->devices; device++) {
			at_ns += step_ns;
			(void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME,
					      &(struct timespec){ at_ns / GR_NS_PER_S, at_ns % GR_NS_PER_S },
					      NULL);
			send_report(s, fd, (unsigned)o->devices, device, number,
				    (double)number / o->rate_hz);
		}
	close(fd);
}

static pid_t start_controllers(struct shared *s, const struct options *o)
{
	const pid_t pid = fork();

	if (pid != 0)
		return pid;
	(void)prctl(PR_SET_PDEATHSIG, SIGKILL);
	(void)prctl(PR_SET_TIMERSLACK, 1000); /* a device keeps its own time */
	send_all(s, o);
	_exit(0);
}

/* ---- the rooms ---- */

/* Filtered by now; what is still missing is the question where the body is. */
static void on_sample(void *ctx, size_t tracker, const struct track_sample *sample, bool taken)
{
	struct bench_room *room = ctx;
	struct bench *b = room->of;
	const size_t device = 2 * (size_t)(room - b->rooms) + tracker;
	const long number = lround((double)sample->T_room_body.p[0] * 1e6);
	const int64_t arrived_ns = room->trackers.all[tracker].sensors[0].last.arrived_ns;
	int64_t sent_ns;

	b->refused += !taken;
	if (!taken || number <= 0 || number >= REPORTS_MOST || b->pending == PENDING_MOST)
		return;
	sent_ns = atomic_load_explicit(&b->shared->sent_ns[device][number], memory_order_acquire);
	if (b->counts && b->count + b->pending < b->most)
		b->handed_us[b->count + b->pending] = (double)(arrived_ns - sent_ns) * 1e-3;
	b->pending_ns[b->pending++] = sent_ns;
}

static const char room_text[] =
	"walls = ( { name = \"front\"; lower_left = [-1.5, 0.0, -1.5]; lower_right = [1.5, 0.0, -1.5];\n"
	"  upper_left = [-1.5, 2.0, -1.5]; pixels = [64, 64]; nodes = ( { address = \"127.0.0.1\"; port = 5001; } ); } );\n"
	"network = { master_address = \"127.0.0.1\"; };\n"
	"room = { min = [-2.0, 0.0, -1.4]; max = [2.0, 3.0, 2.0]; };\n"
	"trackers = ( { name = \"a\"; kind = \"dtrack\"; dtrack = { port = %u; address = \"127.0.0.1\"; };\n"
	"    bind = ( { body = \"head\"; sensor = \"body0\"; } ); },\n"
	"  { name = \"b\"; kind = \"dtrack\"; dtrack = { port = %u; address = \"127.0.0.1\"; };\n"
	"    bind = ( { body = \"wand\"; sensor = \"body0\"; } ); } );\n";

static int open_room(struct bench *b, struct bench_room *room, struct gr_diag *diag)
{
	const uint16_t *ports = b->shared->ports + 2 * (room - b->rooms);
	char text[sizeof room_text + 32];
	const int len = snprintf(text, sizeof text, room_text, (unsigned)ports[0], (unsigned)ports[1]);
	int r = layout_parse(text, (size_t)len, "bench.cave", &room->layout, diag);

	room->of = b;
	if (r == GR_OK)
		r = trackers_open(&room->trackers, room->layout, diag);
	if (r != GR_OK)
		return r;
	room->trackers.tap = (struct trackers_tap){ on_sample, room };
	b->room_count++;
	return trackers_start(&room->trackers);
}

/* Ports that nobody has just now. */
static int find_ports(struct shared *s, int count)
{
	for (int i = 0; i < count; i++) {
		struct sockaddr_in at = { .sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
		socklen_t len = sizeof at;
		const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
		const int bound = fd < 0 ? -1 : bind(fd, (const struct sockaddr *)&at, sizeof at);

		if (bound < 0 || getsockname(fd, (struct sockaddr *)&at, &len) < 0)
			return GR_ERR_IO;
		s->ports[i] = ntohs(at.sin_port);
		close(fd);
	}
	return GR_OK;
}

/* ---- what the machine itself needs to wake a thread with a datagram ---- */

static void *run_bare(void *ctx)
{
	struct bare *b = ctx;
	char text[256];

	while (!b->stop) {
		const ssize_t n = recv(b->fd, text, sizeof text - 1, 0);
		const int64_t now_ns = gr_clock_now(&gr_clock_monotonic);
		unsigned number;

		if (n < 4)
			continue;
		text[n] = '\0';
		number = (unsigned)strtoul(text + 3, NULL, 10);
		if (b->counts && number < REPORTS_MOST && b->count < b->most)
			b->late_us[b->count++] =
				(double)(now_ns - atomic_load_explicit(&b->shared->sent_ns[b->number][number],
								       memory_order_acquire)) * 1e-3;
	}
	return NULL;
}

static int start_bare(struct bench *b)
{
	const struct options *o = b->options;
	const struct timeval patience = { .tv_usec = 100000 };
	struct sockaddr_in at = { .sin_family = AF_INET,
				  .sin_port = htons(b->shared->ports[o->devices]),
				  .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };

	b->bare = (struct bare){ .shared = b->shared, .number = (unsigned)o->devices, .most = b->most };
	b->bare.late_us = calloc(b->most, sizeof *b->bare.late_us);
	b->bare.fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	if (!b->bare.late_us || b->bare.fd < 0 ||
	    setsockopt(b->bare.fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) < 0 ||
	    bind(b->bare.fd, (const struct sockaddr *)&at, sizeof at) < 0 ||
	    pthread_create(&b->bare.thread, NULL, run_bare, &b->bare) != 0)
		return GR_ERR_IO;
	return GR_OK;
}

static void stop_bare(struct bench *b)
{
	if (b->bare.thread) {
		b->bare.stop = true;
		pthread_join(b->bare.thread, NULL);
	}
	if (b->bare.fd > 0)
		close(b->bare.fd);
	free(b->bare.late_us);
}

/* What a master does for a frame; returns how long that took. */
static int64_t look(struct bench *b)
{
	const int64_t begun_ns = gr_clock_now(&gr_clock_monotonic);
	int64_t done_ns;

	b->pending = 0;
	for (int i = 0; i < b->room_count; i++) {
		struct master_input input = { 0 };

		trackers_poll(&b->rooms[i].trackers, begun_ns, begun_ns);
		trackers_sample(&b->rooms[i].trackers, begun_ns + FRAME_NS, &input);
	}
	done_ns = gr_clock_now(&gr_clock_monotonic);
	for (size_t k = 0; k < b->pending && b->counts && b->count < b->most; k++)
		b->late_us[b->count++] = (double)(done_ns - b->pending_ns[k]) * 1e-3;
	return done_ns - begun_ns;
}

static double cpu_s(int whose)
{
	struct rusage u;

	getrusage(whose, &u);
	return (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
	       (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec) * 1e-6;
}

/* Looks each `every_ns` for so long; per look its length, in us, where there is room. */
static size_t look_for(struct bench *b, int64_t every_ns, double seconds, double *looks_us, size_t most)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + (int64_t)(seconds * 1e9);
	size_t count = 0;

	while (gr_clock_now(&gr_clock_monotonic) < end_ns) {
		const int64_t took_ns = look(b);

		if (looks_us && count < most)
			looks_us[count++] = (double)took_ns * 1e-3;
		(void)nanosleep(&(struct timespec){ 0, every_ns > took_ns ? every_ns - took_ns : 1 }, NULL);
	}
	return count;
}

static void print_losses(const struct bench *b)
{
	uint64_t reports = 0, missed = 0, unread = 0, faults = 0;

	for (int i = 0; i < b->room_count; i++)
		for (size_t k = 0; k < b->rooms[i].trackers.count; k++) {
			const struct tracker *t = &b->rooms[i].trackers.all[k];
			struct track_counters c;

			track_device_counters(t->device, &c);
			reports += c.reports;
			missed += c.missed;
			unread += t->reader.missed;
			for (int f = 0; f < TRACK_FAULTS; f++)
				faults += c.faults[f];
		}
	printf("%llu datagrams sent to the devices, %llu read; %llu missed by their numbers, %llu refused, %llu not read in "
	       "time, %llu samples not taken\n",
	       (unsigned long long)b->shared->sent, (unsigned long long)reports, (unsigned long long)missed,
	       (unsigned long long)faults, (unsigned long long)unread, (unsigned long long)b->refused);
}

/* Of one run; us. */
struct figures {
	double bare[3], handed[3], pose[3], look[2]; /* p50, p99, p99.9 */
	double threads, here;             /* share of a core */
};

static void quantiles(double *us, size_t count, double *out, int n)
{
	static const double shares[] = { 0.5, 0.99, 0.999 };

	stats_sort(us, count);
	for (int i = 0; i < n; i++)
		out[i] = stats_quantile(us, count, shares[i]);
}

static struct figures measure(struct bench *b, double *looks_us, size_t looks_most)
{
	const double seconds = (double)b->options->seconds;
	struct figures f;
	size_t looks;
	double here, all;

	/* What waited for the last look of the run before is none of this one's. */
	look_for(b, NAP_NS, 0.01, NULL, 0);
	b->count = b->bare.count = 0;
	b->counts = true;
	b->bare.counts = true;
	here = cpu_s(RUSAGE_THREAD);
	all = cpu_s(RUSAGE_SELF);
	look_for(b, NAP_NS, seconds, NULL, 0);
	here = cpu_s(RUSAGE_THREAD) - here;
	all = cpu_s(RUSAGE_SELF) - all;
	b->counts = false;
	b->bare.counts = false;
	looks = look_for(b, FRAME_NS, seconds, looks_us, looks_most);
	quantiles(b->bare.late_us, b->bare.count, f.bare, 3);
	quantiles(b->handed_us, b->count, f.handed, 3);
	quantiles(b->late_us, b->count, f.pose, 3);
	quantiles(looks_us, looks, f.look, 2);
	f.threads = (all - here) / seconds;
	f.here = here / seconds;
	return f;
}

static int compare_pose(const void *a, const void *b)
{
	const struct figures *x = a, *y = b;

	return (x->pose[1] > y->pose[1]) - (x->pose[1] < y->pose[1]);
}

static void print_figures(const char *run, const struct figures *f)
{
	printf("| %s | %.0f / %.0f / %.0f | %.0f / %.0f / %.0f | %.0f / %.0f / %.0f | %.0f / %.0f | %.1f | %.1f |\n", run,
	       f->bare[0], f->bare[1], f->bare[2], f->handed[0], f->handed[1], f->handed[2], f->pose[0], f->pose[1],
	       f->pose[2], f->look[0], f->look[1], 100 * f->threads, 100 * f->here);
}

static void measure_all(struct bench *b)
{
	const struct options *o = b->options;
	const size_t looks_most = (size_t)((double)o->seconds * 100) + 100;
	double *looks_us = calloc(looks_most, sizeof *looks_us);
	struct figures *all = calloc((size_t)o->runs, sizeof *all);
	int good = 0;

	for (int i = 0; looks_us && all && i < o->runs; i++) {
		all[i] = measure(b, looks_us, looks_most);
		good += all[i].pose[1] < 1000;
	}
	if (looks_us && all) {
		qsort(all, (size_t)o->runs, sizeof *all, compare_pose);
		printf("| run, by its p99 | a thread that does nothing else: p50 / p99 / p99.9, us | handed over, us | filtered pose, "
		       "us | a frame's reports taken: p50 / p99, us | threads, %% of a core | looks, %% |\n"
		       "|---|---:|---:|---:|---:|---:|---:|\n");
		print_figures("best", &all[0]);
		print_figures("median", &all[o->runs / 2]);
		print_figures("worst", &all[o->runs - 1]);
		printf("\n%d runs of %.3g s, and of each a second one for the looks of a frame; p99 below 1 ms in %d; the median run's threads took %.1f us a report\n", o->runs,
		       (double)o->seconds, good,
		       all[o->runs / 2].threads * 1e6 / (o->rate_hz * o->devices));
		print_losses(b);
	}
	free(looks_us);
	free(all);
}

static int run(const struct options *o)
{
	struct shared *s = mmap(NULL, sizeof *s, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	struct bench *b = calloc(1, sizeof *b);
	struct gr_diag diag = { 0 };
	pid_t pid = -1;
	int r = GR_ERR_NOMEM;

	if (s == MAP_FAILED || !b)
		goto out;
	b->options = o;
	b->shared = s;
	b->most = (size_t)((double)o->seconds * o->rate_hz * o->devices * 1.1);
	b->late_us = calloc(b->most, sizeof *b->late_us);
	b->handed_us = calloc(b->most, sizeof *b->handed_us);
	r = b->late_us && b->handed_us ? find_ports(s, o->devices + 1) : GR_ERR_NOMEM;
	/* Before there are threads. */
	pid = r == GR_OK ? start_controllers(s, o) : -1;
	for (int i = 0; r == GR_OK && i < o->devices / 2; i++)
		r = open_room(b, &b->rooms[i], &diag);
	if (r == GR_OK)
		r = start_bare(b);
	if (r == GR_OK && pid > 0) {
		look_for(b, NAP_NS, WARM_NS * 1e-9, NULL, 0);
		measure_all(b);
	}
out:
	if (r != GR_OK || pid < 0)
		fprintf(stderr, "bench-arrival: %s\n", pid < 0 && r == GR_OK ? strerror(errno) : gr_result_name(r));
	gr_diag_log(&diag);
	gr_diag_finish(&diag);
	if (pid > 0) {
		s->stop = true;
		waitpid(pid, NULL, 0);
	}
	for (int i = 0; b && i < b->room_count; i++) {
		trackers_close(&b->rooms[i].trackers);
		layout_destroy(&b->rooms[i].layout);
	}
	if (b) {
		stop_bare(b);
		free(b->late_us);
		free(b->handed_us);
	}
	free(b);
	return r == GR_OK && pid > 0 ? GR_EXIT_OK : GR_EXIT_RUNTIME;
}

int main(int argc, char **argv)
{
	struct options o = { .devices = 8, .rate_hz = 1000, .runs = 40, .seconds = 1 };
	const struct cli_option options[] = {
		{ "devices", 0, CLI_INT, &o.devices, 2, DEVICES_MOST, "N", "controllers, a port and a thread each (8)" },
		{ "rate", 0, CLI_INT, &o.rate_hz, 1, 2000, "HZ", "reports a second of each (1000)" },
		{ "runs", 0, CLI_INT, &o.runs, 1, 1000, "N", "of which the best, the median and the worst are said (40)" },
		{ "seconds", 0, CLI_REAL, &o.seconds, 1, 200, "S", "of a run, and once more for frames (1)" },
	};
	const struct cli_table table = {
		"bench-arrival [--devices N] [--rate HZ] [--runs N] [--seconds S]",
		"How long from a report's arrival to the pose that is made of it: DTrack controllers over\n"
		"UDP on loopback, devices' threads, hand-over, Kalman filters, and the pose of a frame ahead.",
		options, sizeof options / sizeof options[0]
	};
	int words;

	gr_log_init("bench-arrival", GR_LOG_WARNING);
	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	if (words > 0 || o.devices % 2 || (double)o.rate_hz * ((double)o.seconds * 2.1 * o.runs + 10) >= REPORTS_MOST) {
		fprintf(stderr, "bench-arrival: devices come in twos, and of one there are no more than %d reports\n",
			REPORTS_MOST);
		return GR_EXIT_CONFIG;
	}
	return run(&o);
}
