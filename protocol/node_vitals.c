/* What a node tells of itself once a second: vitals.h. */
#include "protocol/node_private.h"

#include <string.h>

void fdp_node_stages(struct fdp_node *n, const struct fdp_vitals_stage *stages, unsigned count)
{
	n->vitals.count = count < FDP_VITALS_STAGES ? count : FDP_VITALS_STAGES;
	memcpy(n->vitals.stages, stages, n->vitals.count * sizeof *stages);
}

int64_t fdp_node_vitals_next(const struct fdp_node *n)
{
	if (!n->vitals.receive_bytes && !n->vitals.count)
		return INT64_MAX;
	return n->vitals_ns ? n->vitals_ns + FDP_VITALS_NS : 0; /* at once in a new session */
}

void fdp_node_vitals_tick(struct fdp_node *n, int64_t now_ns)
{
	if (now_ns < fdp_node_vitals_next(n))
		return;
	n->vitals_ns = now_ns;
	fdp_outbox_send(&n->out, FDP_TO_ALL, FDP_VITALS,
			fdp_vitals_encode(&n->vitals, fdp_outbox_body(&n->out), FDP_BODY_MAX));
}
