/*
 * A run of a peer: an update every period, whether the one before has come or not.
 * The time begins before the peer is given it. Update 0 goes until all nodes are there,
 * for as many updates as are warm, and does not count.
 */
#include "tools/bench/delivery.h"

#include "base/clock.h"
#include "base/cursor.h"

#include <stdlib.h>

#define JOIN_NS (20 * GR_NS_PER_S)  /* for all nodes to be there */
#define AFTER_NS (2 * GR_NS_PER_S)  /* for what is still under way when the last was sent */

static int64_t now(void)
{
	return gr_clock_now(&gr_clock_monotonic);
}

static struct peer_place place_of(const struct delivery_room *room, bool sender, unsigned node)
{
	const struct bench_cluster *c = &room->cluster;

	return (struct peer_place){
		.cluster = c, .sender = sender, .node = sender ? c->node_count : node,
		.port = (uint16_t)(c->bench->port + 200 + 10 * room->way),
		.update_bytes = room->update_bytes,
	};
}

struct sender {
	struct delivery_room *room;
	const struct peer *peer;
	void *end;
	uint8_t *bytes;
	uint64_t random;
	int64_t next_ns;
};

static void nothing(void *ctx, const uint8_t *bytes, size_t len)
{
	(void)ctx;
	(void)bytes;
	(void)len;
}

/* All of it is new, and does not pack. */
static void send_update(struct sender *s, uint32_t number)
{
	const size_t len = s->room->update_bytes;
	struct gr_writer w = gr_writer(s->bytes, len);

	gr_write_u32(&w, number);
	while (w.len + 4 <= len) {
		s->random = s->random * UINT64_C(6364136223846793005) + 1;
		gr_write_u32(&w, (uint32_t)(s->random >> 32));
	}
	if (number)
		s->room->sent_ns[s->room->way][number - 1] = now();
	s->peer->send(s->end, s->bytes, len);
}

static void send_all(struct sender *s)
{
	struct delivery_room *room = s->room;
	const unsigned nodes = room->cluster.node_count;
	const int64_t join_by_ns = now() + JOIN_NS;
	unsigned warm = 0, sent = 0;
	int64_t over_ns = INT64_MAX;

	s->next_ns = now();
	while (now() < over_ns && atomic_load(&room->arrivals) < (unsigned long)nodes * room->updates) {
		const bool here = atomic_load(&room->here) == nodes;

		if (now() >= s->next_ns && sent < room->updates) {
			if (!here && now() > join_by_ns)
				break;
			send_update(s, here && warm >= room->warm ? ++sent : 0);
			warm++;
			s->next_ns += room->cluster.period_ns;
			if (sent == room->updates)
				over_ns = now() + AFTER_NS;
		}
		s->peer->serve(s->end, sent < room->updates ? s->next_ns : over_ns, nothing, NULL);
	}
}

void delivery_peer_sender(struct delivery_room *room)
{
	const struct peer_place place = place_of(room, true, 0);
	struct sender s = {
		.room = room, .peer = peers[room->way - DELIVERY_PEER],
		.random = room->cluster.session, .bytes = calloc(1, room->update_bytes),
	};

	s.end = s.bytes ? s.peer->open(&place) : NULL;
	if (s.end)
		send_all(&s);
	else
		atomic_store(&room->cluster.failed, true);
	atomic_store(&room->cluster.over, true);
	if (s.end)
		s.peer->close(s.end);
	free(s.bytes);
}

struct receiver {
	struct delivery_room *room;
	unsigned node;
	bool here;
};

static void take(void *ctx, const uint8_t *bytes, size_t len)
{
	struct receiver *n = ctx;
	struct gr_reader r = gr_reader(bytes, len);
	const uint32_t number = gr_read_u32(&r);

	if (!r.ok)
		return;
	if (!n->here)
		atomic_fetch_add(&n->room->here, 1);
	n->here = true;
	if (!number)
		return;
	delivery_note(n->room, n->room->way, n->node, number - 1);
	atomic_fetch_add(&n->room->arrivals, 1);
}

void delivery_peer_receiver(struct delivery_room *room, unsigned node)
{
	const struct peer_place place = place_of(room, false, node);
	const struct peer *peer = peers[room->way - DELIVERY_PEER];
	struct receiver n = { .room = room, .node = node };
	void *end = peer->open(&place);

	if (!end) {
		atomic_store(&room->cluster.failed, true);
		return;
	}
	while (!atomic_load(&room->cluster.over) && !atomic_load(&room->cluster.failed))
		peer->serve(end, INT64_MAX, take, &n);
	peer->close(end);
}
