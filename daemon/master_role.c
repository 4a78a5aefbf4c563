/* Which of the room's masters this is at present, and what it takes over from the one before. */
#include "daemon/master_private.h"

#include "base/clock.h"
#include "base/result.h"

#include <inttypes.h>
#include <math.h>
#include <sodium.h>
#include <string.h>

int64_t master_takeover_ns(const struct layout *layout)
{
	const double frames = layout->standby_count ? layout->rates.takeover_frames : 0;

	return llrint(frames * 1e9 / (double)layout->rates.frame_hz);
}

static const char *master_name(unsigned index, char name[FDP_NAME_BYTES])
{
	fdp_master_name(index, name);
	return name;
}

/* The ear's: to masters, which the socket has after the nodes. */
static void send_to_masters(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct master *m = ctx;
	const struct layout *layout = m->params.layout;

	for (size_t i = 0; i < net_masters(layout); i++)
		if (i != m->params.index && (to == FDP_TO_ALL || (size_t)to == i))
			faults_send(m->faults, m->net, (int)(layout->node_count + i),
				    layout->node_count, bytes, len);
}

static void refused(void *ctx, const char *reason)
{
	struct master *m = ctx;
	uint64_t times;

	if (gr_log_limit(&m->role_limit, gr_clock_now(&gr_clock_monotonic), &times))
		gr_error("the active master lets this one not follow: %s", reason);
}

int master_role_create(struct master *m)
{
	const struct layout *layout = m->params.layout;
	struct fdp_standby_params params = {
		.index = m->params.index,
		.masters = (unsigned)net_masters(layout),
		.node_count = layout->node_count,
		.contents = m->params.contents,
		.datagram_max = net_datagram_max(&layout->network),
		.silence_ns = master_takeover_ns(layout) / 2,
		.period_ns = m->period_ns,
		.follows = m->params.standby,
	};
	const struct fdp_standby_ops ops = { send_to_masters, refused, m };
	int r;

	memcpy(params.key, m->params.key, sizeof params.key);
	r = fdp_standby_create(&m->standby, &params, &ops, m->fdp,
			       gr_clock_now(&gr_clock_monotonic));
	sodium_memzero(params.key, sizeof params.key);
	return r;
}

void master_role_event(struct master *m, const struct fdp_master_event *event)
{
	const unsigned index = (unsigned)event->node - (unsigned)m->params.layout->node_count;
	char name[FDP_NAME_BYTES];
	uint64_t times;

	switch (event->kind) {
	case FDP_MASTER_OUTRANKED: fdp_standby_outranked(m->standby, event->theirs); break;
	case FDP_MASTER_FOLLOWED: gr_notice("%s follows", master_name(index, name)); break;
	case FDP_MASTER_LEFT:
		gr_notice("%s follows no more: %s", master_name(index, name),
			  event->reason ? event->reason : "no reason given");
		break;
	case FDP_MASTER_REFUSED:
		if (gr_log_limit(&m->refused_limit[event->node % FDP_MAX_NODES],
				 gr_clock_now(&gr_clock_monotonic), &times))
			gr_error("%s may not follow: %s", master_name(index, name),
				 event->reason ? event->reason : "no reason given");
		break;
	case FDP_MASTER_MISMATCH:
		gr_error("%s holds another state at frame %" PRIu64 "; it gets a snapshot",
			 master_name(index, name), event->frame);
		break;
	case FDP_MASTER_JOINED:
	case FDP_MASTER_LATE:
	case FDP_MASTER_EVICTED:
	case FDP_MASTER_PACE:
	case FDP_MASTER_SWAP:
	case FDP_MASTER_WAY: break;
	}
}

int master_role_receive(struct master *m, const uint8_t *bytes, size_t len, int64_t arrived_ns,
			int64_t now_ns)
{
	int r = fdp_standby_receive(m->standby, bytes, len, arrived_ns, now_ns);

	/* Words of a master that this one does not follow, or not yet, are nothing bad. */
	return r == GR_ERR_MISMATCH ? GR_OK : r;
}

/* Nobody whom this master knew is in any more. */
static void forget_nodes(struct master *m)
{
	for (size_t i = 0; i < m->params.layout->node_count; i++)
		if (m->members >> i & 1)
			master_node_gone(m, (int)i);
	m->session = fdp_master_session(m->fdp);
}

static void take_over(struct master *m, int64_t now_ns)
{
	uint64_t frame;
	int64_t frame_ns;
	const struct param_state *followed = fdp_standby_state(m->standby, &frame, &frame_ns);

	m->session = fdp_master_session(m->fdp);
	m->started = m->took_over = true;
	m->takeovers++;
	if (frame != 0) {
		param_state_copy(m->state, followed);
		m->frame = fdp_standby_first_frame(m->standby, now_ns) - 1;
		live_source_adopt(m->params.live, followed, m->frame, frame_ns, now_ns);
	}
	m->next_frame_ns = now_ns;
	gr_notice("takes over in epoch %" PRIu64 ": %s %" PRIu64
		  ", %.0f ms after it was last heard of",
		  m->session >> FDP_EPOCH_SHIFT,
		  frame ? "goes on from frame" : "knows no frame, begins after", m->frame,
		  frame ? (double)(now_ns - frame_ns) * 1e-6 : 0.0);
}

static void yield(struct master *m)
{
	char name[FDP_NAME_BYTES];
	const int by = fdp_standby_follows(m->standby);

	forget_nodes(m);
	m->started = false;
	m->yielded++;
	master_name(by < 0 ? 0 : (unsigned)by, name);
	if (m->params.standby) {
		gr_warning("the room has a master with a higher epoch (%s): this one stands by "
			   "from now on",
			   name);
		return;
	}
	gr_error("the room has a master with a higher epoch (%s): this one ends; with --standby it "
		 "would follow",
		 name);
	m->status = GR_EXIT_RUNTIME;
	loop_stop(m->loop);
}

void master_role_tick(struct master *m, int64_t now_ns)
{
	char name[FDP_NAME_BYTES];
	uint64_t frame;

	switch (fdp_standby_tick(m->standby, now_ns)) {
	case FDP_STANDBY_SAME: break;
	case FDP_STANDBY_FOLLOWS:
		forget_nodes(m);
		gr_notice("stands by, and follows %s",
			  master_name((unsigned)fdp_standby_follows(m->standby), name));
		break;
	case FDP_STANDBY_CALLS:
		m->session = fdp_master_session(m->fdp);
		fdp_standby_state(m->standby, &frame, NULL);
		gr_warning("hears no master: looks for nodes that have lost theirs, too (last "
			   "frame %" PRIu64 ")",
			   frame);
		break;
	case FDP_STANDBY_RETURNS: gr_notice("hears the active master again, and follows it"); break;
	case FDP_STANDBY_TAKES: take_over(m, now_ns); break;
	case FDP_STANDBY_YIELDS: yield(m); break;
	case FDP_STANDBY_RENEWED:
		forget_nodes(m);
		m->next_frame_ns = now_ns;
		gr_notice("goes on in epoch %" PRIu64 ", above one that nodes have been in",
			  m->session >> FDP_EPOCH_SHIFT);
		break;
	}
}

int64_t master_role_next(const struct master *m)
{
	const int64_t role_ns = fdp_standby_next(m->standby), frame_ns = fdp_master_next(m->fdp);

	if (fdp_standby_role(m->standby) == FDP_ROLE_FOLLOWS)
		return role_ns;
	return role_ns < frame_ns ? role_ns : frame_ns;
}

void master_role_status(const struct master *m, int64_t now_ns)
{
	uint64_t frame;
	int64_t frame_ns;
	char name[FDP_NAME_BYTES];

	fdp_standby_state(m->standby, &frame, &frame_ns);
	if (fdp_standby_role(m->standby) == FDP_ROLE_CALLS)
		notify_status("hears no master; no node has lost its own");
	else if (fdp_standby_follows(m->standby) < 0)
		notify_status("stands by; no master is found");
	else
		notify_status("stands by: has frame %" PRIu64 " of %s, %.0f ms old", frame,
			      master_name((unsigned)fdp_standby_follows(m->standby), name),
			      frame ? (double)(now_ns - frame_ns) * 1e-6 : 0.0);
}

static void write_other(struct json *json, const struct master *m, unsigned i, int64_t now_ns)
{
	const size_t peer_at = m->params.layout->node_count + i;
	char name[FDP_NAME_BYTES], text[NET_ADDRESS_TEXT];
	struct net_address address;
	struct fdp_peer_status peer;
	bool rules = i == m->params.index && master_rules(m);

	fdp_master_peer(m->fdp, peer_at, &peer);
	json_open(json, NULL, '{');
	json_string(json, "name", master_name(i, name));
	if (net_master_address(m->params.layout, i, &address) == GR_OK) {
		net_address_text(&address, text);
		json_string(json, "address", text);
	}
	if (i == m->params.index)
		json_string(json, "state", fdp_role_name(fdp_standby_role(m->standby)));
	else if ((int)i == fdp_standby_follows(m->standby))
		json_string(json, "state", "active");
	else
		json_string(json, "state", fdp_peer_state_name(peer.state));
	if (!rules && peer.state == FDP_PEER_FOLLOWS) {
		json_u64(json, "acked", peer.acked);
		json_f64(json, "heard_ms_ago", (double)(now_ns - peer.last_heard_ns) * 1e-6);
	}
	json_close(json, '}');
}

void master_role_write_json(const struct master *m, struct json *json, int64_t now_ns)
{
	uint64_t frame;
	int64_t frame_ns;

	json_string(json, "role", fdp_role_name(fdp_standby_role(m->standby)));
	json_u64(json, "epoch", m->session >> FDP_EPOCH_SHIFT);
	if (!m->params.layout->standby_count)
		return;
	json_u64(json, "takeovers", m->takeovers);
	json_u64(json, "yielded", m->yielded);
	if (!master_rules(m)) {
		fdp_standby_state(m->standby, &frame, &frame_ns);
		json_u64(json, "followed_frame", frame);
		if (frame != 0)
			json_f64(json, "followed_ms_ago", (double)(now_ns - frame_ns) * 1e-6);
	}
	json_open(json, "masters", '[');
	for (unsigned i = 0; i < net_masters(m->params.layout); i++)
		write_other(json, m, i, now_ns);
	json_close(json, ']');
}
