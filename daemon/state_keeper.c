#include "daemon/state_keeper.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct state_keeper {
	char *path, *beside;
	size_t room;
	uint8_t *next, *writing; /* handed over; the thread's */
	size_t next_len;         /* 0: nothing new */
	bool end;
	pthread_t thread;
	pthread_mutex_t mutex;
	pthread_cond_t changed;
	struct gr_log_limit limit; /* the thread's */
};

static bool write_whole(int fd, const uint8_t *bytes, size_t len)
{
	while (len) {
		const ssize_t n = write(fd, bytes, len);

		if (n < 0 && errno != EINTR)
			return false;
		if (n > 0) {
			bytes += n;
			len -= (size_t)n;
		}
	}
	return true;
}

static bool replace(struct state_keeper *k, size_t len)
{
	int fd = open(k->beside, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0600);
	bool ok;

	if (fd < 0)
		return false;
	ok = write_whole(fd, k->writing, len) && fsync(fd) == 0;
	ok = close(fd) == 0 && ok;
	return ok && rename(k->beside, k->path) == 0;
}

static void *write_thread(void *ctx)
{
	struct state_keeper *k = ctx;
	size_t len;

	pthread_mutex_lock(&k->mutex);
	for (;;) {
		uint64_t times;

		while (!k->next_len && !k->end)
			pthread_cond_wait(&k->changed, &k->mutex);
		len = k->next_len;
		if (!len)
			break;
		memcpy(k->writing, k->next, len);
		k->next_len = 0;
		pthread_mutex_unlock(&k->mutex);
		if (!replace(k, len) && gr_log_limit(&k->limit, gr_clock_now(&gr_clock_monotonic), &times))
			gr_warning("%s: cannot be written: %s (a master that is started again begins afresh)",
				   k->path, strerror(errno));
		pthread_mutex_lock(&k->mutex);
	}
	pthread_mutex_unlock(&k->mutex);
	return NULL;
}

static void free_all(struct state_keeper *k)
{
	free(k->path);
	free(k->beside);
	free(k->next);
	free(k->writing);
	free(k);
}

int state_keeper_create(struct state_keeper **out, const char *path, size_t room)
{
	struct state_keeper *k = calloc(1, sizeof *k);

	*out = NULL;
	if (!k)
		return GR_ERR_NOMEM;
	k->path = strdup(path);
	k->beside = malloc(strlen(path) + sizeof ".new");
	k->next = malloc(room);
	k->writing = malloc(room);
	k->room = room;
	if (!k->path || !k->beside || !k->next || !k->writing) {
		free_all(k);
		return GR_ERR_NOMEM;
	}
	sprintf(k->beside, "%s.new", path);
	pthread_mutex_init(&k->mutex, NULL);
	pthread_cond_init(&k->changed, NULL);
	if (pthread_create(&k->thread, NULL, write_thread, k) != 0) {
		pthread_cond_destroy(&k->changed);
		pthread_mutex_destroy(&k->mutex);
		free_all(k);
		return GR_ERR_IO;
	}
	*out = k;
	return GR_OK;
}

void state_keeper_put(struct state_keeper *k, const uint8_t *bytes, size_t len)
{
	if (!len || len > k->room)
		return;
	pthread_mutex_lock(&k->mutex);
	memcpy(k->next, bytes, len);
	k->next_len = len;
	pthread_cond_signal(&k->changed);
	pthread_mutex_unlock(&k->mutex);
}

void state_keeper_destroy(struct state_keeper **keeper)
{
	struct state_keeper *k = *keeper;

	*keeper = NULL;
	if (!k)
		return;
	pthread_mutex_lock(&k->mutex);
	k->end = true;
	pthread_cond_signal(&k->changed);
	pthread_mutex_unlock(&k->mutex);
	pthread_join(k->thread, NULL);
	pthread_cond_destroy(&k->changed);
	pthread_mutex_destroy(&k->mutex);
	free_all(k);
}
