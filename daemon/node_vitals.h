/* What a node tells the master of its drawing, once a second: each stage's mean over its last frames. */
#ifndef GROTTO_DAEMON_NODE_VITALS_H
#define GROTTO_DAEMON_NODE_VITALS_H

#include "protocol/node.h"
#include "renderer/renderer.h"

void node_vitals_tell(struct renderer *renderer, struct fdp_node *fdp);

#endif
