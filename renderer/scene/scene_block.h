/*
 * A scene and the words about it as one flat block, for handing from the process
 * that imported it to the one that uses it. Same machine, same program: values
 * stand as in memory. The reader trusts nothing, since what wrote the block has
 * read a model from outside.
 */
#ifndef GROTTO_RENDERER_SCENE_SCENE_BLOCK_H
#define GROTTO_RENDERER_SCENE_SCENE_BLOCK_H

#include "base/diag.h"
#include "renderer/scene/scene.h"

#include <stddef.h>
#include <stdint.h>

/* Longest block: the largest scene that is accepted, and room for the rest. */
#define SCENE_BLOCK_MAX ((size_t)5 << 30)

/* `result` of the import; scene is NULL unless that is GR_OK. GR_ERR_IO. */
int scene_block_write(int fd, int result, const struct scene *scene, const struct gr_diag *diag);
/*
 * Adds the block's lines to diag and returns the result that it holds; on GR_OK
 * *out is the scene, without its hash. GR_ERR_FORMAT: not a block as
 * written above, or a scene whose parts do not fit; GR_ERR_NOMEM.
 */
int scene_block_read(const uint8_t *bytes, size_t len, struct scene **out, struct gr_diag *diag);

#endif
