/*
 * More than one master: others follow this one's state, as peers after the
 * nodes, and each session ranks above those before it. Who follows gets the
 * frame's delta and has no part in anything else of the frame.
 */
#include "protocol/master_private.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

void fdp_master_name(unsigned index, char name[FDP_NAME_BYTES])
{
	if (index)
		snprintf(name, FDP_NAME_BYTES, "standby %u", index % FDP_MAX_MASTERS);
	else
		snprintf(name, FDP_NAME_BYTES, "master");
}

uint64_t fdp_session_after(uint64_t highest)
{
	const uint64_t epoch = (highest >> FDP_EPOCH_SHIFT) + 1;

	/* Epochs do not end: one a second would take more than a hundred years. */
	return epoch << FDP_EPOCH_SHIFT | randombytes_random();
}

uint64_t fdp_master_session(const struct fdp_master *m)
{
	return m->params.session;
}

/* Whom the delta of the frame was written for too; who waits for its snapshot has nothing to put it
 * on. */
void fdp_master_tell_followers(struct fdp_master *m)
{
	for (size_t i = m->params.node_count; i < fdp_master_peers(m); i++)
		if (m->peers[i].state == FDP_PEER_FOLLOWS)
			fdp_master_send_delta(m, (int)i);
}

static bool somebody_listens(const struct fdp_master *m)
{
	return m->params.masters > 1 && m->params.heartbeat_ns &&
	       fdp_master_mask(m, fdp_peer_present);
}

int64_t fdp_master_heartbeat_at(const struct fdp_master *m)
{
	return somebody_listens(m) ? m->spoke_ns + m->params.heartbeat_ns : INT64_MAX;
}

static void beacon_to(struct fdp_master *m, int to)
{
	fdp_outbox_send(&m->out, to, FDP_BEACON,
			fdp_beacon_encode(fdp_outbox_body(&m->out), FDP_BODY_MAX));
}

/* To masters that do not follow: whoever rules must know of who else does. */
static void beacon_to_masters(struct fdp_master *m)
{
	for (unsigned i = 0; i < m->params.masters && m->params.masters > 1; i++) {
		const size_t peer = m->params.node_count + i;

		if (i != m->params.index && !fdp_peer_present(m->peers[peer].state))
			beacon_to(m, (int)peer);
	}
}

void fdp_master_heartbeat(struct fdp_master *m, int64_t now_ns)
{
	const uint64_t nodes = fdp_master_mask(m, fdp_peer_counts);
	uint64_t present;

	if (now_ns < fdp_master_heartbeat_at(m))
		return;
	m->spoke_ns = now_ns;
	present = fdp_master_mask(m, fdp_peer_present);
	if (nodes)
		fdp_master_announce_to(m, nodes, FDP_PROBE);
	/* Who joins hears it by itself, as does who follows. */
	for (size_t i = 0; i < fdp_master_peers(m); i++)
		if (present & ~nodes & UINT64_C(1) << i)
			fdp_master_announce(m, (int)i, FDP_PROBE);
	beacon_to_masters(m);
}

void fdp_master_beacon(struct fdp_master *m, int64_t now_ns)
{
	m->now_ns = now_ns;
	fdp_master_send_beacon(m);
	beacon_to_masters(m);
}

void fdp_master_call(struct fdp_master *m)
{
	m->calls = true;
}

uint64_t fdp_master_floor(const struct fdp_master *m)
{
	return m->floor;
}

void fdp_master_listen(struct fdp_master *m, int64_t until_ns)
{
	m->listens_ns = until_ns;
}

bool fdp_master_calls(const struct fdp_master *m)
{
	return m->calls;
}

/* As it was created, but for counters. */
static void forget_room(struct fdp_master *m)
{
	memset(m->peers, 0, sizeof m->peers);
	for (size_t i = 0; i < fdp_master_peers(m); i++)
		fdp_master_clock_forget(&m->peers[i]);
	sodium_memzero(m->node_keys, sizeof m->node_keys);
	m->gate.keyed = 0;
	m->frame = m->previous_frame = m->swapped = m->floor = 0;
	m->hash = m->previous_hash = 0;
	memset(m->hash_frames, 0xff, sizeof m->hash_frames);
	m->underway = m->calls = false;
	m->listens_ns = 0;
	m->swap_ns = 0;
	m->barrier = (struct fdp_barrier){ 0 };
	m->half = (struct fdp_half){ 0 };
	m->judges = m->waits_longer = false;
	m->delta.number = m->snapshot.number = 0;
	m->loss = m->probes = 0;
	m->all_told_ns = 0;
	m->group = m->params.multicast && !m->params.probe_group;
	m->told_way = FDP_WAY_NONE;
	m->shared = m->share_changed = 0;
	m->sent_to_all = 0;
	m->fresh = false;
	fdp_master_bulk_forget(m);
	fdp_share_reset(&m->share);
}

void fdp_master_renew(struct fdp_master *m, uint64_t session, const struct param_state *state,
		      uint64_t frame)
{
	forget_room(m);
	m->params.session = m->gate.session = m->out.session = session;
	m->out.sequence = m->out.message = 0;
	randombytes_buf(m->nonce, sizeof m->nonce);
	fdp_key_to_nodes(m->params.key, session, m->nonce, m->key_to_nodes);
	m->keepalive_at = 0;
	for (int id = 0; id < PARAM_COUNT; id++)
		param_reset(m->state, (enum param_id)id);
	fdp_master_remember_hash(m);
	if (frame) {
		param_state_copy(m->state, state);
		m->previous_hash = m->hash;
		m->frame = m->swapped = frame;
		fdp_master_remember_hash(m);
	}
	fdp_master_begin_repairs(m);
}
