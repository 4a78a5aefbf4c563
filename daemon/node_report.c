#include "daemon/node.h"

#include "base/result.h"
#include "daemon/json.h"

#include <stdlib.h>

static void write_wire(struct json *json, const struct node *n)
{
	struct fdp_counters c;
	struct net_stats net;

	fdp_node_counters(n->fdp, &c);
	net_stats(n->net, &net);
	json_open(json, "wire", '{');
	json_u64(json, "bytes_out", c.bytes_out);
	json_u64(json, "bytes_in", c.bytes_in);
	json_u64(json, "datagrams_out", c.datagrams_out);
	json_u64(json, "datagrams_in", c.datagrams_in);
	json_u64(json, "repairs", c.repairs);
	json_u64(json, "healed", c.healed);
	json_u64(json, "send_failed", net.send_failed);
	json_open(json, "bad", '{');
	json_u64(json, "short", c.bad_short);
	json_u64(json, "version", c.bad_version);
	json_u64(json, "auth", c.bad_auth);
	json_u64(json, "session", c.bad_session);
	json_u64(json, "format", c.bad_format);
	json_u64(json, "replay", c.bad_replay);
	json_u64(json, "oversized", net.oversized);
	json_close(json, '}');
	json_close(json, '}');
}

static void write_share(struct json *json, const struct node *n)
{
	struct fdp_share_counts c;

	fdp_node_share(n->fdp, &c);
	json_open(json, "share", '{');
	json_bool(json, "on", n->share.room > 0);
	json_u64(json, "nodes", n->share.count);
	json_u64(json, "sent", c.sent);
	json_u64(json, "bytes_sent", c.bytes_sent);
	json_u64(json, "received", c.received);
	json_u64(json, "bytes_received", c.bytes_received);
	json_u64(json, "late", c.late);
	json_u64(json, "lost", c.lost);
	json_u64(json, "refused", n->share.refused);
	json_u64(json, "asked", c.asked);
	json_u64(json, "repairs", c.repairs);
	json_close(json, '}');
}

static int compare_ms(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/* Of the last frames in which the stage ran: no restart of the light weighs on it. */
static double median_ms(const struct timers *timers, int stage)
{
	double ms[TIMER_WINDOW];
	size_t n = timers_window(timers, stage, ms);

	qsort(ms, n, sizeof *ms, compare_ms);
	return n ? (ms[(n - 1) / 2] + ms[n / 2]) / 2 : 0;
}

static void write_stages(struct json *json, const struct node *n)
{
	struct timers *timers = renderer_timers(n->renderer);

	json_open(json, "stages", '[');
	for (int i = 0; timers && i < TIMER_STAGES; i++) {
		struct timer_stats stats;
		timers_stats(timers, i, &stats);
		if (!stats.name)
			continue;
		json_open(json, NULL, '{');
		json_string(json, "name", stats.name);
		json_u64(json, "count", stats.count);
		json_f64(json, "mean_ms", stats.mean_ms);
		json_f64(json, "median_ms", median_ms(timers, i));
		json_f64(json, "min_ms", stats.min_ms);
		json_f64(json, "max_ms", stats.max_ms);
		json_f64(json, "last_ms", stats.last_ms);
		json_close(json, '}');
	}
	json_close(json, ']');
}

static void write_renderer(struct json *json, const struct node *n)
{
	struct renderer_stats stats;
	int width, height;

	renderer_stats(n->renderer, &stats);
	target_size(n->target, &width, &height);
	json_string(json, "renderer", target_renderer_name(n->target));
	json_string(json, "platform", target_platform_name(n->target));
	json_i64(json, "width", width);
	json_i64(json, "height", height);
	json_u64(json, "shadow_updates", stats.shadow_updates);
	json_u64(json, "gi_updates", stats.gi_updates);
	json_u64(json, "skipped_eyes", stats.skipped_eyes);
	json_u64(json, "gl_errors", stats.gl_errors);
	json_u64(json, "nonfinite", stats.nonfinite);
	json_hash(json, "light_hash", renderer_light_hash(n->renderer));
	write_stages(json, n);
}

static void write_swap(struct json *json, const struct node *n)
{
	json_open(json, "swap", '{');
	json_u64(json, "scheduled", n->counts.scheduled);
	json_u64(json, "told", n->counts.swapped - n->counts.scheduled);
	json_f64(json, "off_p50_us", histogram_percentile(&n->swap_off, 0.5));
	json_f64(json, "off_p99_us", histogram_percentile(&n->swap_off, 0.99));
	json_i64(json, "off_max_us", n->swap_off.max_us);
	json_bool(json, "driver_barrier", n->swap.hardware);
	json_close(json, '}');
}

int node_write_json(const struct node *n, uint64_t pictures_saved, char *text, size_t size,
		    size_t *out_len)
{
	struct json json = json_start(text, size);
	const struct node_counts *c = &n->counts;

	json_open(&json, NULL, '{');
	json_string(&json, "node", n->params.layout->nodes[n->params.index].name);
	json_u64(&json, "applied", c->applied);
	json_u64(&json, "drawn", c->drawn);
	json_u64(&json, "swapped", c->swapped);
	write_swap(&json, n);
	json_u64(&json, "dropped", c->dropped);
	json_u64(&json, "invalid", c->invalid);
	json_u64(&json, "mismatches", c->mismatches);
	json_u64(&json, "joined", c->joined);
	json_u64(&json, "lost", c->lost);
	json_u64(&json, "refused", c->refused);
	if (c->swapped > 1)
		json_f64(&json, "cpu_ms_a_frame", (double)(c->last_cpu_ns - c->first_cpu_ns) * 1e-6 /
						  (double)(c->swapped - 1));
	json_u64(&json, "last_frame", n->swapped);
	json_u64(&json, "pictures", pictures_saved);
	json_u64(&json, "state_frame", n->state_frame);
	json_hash(&json, "state_hash", n->state_hash);
	if (n->renderer)
		write_renderer(&json, n);
	write_share(&json, n);
	write_wire(&json, n);
	json_close(&json, '}');
	*out_len = json.len;
	return json.ok ? GR_OK : GR_ERR_RANGE;
}
