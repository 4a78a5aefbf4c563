/* What the eye looks at of this node's wall, told to the master: glance.h. */
#include "protocol/node_private.h"

#include <string.h>

void fdp_node_glance(struct fdp_node *n, const struct fdp_glance *glance)
{
	if (n->glance.given && !memcmp(glance, &n->glance.state, sizeof *glance))
		return;
	n->glance.state = *glance;
	n->glance.given = true;
	n->glance.sent_ns = 0; /* now */
}

int64_t fdp_node_glance_next(const struct fdp_node *n)
{
	if (!n->glance.given)
		return INT64_MAX;
	return n->glance.sent_ns ? n->glance.sent_ns + FDP_GLANCE_AGAIN_NS : 0;
}

void fdp_node_glance_tick(struct fdp_node *n, int64_t now_ns)
{
	if (now_ns < fdp_node_glance_next(n))
		return;
	n->glance.sent_ns = now_ns;
	fdp_outbox_send(&n->out, FDP_TO_ALL, FDP_GLANCE,
			fdp_glance_encode(&n->glance.state, fdp_outbox_body(&n->out), FDP_BODY_MAX));
}
