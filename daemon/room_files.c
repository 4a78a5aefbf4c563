#include "daemon/room_files.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(LAYOUT_ITEMS_MAX + SCENE_ITEMS_MAX <= FDP_ITEMS_MAX,
	       "every part of the largest room must fit into a JOIN");

static int load_key(struct room_files *out, const struct common_options *options,
		    struct gr_diag *diag)
{
	char *path = options->key ? strdup(options->key) : layout_key_path(out->layout);
	int r = fdp_key_load(path, out->key, diag);

	free(path);
	return r;
}

int room_files_load(struct room_files *out, const struct common_options *options)
{
	struct gr_diag diag = { 0 };
	int layout_result, scene_result, r;

	*out = (struct room_files){ 0 };
	if (sodium_init() < 0) {
		gr_error("libsodium cannot be initialised");
		return GR_ERR_UNSUPPORTED;
	}
	/* Both files are looked at, so that a person sees all faults at once. */
	layout_result = layout_load(options->layout, &out->layout, &diag);
	scene_result = scene_file_load(options->scene, &out->scene_file, &diag);
	r = layout_result < 0 ? layout_result : scene_result;
	if (r >= 0)
		r = load_key(out, options, &diag);
	if (r >= 0)
		r = scene_import(out->scene_file, &out->scene, &diag);
	gr_diag_log(&diag);
	gr_diag_finish(&diag);
	if (r < 0) {
		gr_error("cannot start: %s", gr_result_name(r));
		room_files_finish(out);
		return r;
	}
	scene_content_hash(out->scene_file, out->scene, out->content_hash);
	out->layout_item_count = layout_items(out->layout, out->layout_items, LAYOUT_ITEMS_MAX,
					      out->layout->hash);
	out->scene_item_count = scene_content_items(out->scene_file, out->scene, out->scene_items);
	if (options->deadline_ms > 0)
		out->layout->rates.barrier_deadline_ns = options->deadline_ms * GR_NS_PER_MS;
	return GR_OK;
}

struct fdp_contents room_files_contents(const struct room_files *files)
{
	struct fdp_contents contents = {
		.layout = files->layout_items, .layout_count = files->layout_item_count,
		.scene = files->scene_items, .scene_count = files->scene_item_count,
	};

	memcpy(contents.layout_hash, files->layout->hash, sizeof contents.layout_hash);
	memcpy(contents.scene_hash, files->content_hash, sizeof contents.scene_hash);
	return contents;
}

void room_files_finish(struct room_files *files)
{
	scene_destroy(&files->scene);
	scene_file_destroy(&files->scene_file);
	layout_destroy(&files->layout);
	sodium_memzero(files->key, sizeof files->key);
}

int room_files_exit(int result)
{
	switch (result) {
	case GR_OK: return GR_EXIT_OK;
	/* A file that cannot be opened is a wrong path in the configuration. */
	case GR_ERR_CONFIG:
	case GR_ERR_IO:
	case GR_ERR_RANGE:
	case GR_ERR_FORMAT: return GR_EXIT_CONFIG;
	default: return GR_EXIT_RUNTIME;
	}
}
