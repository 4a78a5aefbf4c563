#include "tests/accuracy/folder/folder.h"

#include "base/result.h"
#include "tests/accuracy/folder/scene_text.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int write_scene(struct folder *folder, const char *work, struct gr_diag *diag)
{
	FILE *out = fopen(folder->scene_path, "w");
	int result;
	bool failed;

	if (!out) {
		gr_diag_add(diag, GR_DIAG_ERROR, folder->scene_path, 0, NULL, "cannot be written");
		return GR_ERR_IO;
	}
	result = scene_text_write(folder, work, out, diag);
	failed = ferror(out) != 0;
	if ((fclose(out) != 0 || failed) && result == GR_OK)
		result = GR_ERR_IO;
	return result;
}

int folder_open(struct folder *out, const char *path, const char *work, struct gr_diag *diag)
{
	int result;

	memset(out, 0, sizeof *out);
	out->path = strdup(path);
	if (!out->path || asprintf(&out->scene_path, "%s/scene.scene", work) < 0) {
		folder_close(out);
		return GR_ERR_NOMEM;
	}
	result = write_scene(out, work, diag);
	if (result == GR_OK)
		result = scene_file_load(out->scene_path, &out->file, diag);
	if (result == GR_OK)
		result = scene_import(out->file, &out->scene, diag);
	if (result != GR_OK)
		folder_close(out);
	return result;
}

void folder_close(struct folder *folder)
{
	scene_destroy(&folder->scene);
	scene_file_destroy(&folder->file);
	for (int i = 0; i < SCENE_MAX_CAMERAS; i++)
		free(folder->cameras[i]);
	free(folder->scene_path);
	free(folder->path);
	memset(folder, 0, sizeof *folder);
}

static int read_one(const struct folder *folder, const char *camera, const char *part, bool needed,
		    struct image *out, struct gr_diag *diag)
{
	char *path;
	int result;

	if (asprintf(&path, "%s/%s%s.exr", folder->path, camera, part) < 0)
		return GR_ERR_NOMEM;
	if (!needed && access(path, F_OK) != 0) {
		free(path);
		return GR_OK;
	}
	result = image_read_exr(path, out, diag);
	if (result == GR_OK && (out->width != folder->width || out->height != folder->height ||
				out->channels != 3)) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
			    "%d x %d pixels of %d channels; the scene says %d x %d of 3", out->width,
			    out->height, out->channels, folder->width, folder->height);
		result = GR_ERR_CONFIG;
	}
	free(path);
	return result;
}

int folder_pictures_read(const struct folder *folder, size_t camera, struct folder_pictures *out,
			 struct gr_diag *diag)
{
	const char *name = folder->cameras[camera];
	int result;

	memset(out, 0, sizeof *out);
	result = read_one(folder, name, "", true, &out->picture, diag);
	if (result == GR_OK)
		result = read_one(folder, name, "_stderr", false, &out->error, diag);
	if (result == GR_OK)
		result = read_one(folder, name, "_indirect", false, &out->indirect, diag);
	if (result != GR_OK)
		folder_pictures_finish(out);
	return result;
}

void folder_pictures_finish(struct folder_pictures *pictures)
{
	image_finish(&pictures->picture);
	image_finish(&pictures->error);
	image_finish(&pictures->indirect);
}
