#include <config.h>

#include "renderer/gi/surfel_store.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define POLL_NS 50000000 /* how often a lock is asked for */
#define HASH_BYTES 8

/* --- places --- */

/* grotto's folder for what can be made again; NULL: no one knows where. */
static char *cache_folder(void)
{
	const char *given = getenv("CACHE_DIRECTORY"), *xdg = getenv("XDG_CACHE_HOME");
	const char *home = getenv("HOME");
	char *folder = NULL;
	int n = 0;

	/* of several systemd parts them by colons */
	if (given && given[0] == '/')
		n = asprintf(&folder, "%.*s", (int)strcspn(given, ":"), given);
	else if (xdg && xdg[0] == '/')
		n = asprintf(&folder, "%s/grotto", xdg);
	else if (home && home[0] == '/')
		n = asprintf(&folder, "%s/.cache/grotto", home);
	return n < 0 ? NULL : folder;
}

/* The last part of a path without ".scene", as a slice. */
static size_t stem(const char *path, const char **out)
{
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
	size_t len = strlen(name);

	*out = name;
	return len > 6 && strcmp(name + len - 6, ".scene") == 0 ? len - 6 : len;
}

static char *cache_file(const char *scene_path)
{
	char *folder = cache_folder(), *whole = realpath(scene_path, NULL), *path = NULL;
	const char *hashed = whole ? whole : scene_path, *name;
	uint8_t hash[16];
	char hex[2 * HASH_BYTES + 1];
	size_t len = stem(scene_path, &name);

	crypto_generichash(hash, sizeof hash, (const uint8_t *)hashed, strlen(hashed), NULL, 0);
	sodium_bin2hex(hex, sizeof hex, hash, HASH_BYTES);
	if (folder && asprintf(&path, "%s/%.*s-%s.surfels", folder, (int)len, name, hex) < 0)
		path = NULL;
	free(folder);
	free(whole);
	return path;
}

int surfel_store_init(struct surfel_store *out, const struct scene_file *file)
{
	const char *name;
	size_t len;

	*out = (struct surfel_store){ .wait_s = SURFEL_STORE_WAIT_S };
	if (!file->path)
		return GR_OK;
	len = stem(file->path, &name);
	if (asprintf(&out->beside, "%.*s.surfels", (int)((size_t)(name - file->path) + len),
		     file->path) < 0) {
		out->beside = NULL;
		return GR_ERR_NOMEM;
	}
	out->cache = cache_file(file->path);
	return GR_OK;
}

int surfel_store_at(struct surfel_store *out, const char *path)
{
	*out = (struct surfel_store){ .wait_s = SURFEL_STORE_WAIT_S, .beside = strdup(path) };
	return out->beside ? GR_OK : GR_ERR_NOMEM;
}

void surfel_store_finish(struct surfel_store *store)
{
	free(store->beside);
	free(store->cache);
	*store = (struct surfel_store){ 0 };
}

/* The folder of the cache's file and the one above it, where they are missing. */
static void make_folder(const char *path)
{
	char *folder = strdup(path);
	char *slash = folder ? strrchr(folder, '/') : NULL;

	if (slash && slash != folder) {
		*slash = 0;
		if (mkdir(folder, 0700) != 0 && errno == ENOENT) {
			char *above = strrchr(folder, '/');

			if (above && above != folder) {
				*above = 0;
				mkdir(folder, 0700);
				*above = '/';
				mkdir(folder, 0700);
			}
		}
	}
	free(folder);
}

/* --- the lock --- */

/*
 * PATH.lock, held by flock and gone with its holder's work. Who gets it looks
 * whether it is still the file of that name: the one before may have removed it.
 */
struct lock {
	char *path;
	int fd; /* -1: not held */
};

static bool is_still_there(const struct lock *lock)
{
	struct stat held, named;

	return fstat(lock->fd, &held) == 0 && stat(lock->path, &named) == 0 &&
	       held.st_ino == named.st_ino && held.st_dev == named.st_dev;
}

/* GR_OK; GR_NOTHING: another holds it; GR_ERR_IO. */
static int try_lock(struct lock *lock)
{
	int why;

	lock->fd = open(lock->path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
	if (lock->fd < 0)
		return GR_ERR_IO;
	if (flock(lock->fd, LOCK_EX | LOCK_NB) == 0) {
		if (is_still_there(lock))
			return GR_OK;
		why = EWOULDBLOCK;
	} else {
		why = errno;
	}
	close(lock->fd);
	lock->fd = -1;
	return why == EWOULDBLOCK || why == EINTR ? GR_NOTHING : GR_ERR_IO;
}

/* GR_OK; GR_ERR_IO: there can be no file; GR_ERR_TIMEOUT. */
static int lock_file(struct lock *lock, const char *path, int wait_s, double *waited_s)
{
	int64_t start = gr_clock_now(&gr_clock_monotonic);
	bool told = false;

	lock->fd = -1;
	if (asprintf(&lock->path, "%s.lock", path) < 0) {
		lock->path = NULL;
		return GR_ERR_IO;
	}
	for (;;) {
		const struct timespec pause = { 0, POLL_NS };
		int result = try_lock(lock);
		int64_t waited = gr_clock_now(&gr_clock_monotonic) - start;

		if (told)
			*waited_s = (double)waited * 1e-9;
		if (result != GR_NOTHING)
			return result;
		if (waited > wait_s * GR_NS_PER_S)
			return GR_ERR_TIMEOUT;
		if (!told)
			gr_notice("surfels: another process bakes %s; waiting for it, %d s at most",
				  path, wait_s);
		told = true;
		nanosleep(&pause, NULL);
	}
}

static void unlock_file(struct lock *lock)
{
	if (lock->path && lock->fd >= 0) {
		/* before it is let go: whoever waits sees that this one is no more */
		unlink(lock->path);
		close(lock->fd);
	}
	free(lock->path);
}

/* --- getting a set --- */

struct request {
	const struct surfel_store *store;
	struct surfel_set **out;
	const struct scene *scene;
	const struct scene_file *file;
	const struct surfel_bake_params *params;
	struct gr_diag *diag;
	struct surfel_store_done *done;
	uint8_t key[SURFEL_KEY_BYTES];
};

/* GR_OK when a file could be used. */
static int read_either(struct request *r, struct gr_diag *diag)
{
	const char *const places[2] = { r->store->beside, r->store->cache };

	for (int i = 0; i < 2; i++) {
		int result = places[i] ? surfel_file_read(r->out, r->key, places[i], diag)
				       : GR_NOTHING;

		if (result == GR_OK)
			r->done->path = places[i];
		if (result == GR_OK || result == GR_ERR_NOMEM)
			return result;
	}
	return GR_NOTHING;
}

/* Of the places the first in which a lock can be had: it can be written. */
static int choose_place(struct request *r, struct lock *lock, const char **out_path)
{
	const char *const places[2] = { r->store->beside, r->store->cache };
	int result = GR_ERR_IO;

	*out_path = NULL;
	for (int i = 0; i < 2 && result == GR_ERR_IO; i++) {
		if (!places[i])
			continue;
		if (i == 1)
			make_folder(places[i]);
		result = lock_file(lock, places[i], r->store->wait_s, &r->done->waited_s);
		if (result == GR_OK) {
			*out_path = places[i];
		} else {
			int why = errno;

			free(lock->path);
			lock->path = NULL;
			gr_diag_add(r->diag, result == GR_ERR_TIMEOUT ? GR_DIAG_WARNING : GR_DIAG_NOTE,
				    places[i], 0, NULL, "%s",
				    result == GR_ERR_TIMEOUT
					    ? "another process still bakes it; baking without keeping"
					    : strerror(why));
		}
	}
	return result;
}

static int bake_and_keep(struct request *r, const char *path)
{
	int result = surfel_bake(r->out, r->scene, r->file, r->params, r->diag);

	if (result != GR_OK)
		return result;
	r->done->baked = true;
	if (!path) {
		/* a scene without a file has no place, and asks for none */
		if (r->store->beside)
			gr_diag_add(r->diag, GR_DIAG_WARNING, r->store->beside, 0, NULL,
				    "cannot be written, and neither can a cache: baked again at every start");
	} else if (surfel_file_write(*r->out, r->key, path) == GR_OK) {
		r->done->path = path;
	} else {
		gr_diag_add(r->diag, GR_DIAG_WARNING, path, 0, NULL, "cannot be written: %s",
			    strerror(errno));
	}
	return GR_OK;
}

int surfel_store_get(const struct surfel_store *store, struct surfel_set **out,
		     const struct scene *scene, const struct scene_file *file,
		     const struct surfel_bake_params *params, struct gr_diag *diag,
		     struct surfel_store_done *done)
{
	struct surfel_store_done unasked;
	struct request r = { store, out, scene, file, params, diag, done ? done : &unasked, { 0 } };
	struct lock lock = { NULL, -1 };
	struct gr_diag said = { 0 };
	const char *path;
	int result = GR_NOTHING;

	*out = NULL;
	*r.done = (struct surfel_store_done){ 0 };
	surfel_file_key(scene, params, r.key);
	if (!store->force)
		result = read_either(&r, diag);
	if (result == GR_OK || result == GR_ERR_NOMEM)
		return result;
	choose_place(&r, &lock, &path);
	/* who held the lock has baked meanwhile; what was wrong before has been said */
	if (!store->force)
		result = read_either(&r, &said);
	gr_diag_finish(&said);
	if (result == GR_NOTHING)
		result = bake_and_keep(&r, path);
	unlock_file(&lock);
	return result;
}

/* --- for the daemons --- */

struct teller {
	int64_t next_ns;
};

/* A line every ten seconds. */
static bool tell(void *ctx, const char *stage, double done, double seconds_left)
{
	struct teller *teller = ctx;
	int64_t now = gr_clock_now(&gr_clock_monotonic);

	if (now < teller->next_ns)
		return true;
	teller->next_ns = now + 10 * GR_NS_PER_S;
	if (seconds_left >= 0)
		gr_notice("surfels: baking, %s: %.0f %%, %.0f s left", stage, 100 * done, seconds_left);
	else
		gr_notice("surfels: baking, %s: %.0f %%", stage, 100 * done);
	return true;
}

int surfels_load_or_bake(struct surfel_set **out, const struct scene *scene,
			 const struct scene_file *file, const struct surfel_bake_params *params)
{
	struct teller teller = { gr_clock_now(&gr_clock_monotonic) + 2 * GR_NS_PER_S };
	struct surfel_bake_params told = *params;
	struct surfel_store_done done;
	struct surfel_store store;
	struct gr_diag diag = { 0 };
	int result = surfel_store_init(&store, file);

	*out = NULL;
	if (!told.progress) {
		told.progress = tell;
		told.ctx = &teller;
	}
	if (result == GR_OK)
		result = surfel_store_get(&store, out, scene, file, &told, &diag, &done);
	gr_diag_log(&diag);
	gr_diag_finish(&diag);
	/* a scene without a file is the calibration's, or a test's */
	if (result == GR_OK && done.baked && file->path)
		gr_info("surfels: %zu baked in %.1f s, kept as %s", (*out)->count, (*out)->seconds,
			done.path ? done.path : "nothing");
	else if (result == GR_OK && !done.baked)
		gr_info("surfels: %zu read from %s", (*out)->count, done.path);
	surfel_store_finish(&store);
	return result;
}
