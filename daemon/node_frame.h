/*
 * From the applied parameters to what the renderer draws. Pure. The ranges of
 * single values were checked when the delta was applied; here it is checked
 * that they make sense together.
 */
#ifndef GROTTO_DAEMON_NODE_FRAME_H
#define GROTTO_DAEMON_NODE_FRAME_H

#include "protocol/params.h"
#include "renderer/frame.h"

/*
 * Fills `out`, which render_frame_init() prepared for `scene` (what the wire
 * does not carry stays as it is). A rotation of all zeros is none. GR_OK, or
 * GR_ERR_RANGE and *out untouched: a rotation that is not a unit quaternion,
 * a lit lamp without direction, likewise a wand whose HUD is shown; *refused names the parameter.
 */
int node_frame_fill(struct render_frame *out, const struct scene_file *scene,
		    const struct param_state *params, uint64_t frame, const char **refused);

#endif
