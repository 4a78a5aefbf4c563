/* What is done at a node's window goes to the master, where the layout makes a wand of it. */
#ifndef GROTTO_DAEMON_NODE_INPUT_H
#define GROTTO_DAEMON_NODE_INPUT_H

#include "config/layout.h"
#include "protocol/node.h"
#include "renderer/gl/target.h"

/* The layout has a tracker of that kind. */
bool node_input_wanted(const struct layout *layout);
/* As the window has it now; without one nothing is told. */
void node_input_tell(const struct target *target, struct fdp_node *fdp);

#endif
