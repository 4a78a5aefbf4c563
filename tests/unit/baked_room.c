#include "tests/unit/baked_room.h"

#include "base/result.h"
#include "tools/bench/room.h"

#include <sodium.h>
#include <unistd.h>

const struct surfel_bake_params baked_room_coarse = {
	.spacing_m = 1, .links = 16, .taps = 2, .probes = 2, .threads = 1, .seed = 1,
};

int baked_room_make(struct baked_room *room)
{
	struct gr_diag diag = { 0 };

	if (sodium_init() < 0)
		return -1;
	room->scene = room_cornell();
	snprintf(room->folder, sizeof room->folder, "/tmp/grotto-surfels-XXXXXX");
	if (!mkdtemp(room->folder))
		return -1;
	return surfel_bake(&room->set, room->scene, NULL, &baked_room_coarse, &diag) == GR_OK ? 0 : -1;
}

int baked_room_remove(struct baked_room *room)
{
	surfel_set_destroy(&room->set);
	room_free(&room->scene);
	return rmdir(room->folder);
}

char *baked_room_path(const struct baked_room *room, const char *name,
		      char out[BAKED_ROOM_PATH_BYTES])
{
	snprintf(out, BAKED_ROOM_PATH_BYTES, "%s/%s", room->folder, name);
	return out;
}
