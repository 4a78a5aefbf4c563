/* The room in which calibrate.h measures: 4 x 4 x 4 m, a block in it, one spot. */
#ifndef GROTTO_RENDERER_CALIBRATE_ROOM_H
#define GROTTO_RENDERER_CALIBRATE_ROOM_H

#include "renderer/scene/scene.h"

/* Free with scene_destroy. GR_OK or GR_ERR_NOMEM. */
int calibrate_room(struct scene **out);
/* No memory of its own but *lamp, which the caller keeps. */
void calibrate_room_file(struct scene_file *out, struct scene_lamp *lamp);

#endif
