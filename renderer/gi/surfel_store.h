/*
 * Where baked surfels are kept, and who bakes them: beside the scene file
 * (cornell.scene: cornell.surfels), and where that folder cannot be written in
 * the user's cache. A file of the cache is looked for only when there is none
 * beside the scene that can be used.
 *
 * Several processes that start at once bake once: the first takes a lock, the
 * others wait for it and read its file. Where it cannot be written once it is
 * baked (a full disk, a quota) the next place is tried; the set is used in any case.
 *
 * Thread safety: one thread calls. Reads the environment (the cache's place).
 */
#ifndef GROTTO_RENDERER_GI_SURFEL_STORE_H
#define GROTTO_RENDERER_GI_SURFEL_STORE_H

#include "renderer/alive.h"
#include "renderer/gi/surfel_file.h"

/* Longest wait for another process; below the services' TimeoutStartSec. */
#define SURFEL_STORE_WAIT_S 240

struct surfel_store {
	char *beside;    /* file beside the scene; NULL: the scene has no path */
	char *cache;     /* file in the cache; NULL: there is no place for one */
	bool one_place;  /* the file is what is wanted: no cache, and GR_ERR_IO instead of a bake
			  * when it cannot be written there */
	bool force;      /* bake, whatever there is */
	int wait_s;      /* most */
	struct alive alive; /* asked while another process is waited for */
};
/*
 * The places for a scene file. The cache is CACHE_DIRECTORY (systemd's), or
 * grotto in XDG_CACHE_HOME, or in .cache of HOME: CACHE/NAME-HASH.surfels, with a
 * hash of the scene file's whole path. GR_OK, GR_ERR_NOMEM. Finish frees.
 */
int surfel_store_init(struct surfel_store *out, const struct scene_file *file);
/* One place, and no other. */
int surfel_store_at(struct surfel_store *out, const char *path);
void surfel_store_finish(struct surfel_store *store);

/* What was done, for a report. */
struct surfel_store_done {
	bool baked;           /* else read */
	const char *path;     /* the store's, of the file; NULL: it is kept nowhere */
	double waited_s;      /* for another process */
};

/*
 * The set from a file that fits, or baked and kept. That a file is stale or
 * damaged, that none can be written, and that another process is waited for, is
 * said in diag, or in the log while it waits; none of it is an error but as
 * one_place says. GR_NOTHING: store->alive ended it. As surfel_bake otherwise. done may be NULL.
 */
int surfel_store_get(const struct surfel_store *store, struct surfel_set **out,
		     const struct scene *scene, const struct scene_file *file,
		     const struct surfel_bake_params *params, struct gr_diag *diag,
		     struct surfel_store_done *done);

/* Only what is there: GR_OK, GR_NOTHING, GR_ERR_NOMEM. Why a file is not used is said in diag. */
int surfel_store_read(const struct surfel_store *store, struct surfel_set **out,
		      const struct scene *scene, const struct surfel_bake_params *params,
		      struct gr_diag *diag, struct surfel_store_done *done);

/*
 * All of the above with the usual places, what there is to say logged. alive is
 * asked while it bakes or waits, unless params have a progress of their own.
 */
int surfels_load_or_bake(struct surfel_set **out, const struct scene *scene,
			 const struct scene_file *file, const struct surfel_bake_params *params,
			 struct alive alive);

#endif
