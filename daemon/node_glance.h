/* What the eye looks at of this node's wall, to the master. GL thread. */
#ifndef GROTTO_DAEMON_NODE_GLANCE_H
#define GROTTO_DAEMON_NODE_GLANCE_H

#include "protocol/node.h"
#include "renderer/renderer.h"

/* After a frame that the GPU has finished; does nothing where the scene's eye is fixed. */
void node_glance_tell(struct renderer *renderer, struct fdp_node *fdp);

#endif
