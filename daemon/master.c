#include "daemon/master_private.h"

#include "base/clock.h"
#include "base/result.h"
#include "daemon/master_pace.h"
#include "daemon/master_params.h"
#include "protocol/message.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RECEIVE_MOST 256 /* then timers and other descriptors have their turn */
/* A light that starts anew costs many frames' work in one; the barrier waits longer for it. */
#define RESTART_PATIENCE 8
#define RESTART_PATIENCE_NS (30 * GR_NS_PER_S) /* but no longer, unless the deadline is */
#define LIGHT_RESTART_NS GR_NS_PER_S /* a slow node may not make the others start over more often */

_Static_assert(NET_TO_ALL == FDP_TO_ALL && NET_TO_GROUP == FDP_TO_GROUP,
	       "what the protocol says goes to the socket as it is");

static void send_datagram(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct master *m = ctx;

	/* An answer goes back where the question came from, which teaches nothing yet. */
	if (m->from && to >= 0 && to == fdp_master_answers(m->fdp))
		faults_send_to(m->faults, m->net, m->from, bytes, len);
	else
		faults_send(m->faults, m->net, to, m->params.layout->node_count, bytes, len);
}

static void on_report(void *ctx, unsigned node, unsigned kind, const struct fdp_report *report)
{
	struct master *m = ctx;

	recorder_report(m->recorder, m->heard_ns, node, kind, report);
	/* SWAPPED names no state. */
	if (m->source->ops->held && kind != FDP_SWAPPED)
		m->source->ops->held(m->source, node, report->frame, report->hash);
}

static void on_input(void *ctx, unsigned node, const struct fdp_input *input)
{
	struct master *m = ctx;

	if (m->params.live)
		live_source_window_input(m->params.live, node, input, m->heard_ns);
}

static void on_glance(void *ctx, unsigned node, const struct fdp_glance *glance)
{
	struct master *m = ctx;

	if (m->params.live)
		live_source_glance(m->params.live, node, glance);
}

static void on_sample(void *ctx, size_t tracker, const struct track_sample *sample, bool taken)
{
	struct master *m = ctx;

	recorder_sample(m->recorder, m->params.live->polled_ns, tracker, sample, taken);
}

/*
 * A node that missed frames did fewer propagation steps than the others; once
 * it keeps up again, all start from the steady state of the same frame.
 */
static void look_for_caught_up(struct master *m, int64_t now_ns)
{
	uint64_t caught_up = 0;

	for (int i = 0; m->behind >> i && i < FDP_MAX_NODES; i++) {
		struct fdp_peer_status peer;
		if (!(m->behind >> i & 1))
			continue;
		fdp_master_peer(m->fdp, (size_t)i, &peer);
		if (peer.state == FDP_PEER_LIVE && peer.ready == m->frame && peer.pace != FDP_PACE_HALF)
			caught_up |= UINT64_C(1) << i;
	}
	if (caught_up && now_ns - m->light_restart_ns > LIGHT_RESTART_NS) {
		m->behind &= ~caught_up;
		m->restart_light = true;
	}
}

static int64_t frame_deadline(const struct master *m, bool restarts_light)
{
	int64_t usual = m->params.layout->rates.barrier_deadline_ns, longer = RESTART_PATIENCE * usual;

	if (!restarts_light || usual >= RESTART_PATIENCE_NS)
		return usual;
	return longer < RESTART_PATIENCE_NS ? longer : RESTART_PATIENCE_NS;
}

static void record_frame(struct master *m, const struct frame_next *next, uint64_t previous_hash,
			 uint64_t live, int64_t now_ns)
{
	const struct record_frame frame = {
		.frame = next->frame,
		.previous_frame = next->jumps ? next->previous_frame : m->frame,
		.hash = fdp_master_hash(m->fdp), .previous_hash = previous_hash,
		.live = live,
	};

	recorder_frame(m->recorder, now_ns, m->state, &frame);
}

/* Where masters take over from each other no wall's frames go back, whoever said the last. */
static uint64_t last_frame(const struct master *m)
{
	const uint64_t floor = m->params.layout->standby_count ? fdp_master_floor(m->fdp) : 0;

	return floor > m->frame ? floor : m->frame;
}

/* Asks what comes next. False when nothing does: the room ends, in order or not. */
static bool next_frame(struct master *m, int64_t now_ns, struct frame_next *next)
{
	const struct frame_moment moment = {
		.now_ns = now_ns,
		.to_swap_ns = m->params.frame_clock || m->stats.smoothed_swap_ns == 0 ?
				      m->period_ns : m->stats.smoothed_swap_ns,
		.last = last_frame(m),
		.restart_light = m->restart_light,
	};
	uint64_t times;
	int r = m->source->ops->next(m->source, &moment, m->state, next);

	if (r == GR_OK && next->refused && gr_log_limit(&m->range_limit, now_ns, &times))
		gr_warning("frame %" PRIu64 ": %s is outside its range and keeps its value (%" PRIu64
			   " since the last line)", next->frame, next->refused, times);
	if (r == GR_OK && next->jumps)
		r = fdp_master_chain(m->fdp, next->previous_frame, next->previous_hash);
	if (r == GR_OK)
		return true;
	if (r < 0)
		gr_error("after frame %" PRIu64 " none can be shown: %s", m->frame, gr_result_name(r));
	loop_stop(m->loop);
	return false;
}

/* What is shown for the first time after a takeover is shown as it was: the light starts anew after it. */
static bool hold_light(struct master *m)
{
	const bool hold = m->took_over && m->restart_light;

	m->took_over = false;
	if (hold)
		m->restart_light = false;
	return hold;
}

static void begin_frame(struct master *m, int64_t now_ns)
{
	struct frame_next next;
	uint64_t previous_hash, live;
	bool held;
	int r;

	look_for_caught_up(m, now_ns);
	held = hold_light(m);
	if (!next_frame(m, now_ns, &next))
		return;
	if (next.restarts_light)
		m->light_restart_ns = now_ns;
	fdp_master_set_deadline(m->fdp, frame_deadline(m, next.restarts_light));
	m->restart_light = held;
	previous_hash = fdp_master_hash(m->fdp);
	r = fdp_master_begin(m->fdp, m->state, next.frame, now_ns);
	live = fdp_master_every_frame(m->fdp);
	frame_stats_begin(&m->stats, next.frame, live, now_ns);
	net_flush(m->net);
	record_frame(m, &next, previous_hash, live, now_ns);
	m->frame = next.frame;
	if (m->source->ops->begun)
		m->source->ops->begun(m->source, live, fdp_master_hash(m->fdp), now_ns);
	if (r < 0) {
		gr_error("frame %" PRIu64 " cannot begin: %s", m->frame, gr_result_name(r));
		loop_stop(m->loop);
	}
	/* On the grid of the period; frames whose time is past are not made up for. */
	m->next_frame_ns += m->period_ns;
	if (m->next_frame_ns < now_ns)
		m->next_frame_ns = now_ns;
}

static bool may_begin(struct master *m)
{
	size_t live = master_members(m);

	if (!master_rules(m) || !fdp_master_idle(m->fdp) || m->finish_ns != 0 || live == 0)
		return false;
	if (!m->started && live < m->params.expect)
		return false;
	if (!m->started)
		gr_notice("%zu of %zu nodes are there: frames begin", live,
			  m->params.layout->node_count);
	m->started = true;
	return true;
}

/*
 * With the frame clock nothing but this keeps frames apart: the next begins
 * when the last has been shown everywhere, or a period later should a report
 * be lost. (With the real clock frames are a period apart, and the next is
 * drawn while a display waits for its refresh to show the last.)
 */
static int64_t frame_due(const struct master *m)
{
	const int64_t due_ns = m->source->ops->due ? m->source->ops->due(m->source) : FRAME_SOURCE_GRID;

	if (m->took_over)
		return fdp_standby_begin_at(m->standby);
	if (due_ns != FRAME_SOURCE_GRID)
		return due_ns;
	if (!m->params.frame_clock || m->frame == 0)
		return m->next_frame_ns;
	return frame_stats_settled(&m->stats, m->frame) ? 0 : m->swap_ns + m->period_ns;
}

static bool frames_are_over(const struct master *m)
{
	if (m->source->ops->over && m->source->ops->over(m->source))
		return true;
	return m->params.frames != 0 && m->stats.begun >= m->params.frames;
}

/* Begins to end once the last frame has swapped: waits a little for the reports of it. */
static void look_for_end(struct master *m, int64_t now_ns)
{
	if (!master_rules(m) || !frames_are_over(m) || !fdp_master_idle(m->fdp))
		return;
	if (m->finish_ns == 0)
		m->finish_ns = now_ns + m->params.layout->rates.barrier_deadline_ns + GR_NS_PER_S;
	if (frame_stats_settled(&m->stats, m->frame) || now_ns >= m->finish_ns)
		loop_stop(m->loop);
}

/* After everything that may have changed the protocol's state. */
static void advance(struct master *m)
{
	int64_t now_ns = gr_clock_now(&gr_clock_monotonic), frame_ns = LOOP_NEVER;

	master_role_tick(m, now_ns);
	net_flush(m->net);
	look_for_end(m, now_ns);
	if (may_begin(m)) {
		frame_ns = frame_due(m);
		if (now_ns >= frame_ns) {
			begin_frame(m, now_ns);
			frame_ns = LOOP_NEVER;
		}
	}
	if (m->finish_ns != 0)
		frame_ns = m->finish_ns;
	loop_timer_set(m->loop, m->frame_timer, frame_ns);
	loop_timer_set(m->loop, m->tick_timer, master_role_next(m));
}

static void note_dropped(struct master *m, int result, const uint8_t *bytes, size_t len,
			 const struct net_address *from, int64_t now_ns)
{
	struct dropped_datagram dropped = {
		.from = from, .peer = net_peer(m->net, from), .bytes = bytes, .len = len
	};
	char name[LAYOUT_NAME_MAX + 8];

	if (dropped.peer >= 0) {
		snprintf(name, sizeof name, "node %s", master_node_name(m, dropped.peer));
		dropped.name = name;
	}
	dropped_add(&m->bad, result, &dropped, now_ns);
}

static void on_datagram(void *ctx, const uint8_t *bytes, size_t len,
			const struct net_address *from, int64_t arrived_ns)
{
	struct master *m = ctx;
	int64_t now_ns = gr_clock_now(&gr_clock_monotonic);
	struct fdp_peer_status peer;
	bool fresh;
	int node, r;

	if (fdp_standby_is_its(m->standby, bytes, len)) {
		r = master_role_receive(m, bytes, len, arrived_ns, now_ns);
		if (r < 0)
			note_dropped(m, r, bytes, len, from, now_ns);
		return;
	}
	/* Nodes ask all masters. */
	if (fdp_standby_role(m->standby) == FDP_ROLE_FOLLOWS)
		return;
	m->from = len > FDP_KIND_AT && bytes[FDP_KIND_AT] == FDP_JOIN ? from : NULL;
	m->heard_ns = now_ns;
	fdp_master_arrived(m->fdp, arrived_ns);
	node = fdp_master_receive(m->fdp, bytes, len, now_ns, &fresh);
	m->from = NULL;
	if (node < 0) {
		note_dropped(m, node, bytes, len, from, now_ns);
		return;
	}
	/*
	 * Whoever sends again what he heard must not have what is for the node: if the node's own was
	 * lost, his copy is the first. So only a JOIN teaches, which the node repeats until it is in.
	 */
	if (fresh)
		net_learn(m->net, node, from);
	if (node >= (int)m->params.layout->node_count)
		return; /* a master that follows */
	fdp_master_peer(m->fdp, (size_t)node, &peer);
	recorder_shown(m->recorder, now_ns, (unsigned)node, &peer);
	frame_stats_applied(&m->stats, (unsigned)node, peer.acked, now_ns);
	if (peer.swapped_frame != 0)
		frame_stats_swapped(&m->stats, (unsigned)node, peer.swapped_frame,
				    peer.swap_ns, now_ns);
}

static void receive(struct master *m)
{
	int fds[2];

	net_fds(m->net, fds);
	faults_receive(m->faults, m->net, fds[0], RECEIVE_MOST, on_datagram, m);
}

static void on_readable(void *ctx, uint32_t events)
{
	struct master *m = ctx;

	(void)events;
	receive(m);
	advance(m);
}

static void on_tick(void *ctx, int64_t now_ns)
{
	struct master *m = ctx;

	(void)now_ns;
	/* Nobody is late whose word has arrived. */
	receive(m);
	if (fdp_standby_role(m->standby) != FDP_ROLE_FOLLOWS)
		fdp_master_tick(m->fdp, gr_clock_now(&gr_clock_monotonic));
	advance(m);
}

static void on_frame_time(void *ctx, int64_t now_ns)
{
	(void)now_ns;
	advance(ctx);
}

static void log_send_failures(struct master *m, int64_t now_ns)
{
	struct net_stats stats;
	uint64_t times;

	net_stats(m->net, &stats);
	if (stats.send_failed == m->seen_send_failed)
		return;
	m->seen_send_failed = stats.send_failed;
	if (gr_log_limit(&m->send_limit, now_ns, &times))
		gr_warning("%" PRIu64 " datagrams could not be sent; the last: %s", stats.send_failed,
			   strerror(stats.send_errno));
}

static void on_second(void *ctx, int64_t now_ns)
{
	struct master *m = ctx;
	size_t live = master_members(m), all = m->params.layout->node_count;

	/* Waiting for nodes, or for a person's step, is healthy; else a room must show frames. */
	if (!master_rules(m) || live == 0 || !m->started || frame_due(m) == LOOP_NEVER)
		notify_feed(&m->notify, now_ns);
	if (!master_rules(m))
		master_role_status(m, now_ns);
	else if (m->frame == m->logged_frame)
		notify_status("waiting for nodes: %zu of %zu live", live, all);
	else
		notify_status("frame %" PRIu64 ", %" PRIu64 " in the last second, %zu of %zu nodes",
			      m->frame, m->frame - m->logged_frame, live, all);
	m->logged_frame = m->frame;
	log_send_failures(m, now_ns);
	master_save(m);
	if (m->recorder)
		recorder_watch(m->recorder);
	loop_timer_set(m->loop, m->second_timer, now_ns + GR_NS_PER_S);
	advance(m);
}

static int create_protocol(struct master *m)
{
	const struct layout *layout = m->params.layout;
	const char *names[LAYOUT_MAX_NODES];
	struct fdp_master_params params = {
		.session = m->session,
		.node_names = names,
		.node_count = layout->node_count,
		.datagram_max = net_datagram_max(&layout->network),
		.deadline_ns = layout->rates.barrier_deadline_ns,
		.evict_frames = (unsigned)layout->rates.evict_frames,
		.pace = master_pace_params(layout),
		.multicast = net_has_group(m->net),
		.probe_group = net_has_group(m->net) && layout->network.cast == LAYOUT_AUTO,
		.masters = (unsigned)net_masters(layout),
		.index = m->params.index,
		.heartbeat_ns = master_takeover_ns(layout) / 8,
		.parity = master_parity(layout->network.parity),
		.swap = master_swap(layout->swap.mode),
		.swap_lead_most_ns = llrint((double)layout->swap.lead_most * (double)m->period_ns),
		.share_bytes = m->params.scene->gi.share == SCENE_SHARE_CLUSTER ? FDP_SHARE_MAX : 0,
	};
	struct fdp_master_ops ops = {
		.send = send_datagram, .event = master_on_event, .report = on_report, .input = on_input,
		.glance = on_glance, .ctx = m
	};
	int r;

	for (size_t i = 0; i < layout->node_count; i++)
		names[i] = layout->nodes[i].name;
	memcpy(params.key, m->params.key, sizeof params.key);
	params.contents = m->params.contents;
	r = fdp_master_create(&m->fdp, &params, &ops);
	sodium_memzero(params.key, sizeof params.key);
	return r < 0 ? r : master_role_create(m);
}

int master_create(struct master **out, struct loop *loop, struct net *net,
		  const struct master_params *params)
{
	struct master *m = calloc(1, sizeof *m);
	int fds[2], r;

	*out = NULL;
	if (!m)
		return GR_ERR_NOMEM;
	m->params = *params;
	m->loop = loop;
	m->net = net;
	m->deaf = -1;
	m->source = params->replay ? replay_source_frames(params->replay) : &params->live->source;
	if (params->live)
		params->live->trackers->tap = (struct trackers_tap){ on_sample, m };
	m->period_ns = llrint(1e9 / (double)params->layout->rates.frame_hz);
	m->session = fdp_session_after(0);
	notify_init(&m->notify);
	r = param_state_create(&m->state);
	if (r >= 0)
		r = create_protocol(m);
	if (r >= 0)
		r = m->tick_timer = loop_timer_create(loop, on_tick, m);
	if (r >= 0)
		r = m->frame_timer = loop_timer_create(loop, on_frame_time, m);
	if (r >= 0)
		r = m->second_timer = loop_timer_create(loop, on_second, m);
	net_fds(net, fds);
	if (r >= 0)
		r = loop_add(loop, fds[0], EPOLLIN, on_readable, m);
	if (r < 0) {
		gr_error("the master cannot start: %s", gr_result_name(r));
		master_destroy(&m);
		return r;
	}
	m->start_ns = m->next_frame_ns = gr_clock_now(&gr_clock_monotonic);
	if (params->live)
		params->live->start_ns = m->start_ns;
	on_second(m, m->start_ns);
	*out = m;
	return GR_OK;
}

void master_use_recorder(struct master *master, struct recorder *recorder)
{
	master->recorder = recorder;
}

static void on_due(void *ctx)
{
	on_readable(ctx, 0);
}

void master_use_faults(struct master *master, struct faults *faults)
{
	master->faults = faults;
	faults_on_due(faults, on_due, master);
}

void master_leave(struct master *master)
{
	if (master->left)
		return;
	master->left = true;
	master_save(master);
	if (fdp_standby_role(master->standby) != FDP_ROLE_FOLLOWS)
		fdp_master_leave(master->fdp, gr_clock_now(&gr_clock_monotonic));
	net_flush(master->net);
	dropped_finish(&master->bad);
}

void master_destroy(struct master **master)
{
	struct master *m = *master;
	int fds[2];

	if (!m)
		return;
	net_fds(m->net, fds);
	loop_remove(m->loop, fds[0]);
	fdp_standby_destroy(&m->standby);
	fdp_master_destroy(&m->fdp);
	param_state_destroy(&m->state);
	sodium_memzero(m->params.key, sizeof m->params.key);
	free(m);
	*master = NULL;
}
