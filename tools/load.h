/* A scene that a command was given: its file and its model. */
#ifndef GROTTO_TOOLS_LOAD_H
#define GROTTO_TOOLS_LOAD_H

#include "config/scene_file.h"
#include "renderer/scene/scene.h"

/*
 * Says what there is to say of both. GR_OK; GR_ERR_NOMEM; GR_ERR_CONFIG for all
 * else: a file that cannot be opened is a wrong path. The caller destroys both,
 * also after a failure (NULL: not there).
 */
int load_scene(const char *path, struct scene_file **out_file, struct scene **out_scene);

#endif
