/*
 * Pieces of the light that wait: what a node asks for, and what there is too much of to
 * be passed on at once. They leave beside the frames, a little at a time (FDP_BULK_TICK),
 * to each node as its bucket and its window let them, in turns. Shortly before a frame is due
 * they rest, so that its delta finds an empty wire.
 */
#include "protocol/master_private.h"

#include "base/result.h"

#include <stdlib.h>
#include <string.h>

/* Pieces of one slice that one node, or the group, is to have. */
struct fdp_want {
	uint64_t frame; /* of the slice; 0: nothing */
	unsigned left;
	uint64_t bits[FDP_SLICE_PIECES_MAX / 64];
};

int fdp_master_bulk_init(struct fdp_master *m)
{
	const size_t nodes = m->params.node_count;

	if (!m->params.share_bytes)
		return GR_OK;
	m->wants = calloc((nodes + 1) * nodes, sizeof *m->wants);
	return m->wants ? GR_OK : GR_ERR_NOMEM;
}

void fdp_master_bulk_finish(struct fdp_master *m)
{
	free(m->wants);
	m->wants = NULL;
}

/* The group stands after the nodes. */
static struct fdp_want *want_at(const struct fdp_master *m, size_t to, unsigned index)
{
	return &m->wants[to * m->params.node_count + index];
}

static void forget(struct fdp_master *m, struct fdp_want *want)
{
	m->wanted -= want->left;
	memset(want, 0, sizeof *want);
}

void fdp_master_bulk_forget(struct fdp_master *m)
{
	const size_t nodes = m->params.node_count;

	for (size_t i = 0; m->wanted && i < (nodes + 1) * nodes; i++)
		if (m->wants[i].left)
			forget(m, &m->wants[i]);
}

static bool wanted(const struct fdp_want *want, uint64_t frame, unsigned piece)
{
	return want->frame == frame && want->bits[piece / 64] >> piece % 64 & 1;
}

bool fdp_master_waits(const struct fdp_master *m, unsigned node, unsigned index, uint64_t frame,
		      unsigned piece)
{
	return wanted(want_at(m, node, index), frame, piece) ||
	       wanted(want_at(m, m->params.node_count, index), frame, piece);
}

void fdp_master_want_piece(struct fdp_master *m, int to, unsigned index, uint64_t frame,
			   unsigned piece)
{
	struct fdp_want *want = want_at(m, to < 0 ? m->params.node_count : (size_t)to, index);

	if (frame < want->frame || wanted(want, frame, piece))
		return;
	if (frame > want->frame) {
		forget(m, want); /* the newer one takes its place */
		want->frame = frame;
	}
	want->bits[piece / 64] |= UINT64_C(1) << piece % 64;
	want->left++;
	m->wanted++;
}

static unsigned take_first(struct fdp_master *m, struct fdp_want *want)
{
	unsigned word = 0, piece;

	while (!want->bits[word])
		word++;
	piece = word * 64 + (unsigned)__builtin_ctzll(want->bits[word]);
	want->bits[word] &= want->bits[word] - 1;
	want->left--;
	m->wanted--;
	return piece;
}

/* Bytes sent; 0: not now. */
static size_t send_one(struct fdp_master *m, size_t to, unsigned index)
{
	const bool group = to == m->params.node_count;
	const struct fdp_slice *slice =
		fdp_share_find(&m->share, index, want_at(m, to, index)->frame);
	struct fdp_want *want = want_at(m, to, index);
	size_t len = (size_t)FDP_PIECE_HEAD + (slice ? slice->chunk : 0);

	if (!slice || (!group && !fdp_master_takes_slices(m, (unsigned)to))) {
		forget(m, want);
		return 0;
	}
	if (group ? !fdp_master_bulk_to_all(m, len) : !fdp_master_bulk(m, (unsigned)to, len))
		return 0;
	len = fdp_share_write(&m->share, index, slice, take_first(m, want),
			      fdp_outbox_body(&m->out), m->out.datagram_max - FDP_HEADER_BYTES);
	if (!len)
		return 0;
	fdp_outbox_send(&m->out, group ? FDP_TO_GROUP : (int)to, FDP_SLICE, len);
	return len;
}

static bool rests(const struct fdp_master *m, int64_t now_ns)
{
	return !m->underway && now_ns >= m->due_ns - FDP_BULK_REST_NS &&
	       now_ns < m->due_ns + FDP_BULK_REST_NS;
}

void fdp_master_bulk_tick(struct fdp_master *m, int64_t now_ns)
{
	const size_t places = (m->params.node_count + 1) * m->params.node_count;
	size_t idle = 0, sent = 0;

	if (!m->wanted || now_ns < m->bulk_at_ns)
		return;
	if (rests(m, now_ns)) {
		m->bulk_at_ns = m->due_ns + FDP_BULK_REST_NS;
		return;
	}
	while (m->wanted && idle < places && sent < m->bulk_tick_bytes) {
		const size_t place = m->want_next++ % places, nodes = m->params.node_count;
		const size_t len = m->wants[place].left
					   ? send_one(m, place / nodes, (unsigned)(place % nodes))
					   : 0;

		idle = len ? 0 : idle + 1;
		sent += len;
	}
	/* Who waits for a node to read need not look so often. */
	m->bulk_at_ns = now_ns + (sent ? 1 : 4) * FDP_BULK_TICK_NS;
}

int64_t fdp_master_bulk_next(const struct fdp_master *m)
{
	return m->wanted ? m->bulk_at_ns : INT64_MAX;
}
