/*
 * What a running master says of its room (docs/control.md, `status`). The
 * document may be of another version: what is not there is not judged.
 */
#ifndef GROTTO_TOOLS_DOCTOR_ROOM_H
#define GROTTO_TOOLS_DOCTOR_ROOM_H

#include "tools/doctor/finding.h"

#include <json-c/json.h>
#include <stdint.h>

/* node: an element of nodes[]. */
struct finding room_judge_node(struct json_object *node);
/* lead_ns: how far ahead a swap may be set at most. */
struct finding room_judge_clock(struct json_object *node, int64_t lead_ns);
/* Datagrams that the daemon dropped, could not send, had to repeat. */
void room_judge_wire(struct json_object *status, struct findings *out);

#endif
