#include "daemon/room_files.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

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
	if (options->deadline_ms > 0)
		out->layout->rates.barrier_deadline_ns = options->deadline_ms * GR_NS_PER_MS;
	return GR_OK;
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
