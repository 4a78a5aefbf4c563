#include "tools/bench/delivery.h"

#include "base/clock.h"
#include "protocol/message.h"
#include "tools/bench/cluster_ends.h"

#include <string.h>

#define RECEIVE_MOST 256
#define BALLAST_WORDS_MOST (UINT16_MAX / 4) /* the size of a parameter has 16 bits */
#define DEADLINE_NS (33 * GR_NS_PER_MS)

static int64_t now(void)
{
	return gr_clock_now(&gr_clock_monotonic);
}

struct master_end {
	struct cluster_master end; /* first: the protocol's ctx */
	struct delivery_room *room;
	uint64_t random;
	struct delivery_runs runs;
	uint64_t frame;
	int64_t next_ns;
	struct bare {
		unsigned sent;
		int64_t next_ns; /* 0: not before the first frame that counts */
	} bare[DELIVERY_FDP];
	uint64_t bytes_warm; /* sent before the updates that count */
};

static void master_event(void *ctx, const struct fdp_master_event *event)
{
	(void)ctx;
	(void)event;
}

static void master_datagram(void *ctx, const uint8_t *bytes, size_t len,
			    const struct net_address *from, int64_t arrived_ns)
{
	struct master_end *m = ctx;

	(void)from;
	if (delivery_lost(&m->room->loss, &m->runs))
		return;
	fdp_master_arrived(m->end.fdp, arrived_ns);
	fdp_master_receive(m->end.fdp, bytes, len, now(), NULL);
}

static uint32_t draw(struct master_end *m)
{
	m->random = m->random * UINT64_C(6364136223846793005) + 1;
	return (uint32_t)(m->random >> 32);
}

/* PARAM_COUNT: this program's table has none. */
static enum param_id ballast_id(void)
{
	enum param_id id = (enum param_id)0;

	while (id < PARAM_COUNT && strcmp(param_info(id)->name, "ballast"))
		id++;
	return id;
}

size_t delivery_ballast(void)
{
	const enum param_id id = ballast_id();

	return id < PARAM_COUNT ? param_info(id)->size : 0;
}

static void set_ballast(struct master_end *m, uint64_t frame)
{
	static uint32_t words[BALLAST_WORDS_MOST];
	const enum param_id id = ballast_id();

	if (id == PARAM_COUNT)
		return;
	for (size_t i = 0; i < param_info(id)->count; i++)
		words[i] = draw(m);
	param_set(m->end.state, id, words, frame);
}

/* All of it is new, and does not pack. */
static void set_state(struct master_end *m, uint64_t frame)
{
	const float head[3] = { (float)draw(m) * 1e-9f, 1.7f, (float)draw(m) * 1e-9f };
	const float turned[4] = { 0, head[0] * 0.1f, 0, 1 };
	const uint64_t time = frame * (uint64_t)m->room->cluster.period_ns;

	param_set(m->end.state, PARAM_FRAME_TIME, &time, frame);
	param_set(m->end.state, PARAM_HEAD_POSITION, head, frame);
	param_set(m->end.state, PARAM_HEAD_ROTATION, turned, frame);
	param_set(m->end.state, PARAM_WAND_POSITION, head, frame);
	param_set(m->end.state, PARAM_WAND_ROTATION, turned, frame);
	set_ballast(m, frame);
}

static void begin(struct master_end *m)
{
	struct delivery_room *room = m->room;
	struct fdp_counters c;
	const uint64_t frame = m->frame + 1;

	set_state(m, frame);
	if (frame == room->warm + 1) {
		fdp_master_counters(m->end.fdp, &c);
		m->bytes_warm = c.bytes_out;
	}
	m->frame = frame;
	if (frame > room->warm)
		room->sent_ns[DELIVERY_FDP][frame - room->warm - 1] = now();
	fdp_master_begin(m->end.fdp, m->end.state, frame, now());
	net_flush(m->end.net);
	m->next_ns += room->cluster.period_ns;
	if (m->next_ns < now())
		m->next_ns = now();
}

/* Between the frames: bare ones half a period later, signed ones three quarters. */
static void send_bare(struct master_end *m, int64_t *until_ns)
{
	struct delivery_room *room = m->room;
	const int64_t period_ns = room->cluster.period_ns;

	if (m->frame <= room->warm)
		return;
	for (int way = DELIVERY_BARE; way < DELIVERY_FDP; way++) {
		struct bare *bare = &m->bare[way];

		if (bare->sent == room->updates)
			continue;
		if (!bare->next_ns)
			bare->next_ns = now() + period_ns / 2 + way * period_ns / 4;
		if (now() >= bare->next_ns) {
			delivery_send_bare(room, m->end.net, (enum delivery_way)way, bare->sent++);
			bare->next_ns += period_ns;
		}
		*until_ns = bare->next_ns < *until_ns ? bare->next_ns : *until_ns;
	}
}

static bool all_sent(const struct master_end *m)
{
	const unsigned updates = m->room->updates;

	return m->frame >= m->room->warm + updates && m->bare[DELIVERY_BARE].sent == updates &&
	       m->bare[DELIVERY_SIGNED].sent == updates;
}

static void master_run(struct master_end *m)
{
	struct delivery_room *room = m->room;
	const uint64_t last = room->warm + room->updates;
	const int64_t give_up_ns = now() + 20 * GR_NS_PER_S + (int64_t)last * room->cluster.period_ns * 4;
	int fds[2];

	net_fds(m->end.net, fds);
	while (now() < give_up_ns) {
		const bool idle = fdp_master_idle(m->end.fdp);
		const bool present = fdp_master_present(m->end.fdp) == room->cluster.node_count;
		int64_t until_ns = fdp_master_next(m->end.fdp);

		if (idle && all_sent(m))
			break;
		if (!present)
			m->next_ns = now();
		else if (idle && m->frame < last && now() >= m->next_ns)
			begin(m);
		send_bare(m, &until_ns);
		if (now() >= fdp_master_next(m->end.fdp))
			fdp_master_tick(m->end.fdp, now());
		net_flush(m->end.net);
		if (present && fdp_master_idle(m->end.fdp) && m->frame < last && m->next_ns < until_ns)
			until_ns = m->next_ns;
		cluster_wait(m->end.net, until_ns);
		net_receive(m->end.net, fds[0], RECEIVE_MOST, master_datagram, m);
		net_flush(m->end.net);
	}
}

void delivery_master(struct delivery_room *room)
{
	struct master_end m = {
		.end.cluster = &room->cluster, .room = room, .random = room->cluster.session,
		.runs.random = room->cluster.session * 1000 + 999,
	};
	const struct fdp_master_params params = { .deadline_ns = DEADLINE_NS, .evict_frames = 1000,
						  .parity = room->parity };
	struct fdp_counters c;

	if (cluster_master_open(&m.end, params, master_event)) {
		master_run(&m);
		fdp_master_counters(m.end.fdp, &c);
		room->bytes_out = c.bytes_out - m.bytes_warm;
		if (m.frame < room->warm + room->updates)
			atomic_store(&room->cluster.failed, true);
	} else {
		atomic_store(&room->cluster.failed, true);
	}
	atomic_store(&room->cluster.over, true);
	cluster_master_close(&m.end);
}

struct node_end {
	struct cluster_node end; /* first: the protocol's ctx */
	struct delivery_room *room;
	uint64_t ready, swap; /* frames: to be said ready, to be shown */
	struct delivery_bare bare[DELIVERY_FDP];
	struct delivery_runs runs;
};

static void node_event(void *ctx, const struct fdp_node_event *event)
{
	struct node_end *n = ctx;

	if (event->kind == FDP_NODE_FRAME) {
		delivery_note(n->room, DELIVERY_FDP, n->end.index, event->frame - n->room->warm - 1);
		n->ready = event->frame;
	} else if (event->kind == FDP_NODE_SWAP) {
		n->swap = event->frame;
	}
}

static void node_datagram(void *ctx, const uint8_t *bytes, size_t len,
			  const struct net_address *from, int64_t arrived_ns)
{
	struct node_end *n = ctx;

	(void)from;
	if (delivery_lost(&n->room->loss, &n->runs))
		return;
	if (len >= FDP_HEADER_BYTES && delivery_take_bare(n->room, n->end.index, n->bare, bytes, len))
		return;
	fdp_node_arrived(n->end.fdp, arrived_ns);
	fdp_node_receive(n->end.fdp, bytes, len, now());
}

/* It draws nothing: what has come is ready at once. */
static void node_answer(struct node_end *n)
{
	if (n->ready) {
		const uint64_t frame = n->ready;

		n->ready = 0;
		fdp_node_ready(n->end.fdp, frame, 0, now());
	}
	if (n->swap) {
		const uint64_t frame = n->swap;

		n->swap = 0;
		fdp_node_swapped(n->end.fdp, frame, now(), now());
	}
	net_flush(n->end.net);
}

void delivery_node(struct delivery_room *room, unsigned node)
{
	struct node_end n = { .end = { .cluster = &room->cluster, .index = node }, .room = room,
			      .runs.random = room->cluster.session * 1000 + node };
	int fds[2], count;

	if (cluster_node_open(&n.end, node_event)) {
		count = net_fds(n.end.net, fds);
		while (!atomic_load(&room->cluster.over)) {
			if (now() >= fdp_node_next(n.end.fdp))
				fdp_node_tick(n.end.fdp, now());
			node_answer(&n);
			cluster_wait(n.end.net, fdp_node_next(n.end.fdp));
			for (int i = 0; i < count; i++) {
				net_receive(n.end.net, fds[i], RECEIVE_MOST, node_datagram, &n);
				node_answer(&n);
			}
		}
	} else {
		atomic_store(&room->cluster.failed, true);
	}
	cluster_node_close(&n.end);
}
