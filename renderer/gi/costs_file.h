/*
 * What was measured of a GPU, kept between runs: a small text file, one for
 * each GPU, driver and version of grotto. It is believed only whole: known keys
 * in their order, numbers in range, the right device, a checksum over all.
 *
 * Thread safe, and safe between processes: a file is there whole or not at all.
 */
#ifndef GROTTO_RENDERER_GI_COSTS_FILE_H
#define GROTTO_RENDERER_GI_COSTS_FILE_H

#include "renderer/gi/plan.h"

#include <stddef.h>

#define COSTS_DEVICE_MAX 256 /* with the final NUL; printable ASCII, what is not becomes '?' */
#define COSTS_FILE_MAX 2048

/*
 * Folder for it: $CACHE_DIRECTORY (systemd's CacheDirectory=, the first of a
 * list), else $XDG_CACHE_HOME/grotto, else $HOME/.cache/grotto. NULL: none of
 * them is set to an absolute path. Caller frees.
 */
char *gi_costs_folder(void);
/* folder/costs-HASH.txt for that device. Caller frees; NULL without memory. */
char *gi_costs_path(const char *folder, const char *device);

/* GR_OK, or GR_ERR_FORMAT with what is wrong in *out_why (a constant), GR_ERR_MISMATCH: another device. */
int gi_costs_decode(const char *text, size_t len, const char *device, struct gi_costs *out,
		    const char **out_why);
/* Writes at most COSTS_FILE_MAX bytes; the length. */
size_t gi_costs_encode(const struct gi_costs *costs, const char *device, char text[COSTS_FILE_MAX]);

/* GR_OK, GR_NOTHING (no file), or as decode; GR_ERR_IO with errno. */
int gi_costs_load(const char *path, const char *device, struct gi_costs *out, const char **out_why);
/* Makes the folder when it is missing. GR_OK or GR_ERR_IO (errno says why). */
int gi_costs_save(const char *path, const char *device, const struct gi_costs *costs);

/*
 * Waits until no other process measures for this path, at most wait_ms, and
 * keeps others waiting until gi_costs_unlock. -1: could not, go on without.
 */
int gi_costs_lock(const char *path, int wait_ms);
void gi_costs_unlock(int lock);

#endif
