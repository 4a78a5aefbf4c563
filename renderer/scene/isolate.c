#include "config.h" /* memfd_create, seals */

#include "renderer/scene/isolate.h"

#include "base/result.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/pidfd.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* The sanitizers' shadow memory takes terabytes of address space. */
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
#define LIMIT_MEMORY false
#elif defined __has_feature
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
	__has_feature(memory_sanitizer)
#define LIMIT_MEMORY false
#endif
#endif
#ifndef LIMIT_MEMORY
#define LIMIT_MEMORY true
#endif

/* The hard limit stands `above` the soft one: at the hard one for CPU time there is no SIGXCPU. */
static bool limit(__rlimit_resource_t what, rlim_t most, rlim_t above)
{
	struct rlimit old, new;

	if (getrlimit(what, &old) != 0)
		return false;
	new.rlim_max = old.rlim_max < most + above ? old.rlim_max : most + above;
	new.rlim_cur = old.rlim_cur < most ? old.rlim_cur : most;
	return setrlimit(what, &new) == 0;
}

/* Address space in use, from /proc; 0 when that cannot be read. */
static size_t address_space(void)
{
	FILE *file = fopen("/proc/self/statm", "re");
	unsigned long pages = 0;

	if (!file)
		return 0;
	if (fscanf(file, "%lu", &pages) != 1)
		pages = 0;
	fclose(file);
	return (size_t)pages * (size_t)sysconf(_SC_PAGESIZE);
}

/* Where memory runs out for real, the kernel shall take this process, not the room's. */
static void offer_to_oom_killer(void)
{
	FILE *file = fopen("/proc/self/oom_score_adj", "we");

	if (!file)
		return;
	fputs("1000\n", file);
	fclose(file);
}

static bool enter_child(const struct isolate_limits *limits, pid_t parent)
{
	static const int fatal[] = { SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU, SIGXFSZ,
				     SIGTERM, SIGINT, SIGHUP, SIGALRM, SIGPIPE };
	sigset_t none;

	/* The parent's handlers are about the parent. */
	for (size_t i = 0; i < sizeof fatal / sizeof fatal[0]; i++)
		signal(fatal[i], SIG_DFL);
	sigemptyset(&none);
	sigprocmask(SIG_SETMASK, &none, NULL);
	if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != parent)
		return false;
	offer_to_oom_killer();
	return limit(RLIMIT_CORE, 0, 0) && limit(RLIMIT_CPU, limits->cpu_s, 1) &&
	       limit(RLIMIT_FSIZE, limits->block, 0) &&
	       (!LIMIT_MEMORY || limit(RLIMIT_AS, address_space() + limits->memory, 0));
}

static int64_t now_ms(void)
{
	struct timespec now;

	clock_gettime(CLOCK_MONOTONIC, &now);
	return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* Waits for the end, then takes the status; kills a child that is late. */
static int wait_for(pid_t child, unsigned wall_ms, struct isolate_end *out)
{
	int64_t until = now_ms() + wall_ms;
	int fd = pidfd_open(child, 0), status;
	struct pollfd ready = { .fd = fd, .events = POLLIN };
	bool late = fd < 0;

	while (!late) {
		int64_t left = until - now_ms();
		int got = left > 0 ? poll(&ready, 1, (int)left) : 0;

		if (got > 0)
			break;
		late = got == 0 || errno != EINTR;
	}
	if (late)
		kill(child, SIGKILL);
	if (fd >= 0)
		close(fd);
	while (waitpid(child, &status, 0) < 0) {
		if (errno != EINTR)
			return GR_ERR_IO;
	}
	if (fd < 0)
		return GR_ERR_IO;
	out->how = late ? ISOLATE_LATE : ISOLATE_DONE;
	if (!late && WIFSIGNALED(status)) {
		out->how = ISOLATE_SIGNAL;
		out->number = WTERMSIG(status);
	} else if (!late && WEXITSTATUS(status) != 0) {
		out->how = ISOLATE_STATUS;
		out->number = WEXITSTATUS(status);
	}
	return GR_OK;
}

/* Sealing fails while anyone, say a child of the child, can still write by a mapping. */
static int map_block(int fd, size_t most, struct isolate_end *out)
{
	struct stat status;
	void *block;

	if (fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE | F_SEAL_SEAL) != 0 ||
	    fstat(fd, &status) != 0)
		return GR_ERR_IO;
	if (status.st_size < 1 || (uint64_t)status.st_size > most) {
		errno = EFBIG;
		return GR_ERR_IO;
	}
	block = mmap(NULL, (size_t)status.st_size, PROT_READ, MAP_PRIVATE, fd, 0);
	if (block == MAP_FAILED)
		return GR_ERR_IO;
	out->block = block;
	out->len = (size_t)status.st_size;
	return GR_OK;
}

int isolate_run(const struct isolate_limits *limits, isolate_work work, void *context,
		struct isolate_end *out)
{
	int fd = memfd_create("isolated", MFD_CLOEXEC | MFD_ALLOW_SEALING);
	pid_t parent = getpid(), child;
	int result;

	*out = (struct isolate_end){ 0 };
	if (fd < 0)
		return GR_ERR_IO;
	child = fork();
	if (child == 0) /* _exit: buffers and exit handlers are the parent's */
		_exit(enter_child(limits, parent) ? work(context, fd) : 126);
	result = child > 0 ? wait_for(child, limits->wall_ms, out) : GR_ERR_IO;
	if (result == GR_OK && out->how == ISOLATE_DONE)
		result = map_block(fd, limits->block, out);
	close(fd);
	return result;
}

void isolate_finish(struct isolate_end *end)
{
	if (end->block)
		munmap((void *)(uintptr_t)end->block, end->len);
	*end = (struct isolate_end){ 0 };
}

int isolate_write(int fd, const void *bytes, size_t len)
{
	const uint8_t *at = bytes;

	while (len > 0) {
		ssize_t wrote = write(fd, at, len);

		if (wrote < 0 && errno == EINTR)
			continue;
		if (wrote <= 0)
			return GR_ERR_IO;
		at += wrote;
		len -= (size_t)wrote;
	}
	return GR_OK;
}
