#include <config.h> /* ppoll */

#include "tools/bench/delivery.h"

#include "base/clock.h"
#include "base/cursor.h"
#include "protocol/message.h"
#include "tools/bench/cluster_ends.h"

#include <poll.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

#define RECEIVE_MOST 256
#define LOOK_NS (20 * GR_NS_PER_MS) /* how often an end looks whether the run is over */
#define BARE_HEAD 12
#define BALLAST_WORDS_MOST (UINT16_MAX / 4) /* the size of a parameter has 16 bits */
#define DEADLINE_NS (33 * GR_NS_PER_MS)

static const uint8_t bare_magic[4] = { 'B', 'A', 'R', 'E' };
extern char **environ;

static int64_t now(void)
{
	return gr_clock_now(&gr_clock_monotonic);
}

bool delivery_lose(unsigned permille)
{
	char rules[320], *words[] = { (char *)"nft", rules, NULL };
	int status, len;
	pid_t pid;

	len = snprintf(rules, sizeof rules, "add table netdev loss; delete table netdev loss");
	if (permille)
		snprintf(rules + len, sizeof rules - (size_t)len,
			 "; add table netdev loss; add chain netdev loss in { type filter hook ingress "
			 "device \"eth0\" priority 0; }; add rule netdev loss in ip protocol udp numgen "
			 "random mod 1000 < %u drop", permille);
	return !posix_spawnp(&pid, words[0], NULL, NULL, words, environ) &&
	       waitpid(pid, &status, 0) == pid && WIFEXITED(status) && !WEXITSTATUS(status);
}

/* Until something can be read or the time has come. */
static void wait_for(struct net *net, int64_t until_ns)
{
	struct pollfd fds[2];
	int raw[2];
	const int count = net_fds(net, raw);
	int64_t left_ns = until_ns - now();
	struct timespec ts;

	left_ns = left_ns < 0 ? 0 : left_ns > LOOK_NS ? LOOK_NS : left_ns;
	ts = (struct timespec){ .tv_nsec = (long)left_ns };
	for (int i = 0; i < count; i++)
		fds[i] = (struct pollfd){ .fd = raw[i], .events = POLLIN };
	ppoll(fds, (nfds_t)count, &ts, NULL);
}

struct master_end {
	struct cluster_master end; /* first: the protocol's ctx */
	struct delivery_room *room;
	uint64_t random;
	uint64_t frame;
	unsigned bare;
	int64_t next_ns, next_bare_ns;
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

/* The floor: the same bytes in datagrams that nobody acknowledges, half a period later. */
static void send_bare(struct master_end *m)
{
	struct delivery_room *room = m->room;
	static uint8_t bytes[FDP_DATAGRAM_MAX];
	const size_t most = net_datagram_max(&room->cluster.layout.network);
	const size_t count = (room->update_bytes + most - 1) / most;

	room->sent_ns[DELIVERY_BARE][m->bare] = now();
	for (size_t i = 0; i < count; i++) {
		const size_t left = room->update_bytes - i * most, len = left < most ? left : most;
		struct gr_writer w = gr_writer(bytes, sizeof bytes);

		gr_write_bytes(&w, bare_magic, sizeof bare_magic);
		gr_write_u32(&w, m->bare);
		gr_write_u32(&w, (uint32_t)count);
		net_send(m->end.net, room->cluster.layout.network.cast == LAYOUT_MULTICAST ? FDP_TO_GROUP : FDP_TO_ALL,
			 bytes, len < BARE_HEAD ? BARE_HEAD : len);
	}
	net_flush(m->end.net);
	m->bare++;
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

		if (m->frame >= last && m->bare >= room->updates && idle)
			break;
		if (!present)
			m->next_ns = now();
		else if (idle && m->frame < last && now() >= m->next_ns)
			begin(m);
		if (m->frame > room->warm && m->bare < room->updates) {
			if (!m->next_bare_ns)
				m->next_bare_ns = now() + room->cluster.period_ns / 2;
			if (now() >= m->next_bare_ns) {
				send_bare(m);
				m->next_bare_ns += room->cluster.period_ns;
			}
			until_ns = m->next_bare_ns < until_ns ? m->next_bare_ns : until_ns;
		}
		if (now() >= fdp_master_next(m->end.fdp))
			fdp_master_tick(m->end.fdp, now());
		net_flush(m->end.net);
		if (present && fdp_master_idle(m->end.fdp) && m->frame < last && m->next_ns < until_ns)
			until_ns = m->next_ns;
		wait_for(m->end.net, until_ns);
		net_receive(m->end.net, fds[0], RECEIVE_MOST, master_datagram, m);
		net_flush(m->end.net);
	}
}

void delivery_master(struct delivery_room *room)
{
	struct master_end m = {
		.end.cluster = &room->cluster, .room = room, .random = room->cluster.session,
	};
	const struct fdp_master_params params = { .deadline_ns = DEADLINE_NS, .evict_frames = 1000 };
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
	uint32_t bare, bare_have;
};

static void note(struct node_end *n, enum delivery_way way, uint64_t update)
{
	if (update < n->room->updates)
		n->room->arrived_ns[way][(size_t)n->end.index * n->room->updates + update] = now();
}

static void node_event(void *ctx, const struct fdp_node_event *event)
{
	struct node_end *n = ctx;

	if (event->kind == FDP_NODE_FRAME) {
		note(n, DELIVERY_FDP, event->frame - n->room->warm - 1);
		n->ready = event->frame;
	} else if (event->kind == FDP_NODE_SWAP) {
		n->swap = event->frame;
	}
}

static void take_bare(struct node_end *n, const uint8_t *bytes, size_t len)
{
	struct gr_reader r = gr_reader(bytes + sizeof bare_magic, len - sizeof bare_magic);
	const uint32_t update = gr_read_u32(&r), count = gr_read_u32(&r);

	if (update != n->bare || !n->bare_have) {
		n->bare = update;
		n->bare_have = 0;
	}
	if (++n->bare_have == count) {
		note(n, DELIVERY_BARE, update);
		n->bare_have = 0;
	}
}

static void node_datagram(void *ctx, const uint8_t *bytes, size_t len,
			  const struct net_address *from, int64_t arrived_ns)
{
	struct node_end *n = ctx;

	(void)from;
	if (len >= BARE_HEAD && !memcmp(bytes, bare_magic, sizeof bare_magic)) {
		take_bare(n, bytes, len);
		return;
	}
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
	struct node_end n = { .end = { .cluster = &room->cluster, .index = node }, .room = room };
	int fds[2], count;

	if (cluster_node_open(&n.end, node_event)) {
		count = net_fds(n.end.net, fds);
		while (!atomic_load(&room->cluster.over)) {
			if (now() >= fdp_node_next(n.end.fdp))
				fdp_node_tick(n.end.fdp, now());
			node_answer(&n);
			wait_for(n.end.net, fdp_node_next(n.end.fdp));
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
