/*
 * bed FIFO PROGRAM ARGUMENT...: runs a program that finds mocked devices where real
 * ones would be, a Hydra so far. Lines from the FIFO say what becomes of it:
 *
 *   plug NODE     its nodes are /dev/hidraw NODE and NODE + 1
 *   at X Y Z      mm, in its own axes: where the wands are from now on (left one at -X)
 *   damage N      N reports, at most 32, of which one bit each is another
 *   unplug
 *
 * The exit status is the program's; SIGTERM and SIGINT are passed on to it.
 */
#include "tests/unit/hydra_bytes.h"
#include "tests/unit/mock_hydra.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#define PERIOD_MS 4

struct bed {
	UMockdevTestbed *testbed;
	struct mock_hydra hydra;
	int at[3];
	uint8_t sequence;
	char line[256];
	size_t len;
	pid_t child;
	int status; /* of the child; -1: it runs */
};

/* From far away, so that one that was taken would be seen. */
static void say_damaged(struct bed *bed, int count)
{
	uint8_t bytes[HYDRA_BYTES];

	for (int i = 0; i < count; i++) {
		hydra_make(bytes, bed->sequence, 2000, 2000, 2000);
		bytes[6 + i % 44] ^= (uint8_t)(1 << i % 8);
		mock_hid_push(bed->hydra.reports, bytes, sizeof bytes);
	}
}

static void obey(struct bed *bed, const char *line)
{
	int node, count, at[3];

	if (sscanf(line, "plug %d", &node) == 1 && !bed->hydra.plugged) {
		mock_hydra_finish(&bed->hydra);
		mock_hydra_plug(&bed->hydra, bed->testbed, node, node + 1);
	} else if (sscanf(line, "at %d %d %d", &at[0], &at[1], &at[2]) == 3) {
		memcpy(bed->at, at, sizeof bed->at);
	} else if (sscanf(line, "damage %d", &count) == 1 && count <= 32 && bed->hydra.plugged) {
		say_damaged(bed, count);
	} else if (!strcmp(line, "unplug") && bed->hydra.plugged) {
		mock_hydra_unplug(&bed->hydra);
	} else {
		fprintf(stderr, "bed: cannot do '%s' now\n", line);
		exit(1);
	}
}

static void read_lines(struct bed *bed, int fifo)
{
	char c;

	while (read(fifo, &c, 1) == 1) {
		if (c != '\n' && bed->len + 1 < sizeof bed->line) {
			bed->line[bed->len++] = c;
			continue;
		}
		bed->line[bed->len] = '\0';
		bed->len = 0;
		obey(bed, bed->line);
	}
}

static void hear_signal(struct bed *bed, int fd)
{
	struct signalfd_siginfo info;
	int status;

	if (read(fd, &info, sizeof info) != (ssize_t)sizeof info)
		return;
	if (info.ssi_signo != SIGCHLD)
		kill(bed->child, (int)info.ssi_signo);
	else if (waitpid(bed->child, &status, WNOHANG) == bed->child)
		bed->status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

static void start(struct bed *bed, char **argv, const sigset_t *signals)
{
	bed->child = fork();
	if (bed->child)
		return;
	/* A client must not outlive the bed. */
	prctl(PR_SET_PDEATHSIG, SIGKILL);
	sigprocmask(SIG_UNBLOCK, signals, NULL);
	execvp(argv[0], argv);
	fprintf(stderr, "bed: %s: %s\n", argv[0], strerror(errno));
	_exit(127);
}

int main(int argc, char **argv)
{
	struct bed bed = { .status = -1, .at = { 500, 0, 0 } };
	struct pollfd fds[2] = { { .events = POLLIN }, { .events = POLLIN } };
	sigset_t signals;

	sigemptyset(&signals);
	sigaddset(&signals, SIGTERM);
	sigaddset(&signals, SIGINT);
	sigaddset(&signals, SIGCHLD);
	/* Before the test bed starts its threads, which would take them otherwise. */
	sigprocmask(SIG_BLOCK, &signals, NULL);
	bed.testbed = mock_begin(argv);
	if (argc < 3)
		return 2;
	/* Also for writing, or it would end with the first line's writer. */
	fds[0].fd = open(argv[1], O_RDWR | O_NONBLOCK | O_CLOEXEC);
	fds[1].fd = signalfd(-1, &signals, SFD_CLOEXEC);
	if (fds[0].fd < 0 || fds[1].fd < 0)
		return 2;
	start(&bed, argv + 2, &signals);
	while (bed.status < 0) {
		if (poll(fds, 2, PERIOD_MS) < 0 && errno != EINTR)
			return 2;
		if (fds[0].revents)
			read_lines(&bed, fds[0].fd);
		if (fds[1].revents)
			hear_signal(&bed, fds[1].fd);
		if (bed.hydra.plugged && mock_hydra_mode(&bed.hydra) == MOCK_HYDRA_MOTION)
			mock_hydra_say(&bed.hydra, bed.sequence++, bed.at[0], bed.at[1], bed.at[2]);
	}
	mock_hydra_finish(&bed.hydra);
	g_object_unref(bed.testbed);
	return bed.status;
}
