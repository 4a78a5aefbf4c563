#include "protocol/master_private.h"

#include "base/result.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(FDP_STATE_HEAD_MAX + PARAM_DELTA_MAX <= FDP_MESSAGE_MAX,
	       "the whole state must fit into one message");
_Static_assert(FDP_STATE_HEAD_MAX + PARAM_DELTA_MAX <=
		       FDP_FRAGMENTS_MAX * (FDP_DATAGRAM_MIN - FDP_HEADER_BYTES),
	       "the whole state must fit into the fragments of the smallest datagrams");
_Static_assert(FDP_HEADER_BYTES + FDP_BODY_MAX <= FDP_DATAGRAM_MIN,
	       "every short message must fit into one datagram");

#define BIT(node) (UINT64_C(1) << (node))
#define MASTER_KINDS (1u << FDP_JOIN | 1u << FDP_ACK | 1u << FDP_NACK | 1u << FDP_READY | \
		      1u << FDP_SWAPPED | 1u << FDP_LEAVE | 1u << FDP_VITALS | 1u << FDP_INPUT | 1u << FDP_GLANCE)
#define SHARE_KINDS (1u << FDP_SLICE | 1u << FDP_LACK)

static void to_caller(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct fdp_master *m = ctx;

	fdp_master_count_sent(m, to, bytes, len);
	m->ops.send(m->ops.ctx, to, bytes, len);
}

void fdp_master_say(struct fdp_master *m, const struct fdp_master_event *event)
{
	m->ops.event(m->ops.ctx, event);
}

uint64_t fdp_master_mask(const struct fdp_master *m, bool (*test)(enum fdp_peer_state))
{
	uint64_t mask = 0;

	for (size_t i = 0; i < fdp_master_peers(m); i++)
		mask |= test(m->peers[i].state) ? BIT(i) : 0;
	return mask;
}

static size_t count_bits(uint64_t mask)
{
	return (size_t)__builtin_popcountll(mask);
}

static int check_params(const struct fdp_master_params *p, const struct fdp_master_ops *ops)
{
	if (p->contents.layout_count + p->contents.scene_count > FDP_ITEMS_MAX)
		return GR_ERR_RANGE;
	if (!p->session || !p->node_count || p->node_count > FDP_MAX_NODES || !p->node_names ||
	    p->datagram_max < FDP_DATAGRAM_MIN || p->datagram_max > FDP_DATAGRAM_MAX ||
	    (p->probe_group && !p->multicast) || p->deadline_ns <= 0 || p->probe_ns < 0 ||
	    p->swap_lead_most_ns < 0 || !p->evict_frames || p->pace.policy > FDP_SLOW_HALF ||
	    p->pace.limit_ns < 0 || p->pace.wait_most_ns < 0 || p->pace.rejoin_most_ns < 0 ||
	    p->masters > FDP_MAX_MASTERS || p->index >= (p->masters ? p->masters : 1) ||
	    (p->masters > 1 && p->node_count + p->masters > FDP_MAX_NODES) || p->heartbeat_ns < 0 ||
	    !ops->send || !ops->event)
		return GR_ERR_RANGE;
	for (size_t i = 0; i < p->node_count; i++)
		if (!p->node_names[i] || !p->node_names[i][0] ||
		    strlen(p->node_names[i]) >= FDP_NAME_BYTES)
			return GR_ERR_RANGE;
	return GR_OK;
}

/* Frame 0 is the defaults: what a node can hold before the first frame begins. */
void fdp_master_remember_hash(struct fdp_master *m)
{
	m->hash = param_state_hash(m->state, m->previous_hash);
	m->hashes[m->frame % FDP_HASH_RING] = m->hash;
	m->hash_frames[m->frame % FDP_HASH_RING] = m->frame;
}

static int64_t default_probe(int64_t deadline_ns)
{
	const int64_t ns = deadline_ns / 8;

	return ns < 1 ? 1 : ns < FDP_PROBE_MOST_NS ? ns : FDP_PROBE_MOST_NS;
}

int fdp_master_create(struct fdp_master **out, const struct fdp_master_params *params,
		      const struct fdp_master_ops *ops)
{
	struct fdp_master *m;
	int result = check_params(params, ops);

	*out = NULL;
	if (result)
		return result;
	m = calloc(1, sizeof *m);
	if (!m)
		return GR_ERR_NOMEM;
	m->params = *params;
	m->params.node_names = NULL; /* copied, so that the caller's may go */
	for (size_t i = 0; i < params->node_count; i++)
		strcpy(m->names[i], params->node_names[i]);
	for (size_t i = params->node_count; i < fdp_master_peers(m); i++)
		fdp_master_name((unsigned)(i - params->node_count), m->names[i]);
	if (!m->params.probe_ns)
		m->params.probe_ns = default_probe(params->deadline_ns);
	m->usual_deadline_ns = params->deadline_ns;
	m->pace = fdp_pace_complete(&params->pace, params->deadline_ns);
	m->ops = *ops;
	m->answers = -1;
	m->bulk_node = (struct fdp_rate){ FDP_BULK_NODE_BYTES_S, FDP_BULK_NODE_BURST };
	m->bulk_tick_bytes = FDP_BULK_TICK_BYTES;
	m->bulk_all = (struct fdp_rate){ FDP_BULK_ALL_BYTES_S, FDP_BULK_ALL_BURST };
	m->group = params->multicast && !params->probe_group;
	randombytes_buf(m->nonce, sizeof m->nonce);
	fdp_key_to_nodes(m->params.key, params->session, m->nonce, m->key_to_nodes);
	m->gate = (struct fdp_gate){
		.cluster_key = m->params.key,
		.keys = (const uint8_t(*)[FDP_KEY_BYTES])m->node_keys,
		.session = params->session,
		.kinds = MASTER_KINDS | (params->share_bytes ? SHARE_KINDS : 0),
		.any_version_kinds = 1u << FDP_JOIN,
		.first_sender = 0,
		.last_sender = (uint16_t)(fdp_master_peers(m) - 1),
	};
	m->out = (struct fdp_outbox){
		.cluster_key = m->params.key,
		.key = m->key_to_nodes,
		.sender = fdp_master_sender(params->index),
		.session = params->session,
		.datagram_max = params->datagram_max,
		.fan_out = params->node_count,
		.counters = &m->counters,
		.send = to_caller,
		.ctx = m,
	};
	memset(m->hash_frames, 0xff, sizeof m->hash_frames);
	result = fdp_outbox_init(&m->out);
	if (!result)
		result = param_state_create(&m->state);
	if (!result)
		result = fdp_share_init(&m->share, params->share_bytes);
	if (!result)
		result = fdp_master_bulk_init(m);
	if (result) {
		fdp_master_destroy(&m);
		return result;
	}
	for (size_t i = 0; i < fdp_master_peers(m); i++)
		fdp_master_clock_forget(&m->peers[i]);
	fdp_master_remember_hash(m);
	fdp_master_begin_repairs(m);
	*out = m;
	return GR_OK;
}

void fdp_master_destroy(struct fdp_master **master)
{
	struct fdp_master *m = *master;

	*master = NULL;
	if (!m)
		return;
	fdp_outbox_finish(&m->out);
	fdp_share_finish(&m->share);
	fdp_master_bulk_finish(m);
	param_state_destroy(&m->state);
	sodium_memzero(m->params.key, sizeof m->params.key);
	sodium_memzero(m->key_to_nodes, sizeof m->key_to_nodes);
	sodium_memzero(m->node_keys, sizeof m->node_keys);
	free(m);
}

static uint32_t clamp_us(int64_t ns)
{
	return ns / 1000 > UINT32_MAX ? UINT32_MAX : (uint32_t)(ns / 1000);
}

void fdp_master_announce(struct fdp_master *m, int to, enum fdp_kind kind)
{
	/* Who is told to swap needs no delta any more: the next one heals it. */
	const bool delta = kind == FDP_PROBE && m->delta.number && m->delta.frame == m->frame;
	struct fdp_announce a = {
		.frame = m->frame,
		.swapped = m->swapped,
		.message = delta ? m->delta.number : 0,
		.count = delta ? m->delta.count : 0,
		.live = fdp_master_draws(m),
		.present = fdp_master_mask(m, fdp_peer_present),
		.flags = fdp_master_twice(m) ? FDP_TWICE : 0,
	};

	if (fdp_master_twice(m))
		a.wait_us = clamp_us(fdp_master_wait(m, a.live));
	fdp_master_say_slices(m, kind, &a);
	fdp_master_say_time(m, to, &a);
	fdp_outbox_send(&m->out, to, kind,
			fdp_announce_encode(&a, fdp_outbox_body(&m->out), FDP_BODY_MAX));
	fdp_master_mark_time(m, to, a.sent_ns);
}

static void announce_to_each(struct fdp_master *m, uint64_t nodes, enum fdp_kind kind)
{
	/*
	 * Who seems to take nothing out of its socket is still asked once in a frame: what was
	 * lost on the way looks the same, and only an answer tells.
	 */
	if (kind != FDP_PROBE || m->probes > 1)
		nodes = fdp_master_with_room(m, nodes, 0);
	/*
	 * In turns, so that each is the first now and then: its way is then no
	 * longer than the way back, and that exchange is the one that its clock
	 * is measured by.
	 */
	for (size_t i = 0; i < m->params.node_count; i++) {
		const size_t node = (m->frame + i) % m->params.node_count;

		if (nodes & BIT(node))
			fdp_master_announce(m, (int)node, kind);
	}
}

void fdp_master_announce_to(struct fdp_master *m, uint64_t nodes, enum fdp_kind kind)
{
	if (m->group && nodes & (nodes - 1))
		fdp_master_announce(m, FDP_TO_GROUP, kind);
	else
		announce_to_each(m, nodes, kind);
}

void fdp_master_write_state(struct fdp_master *m, struct fdp_letter *letter, enum fdp_kind kind,
			    uint64_t base)
{
	const bool chained = base && base == m->previous_frame;
	const struct fdp_state_head head = {
		.frame = m->frame,
		.previous_frame = m->previous_frame,
		.hash = m->hash,
		.previous_hash = chained ? 0 : m->previous_hash,
		.live = fdp_master_draws(m),
		.half = m->half.shows ? 0 : m->half.nodes,
		.present = fdp_master_mask(m, fdp_peer_present),
		.flags = (fdp_master_twice(m) ? FDP_TWICE : 0u) | (chained ? FDP_CHAINED : 0u),
		.shared = m->share.since ? m->shared : 0,
		.shared_since = m->share.since,
	};
	const size_t at = fdp_state_head_encode(&head, letter->bytes, FDP_STATE_HEAD_MAX);
	/* Cannot fail: the static assertions above. */
	const long len = param_delta_encode(m->state, base, letter->bytes + at, PARAM_DELTA_MAX);

	fdp_outbox_letter(&m->out, letter, kind, m->frame, at + (size_t)len);
}

/* Base: the oldest frame that every live node, and every master that follows, has acknowledged. */
static uint64_t common_base(const struct fdp_master *m, uint64_t live)
{
	uint64_t base = UINT64_MAX;

	for (size_t i = 0; i < fdp_master_peers(m); i++) {
		const struct fdp_peer *peer = &m->peers[i];
		const bool follows = peer->state == FDP_PEER_FOLLOWS && !peer->wants_snapshot;

		if ((live & BIT(i) || follows) && peer->status.acked < base)
			base = peer->status.acked;
	}
	return base == UINT64_MAX ? 0 : base;
}

/*
 * On a lossy wire the last fragment goes twice: it has no successor whose
 * arrival would show that it is missing. With parity any may be missing.
 */
void fdp_master_send_delta(struct fdp_master *m, int to)
{
	fdp_outbox_post(&m->out, to, &m->delta);
	if (fdp_master_twice(m) && !m->delta.parity)
		fdp_outbox_again(&m->out, to, &m->delta, m->delta.count - 1u);
}

/* Who takes nothing out of its socket is asked where it is, and gets it when it answers. */
static void send_delta_to(struct fdp_master *m, uint64_t live)
{
	if (!m->group)
		live = fdp_master_with_room(m, live, m->delta.len);
	if (m->group || count_bits(live) == m->params.node_count) {
		/* To each of them the same datagram, signed once. */
		fdp_master_send_delta(m, fdp_master_all(m));
		return;
	}
	for (size_t i = 0; i < m->params.node_count; i++)
		if (live & BIT(i))
			fdp_master_send_delta(m, (int)i);
}

/* A frame boundary: who has acknowledged its snapshot counts from here on. */
static void promote_joiners(struct fdp_master *m)
{
	for (size_t i = 0; i < m->params.node_count; i++) {
		struct fdp_peer *peer = &m->peers[i];

		if (peer->state != FDP_PEER_JOINING || !peer->synced)
			continue;
		peer->state = fdp_peer_next(peer->state, FDP_PEER_COMMITS);
		peer->synced = false;
		peer->missed_row = 0;
	}
}

static void refresh_snapshots(struct fdp_master *m, int64_t now_ns)
{
	for (unsigned i = 0; i < fdp_master_peers(m); i++) {
		struct fdp_peer *peer = &m->peers[i];
		const bool joiner = peer->state == FDP_PEER_JOINING && !peer->synced;

		if ((joiner || (fdp_peer_present(peer->state) && peer->wants_snapshot)) &&
		    now_ns - peer->snapshot_ns >= m->params.probe_ns)
			fdp_master_send_snapshot(m, i, now_ns);
	}
}

int fdp_master_begin(struct fdp_master *m, const struct param_state *state, uint64_t frame,
		     int64_t now_ns)
{
	uint64_t live;

	if (m->underway)
		return GR_ERR_STATE;
	if (frame <= m->frame || param_newest(state) > frame)
		return GR_ERR_RANGE;
	m->now_ns = now_ns;
	m->due_ns = now_ns + (now_ns - m->barrier.begun_ns);
	param_state_copy(m->state, state);
	m->previous_frame = m->frame;
	m->previous_hash = m->hash;
	m->frame = frame;
	fdp_master_remember_hash(m);
	m->loss -= m->loss > 0;
	m->asked_ns = now_ns;
	fdp_master_measure_loss(m);
	promote_joiners(m);
	live = fdp_master_mask(m, fdp_peer_counts);
	m->underway = true;
	fdp_master_start_barrier(m, live, now_ns);
	m->probes = 0;
	fdp_master_choose_way(m, live, now_ns);
	fdp_master_begin_repairs(m);
	fdp_master_share_begin(m, live);
	if (live) {
		fdp_master_write_state(m, &m->delta, FDP_DELTA, common_base(m, live));
		fdp_outbox_protect(&m->out, &m->delta, fdp_master_parity(m, m->delta.count));
		send_delta_to(m, live);
		fdp_master_tell_followers(m);
		fdp_master_mark_frame(m, fdp_master_mask(m, fdp_peer_present));
		m->spoke_ns = now_ns;
	}
	refresh_snapshots(m, now_ns);
	fdp_master_finish_if_over(m, now_ns);
	return GR_OK;
}

int fdp_master_chain(struct fdp_master *m, uint64_t previous_frame, uint64_t previous_hash)
{
	if (m->underway)
		return GR_ERR_STATE;
	if (previous_frame < m->frame)
		return GR_ERR_RANGE;
	m->frame = previous_frame;
	m->hash = previous_hash;
	return GR_OK;
}

void fdp_master_finish_if_over(struct fdp_master *m, int64_t now_ns)
{
	struct fdp_master_event swap = {
		.kind = FDP_MASTER_SWAP, .node = FDP_TO_ALL, .frame = m->frame
	};
	uint64_t live;

	if (!m->underway || !fdp_master_frame_over(m, now_ns))
		return;
	fdp_master_judge(m, now_ns);
	m->underway = false;
	m->swapped = m->frame;
	m->swapped_ns = now_ns;
	live = fdp_master_mask(m, fdp_peer_counts);
	m->swap_ns = swap.swap_ns = fdp_master_swap_time(m, live, now_ns);
	if (live) {
		const uint64_t told = m->group ? live : fdp_master_with_room(m, live, 0);

		fdp_master_announce_to(m, live, FDP_SWAP);
		if (count_bits(told) == m->params.node_count)
			m->all_told_ns = now_ns;
		if (fdp_master_twice(m))
			fdp_master_announce_to(m, live, FDP_SWAP);
	}
	fdp_master_say(m, &swap);
}

/* Who joins or follows is served and, when it falls silent, forgotten. */
static void tend_joiners(struct fdp_master *m, int64_t now_ns)
{
	for (size_t i = 0; i < fdp_master_peers(m); i++) {
		struct fdp_peer *peer = &m->peers[i];
		const struct fdp_master_event left = {
			.kind = FDP_MASTER_LEFT, .node = (int)i, .frame = m->frame,
			.reason = fdp_master_is_follower(m, (unsigned)i) ? "silent" : "silent while joining",
		};

		if ((peer->state != FDP_PEER_JOINING && peer->state != FDP_PEER_FOLLOWS) ||
		    now_ns - peer->status.last_heard_ns < FDP_JOIN_SILENCE_NS)
			continue;
		peer->state = fdp_peer_next(peer->state, FDP_PEER_EXPIRES);
		fdp_master_say(m, &left);
	}
	refresh_snapshots(m, now_ns);
}

/* When who has not acknowledged is asked; INT64_MAX: all have. */
static int64_t ask_at(const struct fdp_master *m)
{
	const uint64_t unacked = fdp_barrier_unacked(&m->barrier);
	const unsigned doublings = m->probes < 4 ? 0 : m->probes < 8 ? m->probes - 4 : 4;
	int64_t wait_ns, steady_ns;

	if (!unacked)
		return INT64_MAX;
	wait_ns = fdp_master_wait(m, unacked) << doublings;
	steady_ns = fdp_backoff(m->params.probe_ns, m->probes);
	return m->asked_ns + (wait_ns < steady_ns ? wait_ns : steady_ns);
}

void fdp_master_tick(struct fdp_master *m, int64_t now_ns)
{
	m->now_ns = now_ns;
	tend_joiners(m, now_ns);
	fdp_master_bulk_tick(m, now_ns);
	if (now_ns >= m->keepalive_at) {
		m->keepalive_at = now_ns + FDP_KEEPALIVE_NS;
		/* Each SWAP says as much; and who calls has told nobody anything. */
		if (!m->calls && (!m->all_told_ns || now_ns - m->all_told_ns > FDP_KEEPALIVE_NS / 2))
			fdp_master_announce(m, fdp_master_all(m), FDP_PROBE);
		fdp_master_probe_group(m);
		fdp_master_beacon(m, now_ns);
	}
	fdp_master_heartbeat(m, now_ns);
	if (!m->underway)
		return;
	if (now_ns >= ask_at(m) && now_ns < m->barrier.deadline_ns) {
		const uint64_t unacked = fdp_barrier_unacked(&m->barrier);

		m->asked_ns = now_ns;
		m->probes++;
		fdp_master_send_end_again(m, unacked);
		if (m->probes == 1)
			fdp_master_announce_to(m, unacked, FDP_PROBE);
		else /* perhaps they do not hear the group */
			announce_to_each(m, unacked, FDP_PROBE);
	}
	fdp_master_finish_if_over(m, now_ns);
}

int64_t fdp_master_next(const struct fdp_master *m)
{
	int64_t next = fdp_master_bulk_next(m) < m->keepalive_at ? fdp_master_bulk_next(m) : m->keepalive_at;

	if (fdp_master_heartbeat_at(m) < next)
		next = fdp_master_heartbeat_at(m);
	for (size_t i = 0; i < fdp_master_peers(m); i++) {
		const struct fdp_peer *peer = &m->peers[i];
		int64_t at = INT64_MAX;

		if ((peer->state == FDP_PEER_JOINING && !peer->synced) ||
		    (fdp_peer_present(peer->state) && peer->wants_snapshot))
			at = peer->snapshot_ns + m->params.probe_ns;
		else if (peer->state == FDP_PEER_JOINING || peer->state == FDP_PEER_FOLLOWS)
			at = peer->status.last_heard_ns + FDP_JOIN_SILENCE_NS;
		next = at < next ? at : next;
	}
	if (m->underway) {
		if (ask_at(m) < next)
			next = ask_at(m);
		if (m->barrier.deadline_ns < next)
			next = m->barrier.deadline_ns;
	}
	return next;
}

void fdp_master_leave(struct fdp_master *m, int64_t now_ns)
{
	(void)now_ns;
	/* Nobody answers to it: twice, so that one loss does not cost the nodes their time-out. */
	for (int i = 0; i < 2; i++) {
		fdp_outbox_send(&m->out, fdp_master_all(m), FDP_LEAVE,
				fdp_leave_encode(m->frame, fdp_outbox_body(&m->out), FDP_BODY_MAX));
		for (size_t k = m->params.node_count; k < fdp_master_peers(m); k++)
			if (fdp_peer_present(m->peers[k].state))
				fdp_outbox_send(&m->out, (int)k, FDP_LEAVE,
						fdp_leave_encode(m->frame, fdp_outbox_body(&m->out),
								 FDP_BODY_MAX));
	}
}

void fdp_master_set_deadline(struct fdp_master *m, int64_t deadline_ns)
{
	if (deadline_ns > 0)
		m->params.deadline_ns = deadline_ns;
}

bool fdp_master_idle(const struct fdp_master *m)
{
	return !m->underway;
}

size_t fdp_master_live(const struct fdp_master *m)
{
	return count_bits(fdp_master_mask(m, fdp_peer_counts));
}

size_t fdp_master_present(const struct fdp_master *m)
{
	const uint64_t present = fdp_master_mask(m, fdp_peer_present);

	return count_bits(m->params.node_count < 64 ? present & (BIT(m->params.node_count) - 1) : present);
}

uint64_t fdp_master_hash(const struct fdp_master *m)
{
	return m->hash;
}

void fdp_master_peer(const struct fdp_master *m, size_t node, struct fdp_peer_status *out)
{
	*out = (struct fdp_peer_status){ .state = FDP_PEER_ABSENT };
	if (node >= fdp_master_peers(m))
		return;
	*out = m->peers[node].status;
	out->state = m->peers[node].state;
	out->pace = m->peers[node].pace.state;
	out->pace_since_ns = m->peers[node].pace.since_ns;
	out->out_until_ns = m->peers[node].pace.out_until_ns;
	out->under_way = fdp_window_under_way(&m->peers[node].window_out, m->sent_to_all);
	out->answer_ns = m->peers[node].trip.mean_ns;
}

void fdp_master_clock(const struct fdp_master *m, size_t node, int64_t now_ns,
		      struct fdp_clock_estimate *out)
{
	*out = (struct fdp_clock_estimate){ .known = false };
	if (node < m->params.node_count)
		fdp_clock_estimate(&m->peers[node].clock, now_ns, out);
}

void fdp_master_counters(const struct fdp_master *m, struct fdp_counters *out)
{
	*out = m->counters;
}
