/* Nodes that do not keep up (protocol/pace.h): what the layout says of them, and what the log does. */
#ifndef GROTTO_DAEMON_MASTER_PACE_H
#define GROTTO_DAEMON_MASTER_PACE_H

#include "daemon/json.h"
#include "protocol/master.h"

struct layout;
struct master;

struct fdp_pace_params master_pace_params(const struct layout *layout);
/* FDP_MASTER_PACE and FDP_MASTER_EVICTED. */
void master_note_pace(struct master *master, const struct fdp_master_event *event, int64_t now_ns);
void master_note_evicted(struct master *master, const struct fdp_master_event *event);
/* "pace", and with it what is known: "pace_for_s", "out_for_s". */
void master_write_pace(struct json *json, const struct fdp_peer_status *peer, int64_t now_ns);
/* "stages": where its time goes. */
void master_write_stages(struct json *json, const struct fdp_peer_status *peer);

#endif
