/*
 * A folder of foreign pictures with their scene, in the form of
 * ../shared/reference/renders/: scene.json, scene.glb or the model that the
 * scene's one object names, and for each camera CAM.exr, CAM_stderr.exr and
 * perhaps CAM_indirect.exr. It becomes a scene file of ours with its model and
 * environment. Nothing here knows any such folder; what a scene.json holds and
 * is not understood is refused by its name.
 */
#ifndef GROTTO_TESTS_FOLDER_FOLDER_H
#define GROTTO_TESTS_FOLDER_FOLDER_H

#include "base/diag.h"
#include "config/scene_file.h"
#include "renderer/image/image.h"
#include "renderer/scene/scene.h"

#include <stdbool.h>
#include <stdio.h>

struct folder {
	char *path;
	char *scene_path; /* of the scene file that was written */
	int width, height, max_bounces;
	bool diffuse;       /* every material is Lambert or emits */
	bool surrounded;    /* an environment lights it */
	char name[64];
	char *cameras[SCENE_MAX_CAMERAS]; /* names of the pictures, as many as the scene file has cameras */
	struct scene_file *file;
	struct scene *scene;
};

/*
 * Writes scene.scene, and the model and the environment where they are made, into
 * `work`, which exists; loads them. GR_OK, GR_ERR_CONFIG with faults in diag,
 * GR_ERR_IO, GR_ERR_NOMEM.
 */
int folder_open(struct folder *out, const char *path, const char *work, struct gr_diag *diag);
void folder_close(struct folder *folder);

/* What the folder has of a camera; pictures that are not there have no data. */
struct folder_pictures {
	struct image picture, error, indirect;
};
int folder_pictures_read(const struct folder *folder, size_t camera, struct folder_pictures *out,
			 struct gr_diag *diag);
void folder_pictures_finish(struct folder_pictures *pictures);

#endif
