#include "protocol/node_private.h"

#include "base/result.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#define NODE_KINDS (1u << FDP_WELCOME | 1u << FDP_REFUSE | 1u << FDP_SNAPSHOT | 1u << FDP_DELTA | \
		    1u << FDP_PROBE | 1u << FDP_SWAP | 1u << FDP_LEAVE | 1u << FDP_SLICE | 1u << FDP_LACK | \
		    1u << FDP_BEACON)
/* A REFUSED is told again after this, even if nothing has changed. */
#define REFUSED_AGAIN_NS INT64_C(60000000000)

static const char *const state_names[] = {
	[FDP_NODE_ALONE] = "alone", [FDP_NODE_ASKING] = "asking",
	[FDP_NODE_WAITING_SNAPSHOT] = "waiting for the snapshot", [FDP_NODE_LIVE] = "live",
};

const char *fdp_node_state_name(enum fdp_node_state state)
{
	return (unsigned)state < sizeof state_names / sizeof *state_names ? state_names[state]
									   : "unknown";
}

static void to_caller(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct fdp_node *n = ctx;

	(void)to;
	n->ops.send(n->ops.ctx, n->to, bytes, len);
}

static void say_reason(struct fdp_node *n, enum fdp_node_event_kind kind, const char *reason)
{
	const struct fdp_node_event event = {
		.kind = kind, .frame = n->applied, .reason = reason
	};

	n->ops.event(n->ops.ctx, &event);
}

void fdp_node_say(struct fdp_node *n, enum fdp_node_event_kind kind, uint64_t frame)
{
	const struct fdp_node_event event = { .kind = kind, .frame = frame };

	n->ops.event(n->ops.ctx, &event);
}

static void write_items(const struct fdp_contents *c, uint8_t items[FDP_ITEMS_BYTES])
{
	const unsigned width = fdp_items_width((unsigned)(c->layout_count + c->scene_count));

	for (size_t i = 0; i < c->layout_count; i++)
		memcpy(items + i * width, c->layout[i].digest, width);
	items += c->layout_count * width;
	for (size_t i = 0; i < c->scene_count; i++)
		memcpy(items + i * width, c->scene[i].digest, width);
}

int fdp_node_create(struct fdp_node **out, const struct fdp_node_params *params,
		    const struct fdp_node_ops *ops)
{
	struct fdp_node *n;
	int result;

	*out = NULL;
	if (params->index >= FDP_MAX_NODES || !params->name || !params->name[0] ||
	    strlen(params->name) >= FDP_NAME_BYTES || params->datagram_max < FDP_DATAGRAM_MIN ||
	    params->datagram_max > FDP_DATAGRAM_MAX || params->join_ns < 0 ||
	    params->contents.layout_count + params->contents.scene_count > FDP_ITEMS_MAX ||
	    params->masters > FDP_MAX_MASTERS || params->call_ns < 0 || params->silence_ns < 0 || !ops->send || !ops->event)
		return GR_ERR_RANGE;
	n = calloc(1, sizeof *n);
	if (!n)
		return GR_ERR_NOMEM;
	n->params = *params;
	strcpy(n->name, params->name);
	n->params.name = n->name;
	n->vitals.receive_bytes = params->receive_bytes;
	if (!n->params.join_ns)
		n->params.join_ns = FDP_JOIN_DEFAULT_NS;
	if (!n->params.silence_ns)
		n->params.silence_ns = FDP_SILENCE_DEFAULT_NS;
	if (!n->params.masters)
		n->params.masters = 1;
	n->to = fdp_node_whom_to_ask(n);
	n->ops = *ops;
	n->gate = (struct fdp_gate){
		.cluster_key = n->params.key,
		.keys = (const uint8_t(*)[FDP_KEY_BYTES])n->key_to_nodes,
		.kinds = NODE_KINDS,
		.any_version_kinds = 1u << FDP_REFUSE,
		.first_sender = fdp_master_sender(n->params.masters - 1),
		.last_sender = FDP_SENDER_MASTER,
		.self = (uint8_t)(params->index + 1),
	};
	n->out = (struct fdp_outbox){
		.cluster_key = n->params.key,
		.key = n->key_to_master,
		.sender = params->index,
		.datagram_max = params->datagram_max,
		.fan_out = 1,
		.counters = &n->counters,
		.send = to_caller,
		.ctx = n,
	};
	result = fdp_outbox_init(&n->out);
	if (!result)
		result = param_state_create(&n->state);
	if (!result)
		result = param_state_create(&n->scratch);
	if (!result)
		result = fdp_share_init(&n->share, params->share_bytes);
	if (result) {
		fdp_node_destroy(&n);
		return result;
	}
	fdp_node_clock_reset(n);
	randombytes_buf(n->nonce, sizeof n->nonce);
	write_items(&n->params.contents, n->items);
	*out = n;
	return GR_OK;
}

void fdp_node_destroy(struct fdp_node **node)
{
	struct fdp_node *n = *node;

	*node = NULL;
	if (!n)
		return;
	fdp_outbox_finish(&n->out);
	fdp_share_finish(&n->share);
	param_state_destroy(&n->state);
	param_state_destroy(&n->scratch);
	sodium_memzero(n->params.key, sizeof n->params.key);
	fdp_node_forget_session(n);
	free(n);
}

/* May we? or, where we were welcome, we are here now; again, until it is answered. */
static void ask(struct fdp_node *n, int64_t now_ns)
{
	n->asked_ns = now_ns;
	n->asked = true;
	if (n->gate.session)
		fdp_node_send_join(n, n->to, n->gate.session, n->joined_nonce, n->challenge);
	else
		fdp_node_send_join(n, fdp_node_whom_to_ask(n), 0, n->nonce, NULL);
}

static void enter_session(struct fdp_node *n, const struct fdp_header *h, const struct fdp_welcome *w,
			  int64_t now_ns)
{
	const uint64_t session = h->session;
	const unsigned i = (unsigned)h->sender - n->gate.first_sender;

	fdp_node_forget_session(n); /* and what another master knew us by */
	n->master = FDP_SENDER_MASTER - (unsigned)h->sender;
	n->to = (int)n->master;
	n->highest = session;
	n->guards = false;
	fdp_node_forget_calls(n);
	n->gate.session = n->out.session = session;
	fdp_key_to_nodes(n->params.key, session, w->master_nonce, n->key_to_nodes[i]);
	fdp_key_to_master(n->params.key, session, n->params.index, w->master_nonce, w->nonce,
			  w->challenge, n->key_to_master);
	n->gate.keyed = UINT64_C(1) << i;
	n->heard_ns = now_ns;
	n->group_heard_ns = 0;
	n->out.hears_group = false;
	n->input.times = FDP_INPUT_TIMES; /* a new master has heard of no window */
	fdp_node_frame_reset(n);
}

static void stop_taking_part(struct fdp_node *n)
{
	n->status = FDP_NODE_ASKING;
	fdp_node_forget_session(n);
	n->to = fdp_node_whom_to_ask(n);
	n->asked = false; /* at once */
	randombytes_buf(n->nonce, sizeof n->nonce);
}

void fdp_node_ask_again(struct fdp_node *n, enum fdp_node_event_kind kind, const char *reason)
{
	stop_taking_part(n);
	say_reason(n, kind, reason);
	fdp_node_frame_reset(n);
}

static void say_refused(struct fdp_node *n, const struct fdp_refuse *r, int64_t now_ns)
{
	const struct fdp_node_event event = {
		.kind = FDP_NODE_REFUSED, .frame = n->applied, .reason = n->refused, .plan = r->plan
	};

	memcpy(n->refused, r->reason, sizeof n->refused);
	n->refused_ns = now_ns;
	n->ops.event(n->ops.ctx, &event);
}

static enum fdp_verdict on_welcome(struct fdp_node *n, const struct fdp_header *h,
				   const uint8_t *body, int64_t now_ns)
{
	struct fdp_welcome w;

	if (!h->session || fdp_welcome_decode(body, h->payload_len, &w))
		return FDP_BAD_FORMAT;
	/* Two masters answered, and the other was faster. */
	if (n->gate.session && n->params.masters > 1 &&
	    !sodium_memcmp(w.nonce, n->joined_nonce, sizeof w.nonce))
		return FDP_GOOD;
	if (sodium_memcmp(w.nonce, n->nonce, sizeof w.nonce))
		return FDP_BAD_REPLAY;
	/* We asked because of a beacon of another session; this is our own master, or ours speaks again. */
	if (h->session == n->gate.session || !fdp_node_is_free(n, now_ns))
		return FDP_GOOD;
	if (h->session < n->highest || (n->guards && h->session == n->highest)) {
		fdp_node_prove_highest(n, h, &w, now_ns);
		return FDP_GOOD;
	}
	memcpy(n->challenge, w.challenge, sizeof n->challenge);
	/* No WELCOME is good twice: the next one must echo another nonce. */
	memcpy(n->joined_nonce, n->nonce, sizeof n->joined_nonce);
	randombytes_buf(n->nonce, sizeof n->nonce);
	n->retry_ns = n->wait_ns = (int64_t)w.probe_us * 1000;
	n->out.sequence = w.first_sequence - 1;
	fdp_replay_start(&n->window, h->sequence);
	enter_session(n, h, &w, now_ns);
	n->status = FDP_NODE_WAITING_SNAPSHOT;
	n->refused[0] = 0;
	ask(n, now_ns);
	fdp_node_say(n, FDP_NODE_JOINED, 0);
	return FDP_GOOD;
}

static enum fdp_verdict on_refuse(struct fdp_node *n, const struct fdp_header *h,
				  const uint8_t *body, int64_t now_ns)
{
	struct fdp_refuse r;

	if (fdp_refuse_decode(body, h->payload_len, &r))
		return FDP_BAD_FORMAT;
	/* Welcome when it asked, but not when it came: somebody with another plan was faster. */
	if (n->status == FDP_NODE_WAITING_SNAPSHOT &&
	    !sodium_memcmp(r.nonce, n->joined_nonce, sizeof r.nonce)) {
		stop_taking_part(n);
		say_refused(n, &r, now_ns);
		fdp_node_frame_reset(n);
		return FDP_GOOD;
	}
	if (sodium_memcmp(r.nonce, n->nonce, sizeof r.nonce))
		return FDP_BAD_REPLAY;
	if (!strcmp(r.reason, n->refused) && now_ns - n->refused_ns < REFUSED_AGAIN_NS)
		return FDP_GOOD;
	say_refused(n, &r, now_ns);
	return FDP_GOOD;
}

static enum fdp_verdict in_session(struct fdp_node *n, const struct fdp_header *h,
				   const uint8_t *body, int64_t now_ns)
{
	uint64_t frame;

	if (!fdp_replay_take(&n->window, h->sequence))
		return FDP_BAD_REPLAY;
	/* When it came, not when we had time for it: what waited here does not prove it alive. */
	if (n->arrived_ns > n->heard_ns)
		n->heard_ns = n->arrived_ns;
	if (h->group)
		n->group_heard_ns = now_ns;
	n->out.hears_group = n->group_heard_ns && now_ns - n->group_heard_ns < FDP_GROUP_FRESH_NS;
	switch (h->kind) {
	case FDP_SNAPSHOT:
	case FDP_DELTA:
		return fdp_node_on_state(n, h, body, now_ns);
	case FDP_PROBE:
	case FDP_SWAP:
		return fdp_node_on_announce(n, h, body, now_ns);
	case FDP_SLICE:
		return fdp_node_on_slice(n, body, h->payload_len, now_ns);
	case FDP_LACK:
		return fdp_node_on_lack(n, body, h->payload_len);
	case FDP_LEAVE:
		if (fdp_leave_decode(body, h->payload_len, &frame))
			return FDP_BAD_FORMAT;
		fdp_node_ask_again(n, FDP_NODE_MASTER_LEFT, "the master goes");
		/* Its successor needs a moment. */
		n->asked = true;
		n->asked_ns = now_ns;
		for (unsigned i = 0; i < FDP_MAX_MASTERS; i++)
			n->calls[i].hinted_ns = now_ns;
		return FDP_GOOD;
	default:
		return FDP_BAD_FORMAT;
	}
}

int fdp_node_receive(struct fdp_node *n, const uint8_t *bytes, size_t len, int64_t now_ns)
{
	const uint8_t *body = bytes + FDP_HEADER_BYTES;
	struct fdp_header h;
	enum fdp_verdict verdict = fdp_gate_open(&n->gate, bytes, len, &h);

	if (n->arrived_ns > now_ns || n->arrived_ns < now_ns - FDP_ARRIVED_MOST_NS)
		n->arrived_ns = now_ns;
	n->counters.datagrams_in++;
	n->counters.bytes_in += len;
	/*
	 * Nothing bad while we are in no session: a master that we are asking,
	 * or one that called while our scene was being loaded.
	 */
	if (verdict == FDP_BAD_SESSION && !n->gate.session)
		return GR_ERR_MISMATCH;
	if (verdict == FDP_GOOD) {
		if (h.kind == FDP_WELCOME)
			verdict = on_welcome(n, &h, body, now_ns);
		else if (h.kind == FDP_REFUSE)
			verdict = on_refuse(n, &h, body, now_ns);
		else if (h.kind == FDP_BEACON)
			verdict = fdp_node_on_beacon(n, &h, body, now_ns);
		else
			verdict = in_session(n, &h, body, now_ns);
	}
	n->arrived_ns = 0;
	fdp_count_bad(&n->counters, verdict);
	return fdp_verdict_result(verdict);
}

/* Who was welcome a moment ago has a master that answers. */
static int64_t ask_again_ns(const struct fdp_node *n)
{
	const int64_t soon_ns = 4 * n->retry_ns;

	return n->status == FDP_NODE_WAITING_SNAPSHOT && soon_ns < n->params.join_ns ? soon_ns : n->params.join_ns;
}

void fdp_node_tick(struct fdp_node *n, int64_t now_ns)
{
	if (fdp_node_in_session(n) && now_ns - n->heard_ns >= n->params.silence_ns)
		fdp_node_ask_again(n, FDP_NODE_LOST, "nothing from the master");
	if (n->status == FDP_NODE_ALONE)
		n->status = FDP_NODE_ASKING;
	fdp_node_serve_call(n, now_ns);
	if (n->status == FDP_NODE_LIVE) {
		fdp_node_frame_tick(n, now_ns);
		fdp_node_vitals_tick(n, now_ns);
		fdp_node_input_tick(n, now_ns);
		fdp_node_glance_tick(n, now_ns);
		return;
	}
	if (!n->guards && (!n->asked || now_ns - n->asked_ns >= ask_again_ns(n)))
		ask(n, now_ns);
}

int64_t fdp_node_next(const struct fdp_node *n)
{
	int64_t next = fdp_node_call_at(n), frame_next, input_next, glance_next;

	if (n->status == FDP_NODE_ALONE)
		return 0;
	if (fdp_node_in_session(n) && n->heard_ns + n->params.silence_ns < next)
		next = n->heard_ns + n->params.silence_ns;
	if (n->guards)
		return next;
	if (n->status != FDP_NODE_LIVE) {
		const int64_t ask = n->asked ? n->asked_ns + ask_again_ns(n) : 0;
		return ask < next ? ask : next;
	}
	frame_next = fdp_node_frame_next(n);
	next = frame_next < next ? frame_next : next;
	input_next = fdp_node_input_next(n);
	next = input_next < next ? input_next : next;
	glance_next = fdp_node_glance_next(n);
	next = glance_next < next ? glance_next : next;
	return fdp_node_vitals_next(n) < next ? fdp_node_vitals_next(n) : next;
}

const struct param_state *fdp_node_params_state(const struct fdp_node *n)
{
	return n->state;
}

int fdp_node_replan(struct fdp_node *n, uint64_t plan, uint16_t plan_cost, uint16_t plan_error,
		    size_t share_bytes)
{
	const struct fdp_share_counts counts = n->share.counts;
	int result;

	if (n->gate.session)
		return GR_ERR_STATE;
	n->params.plan = plan;
	n->params.plan_cost = plan_cost;
	n->params.plan_error = plan_error;
	fdp_share_finish(&n->share);
	result = fdp_share_init(&n->share, share_bytes);
	n->share.counts = counts;
	/* whatever is said to this plan is news */
	n->refused[0] = 0;
	n->asked = false;
	return result;
}

void fdp_node_leave(struct fdp_node *n, int64_t now_ns)
{
	(void)now_ns;
	if (!n->out.session)
		return;
	/* Nobody answers to it: twice, so that one loss does not cost the room its deadlines. */
	for (int i = 0; i < 2; i++)
		fdp_outbox_send(&n->out, FDP_TO_ALL, FDP_LEAVE,
				fdp_leave_encode(n->applied, fdp_outbox_body(&n->out), FDP_BODY_MAX));
	fdp_node_forget_session(n);
	n->to = fdp_node_whom_to_ask(n);
	n->status = FDP_NODE_ALONE;
	randombytes_buf(n->nonce, sizeof n->nonce);
	fdp_node_frame_reset(n);
}

enum fdp_node_state fdp_node_status(const struct fdp_node *n)
{
	return n->status;
}

uint64_t fdp_node_session(const struct fdp_node *n)
{
	return n->gate.session;
}

uint64_t fdp_node_hash(const struct fdp_node *n)
{
	return n->hash;
}

void fdp_node_counters(const struct fdp_node *n, struct fdp_counters *out)
{
	*out = n->counters;
}
