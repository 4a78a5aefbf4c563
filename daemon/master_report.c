#include "daemon/master_private.h"

#include "base/clock.h"
#include "base/result.h"
#include "daemon/control.h"
#include "daemon/json.h"
#include "daemon/master_pace.h"
#include "renderer/gi/plan.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void write_histogram(struct json *json, const char *key, const struct histogram *histogram)
{
	json_open(json, key, '{');
	json_u64(json, "count", histogram->count);
	json_f64(json, "p50", histogram_percentile(histogram, 0.5));
	json_f64(json, "p99", histogram_percentile(histogram, 0.99));
	json_i64(json, "max", histogram->max_us);
	json_close(json, '}');
}

/* How a node that has joined computes light, in words, and what it expects of that. */
static void write_light(struct json *json, const struct scene_file *file,
			const struct fdp_peer_status *peer)
{
	struct scene_gi gi = file->gi;
	char text[GI_PLAN_TEXT];

	if (peer->state == FDP_PEER_ABSENT || peer->state == FDP_PEER_DEAD)
		return;
	if (peer->plan && !gi_plan_decode(peer->plan, &gi))
		snprintf(text, sizeof text, "unknown");
	else
		gi_plan_settings(text, sizeof text, &gi);
	json_string(json, "light", text);
	if (!peer->plan)
		return;
	json_hash(json, "light_plan", peer->plan);
	json_f64(json, "light_ms", peer->plan_cost * 0.01);
	json_f64(json, "light_error", peer->plan_error * 0.0001);
}

/* Where the node's clock stands beside ours, and how its SWAPs reach it. */
static void write_clock(struct json *json, const struct master *m, size_t i,
			const struct fdp_peer_status *peer, int64_t now_ns)
{
	struct fdp_clock_estimate clock;

	fdp_master_clock(m->fdp, i, now_ns, &clock);
	json_open(json, "clock", '{');
	json_bool(json, "known", clock.known);
	if (clock.known) {
		json_f64(json, "offset_us", (double)clock.offset_ns * 1e-3);
		json_f64(json, "error_us", (double)clock.error_ns * 1e-3);
		json_f64(json, "trip_us", (double)clock.trip_ns * 1e-3);
		json_f64(json, "skew_ppm", clock.skew_ppm);
	}
	json_close(json, '}');
	json_f64(json, "swap_path_us", (double)peer->path_ns * 1e-3);
	json_u64(json, "swaps_late", peer->swaps_late);
}

static void write_node(struct json *json, const struct master *m, size_t i, int64_t now_ns)
{
	const struct layout_node *node = &m->params.layout->nodes[i];
	struct fdp_peer_status peer;

	fdp_master_peer(m->fdp, i, &peer);
	json_open(json, NULL, '{');
	json_string(json, "name", node->name);
	json_string(json, "wall", m->params.layout->walls[node->wall].name);
	json_string(json, "state", fdp_peer_state_name(peer.state));
	master_write_pace(json, &peer, now_ns);
	json_u64(json, "acked", peer.acked);
	json_u64(json, "ready", peer.ready);
	json_u64(json, "swapped", peer.swapped);
	json_u64(json, "missed", peer.missed);
	json_u64(json, "lost", peer.lost);
	json_f64(json, "loss", peer.loss);
	json_f64(json, "answer_us", (double)peer.answer_ns * 1e-3);
	json_u64(json, "mismatches", peer.mismatches);
	json_u64(json, "swapped_frame", peer.swapped_frame);
	json_f64(json, "ready_after_ms", (double)peer.ready_after_ns * 1e-6);
	json_f64(json, "render_ms", (double)peer.render_us * 1e-3);
	json_u64(json, "receive_bytes", peer.vitals.receive_bytes);
	json_u64(json, "under_way", peer.under_way);
	json_u64(json, "slices", peer.slices);
	json_u64(json, "slices_late", peer.slices_late);
	json_u64(json, "slice_bytes", peer.slice_bytes);
	write_light(json, m->params.scene, &peer);
	if (peer.last_heard_ns > 0)
		json_f64(json, "heard_ms_ago", (double)(now_ns - peer.last_heard_ns) * 1e-6);
	write_clock(json, m, i, &peer, now_ns);
	master_write_stages(json, &peer);
	json_close(json, '}');
}

static void write_way(struct json *json, const struct master *m)
{
	const enum layout_cast cast = m->params.layout->network.cast;
	const bool group = fdp_master_way(m->fdp) == FDP_WAY_GROUP;

	json_string(json, "way", !group			    ? "unicast" :
				 cast == LAYOUT_BROADCAST ? "broadcast" : "multicast");
	if (cast == LAYOUT_AUTO && m->deaf >= 0)
		json_string(json, "deaf", m->params.layout->nodes[m->deaf].name);
	else if (cast == LAYOUT_AUTO && !net_has_group(m->net))
		json_string(json, "deaf", "master");
}

static void write_parity(struct json *json, const struct master *m, const struct fdp_counters *c)
{
	static const char *const modes[] = { [LAYOUT_PARITY_AUTO] = "auto", [LAYOUT_PARITY_OFF] = "off",
					     [LAYOUT_PARITY_ON] = "on" };
	unsigned fragments, parity;

	fdp_master_fragments(m->fdp, &fragments, &parity);
	json_open(json, "parity", '{');
	json_string(json, "mode", modes[m->params.layout->network.parity]);
	json_u64(json, "fragments", fragments);
	json_u64(json, "parity", parity);
	json_u64(json, "sent", c->parity);
	json_u64(json, "bytes", c->parity_bytes);
	json_close(json, '}');
}

static void write_wire(struct json *json, const struct master *m)
{
	struct fdp_counters c, ear;
	struct net_stats net;

	fdp_master_counters(m->fdp, &c);
	fdp_standby_counters(m->standby, &ear);
	net_stats(m->net, &net);
	json_open(json, "wire", '{');
	json_u64(json, "bytes_out", c.bytes_out);
	json_u64(json, "bytes_in", c.bytes_in + ear.bytes_in);
	json_u64(json, "datagrams_out", c.datagrams_out);
	json_u64(json, "datagrams_in", c.datagrams_in + ear.datagrams_in);
	json_u64(json, "repairs", c.repairs);
	json_u64(json, "packed", c.packed);
	write_parity(json, m, &c);
	json_u64(json, "send_failed", net.send_failed);
	write_way(json, m);
	json_open(json, "bad", '{');
	json_u64(json, "short", c.bad_short + ear.bad_short);
	json_u64(json, "version", c.bad_version + ear.bad_version);
	json_u64(json, "auth", c.bad_auth + ear.bad_auth);
	json_u64(json, "session", c.bad_session);
	json_u64(json, "format", c.bad_format + ear.bad_format);
	json_u64(json, "replay", c.bad_replay + ear.bad_replay);
	json_u64(json, "oversized", net.oversized);
	json_close(json, '}');
	json_close(json, '}');
}

static void write_share(struct json *json, const struct master *m)
{
	struct fdp_share_counts c;
	unsigned nodes = fdp_master_share(m->fdp, &c);

	json_open(json, "share", '{');
	json_bool(json, "on", m->params.scene->gi.share == SCENE_SHARE_CLUSTER);
	json_u64(json, "nodes", nodes);
	json_u64(json, "slices", c.received);
	json_u64(json, "bytes_in", c.bytes_received);
	json_u64(json, "bytes_out", c.bytes_sent);
	json_u64(json, "late", c.late);
	json_u64(json, "lost", c.lost);
	json_u64(json, "asked", c.asked);
	json_u64(json, "repairs", c.repairs);
	json_close(json, '}');
}

static void write_frames(struct json *json, const struct master *m)
{
	json_u64(json, "frame", m->frame);
	json_u64(json, "frames", m->stats.begun);
	json_u64(json, "frames_complete", m->stats.complete);
	json_u64(json, "frames_incomplete", m->stats.incomplete);
	json_hash(json, "state_hash", fdp_master_hash(m->fdp));
	json_u64(json, "joined", m->joined);
	json_u64(json, "late", m->late);
	json_u64(json, "evicted", m->evicted);
	json_u64(json, "refused", m->refused);
	write_histogram(json, "skew_us", &m->stats.skew);
	write_histogram(json, "skew_told_us", &m->stats.skew_told);
	write_histogram(json, "skew_scheduled_us", &m->stats.skew_scheduled);
	write_histogram(json, "commit_to_applied_us", &m->stats.applied);
	write_histogram(json, "commit_to_swap_sent_us", &m->stats.swap_sent);
	write_histogram(json, "commit_to_last_swap_us", &m->stats.last_swapped);
	write_histogram(json, "swap_sent_to_last_swap_us", &m->stats.swap_to_last);
}

/* Of a body that is lost, this is how long its pose has been held. */
static void write_seen(struct json *json, const struct live_source *live, enum track_body body,
		       const char *key)
{
	int64_t seen_ns;

	if (track_history_seen(&live->trackers->history, body, &seen_ns))
		json_f64(json, key, (double)(live->input.time_ns - seen_ns) * 1e-9);
}

static void write_tracking(struct json *json, const struct master *m, int64_t now_ns)
{
	const struct live_source *live = m->params.live;
	const struct gr_pose *head = &live->input.head.T_room_body;

	json_open(json, "tracking", '{');
	json_bool(json, "head_tracked", live->input.head.tracked);
	json_bool(json, "wand_tracked", live->input.wand.tracked);
	write_seen(json, live, TRACK_HEAD, "head_seen_s_ago");
	write_seen(json, live, TRACK_WAND, "wand_seen_s_ago");
	json_u64(json, "dropped", live->trackers->history.dropped);
	json_open(json, "head_m", '[');
	for (int i = 0; i < 3; i++)
		json_f64(json, NULL, (double)head->p[i]);
	json_close(json, ']');
	trackers_write_json(live->trackers, json, "trackers", now_ns, false);
	json_close(json, '}');
}

static const char *name_of_node(const void *ctx, int node)
{
	const struct layout *layout = ctx;

	return node >= 0 && (size_t)node < layout->node_count ? layout->nodes[node].name : "?";
}

static void write_replay(struct json *json, const struct master *m)
{
	json_open(json, "replay", '{');
	replay_source_write_json(m->params.replay, json, name_of_node, m->params.layout);
	json_close(json, '}');
}

static void write_record(struct json *json, const struct master *m)
{
	json_open(json, "record", '{');
	if (m->recorder)
		recorder_write_json(m->recorder, json);
	json_close(json, '}');
}

static void write_settings(struct json *json, const struct master *m)
{
	const struct master_settings *s = &m->params.live->scene_state.settings;

	json_open(json, "settings", '{');
	json_u64(json, "gi_on", s->gi_on);
	json_u64(json, "gi_steps", s->gi_steps);
	json_u64(json, "gi_gathers", s->gi_gathers);
	json_f64(json, "gi_incremental", (double)s->gi_incremental);
	json_f64(json, "absorption", (double)s->absorption);
	json_f64(json, "scattering", (double)s->scattering);
	json_f64(json, "exposure", (double)s->exposure);
	json_u64(json, "tone_curve", s->tone_curve);
	json_f64(json, "gamma_encode", (double)s->gamma_encode);
	json_f64(json, "adaptation", (double)s->adaptation);
	json_f64(json, "luminance_max", (double)s->luminance_max);
	json_f64(json, "tone_bias", (double)s->tone_bias);
	json_f64(json, "eye_separation", (double)s->eye_separation);
	json_open(json, "lamps", '{');
	for (size_t i = 0; i < m->params.scene->lamp_count && i < PARAM_MAX_LAMPS; i++)
		json_bool(json, m->params.scene->lamps[i].name, s->lamp_on >> i & 1);
	json_close(json, '}');
	json_close(json, '}');
}

/* Where the room's eye gets used to what it looks at. */
static void write_eye(struct json *json, const struct master *m)
{
	const struct master_adapt *adapt = &m->params.live->scene_state.adapt;

	if (!adapt->on)
		return;
	json_open(json, "eye", '{');
	json_f64(json, "cones", adapt->eye.cone);
	json_f64(json, "rods", adapt->eye.rod);
	json_f64(json, "looks_at", adapt->goal);
	json_f64(json, "white", adapt->max);
	json_close(json, '}');
}

static void write_hand(struct json *json, const struct master *m)
{
	const struct hand *hand = &m->params.live->scene_state.hand;

	json_open(json, "hand", '{');
	json_string(json, "layout", hand_mode_name(hand->mode));
	json_u64(json, "buttons", hand->buttons);
	json_bool(json, "quality", hand->quality);
	if (hand->torch >= 0) {
		json_string(json, "torch", m->params.scene->lamps[hand->torch].name);
		json_bool(json, "put_down", hand->put_down);
	}
	json_open(json, "room_m", '[');
	for (int i = 0; i < 3; i++)
		json_f64(json, NULL, (double)m->params.live->scene_state.T_scene_room.p[i]);
	json_close(json, ']');
	json_close(json, '}');
}

int master_write_json(const struct master *m, int64_t now_ns, char *text, size_t size,
		      size_t *out_len)
{
	struct json json = json_start(text, size);

	json_open(&json, NULL, '{');
	json_bool(&json, "ok", true);
	json_string(&json, "layout", m->params.layout->name);
	json_string(&json, "scene", m->params.scene->name);
	json_hash(&json, "session", m->session);
	master_role_write_json(m, &json, now_ns);
	json_f64(&json, "uptime_s", (double)(now_ns - m->start_ns) * 1e-9);
	json_f64(&json, "frame_hz", (double)m->params.layout->rates.frame_hz);
	json_bool(&json, "frame_clock", m->params.frame_clock);
	json_bool(&json, "running", m->started && m->members != 0);
	write_frames(&json, m);
	json_open(&json, "nodes", '[');
	for (size_t i = 0; i < m->params.layout->node_count; i++)
		write_node(&json, m, i, now_ns);
	json_close(&json, ']');
	write_share(&json, m);
	write_wire(&json, m);
	if (m->params.live) {
		write_tracking(&json, m, now_ns);
		write_settings(&json, m);
		write_eye(&json, m);
		write_hand(&json, m);
	}
	if (m->params.replay)
		write_replay(&json, m);
	write_record(&json, m);
	faults_write_json(m->faults, &json, "faults");
	json_close(&json, '}');
	*out_len = json.len;
	return json.ok ? GR_OK : GR_ERR_RANGE;
}

static void answer_ok(char *answer, size_t size)
{
	snprintf(answer, size, "{\"ok\":true}");
}

static void answer_set(struct master *m, char *const *words, int count, char *answer, size_t size)
{
	char why[400];

	if (count < 2) {
		control_refuse(answer, size, "write: set NAME VALUE...");
		return;
	}
	if (!master_rules(m)) {
		control_refuse(answer, size, "this master stands by; ask the active one");
		return;
	}
	if (!m->params.live) {
		control_refuse(answer, size, "a recording is replayed: its settings are what they were");
		return;
	}
	if (master_settings_set(&m->params.live->scene_state.settings, m->params.scene, words + 1, count - 1, why,
				sizeof why) < 0) {
		control_refuse(answer, size, "%s", why);
		return;
	}
	gr_info("control: %s was set", words[1]);
	recorder_setting(m->recorder, gr_clock_now(&gr_clock_monotonic), m->frame, words + 1, count - 1);
	answer_ok(answer, size);
}

static void answer_record(struct master *m, char *const *words, int count, char *answer, size_t size)
{
	struct json json = json_start(answer, size);
	char why[256] = "write: record, record start PATH, record stop";
	int r = GR_ERR_RANGE;

	if (count == 1)
		r = GR_OK;
	else if (!strcmp(words[1], "start") && count == 3 && !master_rules(m))
		snprintf(why, sizeof why, "this master stands by; ask the active one");
	else if (!strcmp(words[1], "start") && count == 3)
		r = master_record(m, words[2], why, sizeof why);
	else if (!strcmp(words[1], "stop") && count == 2 && m->recorder)
		r = recorder_stop(m->recorder, why, sizeof why);
	if (r < 0) {
		control_refuse(answer, size, "%s", why);
		return;
	}
	json_open(&json, NULL, '{');
	json_bool(&json, "ok", true);
	write_record(&json, m);
	json_close(&json, '}');
}

static void answer_step(struct master *m, char *const *words, int count, char *answer, size_t size)
{
	char *end = NULL;
	long frames = count == 2 ? strtol(words[1], &end, 10) : 1;

	if (count > 2 || (end && *end) || frames < 1 || frames > 1000000) {
		control_refuse(answer, size, "write: step, or step N with N from 1 to 1000000");
	} else if (!m->params.replay || replay_source_step(m->params.replay, (uint64_t)frames) < 0) {
		control_refuse(answer, size, "no recording is replayed by steps (--replay FILE --step)");
	} else {
		loop_timer_set(m->loop, m->frame_timer, 0);
		answer_ok(answer, size);
	}
}

static void answer_trackers(const struct master *m, char *answer, size_t size)
{
	size_t len;

	if (!m->params.live)
		control_refuse(answer, size, "a recording is replayed: no tracker is asked");
	else if (trackers_answer(m->params.live->trackers, gr_clock_now(&gr_clock_monotonic), answer,
				 size, &len) < 0)
		control_refuse(answer, size, "the answer is longer than %zu bytes", size);
}

void master_answer(void *ctx, char *const *words, int count, char *answer, size_t size)
{
	struct master *m = ctx;
	size_t len;

	if (!strcmp(words[0], "status") && count == 1) {
		if (master_write_json(m, gr_clock_now(&gr_clock_monotonic), answer, size, &len) < 0)
			control_refuse(answer, size, "the answer is longer than %zu bytes", size);
	} else if (!strcmp(words[0], "trackers") && count == 1) {
		answer_trackers(m, answer, size);
	} else if (!strcmp(words[0], "set")) {
		answer_set(m, words, count, answer, size);
	} else if (!strcmp(words[0], "step")) {
		answer_step(m, words, count, answer, size);
	} else if (!strcmp(words[0], "record")) {
		answer_record(m, words, count, answer, size);
	} else if (!strcmp(words[0], "faults")) {
		faults_answer(m->faults, m->params.layout->path, words, count, answer, size);
	} else if (!strcmp(words[0], "quit") && count == 1) {
		gr_notice("control: asked to end");
		answer_ok(answer, size);
		loop_stop(m->loop);
	} else {
		control_refuse(answer, size, "no request '%.40s'; there are status, trackers, set NAME VALUE..., record, step, quit",
			       words[0]);
	}
}
