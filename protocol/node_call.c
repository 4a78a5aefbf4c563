/*
 * Which master a node is with, where there may be more than one: whom it asks,
 * whose call it answers, and what it never enters. Sessions only rise: a node
 * enters none below one that it has been in, so no two masters can drive it in
 * turns, and leaves the one it is in only when that is silent.
 */
#include "protocol/node_private.h"

#include <sodium.h>
#include <string.h>

/* A master that calls says so every frame; what was asked of it may be lost. */
#define CALL_AGAIN_NS INT64_C(10000000)
#define CALL_KEPT_NS INT64_C(1000000000) /* a call is of use for so long */
/* A master that knows nothing of the room may have it when those that do have been silent for so long. */
#define ORPHANED_NS INT64_C(1000000000)

/* Whichever there is. */
int fdp_node_whom_to_ask(const struct fdp_node *n)
{
	return n->params.masters > 1 ? FDP_TO_ALL : 0;
}

/* Nothing binds us to the master that we are with, if any: another may take its place. */
bool fdp_node_is_free(const struct fdp_node *n, int64_t now_ns)
{
	return !fdp_node_in_session(n) || now_ns - n->heard_ns >= n->params.call_ns;
}

/* Belongs to no session: nothing but a handshake is taken, and the keys are gone. */
void fdp_node_forget_session(struct fdp_node *n)
{
	n->gate.session = n->out.session = n->gate.keyed = 0;
	sodium_memzero(n->key_to_nodes, sizeof n->key_to_nodes);
	sodium_memzero(n->key_to_master, sizeof n->key_to_master);
}

/* session 0 asks; the session of a WELCOME, with its challenge, confirms. */
void fdp_node_send_join(struct fdp_node *n, int to, uint64_t session,
			const uint8_t nonce[FDP_NONCE_BYTES], const uint8_t *challenge)
{
	const uint64_t own = n->out.session;
	const int own_to = n->to;
	struct fdp_join join = {
		.version = FDP_VERSION,
		.index = n->params.index,
		.table_hash = param_table_hash(),
		.plan = n->params.plan,
		.plan_cost = n->params.plan_cost,
		.plan_error = n->params.plan_error,
		.highest = n->highest,
		.shown = n->shown,
		.layout_items = (uint8_t)n->params.contents.layout_count,
		.scene_items = (uint8_t)n->params.contents.scene_count,
	};

	memcpy(join.nonce, nonce, sizeof join.nonce);
	if (challenge)
		memcpy(join.challenge, challenge, sizeof join.challenge);
	memcpy(join.layout_hash, n->params.contents.layout_hash, sizeof join.layout_hash);
	memcpy(join.scene_hash, n->params.contents.scene_hash, sizeof join.scene_hash);
	memcpy(join.items, n->items, sizeof join.items);
	memcpy(join.name, n->name, sizeof join.name);
	n->out.session = session;
	n->out.fan_out = to == FDP_TO_ALL ? n->params.masters : 1;
	n->to = to;
	fdp_outbox_send(&n->out, FDP_TO_ALL, FDP_JOIN,
			fdp_join_encode(&join, fdp_outbox_body(&n->out), FDP_BODY_MAX));
	n->out.fan_out = 1;
	n->out.session = own;
	n->to = own_to;
}

/*
 * A master whose session is below one that we have been in: it was cut off from
 * us, or starts anew. We do not enter; but it may take a session above, now that
 * it is shown that we are here, without a master, and what we have been in.
 */
void fdp_node_prove_highest(struct fdp_node *n, const struct fdp_header *h,
			    const struct fdp_welcome *w, int64_t now_ns)
{
	if (n->guards || (n->params.masters > 1 && now_ns - n->heard_ns < ORPHANED_NS) ||
	    (n->proved_ns && now_ns - n->proved_ns < n->params.join_ns / 4))
		return;
	n->proved_ns = now_ns;
	n->calls[FDP_SENDER_MASTER - h->sender].hinted_ns = 0; /* it will call at once */
	fdp_node_send_join(n, (int)(FDP_SENDER_MASTER - h->sender), h->session, n->nonce,
			   w->challenge);
}

/*
 * A key holder speaks of another session: a new master, or a recording.
 * Asking shows which, and changes nothing here until the answer echoes our nonce.
 * Whether we ask is seen in tick: our own master's word may be waiting behind this.
 */
enum fdp_verdict fdp_node_on_beacon(struct fdp_node *n, const struct fdp_header *h,
				    const uint8_t *body, int64_t now_ns)
{
	struct fdp_node_call *call;

	if (!h->session || fdp_beacon_decode(body, h->payload_len))
		return FDP_BAD_FORMAT;
	/* Who is asking anyway need not be told to, but of a session that replaces the last. */
	if (h->session == n->gate.session ||
	    (!fdp_node_in_session(n) && (!n->highest || h->session <= n->highest)))
		return FDP_GOOD;
	call = &n->calls[FDP_SENDER_MASTER - h->sender];
	if (call->session > h->session && now_ns - call->heard_ns < CALL_KEPT_NS)
		return FDP_GOOD;
	call->session = h->session;
	call->heard_ns = now_ns;
	return FDP_GOOD;
}

void fdp_node_forget_calls(struct fdp_node *n)
{
	for (unsigned i = 0; i < FDP_MAX_MASTERS; i++)
		n->calls[i].session = 0;
}

static int64_t call_at(const struct fdp_node *n, const struct fdp_node_call *call)
{
	const bool several = n->params.masters > 1, below = call->session < n->highest;
	const int64_t silence_ns = several && below ? ORPHANED_NS : n->params.call_ns;
	int64_t at = 0;

	if (!call->session)
		return INT64_MAX;
	if (call->hinted_ns)
		at = call->hinted_ns + (several && !below ? CALL_AGAIN_NS : n->params.join_ns);
	if (fdp_node_in_session(n) && n->heard_ns + silence_ns > at)
		at = n->heard_ns + silence_ns;
	return at;
}

/* When a call that we have heard may be answered; INT64_MAX: there is none. */
int64_t fdp_node_call_at(const struct fdp_node *n)
{
	int64_t at = INT64_MAX;

	for (unsigned i = 0; i < FDP_MAX_MASTERS; i++)
		if (call_at(n, &n->calls[i]) < at)
			at = call_at(n, &n->calls[i]);
	return at;
}

void fdp_node_serve_call(struct fdp_node *n, int64_t now_ns)
{
	for (unsigned i = 0; i < FDP_MAX_MASTERS; i++) {
		struct fdp_node_call *call = &n->calls[i];

		if (call->session &&
		    (call->session == n->gate.session || now_ns - call->heard_ns > CALL_KEPT_NS))
			call->session = 0;
		if (now_ns < call_at(n, call))
			continue;
		call->session = 0;
		call->hinted_ns = now_ns;
		fdp_node_send_join(n, (int)i, 0, n->nonce, NULL);
	}
}

void fdp_node_guard(struct fdp_node *n, uint64_t session)
{
	fdp_node_forget_session(n);
	n->to = fdp_node_whom_to_ask(n);
	n->status = FDP_NODE_ASKING;
	n->guards = true;
	fdp_node_forget_calls(n);
	if (session > n->highest)
		n->highest = session;
	randombytes_buf(n->nonce, sizeof n->nonce);
	fdp_node_frame_reset(n);
}

int64_t fdp_node_heard(const struct fdp_node *n)
{
	return fdp_node_in_session(n) ? n->heard_ns : 0;
}

uint64_t fdp_node_highest(const struct fdp_node *n)
{
	return n->highest;
}

uint64_t fdp_node_applied(const struct fdp_node *n, uint64_t *out_live)
{
	if (out_live)
		*out_live = n->applied_live;
	return n->applied;
}

unsigned fdp_node_master(const struct fdp_node *n)
{
	return n->master;
}
