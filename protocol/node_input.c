/* What a person does at this node's window, told to the master: input.h. */
#include "protocol/node_private.h"

#include <string.h>

static bool is_held(const struct fdp_input *input)
{
	return input->buttons || input->axes[0] != 0 || input->axes[1] != 0;
}

void fdp_node_input(struct fdp_node *n, const struct fdp_input *input)
{
	if (n->input.given && !memcmp(input, &n->input.state, sizeof *input))
		return;
	n->input.state = *input;
	n->input.given = n->input.changed = true;
	n->input.times = FDP_INPUT_TIMES;
}

int64_t fdp_node_input_next(const struct fdp_node *n)
{
	if (!n->input.given || (!n->input.times && !is_held(&n->input.state)))
		return INT64_MAX;
	return n->input.sent_ns + (n->input.changed ? FDP_INPUT_LEAST_NS : FDP_INPUT_AGAIN_NS);
}

void fdp_node_input_tick(struct fdp_node *n, int64_t now_ns)
{
	if (now_ns < fdp_node_input_next(n))
		return;
	n->input.sent_ns = now_ns;
	n->input.changed = false;
	n->input.times -= n->input.times > 0;
	fdp_outbox_send(&n->out, FDP_TO_ALL, FDP_INPUT,
			fdp_input_encode(&n->input.state, fdp_outbox_body(&n->out), FDP_BODY_MAX));
}
