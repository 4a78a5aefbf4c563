#include "protocol/standby.h"

#include "protocol/master_private.h"
#include "protocol/node_private.h"

#include "base/result.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

/* At its start it has time to find who rules: five requests to join. */
#define START_PATIENCE_NS INT64_C(1000000000)
#define SENDER_AT 8
/* It calls for so long in every frame, then as often as any master that misses nodes. */
#define CALLS_OFTEN_NS INT64_C(1000000000)

struct fdp_standby {
	struct fdp_standby_params params;
	struct fdp_standby_ops ops;
	struct fdp_master *master;
	struct fdp_node *ear; /* NULL: there is no other master */
	enum fdp_role role;
	bool joined, left;  /* the ear's news, until the next tick */
	uint64_t outranked; /* a session that a node has been in, above ours; 0: none */

	struct param_state *state;  /* followed */
	uint64_t frame, hash, live; /* whose it is, and who counted in it */
	int64_t frame_ns;
	bool anew;         /* the ear has joined since: whatever it holds first is newer */
	int64_t alive_ns; /* when there last was reason to believe that somebody rules */
	bool found;	  /* somebody did */
	int64_t began_ns, called_ns, took_ns; /* 0: it did not call */
	int64_t listens_ns; /* begins to rule and knows of no room: until then; 0: not */
};

static const char *const role_names[] = {
	[FDP_ROLE_FOLLOWS] = "standby",
	[FDP_ROLE_CALLS] = "calling",
	[FDP_ROLE_RULES] = "active",
};

const char *fdp_role_name(enum fdp_role role)
{
	return (unsigned)role < sizeof role_names / sizeof *role_names ? role_names[role]
								       : "unknown";
}

static void send(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct fdp_standby *s = ctx;

	s->ops.send(s->ops.ctx, to, bytes, len);
}

static void on_event(void *ctx, const struct fdp_node_event *event)
{
	struct fdp_standby *s = ctx;

	s->joined |= event->kind == FDP_NODE_JOINED;
	s->left |= event->kind == FDP_NODE_MASTER_LEFT;
	if (event->kind == FDP_NODE_REFUSED && s->ops.refused)
		s->ops.refused(s->ops.ctx, event->reason);
}

static int create_ear(struct fdp_standby *s)
{
	const struct fdp_standby_params *p = &s->params;
	const struct fdp_node_ops ops = { send, on_event, s };
	char name[FDP_NAME_BYTES];
	struct fdp_node_params params = {
		.index = (uint16_t)(p->node_count + p->index),
		.name = name,
		.contents = p->contents,
		.datagram_max = p->datagram_max,
		.masters = p->masters,
		.call_ns = p->silence_ns,
	};
	int r;

	fdp_master_name(p->index, name);
	memcpy(params.key, p->key, sizeof params.key);
	r = fdp_node_create(&s->ear, &params, &ops);
	sodium_memzero(params.key, sizeof params.key);
	return r;
}

/*
 * One that begins to rule and knows nothing is in the first epoch, and so may be
 * a room that goes on: by their sessions alone chance would choose between them.
 * For some time it takes in nobody who has been in a room, and its ear enters any
 * session of its epoch.
 */
static void listen(struct fdp_standby *s, int64_t now_ns)
{
	const uint64_t session = fdp_master_session(s->master), epoch = session >> FDP_EPOCH_SHIFT;

	if (epoch == 1)
		s->listens_ns = now_ns + START_PATIENCE_NS;
	fdp_master_listen(s->master, s->listens_ns);
	fdp_node_guard(s->ear, s->listens_ns ? epoch << FDP_EPOCH_SHIFT : session);
}

static void end_listening(struct fdp_standby *s)
{
	s->listens_ns = 0;
	if (s->role == FDP_ROLE_RULES)
		fdp_node_guard(s->ear, fdp_master_session(s->master));
}

int fdp_standby_create(struct fdp_standby **out, const struct fdp_standby_params *params,
		       const struct fdp_standby_ops *ops, struct fdp_master *master, int64_t now_ns)
{
	const bool several = params->masters > 1;
	struct fdp_standby *s;
	int r;

	*out = NULL;
	if ((several && (params->silence_ns <= 0 || params->period_ns <= 0 || !ops->send ||
			 params->index >= params->masters)) ||
	    (!several && params->follows))
		return GR_ERR_RANGE;
	s = calloc(1, sizeof *s);
	if (!s)
		return GR_ERR_NOMEM;
	s->params = *params;
	s->ops = *ops;
	s->master = master;
	s->role = params->follows ? FDP_ROLE_FOLLOWS : FDP_ROLE_RULES;
	s->alive_ns = now_ns;
	r = param_state_create(&s->state);
	if (r >= 0 && several)
		r = create_ear(s);
	sodium_memzero(s->params.key, sizeof s->params.key);
	if (r < 0) {
		fdp_standby_destroy(&s);
		return r;
	}
	if (s->ear && s->role == FDP_ROLE_RULES)
		listen(s, now_ns);
	*out = s;
	return GR_OK;
}

void fdp_standby_destroy(struct fdp_standby **standby)
{
	struct fdp_standby *s = *standby;

	*standby = NULL;
	if (!s)
		return;
	fdp_node_destroy(&s->ear);
	param_state_destroy(&s->state);
	free(s);
}

bool fdp_standby_is_its(const struct fdp_standby *s, const uint8_t *bytes, size_t len)
{
	return s->ear && len >= FDP_HEADER_BYTES &&
	       fdp_sender_is_master((uint16_t)(bytes[SENDER_AT] | bytes[SENDER_AT + 1] << 8));
}

/* The ear forgets what it holds when it loses its master; we do not. */
static void keep_state(struct fdp_standby *s, int64_t arrived_ns)
{
	uint64_t live;
	const uint64_t frame = fdp_node_applied(s->ear, &live);

	if (!frame || (frame == s->frame && fdp_node_hash(s->ear) == s->hash && !s->anew))
		return;
	param_state_copy(s->state, fdp_node_params_state(s->ear));
	s->frame = frame;
	s->hash = fdp_node_hash(s->ear);
	s->live = live;
	s->frame_ns = arrived_ns;
	s->anew = false;
}

void fdp_standby_counters(const struct fdp_standby *s, struct fdp_counters *out)
{
	*out = (struct fdp_counters){ 0 };
	if (s->ear)
		fdp_node_counters(s->ear, out);
	out->bad_session = 0;
}

int fdp_standby_receive(struct fdp_standby *s, const uint8_t *bytes, size_t len, int64_t arrived_ns,
			int64_t now_ns)
{
	int r;

	if (!s->ear)
		return GR_ERR_FORMAT;
	fdp_node_arrived(s->ear, arrived_ns);
	r = fdp_node_receive(s->ear, bytes, len, now_ns);
	if (s->role != FDP_ROLE_RULES)
		keep_state(s, now_ns);
	return r;
}

void fdp_standby_outranked(struct fdp_standby *s, uint64_t session)
{
	if (session > s->outranked)
		s->outranked = session;
}

/* Those that stand before us in the layout, and have not ruled, call first. */
static int64_t patience(const struct fdp_standby *s)
{
	const unsigned index = s->params.index;
	const unsigned rank = index - (s->found && fdp_node_master(s->ear) < index);

	return s->found ? s->params.silence_ns * (1 + (int64_t)rank)
			: START_PATIENCE_NS * (1 + (int64_t)index);
}

static uint64_t next_session(const struct fdp_standby *s)
{
	uint64_t highest = fdp_master_session(s->master);

	if (s->ear && fdp_node_highest(s->ear) > highest)
		highest = fdp_node_highest(s->ear);
	if (s->outranked > highest)
		highest = s->outranked;
	return fdp_session_after(highest);
}

static enum fdp_standby_change begin_calling(struct fdp_standby *s, int64_t now_ns)
{
	fdp_master_renew(s->master, next_session(s), s->state, s->frame);
	fdp_master_call(s->master);
	fdp_master_beacon(s->master, now_ns);
	s->role = FDP_ROLE_CALLS;
	s->left = false;
	s->began_ns = s->called_ns = now_ns;
	return FDP_STANDBY_CALLS;
}

static enum fdp_standby_change follow(struct fdp_standby *s, int64_t now_ns)
{
	const int64_t heard_ns = fdp_node_heard(s->ear);

	if (heard_ns > s->alive_ns)
		s->alive_ns = heard_ns;
	/* It said that it goes: for another, of which we may yet hear, or for good. */
	if (s->left) {
		s->left = false;
		s->alive_ns = now_ns - patience(s) / 2;
	}
	if (now_ns - s->alive_ns >= patience(s))
		return begin_calling(s, now_ns);
	return FDP_STANDBY_SAME;
}

/* When it calls again by itself; INT64_MAX: the master's beacons do. */
static int64_t call_at(const struct fdp_standby *s)
{
	return s->began_ns && s->called_ns - s->began_ns < CALLS_OFTEN_NS
		       ? s->called_ns + s->params.period_ns
		       : INT64_MAX;
}

static void call_again(struct fdp_standby *s, int64_t now_ns)
{
	if (now_ns < call_at(s))
		return;
	s->called_ns = now_ns;
	fdp_master_beacon(s->master, now_ns);
}

static enum fdp_standby_change call(struct fdp_standby *s, int64_t now_ns)
{
	const int64_t heard_ns = fdp_node_heard(s->ear);

	call_again(s, now_ns);
	if (!fdp_master_calls(s->master)) {
		s->role = FDP_ROLE_RULES;
		s->took_ns = now_ns;
		fdp_node_guard(s->ear, fdp_master_session(s->master));
		return FDP_STANDBY_TAKES;
	}
	/* Of late: this one may have been stopped itself, and read what waited. */
	if (heard_ns > s->began_ns && now_ns - heard_ns < patience(s)) {
		s->role = FDP_ROLE_FOLLOWS;
		s->alive_ns = heard_ns;
		return FDP_STANDBY_RETURNS;
	}
	return FDP_STANDBY_SAME;
}

/* A node without a master has been where we have not: all join anew, above that. */
static enum fdp_standby_change rise(struct fdp_standby *s, int64_t now_ns)
{
	const uint64_t frame = s->master->frame, session = next_session(s);

	s->outranked = 0;
	/* Where there is one master, nodes look for it at any time. */
	if (s->role == FDP_ROLE_RULES && s->ear)
		fdp_master_leave(s->master, now_ns);
	param_state_copy(s->state, s->master->state);
	fdp_master_renew(s->master, session, s->state, frame);
	if (s->role == FDP_ROLE_CALLS)
		fdp_master_call(s->master);
	else if (s->ear)
		fdp_node_guard(s->ear, session);
	call_again(s, now_ns);
	return s->role == FDP_ROLE_RULES ? FDP_STANDBY_RENEWED : FDP_STANDBY_SAME;
}

/* The ear has joined: who rules is found, and it is not us. */
static enum fdp_standby_change join(struct fdp_standby *s, int64_t now_ns)
{
	const bool ruled = s->role == FDP_ROLE_RULES;

	s->joined = s->left = false;
	s->outranked = 0;
	s->listens_ns = 0;
	if (ruled)
		fdp_master_leave(s->master, now_ns);
	fdp_master_renew(s->master, fdp_master_session(s->master), NULL, 0);
	s->role = FDP_ROLE_FOLLOWS;
	s->found = true;
	s->alive_ns = now_ns;
	/* What comes is its room, not what we had. */
	if (ruled)
		s->frame = 0;
	s->anew = true;
	return ruled ? FDP_STANDBY_YIELDS : FDP_STANDBY_FOLLOWS;
}

enum fdp_standby_change fdp_standby_tick(struct fdp_standby *s, int64_t now_ns)
{
	if (s->ear && now_ns >= fdp_node_next(s->ear))
		fdp_node_tick(s->ear, now_ns);
	if (s->joined)
		return join(s, now_ns);
	if (s->listens_ns && now_ns >= s->listens_ns)
		end_listening(s);
	if (s->outranked > fdp_master_session(s->master) && s->role != FDP_ROLE_FOLLOWS)
		return rise(s, now_ns);
	s->outranked = 0;
	switch (s->role) {
	case FDP_ROLE_FOLLOWS: return follow(s, now_ns);
	case FDP_ROLE_CALLS: return call(s, now_ns);
	case FDP_ROLE_RULES: call_again(s, now_ns); break; /* who has not heard it yet */
	}
	return FDP_STANDBY_SAME;
}

int64_t fdp_standby_next(const struct fdp_standby *s)
{
	int64_t next = s->ear ? fdp_node_next(s->ear) : INT64_MAX, at = INT64_MAX;

	if (s->joined || s->outranked ||
	    (s->role == FDP_ROLE_CALLS && !fdp_master_calls(s->master)))
		return 0;
	if (s->role == FDP_ROLE_FOLLOWS) {
		const int64_t heard_ns = fdp_node_heard(s->ear);

		at = s->left ? 0 : (heard_ns > s->alive_ns ? heard_ns : s->alive_ns) + patience(s);
	} else {
		at = call_at(s);
	}
	if (s->listens_ns && s->listens_ns < at)
		at = s->listens_ns;
	return at < next ? at : next;
}

enum fdp_role fdp_standby_role(const struct fdp_standby *s)
{
	return s->role;
}

const struct param_state *fdp_standby_state(const struct fdp_standby *s, uint64_t *out_frame,
					    int64_t *out_frame_ns)
{
	*out_frame = s->frame;
	if (out_frame_ns)
		*out_frame_ns = s->frame_ns;
	return s->state;
}

int fdp_standby_follows(const struct fdp_standby *s)
{
	return s->ear && fdp_node_session(s->ear) ? (int)fdp_node_master(s->ear) : -1;
}

uint64_t fdp_standby_first_frame(const struct fdp_standby *s, int64_t now_ns)
{
	if (!s->frame || !s->params.period_ns || now_ns < s->frame_ns)
		return s->frame + 1;
	return s->frame + 1 + (uint64_t)((now_ns - s->frame_ns) / s->params.period_ns);
}

int64_t fdp_standby_begin_at(const struct fdp_standby *s)
{
	uint64_t in = 0;

	for (size_t i = 0; i < s->params.node_count; i++) {
		const struct fdp_peer *peer = &s->master->peers[i];

		if (fdp_peer_counts(peer->state) ||
		    (peer->state == FDP_PEER_JOINING && peer->synced))
			in |= UINT64_C(1) << i;
	}
	return s->live & ~in ? s->took_ns + s->params.period_ns : 0;
}
