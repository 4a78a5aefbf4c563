/*
 * A generated atrium of any number of triangles: a floor, walls, two rows of
 * fluted columns and arches between, open to the sky. The same shape at every
 * number, only finer.
 */
#ifndef GROTTO_TOOLS_BENCH_ATRIUM_H
#define GROTTO_TOOLS_BENCH_ATRIUM_H

#include "renderer/scene/scene.h"

/* About so many triangles, at least 2000. Aborts when out of memory; room_free frees. */
struct scene *atrium_build(size_t triangles);
/* As a binary glTF 2.0 file. GR_OK, GR_ERR_IO (errno says why). */
int atrium_write(const struct scene *scene, const char *path);

#endif
