#include "daemon/node_control.h"

#include "daemon/control.h"
#include "daemon/json.h"

#include <stdio.h>
#include <string.h>

bool node_control_path(const struct layout *layout, const char *node, char path[NODE_CONTROL_PATH])
{
	return layout->control_socket &&
	       snprintf(path, NODE_CONTROL_PATH, "%s.%s", layout->control_socket, node) < (int)NODE_CONTROL_PATH;
}

static void write_status(const struct node *n, char *answer, size_t size)
{
	struct json json = json_start(answer, size);
	struct net_stats net;

	net_stats(n->net, &net);
	json_open(&json, NULL, '{');
	json_bool(&json, "ok", true);
	json_string(&json, "node", n->params.layout->nodes[n->params.index].name);
	json_string(&json, "state", fdp_node_state_name(fdp_node_status(n->fdp)));
	json_u64(&json, "frame", n->state_frame);
	json_hash(&json, "state_hash", n->state_hash);
	json_u64(&json, "applied", n->counts.applied);
	json_u64(&json, "drawn", n->counts.drawn);
	json_u64(&json, "swapped", n->counts.swapped);
	json_u64(&json, "dropped", n->counts.dropped);
	json_u64(&json, "mismatches", n->counts.mismatches);
	json_u64(&json, "lost", n->counts.lost);
	json_u64(&json, "send_failed", net.send_failed);
	faults_write_json(n->faults, &json, "faults");
	json_close(&json, '}');
	if (!json.ok)
		control_refuse(answer, size, "the answer is longer than %zu bytes", size);
}

void node_answer(void *ctx, char *const *words, int count, char *answer, size_t size)
{
	struct node *n = ctx;

	if (!strcmp(words[0], "status") && count == 1) {
		write_status(n, answer, size);
	} else if (!strcmp(words[0], "faults")) {
		faults_answer(n->faults, n->params.layout->path, words, count, answer, size);
	} else if (!strcmp(words[0], "quit") && count == 1) {
		gr_notice("control: asked to end");
		snprintf(answer, size, "{\"ok\":true}");
		loop_stop(n->loop);
	} else {
		control_refuse(answer, size, "no request '%.40s' of a node; there are status, faults, quit",
			       words[0]);
	}
}
