/*
 * What both daemons read before they open anything: layout, scene file,
 * model, key. Everything wrong is said, each fault with file and line.
 */
#ifndef GROTTO_DAEMON_ROOM_FILES_H
#define GROTTO_DAEMON_ROOM_FILES_H

#include "config/layout.h"
#include "config/scene_file.h"
#include "daemon/options.h"
#include "protocol/master.h"
#include "renderer/scene/scene.h"

struct room_files {
	struct layout *layout;
	struct scene_file *scene_file;
	struct scene *scene;
	uint8_t key[FDP_KEY_BYTES];
	uint8_t content_hash[32]; /* scene file and model, compared at join */
	/* The parts of layout and scene, by name. */
	struct gr_item layout_items[LAYOUT_ITEMS_MAX], scene_items[SCENE_ITEMS_MAX];
	size_t layout_item_count, scene_item_count;
};

/* What all machines must have alike; points into files. */
struct fdp_contents room_files_contents(const struct room_files *files);

/*
 * GR_OK or a negative result after logging. A deadline given on the command
 * line replaces the layout's (the layout's hash stays that of the file).
 */
int room_files_load(struct room_files *out, const struct common_options *options);
void room_files_finish(struct room_files *files);

/* What a failed load means to the one who started the daemon: enum gr_exit. */
int room_files_exit(int result);

#endif
