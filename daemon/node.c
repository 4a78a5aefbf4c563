#include "daemon/node.h"

#include "base/clock.h"
#include "base/result.h"
#include "daemon/node_frame.h"
#include "daemon/node_glance.h"
#include "daemon/node_input.h"
#include "daemon/node_vitals.h"
#include "daemon/swap_wait.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define RECEIVE_MOST 256
/* A master that waits for a slow node still speaks several times a second. */
#define SILENCE_NS (5 * GR_NS_PER_S)
#define ONCE_PATIENCE_NS (30 * GR_NS_PER_S) /* with --once: a lost master that is silent as long has ended */
#define WINDOW_NS (100 * GR_NS_PER_MS) /* a window is answered while no frame comes */
#define GPU_SLICE_NS GR_NS_PER_MS /* the longest that the socket waits for the GPU */

static void send_datagram(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct node *n = ctx;

	faults_send(n->faults, n->net, to, net_masters(n->params.layout), bytes, len);
}

static void apply_frame(struct node *n, uint64_t frame, int64_t now_ns)
{
	const char *refused = NULL;
	uint64_t times;

	n->counts.applied++;
	n->state_frame = frame;
	n->state_hash = fdp_node_hash(n->fdp);
	if (n->wanted != 0)
		n->counts.dropped++;
	n->wanted = 0;
	n->master_gone = false;
	if (node_frame_fill(&n->next_frame, n->params.scene_file, fdp_node_params_state(n->fdp),
			    frame, &refused) < 0) {
		n->counts.invalid++;
		if (gr_log_limit(&n->invalid_limit, now_ns, &times))
			gr_error("frame %" PRIu64 " is not drawn: %s makes no sense (%" PRIu64
				 " such since the last line)", frame, refused, times);
		return;
	}
	n->wanted = frame;
	n->wanted_ns = now_ns;
}

static void window_closed(struct node *n)
{
	gr_notice("the window was closed");
	loop_stop(n->loop);
}

/* On a software GL, what drawing costs whoever else uses the processors. */
static void note_cpu(struct node_counts *counts)
{
	struct timespec ts;

	if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &ts) < 0)
		return;
	counts->last_cpu_ns = (int64_t)ts.tv_sec * GR_NS_PER_S + ts.tv_nsec;
	if (counts->swapped == 1)
		counts->first_cpu_ns = counts->last_cpu_ns;
}

/* For acceptance tests: survives our being killed, for the line is the kernel's at once. */
static void log_swap(const struct node *n)
{
	char line[128];
	int len;

	if (n->params.swap_log < 0)
		return;
	len = snprintf(line, sizeof line, "%016" PRIx64 " %" PRIu64 " %016" PRIx64 " %" PRId64 "\n",
		       n->drawn_session, n->swapped, n->drawn_hash, n->swap_ns);
	if (write(n->params.swap_log, line, (size_t)len) != len)
		gr_debug("swap log: %s", strerror(errno));
}

/* The swap itself comes first and alone; what it entails waits for receive to return. */
static void swap(struct node *n, uint64_t frame)
{
	if (n->ready == 0 || frame != n->ready)
		return; /* not ready in time, or told twice */
	if (n->picture && !target_swap(n->target))
		window_closed(n);
	n->swap_ns = gr_clock_now(&gr_clock_monotonic);
	n->swapped = n->report = frame;
	n->ready = n->due = 0;
	n->counts.swapped++;
	node_plan_settled(&n->plan);
	log_swap(n);
	note_cpu(&n->counts);
}

static void told_to_swap(struct node *n, uint64_t frame, int64_t at_ns)
{
	if (n->ready != 0 && frame == n->ready && at_ns != 0 && !n->swap.joined) {
		n->due = frame;
		n->due_ns = at_ns;
	} else {
		swap(n, frame);
	}
}

static void refused(struct node *n, const char *reason, int64_t now_ns)
{
	uint64_t times;

	n->counts.refused++;
	if (gr_log_limit(&n->refused_limit, now_ns, &times))
		gr_error("the master refuses this node: %s", reason ? reason : "no reason given");
	if (n->params.once) {
		n->status = GR_EXIT_CONFIG;
		loop_stop(n->loop);
	}
}

static void on_event(void *ctx, const struct fdp_node_event *event)
{
	struct node *n = ctx;
	int64_t now_ns = gr_clock_now(&gr_clock_monotonic);
	uint64_t times;

	switch (event->kind) {
	case FDP_NODE_JOINED:
		n->counts.joined++;
		n->master_gone = n->orphan = false;
		n->lost_ns = n->left_ns = 0;
		node_swap_begin(&n->swap);
		if (n->params.layout->standby_count)
			gr_notice("joined master %u of %zu, epoch %" PRIu64, fdp_node_master(n->fdp),
				  net_masters(n->params.layout), fdp_node_session(n->fdp) >> FDP_EPOCH_SHIFT);
		else
			gr_notice("joined the master");
		break;
	case FDP_NODE_FRAME: apply_frame(n, event->frame, now_ns); break;
	case FDP_NODE_SWAP: told_to_swap(n, event->frame, event->at_ns); break;
	case FDP_NODE_REFUSED:
		if (!node_plan_offered(&n->plan, event->plan, now_ns))
			refused(n, event->reason, now_ns);
		break;
	case FDP_NODE_LOST:
		n->counts.lost++;
		n->master_gone = n->orphan = true;
		n->lost_ns = now_ns;
		gr_warning("%s: asking to join again",
			   event->reason ? event->reason : "nothing is heard from the master");
		break;
	case FDP_NODE_MASTER_LEFT:
		n->master_gone = true;
		/* Where another stands by, the wall is given time before it shows that nobody is there. */
		n->orphan = !n->params.once && !n->params.layout->standby_count;
		n->left_ns = n->params.layout->standby_count ? now_ns : 0;
		gr_notice("the master left%s", n->params.once ? "" : ": waiting for the next");
		if (n->params.once)
			loop_stop(n->loop);
		break;
	case FDP_NODE_MISMATCH:
		n->counts.mismatches++;
		if (gr_log_limit(&n->mismatch_limit, now_ns, &times))
			gr_error("state of frame %" PRIu64 " differs: the master's %016" PRIx64
				 ", ours %016" PRIx64 "; asked for a snapshot (%" PRIu64
				 " since the last line)", event->frame, event->theirs, event->ours, times);
		break;
	}
}

static void on_datagram(void *ctx, const uint8_t *bytes, size_t len,
			const struct net_address *from, int64_t arrived_ns)
{
	struct node *n = ctx;
	int64_t now_ns = gr_clock_now(&gr_clock_monotonic);
	struct dropped_datagram dropped = { .from = from, .bytes = bytes, .len = len };
	int r;

	fdp_node_arrived(n->fdp, arrived_ns);
	r = fdp_node_receive(n->fdp, bytes, len, now_ns);

	/* A master's words before it has taken us, or another's, are none of ours, and nothing bad. */
	if (r >= 0 || (r == GR_ERR_MISMATCH && (fdp_node_status(n->fdp) != FDP_NODE_LIVE ||
						n->params.layout->standby_count)))
		return;
	dropped.peer = net_peer(n->net, from);
	dropped.name = dropped.peer > 0 ? "a standby" : dropped.peer == 0 ? "the master" : NULL;
	dropped_add(&n->bad, r, &dropped, now_ns);
}

/* Sends what is due; answers leave before any drawing begins. */
static void serve_protocol(struct node *n)
{
	if (n->swap_ns != 0) {
		swap_give_way();
		fdp_node_swapped(n->fdp, n->report, n->swap_ns, gr_clock_now(&gr_clock_monotonic));
		n->swap_ns = 0;
		if (n->params.input)
			node_input_tell(n->target, n->fdp);
		notify_feed(&n->notify, gr_clock_now(&gr_clock_monotonic));
	}
	net_flush(n->net);
	loop_timer_set(n->loop, n->tick_timer, fdp_node_next(n->fdp));
}

static void receive(struct node *n)
{
	int fds[2], count = net_fds(n->net, fds);

	for (int i = 0; i < count; i++)
		faults_receive(n->faults, n->net, fds[i], RECEIVE_MOST, on_datagram, n);
}

static void on_readable(void *ctx, uint32_t events)
{
	(void)events;
	receive(ctx);
	serve_protocol(ctx);
}

static void on_tick(void *ctx, int64_t now_ns)
{
	struct node *n = ctx;

	(void)now_ns;
	/* The master is not silent when its words wait here because we were drawing. */
	receive(n);
	fdp_node_tick(n->fdp, gr_clock_now(&gr_clock_monotonic));
	serve_protocol(n);
}

static void log_send_failures(struct node *n, int64_t now_ns)
{
	struct net_stats stats;
	uint64_t times;

	net_stats(n->net, &stats);
	if (stats.send_failed == n->seen_send_failed)
		return;
	n->seen_send_failed = stats.send_failed;
	if (gr_log_limit(&n->send_limit, now_ns, &times))
		gr_warning("%" PRIu64 " datagrams could not be sent; the last: %s", stats.send_failed,
			   strerror(stats.send_errno));
}

/* Its word that it leaves may have been lost. */
static void look_for_end(struct node *n, int64_t now_ns)
{
	if (!n->params.once || n->lost_ns == 0 || now_ns - n->lost_ns < ONCE_PATIENCE_NS)
		return;
	gr_warning("the master has been silent for %d s and is taken to have ended",
		   (int)((now_ns - n->lost_ns) / GR_NS_PER_S));
	loop_stop(n->loop);
}

/* Nobody took the place of a master that left. */
static void look_for_successor(struct node *n, int64_t now_ns)
{
	if (n->left_ns == 0 || now_ns - n->left_ns < GR_NS_PER_S)
		return;
	n->left_ns = 0;
	n->orphan = true;
}

static void on_second(void *ctx, int64_t now_ns)
{
	struct node *n = ctx;
	enum fdp_node_state state = fdp_node_status(n->fdp);

	/* Waiting for a master, or for its next frame, is healthy; a frame that is not done is not. */
	if (n->wanted == 0 && n->drawing == 0)
		notify_feed(&n->notify, now_ns);
	if (state == FDP_NODE_LIVE)
		notify_status("frame %" PRIu64 ", %" PRIu64 " swapped in the last second", n->swapped,
			      n->counts.swapped - n->logged_swapped);
	else
		notify_status("%s", fdp_node_state_name(state));
	n->logged_swapped = n->counts.swapped;
	log_send_failures(n, now_ns);
	node_vitals_tell(n->renderer, n->fdp);
	look_for_end(n, now_ns);
	look_for_successor(n, now_ns);
	loop_timer_set(n->loop, n->second_timer, now_ns + GR_NS_PER_S);
}

/* A window that nobody answers is taken for a dead one, and could not be closed. */
static void on_window(void *ctx, int64_t now_ns)
{
	struct node *n = ctx;

	if (!target_poll(n->target))
		window_closed(n);
	if (n->params.input) {
		node_input_tell(n->target, n->fdp);
		loop_timer_set(n->loop, n->tick_timer, fdp_node_next(n->fdp));
	}
	loop_timer_set(n->loop, n->window_timer, now_ns + WINDOW_NS);
}

static bool picture_due(const struct node *n, uint64_t frame)
{
	return n->pictures && frame != 0 && frame != n->saved && n->params.every > 0 &&
	       frame % n->params.every == 0;
}

static void save_picture(struct node *n, uint64_t frame)
{
	if (pictures_save(n->pictures, n->renderer, frame) >= 0)
		n->saved = frame;
}

static void start_drawing(struct node *n)
{
	int r;

	n->frame = n->next_frame;
	n->drawing = n->wanted;
	n->drawing_ns = n->wanted_ns;
	n->drawn_hash = n->state_hash;
	n->drawn_session = fdp_node_session(n->fdp);
	n->wanted = n->ready = n->drawn = 0;
	faults_frame(n->faults, n->drawing);
	node_share_begin(&n->share, n->fdp, n->drawing, n->drawing_ns);
	r = renderer_draw(n->renderer, &n->frame);
	if (r < 0) {
		gr_error("frame %" PRIu64 " cannot be drawn: %s", n->drawing, gr_result_name(r));
		n->status = GR_EXIT_RUNTIME;
		loop_stop(n->loop);
	}
	n->picture = r == GR_OK;
}

static void finish_drawing(struct node *n)
{
	int r = renderer_finished(n->renderer, GPU_SLICE_NS);
	int64_t now_ns = gr_clock_now(&gr_clock_monotonic);
	uint64_t frame = n->drawing;

	if (r == GR_NOTHING)
		return;
	if (r < 0) {
		gr_error("the GPU is lost: %s", gr_result_name(r));
		n->status = GR_EXIT_RUNTIME;
		loop_stop(n->loop);
		return;
	}
	n->drawing = 0;
	n->drawn = frame;
	n->counts.drawn++;
	if (n->wanted != 0) {
		n->counts.dropped++;
		return;
	}
	n->ready = frame;
	node_share_end(&n->share, n->fdp, frame, now_ns);
	node_glance_tell(n->renderer, n->fdp);
	fdp_node_ready(n->fdp, frame, (uint32_t)((now_ns - n->drawing_ns) / GR_NS_PER_US), now_ns);
	serve_protocol(n);
}

static void swap_in_time(struct node *n)
{
	const int64_t at_ns = n->due_ns;

	swap_wait(at_ns, n->params.layout->swap.busy_poll_ns);
	swap(n, n->due);
	n->counts.scheduled++;
	histogram_add(&n->swap_off, (n->swap_ns - at_ns) / GR_NS_PER_US);
	serve_protocol(n);
}

static void work(struct node *n)
{
	if (n->due != 0)
		swap_in_time(n);
	if (n->orphan && n->drawing == 0) {
		n->orphan = false;
		/* What the target holds is no frame's picture any more. */
		if (node_swap_orphan(&n->swap))
			n->drawn = n->ready = 0;
	}
	/* A picture that is to be saved must be read before the next is drawn over it. */
	if (n->drawing == 0 && n->drawn != 0 && n->drawn == n->swapped && picture_due(n, n->drawn))
		save_picture(n, n->drawn);
	if (n->drawing == 0 && n->wanted != 0)
		start_drawing(n);
	else if (n->drawing != 0)
		finish_drawing(n);
}

int node_run(struct node *node)
{
	while (!loop_stopped(node->loop) && node->plan.wanted == 0) {
		/* Everything that has arrived is taken first: only the newest frame is drawn. */
		bool busy = node->drawing != 0 || node->wanted != 0;
		int r = loop_once(node->loop, busy ? 0 : -1);

		if (r < 0) {
			gr_error("the event loop failed");
			return GR_EXIT_RUNTIME;
		}
		if (!loop_stopped(node->loop) && node->plan.wanted == 0)
			work(node);
	}
	if (loop_signal(node->loop))
		gr_notice("ends: %s", strsignal(loop_signal(node->loop)));
	return node->status;
}

/*
 * Before the standby calls, so that its first call is answered: it takes a master for
 * dead that is silent for half of takeover_frames.
 */
static int64_t call_after(const struct layout *layout)
{
	const double half = layout->rates.takeover_frames * 0.5;

	return layout->standby_count ? llrint((half - 1) * 1e9 / (double)layout->rates.frame_hz) : 0;
}

static int create_protocol(struct node *n)
{
	const struct layout *layout = n->params.layout;
	struct fdp_node_params params = {
		.index = (uint16_t)n->params.index,
		.name = layout->nodes[n->params.index].name,
		.datagram_max = net_datagram_max(&layout->network),
		.receive_bytes = net_receive_bytes(n->net),
		.silence_ns = SILENCE_NS,
		.masters = (unsigned)net_masters(layout),
		.call_ns = call_after(layout),
		.share_bytes = n->share.room,
	};
	struct fdp_node_ops ops = { send_datagram, on_event, n };
	int r;

	node_share_plan(n->renderer, &params.plan, &params.plan_cost, &params.plan_error);
	n->plan.present = params.plan;
	memcpy(params.key, n->params.key, sizeof params.key);
	params.contents = n->params.contents;
	r = fdp_node_create(&n->fdp, &params, &ops);
	sodium_memzero(params.key, sizeof params.key);
	return r;
}

static int join_loop(struct node *n)
{
	int fds[2], count, r;

	r = n->tick_timer = loop_timer_create(n->loop, on_tick, n);
	if (r >= 0 && n->params.window)
		r = n->window_timer = loop_timer_create(n->loop, on_window, n);
	if (r >= 0)
		r = n->second_timer = loop_timer_create(n->loop, on_second, n);
	count = net_fds(n->net, fds);
	if (r >= 0)
		r = loop_add(n->loop, fds[0], EPOLLIN, on_readable, n);
	if (r >= 0 && count > 1)
		r = loop_add(n->loop, fds[1], EPOLLIN, on_readable, n);
	return r;
}

int node_create(struct node **out, struct loop *loop, struct net *net, struct target *target,
		struct renderer *renderer, struct pictures *pictures,
		const struct node_params *params)
{
	struct node *n = calloc(1, sizeof *n);
	int64_t now_ns = gr_clock_now(&gr_clock_monotonic);
	int r;

	*out = NULL;
	if (!n)
		return GR_ERR_NOMEM;
	n->params = *params;
	n->loop = loop;
	n->net = net;
	n->target = target;
	n->renderer = renderer;
	n->pictures = pictures;
	render_frame_init(&n->next_frame, params->scene_file);
	notify_init(&n->notify);
	r = node_swap_init(&n->swap, target, &params->layout->swap);
	if (r >= 0)
		r = node_share_init(&n->share, renderer, params->scene_file, params->layout->node_count);
	if (r >= 0)
		r = create_protocol(n);
	if (r >= 0)
		r = join_loop(n);
	if (r < 0) {
		gr_error("the node cannot start: %s", gr_result_name(r));
		node_destroy(&n);
		return r;
	}
	on_second(n, now_ns);
	if (n->params.window)
		on_window(n, now_ns);
	on_tick(n, now_ns);
	*out = n;
	return GR_OK;
}

int node_take_renderer(struct node *n, struct renderer *renderer)
{
	uint16_t cost, error;
	uint64_t plan;
	int r;

	n->renderer = renderer;
	n->wanted = n->drawing = n->drawn = n->ready = n->due = 0;
	n->picture = false;
	node_share_finish(&n->share);
	node_share_plan(renderer, &plan, &cost, &error);
	node_plan_tried(&n->plan, plan);
	if (!renderer)
		return GR_OK;
	r = node_share_init(&n->share, renderer, n->params.scene_file, n->params.layout->node_count);
	if (r >= 0)
		r = fdp_node_replan(n->fdp, plan, cost, error, n->share.room);
	if (r < 0)
		gr_error("the room's plan of the light cannot be taken: %s", gr_result_name(r));
	else
		loop_timer_set(n->loop, n->tick_timer, fdp_node_next(n->fdp));
	return r;
}

static void on_due(void *ctx)
{
	on_readable(ctx, 0);
}

void node_use_faults(struct node *node, struct faults *faults)
{
	node->faults = faults;
	faults_on_due(faults, on_due, node);
}

void node_leave(struct node *node)
{
	if (!node->master_gone) {
		fdp_node_leave(node->fdp, gr_clock_now(&gr_clock_monotonic));
		net_flush(node->net);
	}
	dropped_finish(&node->bad);
	if (node->pictures && node->drawn != 0 && node->drawn == node->swapped &&
	    node->drawn != node->saved)
		save_picture(node, node->drawn);
}

void node_destroy(struct node **node)
{
	struct node *n = *node;
	int fds[2], count;

	if (!n)
		return;
	count = net_fds(n->net, fds);
	for (int i = 0; i < count; i++)
		loop_remove(n->loop, fds[i]);
	fdp_node_destroy(&n->fdp);
	node_share_finish(&n->share);
	sodium_memzero(n->params.key, sizeof n->params.key);
	free(n);
	*node = NULL;
}
