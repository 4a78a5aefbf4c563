/* The network of a simulated cluster: datagrams under way, lost, late, twice, or queued on a link. */
#include "cluster_sim_private.h"

double sim_uniform(struct sim *s)
{
	return unit_random_range(&s->random, 0, 1);
}

static bool before(const struct sim_packet *a, const struct sim_packet *b)
{
	return a->at_ns != b->at_ns ? a->at_ns < b->at_ns : a->order < b->order;
}

static void heap_push(struct sim *s, struct sim_packet packet)
{
	size_t i = s->packet_count++;

	s->packet_most = s->packet_count > s->packet_most ? s->packet_count : s->packet_most;
	if (s->packet_count > s->packet_room) {
		s->packet_room = s->packet_room ? s->packet_room * 2 : 256;
		s->packets = realloc(s->packets, s->packet_room * sizeof *s->packets);
		assert_non_null(s->packets);
	}
	for (; i && before(&packet, &s->packets[(i - 1) / 2]); i = (i - 1) / 2)
		s->packets[i] = s->packets[(i - 1) / 2];
	s->packets[i] = packet;
}

struct sim_packet sim_packet_pop(struct sim *s)
{
	const struct sim_packet top = s->packets[0], last = s->packets[--s->packet_count];
	size_t i = 0;

	for (;;) {
		size_t child = 2 * i + 1;

		if (child >= s->packet_count)
			break;
		if (child + 1 < s->packet_count && before(&s->packets[child + 1], &s->packets[child]))
			child++;
		if (!before(&s->packets[child], &last))
			break;
		s->packets[i] = s->packets[child];
		i = child;
	}
	s->packets[i] = last;
	return top;
}

void sim_inject(struct sim *s, int to, const uint8_t *bytes, size_t len, int64_t delay_ns)
{
	heap_push(s, (struct sim_packet){ s->now_ns + delay_ns, s->order++, to, len,
					  unit_copy(bytes, len) });
}

static void set_bit(uint64_t *bits, int i, bool on)
{
	*bits = on ? *bits | UINT64_C(1) << i : *bits & ~(UINT64_C(1) << i);
}

/* The next datagram on a node's way, to it or from it: is it lost to a burst? */
static bool lost_in_burst(struct sim *s, int node, bool to)
{
	struct sim_bursts *b = &s->bursts;
	uint64_t *bad = to ? &b->bad_to : &b->bad_from, *last = to ? &b->last_to : &b->last_from;
	const bool was = *bad >> node & 1;
	const bool is = was ? sim_uniform(s) >= b->to_good : sim_uniform(s) < b->to_bad;
	const bool lost = is && sim_uniform(s) < b->lost;

	set_bit(bad, node, is);
	b->datagrams++;
	b->losses += lost;
	b->runs += lost && !(*last >> node & 1);
	set_bit(last, node, lost);
	return lost;
}

/* One receiver's copy of a datagram: lost, late, twice, as the dice fall. */
static void carry(struct sim *s, int to, int about, const uint8_t *bytes, size_t len,
		  int64_t queued_ns)
{
	const int copies = 1 + (s->duplicate > 0 && sim_uniform(s) < s->duplicate);

	if (s->nodes[about].cut)
		return;
	for (int i = 0; i < copies; i++) {
		uint8_t *copy;

		if (s->loss > 0 && sim_uniform(s) < s->loss)
			continue;
		if (s->bursts.to_bad > 0 && lost_in_burst(s, about, to >= 0))
			continue;
		copy = unit_copy(bytes, len);
		if (s->tamper && !s->tamper(s, to, copy, len)) {
			free(copy);
			continue;
		}
		heap_push(s, (struct sim_packet){
			s->now_ns + queued_ns + s->delay_ns + (to < 0 ? 0 : s->slow_ns) +
				(int64_t)((double)s->jitter_ns * sim_uniform(s)),
			s->order++, to, len, copy });
	}
}

/* Datagrams leave the master one after the other, each with its frame's 66 bytes. */
static void queue_on_link(struct sim *s, size_t len)
{
	if (s->link_free_ns < s->now_ns)
		s->link_free_ns = s->now_ns;
	s->link_free_ns += (int64_t)(len + 66) * s->byte_ns;
}

void sim_master_send(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct sim *s = ctx;

	assert_true(len <= s->datagram_max);
	assert_true(to != FDP_TO_GROUP || s->multicast);
	s->to_group += to == FDP_TO_GROUP;
	if (to == FDP_TO_GROUP)
		queue_on_link(s, len);
	for (int i = 0; i < (int)s->node_count; i++) {
		if (to != FDP_TO_ALL && to != i && (to != FDP_TO_GROUP || s->nodes[i].deaf))
			continue;
		if (to != FDP_TO_GROUP)
			queue_on_link(s, len);
		carry(s, i, i, bytes, len, s->byte_ns ? s->link_free_ns - s->now_ns : 0);
	}
}

void sim_node_send(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct sim_node *n = ctx;

	assert_int_equal(to, 0); /* there is one master */
	assert_true(len <= n->sim->datagram_max);
	carry(n->sim, -1, n->index, bytes, len, 0);
}
