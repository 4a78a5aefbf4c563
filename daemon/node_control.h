/* A node's control socket: what it answers, and where it is. */
#ifndef GROTTO_DAEMON_NODE_CONTROL_H
#define GROTTO_DAEMON_NODE_CONTROL_H

#include "daemon/node.h"

#include <sys/un.h>

#define NODE_CONTROL_PATH (sizeof((struct sockaddr_un *)0)->sun_path + LAYOUT_NAME_MAX)

/*
 * The layout's control socket and the node's name: "/run/grotto/control.front". False
 * where the layout has none. A node has one where faults may be injected.
 */
bool node_control_path(const struct layout *layout, const char *node, char path[NODE_CONTROL_PATH]);
/* Answers status, faults and quit; see daemon/control.h. ctx: struct node. */
void node_answer(void *ctx, char *const *words, int count, char *answer, size_t size);

#endif
