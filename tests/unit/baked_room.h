/* What the tests of bake files share: a small room, a coarse bake of it, and a folder for files. */
#ifndef GROTTO_TESTS_BAKED_ROOM_H
#define GROTTO_TESTS_BAKED_ROOM_H

#include "renderer/gi/surfel_bake.h"
#include "tests/unit/unit.h"

#define BAKED_ROOM_PATH_BYTES 128

struct baked_room {
	struct scene *scene;
	struct surfel_set *set;
	char folder[64];
};

extern const struct surfel_bake_params baked_room_coarse;

/* 0, or -1: as a group's set-up returns. */
int baked_room_make(struct baked_room *room);
/* Not 0 where a test has left something lying about in the folder. */
int baked_room_remove(struct baked_room *room);
/* A name in the folder; returns out. */
char *baked_room_path(const struct baked_room *room, const char *name,
		      char out[BAKED_ROOM_PATH_BYTES]);

#endif
