#include <config.h>

#include "renderer/gi/surfel_lock.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define POLL_NS 50000000 /* how often it is asked for */
#define HOST_SIZE 64

/* Who gets it looks whether it is still the file of that name: the one before may have removed it. */
static bool is_still_there(const struct surfel_lock *lock)
{
	struct stat held, named;

	return fstat(lock->fd, &held) == 0 && stat(lock->path, &named) == 0 &&
	       held.st_ino == named.st_ino && held.st_dev == named.st_dev;
}

/* For those who wait. That it cannot be written (a full disk) takes nothing from the lock. */
static void sign(const struct surfel_lock *lock)
{
	char host[HOST_SIZE] = "", line[SURFEL_HOLDER_SIZE];
	int len;

	if (gethostname(host, sizeof host - 1) != 0)
		host[0] = '\0';
	len = snprintf(line, sizeof line, "%ld %s\n", (long)getpid(), host);
	if (len > 0 && ftruncate(lock->fd, 0) == 0 && pwrite(lock->fd, line, (size_t)len, 0) != len)
		(void)!ftruncate(lock->fd, 0);
}

/* Anybody may have written it: only a number and a name of a host are taken from it. */
static void read_holder(struct surfel_lock *lock)
{
	char line[SURFEL_HOLDER_SIZE] = "", host[HOST_SIZE] = "";
	int fd = open(lock->path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
	long pid = 0;

	if (fd >= 0) {
		ssize_t n = pread(fd, line, sizeof line - 1, 0);

		line[n > 0 ? n : 0] = '\0';
		close(fd);
	}
	if (sscanf(line, "%9ld %63[-.A-Za-z0-9]", &pid, host) == 2 && pid > 0)
		snprintf(lock->holder, sizeof lock->holder, "process %ld on %s", pid, host);
	else
		snprintf(lock->holder, sizeof lock->holder, "another process");
}

/* GR_OK; GR_NOTHING: another holds it; GR_ERR_IO. */
static int try_lock(struct surfel_lock *lock)
{
	int why;

	lock->fd = open(lock->path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644);
	if (lock->fd < 0)
		return GR_ERR_IO;
	if (flock(lock->fd, LOCK_EX | LOCK_NB) == 0) {
		if (is_still_there(lock)) {
			sign(lock);
			return GR_OK;
		}
		why = EWOULDBLOCK;
	} else {
		why = errno;
	}
	close(lock->fd);
	lock->fd = -1;
	errno = why;
	return why == EWOULDBLOCK || why == EINTR ? GR_NOTHING : GR_ERR_IO;
}

int surfel_lock_take(struct surfel_lock *lock, const char *path, int wait_s, struct alive alive)
{
	const struct timespec pause = { 0, POLL_NS };
	int64_t start = gr_clock_now(&gr_clock_monotonic);
	bool told = false;

	*lock = (struct surfel_lock)SURFEL_LOCK;
	if (asprintf(&lock->path, "%s.lock", path) < 0) {
		lock->path = NULL;
		return GR_ERR_NOMEM;
	}
	for (;;) {
		int result = try_lock(lock);
		int64_t waited = gr_clock_now(&gr_clock_monotonic) - start;

		if (told)
			lock->waited_s = (double)waited * 1e-9;
		if (result != GR_NOTHING)
			return result;
		if (wait_s <= 0 || waited > wait_s * GR_NS_PER_S) {
			read_holder(lock);
			return GR_ERR_TIMEOUT;
		}
		if (!told) {
			read_holder(lock);
			gr_notice("surfels: %s bakes %s; waiting for it, %d s at most", lock->holder,
				  path, wait_s);
		}
		told = true;
		if (!alive_go_on(alive))
			return GR_NOTHING;
		nanosleep(&pause, NULL);
	}
}

void surfel_lock_give_back(struct surfel_lock *lock)
{
	if (lock->fd >= 0) {
		/* before it is let go: whoever waits sees that this one is no more */
		unlink(lock->path);
		close(lock->fd);
	}
	free(lock->path);
	lock->path = NULL;
	lock->fd = -1;
}
