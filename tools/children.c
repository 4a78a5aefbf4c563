/* pipe2 and ppoll are GNU extensions: config.h asks for them. */
#include <config.h>

#include "tools/children.h"

#include "base/clock.h"
#include "base/result.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>
#include <sys/wait.h>
#include <unistd.h>

#define WATCHED_MAX 66 /* LAYOUT_MAX_NODES, the master, and one to spare */

int children_start(struct children *children)
{
	sigset_t ending;

	*children = (struct children){ .signal_fd = -1, .timer_fd = -1, .input_fd = -1 };
	sigemptyset(&ending);
	sigaddset(&ending, SIGINT);
	sigaddset(&ending, SIGTERM);
	sigaddset(&ending, SIGHUP);
	if (sigprocmask(SIG_BLOCK, &ending, &children->old_signals) != 0)
		return GR_ERR_IO;
	children->signal_fd = signalfd(-1, &ending, SFD_CLOEXEC | SFD_NONBLOCK);
	children->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK);
	if (children->signal_fd < 0 || children->timer_fd < 0) {
		int error = errno;

		children_finish(children);
		errno = error;
		return GR_ERR_IO;
	}
	return GR_OK;
}

void children_finish(struct children *children)
{
	children_end(children, 0);
	for (size_t i = 0; i < children->count; i++) {
		free(children->items[i].name);
		free(children->items[i].log);
	}
	free(children->items);
	if (children->signal_fd >= 0)
		close(children->signal_fd);
	if (children->timer_fd >= 0)
		close(children->timer_fd);
	sigprocmask(SIG_SETMASK, &children->old_signals, NULL);
	*children = (struct children){ .signal_fd = -1, .timer_fd = -1, .input_fd = -1 };
}

/* In the child: only async-signal-safe calls. Reports errno through `report` on failure. */
static void become(char *const argv[], int log_fd, int report, pid_t parent,
		   const sigset_t *signals)
{
	int null_fd = open("/dev/null", O_RDONLY | O_CLOEXEC);
	int error;
	ssize_t ignored;

	if (null_fd >= 0 && dup2(null_fd, STDIN_FILENO) >= 0 &&
	    dup2(log_fd, STDOUT_FILENO) >= 0 && dup2(log_fd, STDERR_FILENO) >= 0 &&
	    prctl(PR_SET_PDEATHSIG, SIGTERM) == 0 &&
	    sigprocmask(SIG_SETMASK, signals, NULL) == 0) {
		if (getppid() != parent)
			_exit(127); /* the parent died before prctl */
		execv(argv[0], argv);
	}
	error = errno;
	ignored = write(report, &error, sizeof error);
	(void)ignored;
	_exit(127);
}

/* Reads the errno of a failed exec; 0 when the pipe closed by exec. */
static int exec_error(int fd)
{
	int error = 0;
	ssize_t n;

	do
		n = read(fd, &error, sizeof error);
	while (n < 0 && errno == EINTR);
	return n == (ssize_t)sizeof error ? error : 0;
}

static int fork_exec(char *const argv[], int log_fd, const sigset_t *signals, pid_t *out_pid,
		     int *out_pidfd)
{
	int report[2];
	pid_t parent = getpid();
	pid_t pid;
	int error;

	if (pipe2(report, O_CLOEXEC) != 0)
		return GR_ERR_IO;
	pid = fork();
	if (pid == 0)
		become(argv, log_fd, report[1], parent, signals);
	error = errno;
	close(report[1]);
	if (pid < 0) {
		close(report[0]);
		errno = error;
		return GR_ERR_IO;
	}
	error = exec_error(report[0]);
	close(report[0]);
	if (error == 0) {
		*out_pidfd = pidfd_open(pid, 0);
		if (*out_pidfd >= 0) {
			*out_pid = pid;
			return GR_OK;
		}
		error = errno;
		kill(pid, SIGKILL);
	}
	waitpid(pid, NULL, 0);
	errno = error;
	return GR_ERR_IO;
}

int children_spawn(struct children *children, const char *name, char *const argv[],
		   const char *log)
{
	struct child *items = realloc(children->items, (children->count + 1) * sizeof *items);
	struct child child = { .pidfd = -1 };
	int log_fd = -1;
	int result = GR_ERR_NOMEM;
	int error;

	if (!items)
		return GR_ERR_NOMEM;
	children->items = items;
	if (children->count + 2 > WATCHED_MAX)
		return GR_ERR_RANGE;
	child.name = strdup(name);
	child.log = strdup(log);
	if (!child.name || !child.log)
		goto fail;
	result = GR_ERR_IO;
	log_fd = open(log, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644);
	if (log_fd < 0)
		goto fail;
	result = fork_exec(argv, log_fd, &children->old_signals, &child.pid, &child.pidfd);
	if (result != GR_OK)
		goto fail;
	close(log_fd);
	children->items[children->count++] = child;
	children->running++;
	return GR_OK;
fail:
	error = errno;
	if (log_fd >= 0)
		close(log_fd);
	free(child.name);
	free(child.log);
	errno = error;
	return result;
}

int children_tick(struct children *children, int64_t interval_ns)
{
	struct timespec interval = { .tv_sec = interval_ns / 1000000000,
				     .tv_nsec = interval_ns % 1000000000 };
	struct itimerspec spec = { interval, interval };

	return timerfd_settime(children->timer_fd, 0, &spec, NULL) == 0 ? GR_OK : GR_ERR_IO;
}

void children_input(struct children *children, int fd)
{
	children->input_fd = fd;
}

/* Takes the status of a child whose pidfd is readable. */
static void reap(struct children *children, size_t i)
{
	struct child *child = &children->items[i];
	pid_t pid;

	do
		pid = waitpid(child->pid, &child->status, 0);
	while (pid < 0 && errno == EINTR);
	close(child->pidfd);
	child->pidfd = -1;
	children->running--;
}

static bool drain(int fd)
{
	char bytes[512];
	bool any = false;

	while (read(fd, bytes, sizeof bytes) > 0)
		any = true;
	return any;
}

static enum children_event look(struct children *children, const struct pollfd *fds,
				size_t *out_child)
{
	/* Ends first: a signal that came with them must not hide a crash. */
	for (size_t i = 0; i < children->count; i++) {
		if (!(fds[i].revents & POLLIN))
			continue;
		reap(children, i);
		*out_child = i;
		return CHILDREN_ENDED;
	}
	if ((fds[children->count].revents & POLLIN) && drain(children->signal_fd))
		return CHILDREN_SIGNAL;
	if ((fds[children->count + 1].revents & POLLIN) && drain(children->timer_fd))
		return CHILDREN_TICK;
	if (fds[children->count + 2].revents & (POLLIN | POLLHUP | POLLERR))
		return CHILDREN_INPUT;
	return CHILDREN_TIMEOUT;
}

enum children_event children_wait(struct children *children, int64_t timeout_ns,
				  size_t *out_child)
{
	struct pollfd fds[WATCHED_MAX + 3];
	int64_t until = gr_clock_now(&gr_clock_monotonic) + timeout_ns;

	for (;;) {
		struct timespec left = { 0 };
		int64_t left_ns = until - gr_clock_now(&gr_clock_monotonic);
		enum children_event event;
		int n;

		for (size_t i = 0; i < children->count; i++) /* poll skips a negative fd */
			fds[i] = (struct pollfd){ children->items[i].pidfd, POLLIN, 0 };
		fds[children->count] = (struct pollfd){ children->signal_fd, POLLIN, 0 };
		fds[children->count + 1] = (struct pollfd){ children->timer_fd, POLLIN, 0 };
		fds[children->count + 2] = (struct pollfd){ children->input_fd, POLLIN, 0 };
		if (left_ns > 0)
			left = (struct timespec){ left_ns / 1000000000, left_ns % 1000000000 };
		n = ppoll(fds, children->count + 3, timeout_ns < 0 ? NULL : &left, NULL);
		if (n < 0 && errno != EINTR)
			return CHILDREN_FAILED;
		if (n == 0)
			return CHILDREN_TIMEOUT;
		if (n < 0)
			continue;
		event = look(children, fds, out_child);
		if (event != CHILDREN_TIMEOUT)
			return event;
	}
}

static void signal_running(const struct children *children, int signal)
{
	for (size_t i = 0; i < children->count; i++)
		if (children->items[i].pidfd >= 0)
			pidfd_send_signal(children->items[i].pidfd, signal, NULL, 0);
}

void children_end(struct children *children, int64_t patience_ns)
{
	int64_t until = gr_clock_now(&gr_clock_monotonic) + patience_ns;
	size_t ended;

	if (children->running == 0)
		return;
	for (size_t i = 0; i < children->count; i++)
		if (children->items[i].pidfd >= 0)
			children->items[i].told = true;
	signal_running(children, SIGTERM);
	while (children->running > 0 && gr_clock_now(&gr_clock_monotonic) < until) {
		int64_t left = until - gr_clock_now(&gr_clock_monotonic);
		enum children_event event = children_wait(children, left > 0 ? left : 0, &ended);

		if (event == CHILDREN_SIGNAL || event == CHILDREN_FAILED)
			break; /* asked a second time: no more patience */
	}
	signal_running(children, SIGKILL);
	for (size_t i = 0; i < children->count; i++)
		if (children->items[i].pidfd >= 0)
			reap(children, i);
}

bool child_ended_well(const struct child *child)
{
	return child->pidfd < 0 && WIFEXITED(child->status) && WEXITSTATUS(child->status) == 0;
}

void child_describe(const struct child *child, char *text, size_t size)
{
	if (child->pidfd >= 0)
		snprintf(text, size, "runs");
	else if (WIFSIGNALED(child->status))
		snprintf(text, size, "was killed by signal %d (%s)", WTERMSIG(child->status),
			 strsignal(WTERMSIG(child->status)));
	else
		snprintf(text, size, "ended with status %d", WEXITSTATUS(child->status));
}
