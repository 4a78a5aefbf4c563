#include <config.h>

#include "renderer/gi/surfel_store.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "renderer/gi/surfel_lock.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

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
	*out = (struct surfel_store){ .wait_s = SURFEL_STORE_WAIT_S, .beside = strdup(path),
				      .one_place = true };
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

/* --- getting a set --- */

enum place { PLACE_BESIDE, PLACE_CACHE, PLACES };

struct request {
	const struct surfel_store *store;
	struct surfel_set **out;
	struct gr_diag *diag;
	struct surfel_store_done *done;
	const char *places[PLACES]; /* in the order in which they are tried; NULL: none */
	struct surfel_lock lock;
	bool stopped;               /* by the store's alive */
	uint8_t key[SURFEL_KEY_BYTES];
};

/* GR_OK when a file could be used. */
static int read_either(struct request *r, struct gr_diag *diag)
{
	for (int i = 0; i < PLACES; i++) {
		int result = r->places[i] ? surfel_file_read(r->out, r->key, r->places[i], diag)
					  : GR_NOTHING;

		if (result == GR_OK)
			r->done->path = r->places[i];
		if (result == GR_OK || result == GR_ERR_NOMEM)
			return result;
	}
	return GR_NOTHING;
}

static void note_unwritable(struct request *r, const char *path, int why, enum gr_severity severity)
{
	gr_diag_add(r->diag, severity, path, 0, NULL, "cannot be written: %s", strerror(why));
}

/*
 * Whether a file can be kept at a place, which begins with its lock. GR_OK;
 * GR_ERR_IO: not there; GR_ERR_TIMEOUT: somebody else bakes it, longer than wait_s.
 */
static int claim(struct request *r, int place, int wait_s)
{
	const char *path = r->places[place];
	int result, why;

	if (place == PLACE_CACHE)
		make_folder(path);
	result = surfel_lock_take(&r->lock, path, wait_s, r->store->alive);
	why = errno;
	r->done->waited_s += r->lock.waited_s;
	if (result == GR_OK)
		return GR_OK;
	r->stopped = result == GR_NOTHING;
	if (r->stopped)
		result = GR_ERR_TIMEOUT;
	else if (result == GR_ERR_TIMEOUT)
		gr_diag_add(r->diag, GR_DIAG_WARNING, path, 0, NULL,
			    "%s has been baking it for more than %d s (it holds %s.lock); not waited "
			    "for any longer",
			    r->lock.holder, wait_s, path);
	else
		note_unwritable(r, path, why, r->store->one_place ? GR_DIAG_ERROR : GR_DIAG_NOTE);
	surfel_lock_give_back(&r->lock);
	return result == GR_ERR_NOMEM ? GR_ERR_IO : result;
}

/*
 * The first place from `from` on that can be claimed, PLACES: none. Only the
 * first that answers is waited for; who has waited bakes now, come what may.
 */
static int claim_from(struct request *r, int from, int wait_s)
{
	for (int place = from; place < PLACES && !r->stopped; place++) {
		int result = r->places[place] ? claim(r, place, wait_s) : GR_ERR_IO;

		if (result == GR_OK)
			return place;
		if (result == GR_ERR_TIMEOUT)
			wait_s = 0;
	}
	return PLACES;
}

static void warn_not_kept(struct request *r)
{
	const char *path = r->places[PLACE_BESIDE];

	/* a scene without a file has no place, and asks for none; of one place all is said */
	if (!path || r->store->one_place)
		return;
	gr_diag_add(r->diag, GR_DIAG_WARNING, path, 0, NULL, "%s",
		    r->places[PLACE_CACHE]
			    ? "is not kept, nor in the cache: it is baked again at every start"
			    : "is not kept, and there is no cache (none of CACHE_DIRECTORY, "
			      "XDG_CACHE_HOME and HOME names a folder): it is baked again at every start");
}

/* A lock does not say that there is room: what cannot be written here is tried at the next place. */
static void keep(struct request *r, int place)
{
	while (place < PLACES) {
		const char *path = r->places[place];

		if (surfel_file_write(*r->out, r->key, path) == GR_OK) {
			r->done->path = path;
			return;
		}
		note_unwritable(r, path, errno,
				r->store->one_place ? GR_DIAG_WARNING : GR_DIAG_NOTE);
		surfel_lock_give_back(&r->lock);
		place = claim_from(r, place + 1, 0);
	}
	warn_not_kept(r);
}

int surfel_store_read(const struct surfel_store *store, struct surfel_set **out,
		      const struct scene *scene, const struct surfel_bake_params *params,
		      struct gr_diag *diag, struct surfel_store_done *done)
{
	struct request r = { .store = store, .out = out, .diag = diag, .done = done,
			     .places = { store->beside, store->cache } };

	*out = NULL;
	*done = (struct surfel_store_done){ 0 };
	surfel_file_key(scene, params, r.key);
	return read_either(&r, diag);
}

int surfel_store_get(const struct surfel_store *store, struct surfel_set **out,
		     const struct scene *scene, const struct scene_file *file,
		     const struct surfel_bake_params *params, struct gr_diag *diag,
		     struct surfel_store_done *done)
{
	struct surfel_store_done unasked;
	struct request r = { .store = store, .out = out, .diag = diag,
			     .places = { store->beside, store->cache },
			     .done = done ? done : &unasked, .lock = SURFEL_LOCK };
	struct gr_diag said = { 0 };
	int result = GR_NOTHING, place;

	*out = NULL;
	*r.done = (struct surfel_store_done){ 0 };
	surfel_file_key(scene, params, r.key);
	if (!store->force)
		result = read_either(&r, diag);
	if (result == GR_OK || result == GR_ERR_NOMEM)
		return result;
	place = claim_from(&r, PLACE_BESIDE, store->wait_s);
	if (r.stopped)
		return GR_NOTHING;
	/* who held the lock has baked meanwhile; what was wrong before has been said */
	if (!store->force)
		result = read_either(&r, &said);
	gr_diag_finish(&said);
	if (result == GR_NOTHING && place == PLACES && store->one_place && diag->errors > 0)
		result = GR_ERR_IO; /* nobody would have what is baked */
	if (result == GR_NOTHING) {
		result = surfel_bake(out, scene, file, params, diag);
		r.done->baked = result == GR_OK;
		if (result == GR_OK)
			keep(&r, place);
	}
	surfel_lock_give_back(&r.lock);
	return result;
}

/* --- for the daemons --- */

struct teller {
	int64_t next_ns;
	struct alive alive;
};

/* A line every ten seconds. */
static bool tell(void *ctx, const char *stage, double done, double seconds_left)
{
	struct teller *teller = ctx;
	int64_t now = gr_clock_now(&gr_clock_monotonic);

	if (!alive_go_on(teller->alive))
		return false;
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
			 const struct scene_file *file, const struct surfel_bake_params *params,
			 struct alive alive)
{
	struct teller teller = { gr_clock_now(&gr_clock_monotonic) + 2 * GR_NS_PER_S, alive };
	struct surfel_bake_params told = *params;
	struct surfel_store_done done;
	struct surfel_store store;
	struct gr_diag diag = { 0 };
	int result = surfel_store_init(&store, file);

	*out = NULL;
	store.alive = alive;
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
