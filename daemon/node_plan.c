#include "daemon/node_plan.h"

bool node_plan_offered(struct node_plan *plan, uint64_t offered, int64_t now_ns)
{
	if (offered == 0 || offered == plan->present)
		return false;
	if (plan->tries == 0 || now_ns - plan->since_ns >= NODE_PLAN_AGAIN_NS) {
		plan->tries = 0;
		plan->impossible = 0;
		plan->since_ns = now_ns;
	}
	if (offered == plan->impossible || plan->tries == NODE_PLAN_TRIES)
		return false;
	plan->tries++;
	plan->wanted = offered;
	return true;
}

void node_plan_tried(struct node_plan *plan, uint64_t present)
{
	if (present != plan->wanted)
		plan->impossible = plan->wanted;
	plan->present = present;
	plan->wanted = 0;
}

void node_plan_settled(struct node_plan *plan)
{
	plan->tries = 0;
}
