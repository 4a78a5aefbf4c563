/* The ends of a room whose light is shared out and rests, as the daemons do it, with nothing to
 * draw. */
#include "tools/bench/rejoin.h"

#include "base/clock.h"
#include "base/cursor.h"
#include "base/result.h"
#include "tools/bench/cluster_ends.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

#define RECEIVE_MOST 256
#define DEADLINE_NS (33 * GR_NS_PER_MS)
#define SLICE_HEAD 12

static int64_t now(void)
{
	return gr_clock_now(&gr_clock_monotonic);
}

struct master_end {
	struct cluster_master end; /* first: the protocol's ctx */
	struct rejoin_room *room;
	uint64_t frame, bytes_back;
	int64_t next_ns;
};

static void master_event(void *ctx, const struct fdp_master_event *event)
{
	struct master_end *m = ctx;

	if (event->kind == FDP_MASTER_LATE && event->node != (int)REJOIN_VICTIM &&
	    event->frame < m->room->most)
		m->room->late[event->frame] = 1;
}

static void master_datagram(void *ctx, const uint8_t *bytes, size_t len,
			    const struct net_address *from, int64_t arrived_ns)
{
	struct master_end *m = ctx;

	(void)from;
	fdp_master_arrived(m->end.fdp, arrived_ns);
	fdp_master_receive(m->end.fdp, bytes, len, now(), NULL);
}

static uint64_t bytes_out(const struct master_end *m)
{
	struct fdp_counters c;

	fdp_master_counters(m->end.fdp, &c);
	return c.bytes_out;
}

static void begin(struct master_end *m)
{
	struct rejoin_room *room = m->room;
	const uint64_t frame = ++m->frame, time = frame * (uint64_t)room->cluster.period_ns;
	const float head[3] = { (float)sin((double)frame), 1.7f, 0 };

	param_set(m->end.state, PARAM_FRAME_TIME, &time, frame);
	param_set(m->end.state, PARAM_HEAD_POSITION, head, frame);
	room->begun_ns[frame] = now();
	fdp_master_begin(m->end.fdp, m->end.state, frame, now());
	m->next_ns += room->cluster.period_ns;
	if (m->next_ns < now())
		m->next_ns = now();
}

/* All nodes have all of the light since the victim is back. */
static bool all_whole(const struct rejoin_room *room)
{
	for (unsigned i = 0; i < room->cluster.node_count; i++)
		if (!atomic_load(&room->whole_ns[i]))
			return false;
	return true;
}

static void direct(struct master_end *m)
{
	struct rejoin_room *room = m->room;

	/* The light has come to rest in the frames that do not count. */
	if (!atomic_load(&room->dies_after) && all_whole(room))
		atomic_store(&room->dies_after, m->frame + REJOIN_WARM + room->quiet);
	if (atomic_load(&room->back_ns) && !m->bytes_back)
		m->bytes_back = bytes_out(m);
	if (atomic_load(&room->back_ns) && !atomic_load(&room->last) && all_whole(room)) {
		room->bulk_bytes = bytes_out(m) - m->bytes_back;
		atomic_store(&room->last, m->frame);
	}
}

static void master_run(struct master_end *m)
{
	struct rejoin_room *room = m->room;
	bool begun = false;
	int fds[2];

	net_fds(m->end.net, fds);
	while (!atomic_load(&room->last) && m->frame + 1 < room->most) {
		int64_t until_ns = fdp_master_next(m->end.fdp);

		direct(m);
		begun = begun || fdp_master_present(m->end.fdp) == room->cluster.node_count;
		if (!begun)
			m->next_ns = now();
		else if (fdp_master_idle(m->end.fdp) && now() >= m->next_ns)
			begin(m);
		if (now() >= fdp_master_next(m->end.fdp))
			fdp_master_tick(m->end.fdp, now());
		net_flush(m->end.net);
		if (begun && fdp_master_idle(m->end.fdp) && m->next_ns < until_ns)
			until_ns = m->next_ns;
		cluster_wait(m->end.net, until_ns);
		net_receive(m->end.net, fds[0], RECEIVE_MOST, master_datagram, m);
		net_flush(m->end.net);
	}
}

void rejoin_master(struct rejoin_room *room)
{
	struct master_end m = { .end.cluster = &room->cluster, .room = room };
	const struct fdp_master_params params = { .deadline_ns = DEADLINE_NS, .evict_frames = 3 };

	if (cluster_master_open(&m.end, params, master_event))
		master_run(&m);
	if (!atomic_load(&room->last))
		atomic_store(&room->cluster.failed, true);
	atomic_store(&room->cluster.over, true);
	cluster_master_close(&m.end);
}

struct node_end {
	struct cluster_node end; /* first: the protocol's ctx */
	struct rejoin_room *room;
	uint64_t ready, swap, swapped; /* frames: to be drawn, to be shown, shown */
	unsigned index, count;	       /* of the division; 0 of 0 before the first */
	uint64_t has;		       /* slices of it */
	bool made, back;	       /* ours is sent; the victim, come back */
	uint8_t *slice;
};

static void node_event(void *ctx, const struct fdp_node_event *event)
{
	struct node_end *n = ctx;

	if (event->kind == FDP_NODE_FRAME) {
		n->ready = event->frame;
		if (event->frame < n->room->most)
			n->room->applied_ns[n->end.index * n->room->most + event->frame] = now();
	} else if (event->kind == FDP_NODE_SWAP) {
		n->swap = event->frame;
	}
}

static void node_datagram(void *ctx, const uint8_t *bytes, size_t len,
			  const struct net_address *from, int64_t arrived_ns)
{
	struct node_end *n = ctx;

	(void)from;
	fdp_node_arrived(n->end.fdp, arrived_ns);
	fdp_node_receive(n->end.fdp, bytes, len, now());
}

static uint8_t light_byte(size_t at)
{
	return (uint8_t)(at * 7 + (at >> 8));
}

static void put(void *ctx, const uint8_t *bytes, size_t len)
{
	struct node_end *n = ctx;
	struct gr_reader r = gr_reader(bytes, len);
	const unsigned index = gr_read_u16(&r), count = gr_read_u16(&r);

	if (!r.ok || count != n->count || index >= count ||
	    len != n->room->cluster.share_bytes / count)
		abort(); /* the protocol promised what no slice is */
	for (size_t at = SLICE_HEAD; at < len; at += 997)
		if (bytes[at] != light_byte(at))
			abort();
	n->has |= UINT64_C(1) << index;
}

/* The head alone is new: making light is not what is measured. */
static size_t make_slice(const struct node_end *n)
{
	struct gr_writer w = gr_writer(n->slice, SLICE_HEAD);

	gr_write_u16(&w, (uint16_t)n->index);
	gr_write_u16(&w, (uint16_t)n->count);
	gr_write_u64(&w, 0);
	return n->room->cluster.share_bytes / n->count;
}

static void light(struct node_end *n, uint64_t frame)
{
	unsigned index, count;

	if (!fdp_node_division(n->end.fdp, &index, &count) || count < 2)
		return;
	if (index != n->index || count != n->count) {
		n->index = index;
		n->count = count;
		n->has = 0;
		n->made = false;
	}
	fdp_node_slices(n->end.fdp, frame, put, n);
	if (!n->made &&
	    fdp_node_slice(n->end.fdp, frame, n->slice, make_slice(n), now()) == GR_OK) {
		n->made = true;
		n->has |= UINT64_C(1) << index;
	}
	/* Once when the room begins, once when all are there again. */
	if (count == n->room->cluster.node_count && n->has == (UINT64_C(1) << count) - 1 &&
	    !atomic_load(&n->room->whole_ns[n->end.index]))
		atomic_store(&n->room->whole_ns[n->end.index], now());
}

static void node_answer(struct node_end *n)
{
	if (n->ready) {
		const uint64_t frame = n->ready;

		n->ready = 0;
		light(n, frame);
		fdp_node_ready(n->end.fdp, frame, 0, now());
	}
	if (n->swap) {
		n->swapped = n->swap;
		n->swap = 0;
		if (n->back && !atomic_load(&n->room->shows_ns))
			atomic_store(&n->room->shows_ns, now());
		fdp_node_swapped(n->end.fdp, n->swapped, now(), now());
	}
	net_flush(n->end.net);
}

/* Until the run is over, or the victim dies. */
static void node_run(struct node_end *n)
{
	struct rejoin_room *room = n->room;
	const bool may_die = n->end.index == REJOIN_VICTIM && !n->back;
	int fds[2];
	const int count = net_fds(n->end.net, fds);

	while (!atomic_load(&room->cluster.over)) {
		const uint64_t dies = atomic_load(&room->dies_after);

		if (may_die && dies && n->swapped >= dies)
			return;
		if (now() >= fdp_node_next(n->end.fdp))
			fdp_node_tick(n->end.fdp, now());
		node_answer(n);
		cluster_wait(n->end.net, fdp_node_next(n->end.fdp));
		for (int i = 0; i < count; i++) {
			net_receive(n->end.net, fds[i], RECEIVE_MOST, node_datagram, n);
			node_answer(n);
		}
	}
}

static void stay_away(struct rejoin_room *room)
{
	const int64_t until_ns = now() + REJOIN_AWAY * room->cluster.period_ns;

	while (now() < until_ns && !atomic_load(&room->cluster.over))
		nanosleep(&(struct timespec){ .tv_nsec = GR_NS_PER_MS }, NULL);
	for (unsigned i = 0; i < room->cluster.node_count; i++)
		atomic_store(&room->whole_ns[i], 0);
	atomic_store(&room->back_ns, now());
}

void rejoin_node(struct rejoin_room *room, unsigned node)
{
	const int lives = node == REJOIN_VICTIM ? 2 : 1;
	uint8_t *slice = malloc(room->cluster.share_bytes);

	for (size_t at = 0; slice && at < room->cluster.share_bytes; at++)
		slice[at] = light_byte(at);
	for (int life = 0; slice && life < lives && !atomic_load(&room->cluster.over); life++) {
		struct node_end n = { .end = { .cluster = &room->cluster, .index = node },
				      .room = room,
				      .back = life > 0,
				      .slice = slice };

		if (life > 0)
			stay_away(room);
		/* No LEAVE: it falls silent, as one that was killed. */
		if (cluster_node_open(&n.end, node_event))
			node_run(&n);
		else
			atomic_store(&room->cluster.failed, true);
		cluster_node_close(&n.end);
	}
	if (!slice)
		atomic_store(&room->cluster.failed, true);
	free(slice);
}
