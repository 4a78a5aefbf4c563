/*
 * Who bakes: PATH.lock, held by flock and gone with its holder's work, or with
 * the holder. It says "PID HOST" for those who wait.
 *
 * Thread safety: none needed; no state.
 */
#ifndef GROTTO_RENDERER_GI_SURFEL_LOCK_H
#define GROTTO_RENDERER_GI_SURFEL_LOCK_H

#include "renderer/alive.h"

#define SURFEL_HOLDER_SIZE 96

struct surfel_lock {
	char *path;
	int fd;                          /* -1: not held */
	double waited_s;                 /* 0: not at all */
	char holder[SURFEL_HOLDER_SIZE]; /* "process 12 on host", while another holds it */
};
#define SURFEL_LOCK { .fd = -1 }

/*
 * Waits wait_s at most; says in the log whom for. GR_OK: held; GR_ERR_TIMEOUT:
 * `holder` still has it; GR_ERR_IO: no file can be made there, errno says why;
 * GR_ERR_NOMEM; GR_NOTHING: `alive` ended the wait. lock is SURFEL_LOCK, or was given back.
 */
int surfel_lock_take(struct surfel_lock *lock, const char *path, int wait_s, struct alive alive);
/* Also one that is not held. */
void surfel_lock_give_back(struct surfel_lock *lock);

#endif
