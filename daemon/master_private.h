/* Between the parts of the master: master.c has frames, master_events.c what happens, master_role.c who rules. */
#ifndef GROTTO_DAEMON_MASTER_PRIVATE_H
#define GROTTO_DAEMON_MASTER_PRIVATE_H

#include "daemon/master.h"

const char *master_node_name(const struct master *m, int node);
/* Nodes that have joined and have not gone. */
size_t master_members(const struct master *m);
void master_node_gone(struct master *m, int node);
/* As fdp_master_ops.event; ctx is the master. */
void master_on_event(void *ctx, const struct fdp_master_event *event);

/* Needs the protocol's master. GR_OK or a negative result. */
int master_role_create(struct master *m);
/* This master runs the room; else it follows one that does, or looks for nodes that have none. */
static inline bool master_rules(const struct master *m)
{
	return fdp_standby_role(m->standby) == FDP_ROLE_RULES;
}
/* Of a master that follows, or of a session above ours. */
void master_role_event(struct master *m, const struct fdp_master_event *event);
int master_role_receive(struct master *m, const uint8_t *bytes, size_t len, int64_t arrived_ns,
			int64_t now_ns);
/* After everything that may have changed the protocol's state; when it, or the protocol, is due. */
void master_role_tick(struct master *m, int64_t now_ns);
int64_t master_role_next(const struct master *m);
/* Who does not rule says so once a second. */
void master_role_status(const struct master *m, int64_t now_ns);
void master_role_write_json(const struct master *m, struct json *json, int64_t now_ns);

/* Within this a standby has taken over; 0: there is none. */
int64_t master_takeover_ns(const struct layout *layout);

#endif
