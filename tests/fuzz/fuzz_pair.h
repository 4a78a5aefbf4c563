/*
 * A master and its two nodes, joined, with a frame under way: what the
 * datagram fuzzers start from. Time passes by steps; no sockets.
 */
#ifndef GROTTO_TESTS_FUZZ_PAIR_H
#define GROTTO_TESTS_FUZZ_PAIR_H

#include "protocol/master_private.h"
#include "protocol/node_private.h"

#include "base/cursor.h"

#include <stdlib.h>
#include <string.h>

#define FUZZ_SESSION 77
#define FUZZ_QUEUE 512

struct fuzz_pair {
	struct fdp_master *master;
	struct fdp_node *nodes[2];
	struct param_state *state;
	uint64_t frame;
	int64_t now_ns;
	struct {
		int to; /* -1: the master */
		size_t len;
		uint8_t bytes[1472];
	} queue[FUZZ_QUEUE];
	size_t count;
};

struct fuzz_end {
	struct fuzz_pair *pair;
	int index;
};

static void fuzz_queue(struct fuzz_pair *p, int to, const uint8_t *bytes, size_t len)
{
	if (len > sizeof p->queue[0].bytes)
		abort();
	if (p->count == FUZZ_QUEUE)
		return; /* a full socket buffer */
	p->queue[p->count].to = to;
	p->queue[p->count].len = len;
	memcpy(p->queue[p->count++].bytes, bytes, len);
}

static void fuzz_master_send(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	for (int i = 0; i < 2; i++)
		if (to < 0 || to == i)
			fuzz_queue(ctx, i, bytes, len);
}

static void fuzz_master_event(void *ctx, const struct fdp_master_event *event)
{
	(void)ctx;
	if (event->reason && strlen(event->reason) >= FDP_REASON_MAX)
		abort();
}

static void fuzz_node_send(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	(void)to;
	fuzz_queue(ctx, -1, bytes, len);
}

static void fuzz_node_event(void *ctx, const struct fdp_node_event *event)
{
	(void)ctx;
	if (event->reason && strlen(event->reason) >= FDP_REASON_MAX)
		abort();
}

/* Everything queued so far, on exact-size copies; answers wait for the next call. */
static void fuzz_deliver(struct fuzz_pair *p)
{
	const size_t count = p->count;

	for (size_t i = 0; i < count; i++) {
		uint8_t *exact = malloc(p->queue[i].len);

		if (!exact)
			abort();
		memcpy(exact, p->queue[i].bytes, p->queue[i].len);
		if (p->queue[i].to < 0)
			fdp_master_receive(p->master, exact, p->queue[i].len, p->now_ns, NULL);
		else
			fdp_node_receive(p->nodes[p->queue[i].to], exact, p->queue[i].len, p->now_ns);
		free(exact);
	}
	memmove(p->queue, p->queue + count, (p->count - count) * sizeof *p->queue);
	p->count -= count;
}

static void fuzz_take_slice(void *ctx, const uint8_t *bytes, size_t len)
{
	volatile uint8_t sum = 0;

	(void)ctx;
	if (!len || len > 2048)
		abort();
	for (size_t i = 0; i < len; i++)
		sum = (uint8_t)(sum + bytes[i]);
}

/* As a daemon does with its part of the light. */
static void fuzz_light(struct fuzz_pair *p, int i)
{
	struct fdp_node *n = p->nodes[i];
	static const uint8_t slice[900] = { 1, 2, 3 };

	fdp_node_slices(n, n->current.frame, fuzz_take_slice, NULL);
	fdp_node_slice(n, n->current.frame, slice, sizeof slice, p->now_ns);
}

static void fuzz_tick(struct fuzz_pair *p, int64_t ns)
{
	p->now_ns += ns;
	fdp_master_tick(p->master, p->now_ns);
	for (int i = 0; i < 2; i++) {
		fdp_node_tick(p->nodes[i], p->now_ns);
		fuzz_light(p, i);
		fdp_node_ready(p->nodes[i], p->nodes[i]->current.frame, 1, p->now_ns);
	}
}

static void fuzz_begin(struct fuzz_pair *p)
{
	const float head[3] = { (float)(p->frame % 100), 1, 2 };

	if (!fdp_master_idle(p->master))
		return;
	p->frame++;
	param_set(p->state, PARAM_HEAD_POSITION, head, p->frame);
	fdp_master_begin(p->master, p->state, p->frame, p->now_ns);
}

static void fuzz_pair_start(struct fuzz_pair *p, size_t datagram_max)
{
	static const char *const names[] = { "left", "right" };
	const struct fdp_master_ops master_ops = { .send = fuzz_master_send, .event = fuzz_master_event,
						   .ctx = p };
	const struct fdp_node_ops node_ops = { fuzz_node_send, fuzz_node_event, p };
	const struct fdp_master_params master = {
		.session = FUZZ_SESSION, .key = { 1 }, .node_names = names, .node_count = 2,
		.datagram_max = datagram_max, .deadline_ns = 33000000, .evict_frames = 3,
		.multicast = true, .share_bytes = 4096, .masters = 2, .heartbeat_ns = 20000000,
	};

	p->frame = p->count = 0;
	p->now_ns = 1000000000;
	if (fdp_master_create(&p->master, &master, &master_ops) || param_state_create(&p->state))
		abort();
	for (uint16_t i = 0; i < 2; i++) {
		const struct fdp_node_params node = {
			.index = i, .name = names[i], .key = { 1 }, .datagram_max = datagram_max,
			.share_bytes = 4096, .masters = 2, .call_ns = 80000000,
		};
		if (fdp_node_create(&p->nodes[i], &node, &node_ops))
			abort();
	}
	for (int i = 0; i < 4; i++) {
		fuzz_tick(p, 1000000);
		fuzz_deliver(p);
	}
	fuzz_begin(p);
	fuzz_deliver(p);
	fuzz_deliver(p);
}

static __attribute__((unused)) void fuzz_pair_stop(struct fuzz_pair *p)
{
	fdp_master_destroy(&p->master);
	fdp_node_destroy(&p->nodes[0]);
	fdp_node_destroy(&p->nodes[1]);
	param_state_destroy(&p->state);
}

/*
 * The next datagram of the input: a byte that says which fields are put right
 * (and whether the payload has 256 bytes more), 48 bytes of header, the
 * payload's length and the payload. Signed as its kind
 * wants it, since the keys are known here. Returns its length, 0 at the end of
 * the input.
 */
static __attribute__((unused)) size_t fuzz_next(struct fuzz_pair *p, struct gr_reader *r, uint8_t *bytes, size_t size,
			uint16_t sender, uint64_t *sequence)
{
	const uint8_t right = gr_read_u8(r);
	const uint8_t *header = gr_read_bytes(r, FDP_MAC_AT);
	size_t len = gr_read_u8(r) + (right & 16 ? 256u : 0);
	const uint8_t *payload;
	struct gr_writer w = gr_writer(bytes, FDP_MAC_AT);

	len = len > gr_reader_left(r) ? gr_reader_left(r) : len;
	payload = gr_read_bytes(r, len);
	if (!header || !payload || FDP_HEADER_BYTES + len > size)
		return 0;
	memcpy(bytes, header, FDP_MAC_AT);
	memcpy(bytes + FDP_HEADER_BYTES, payload, len);
	if (right & 1) {
		gr_write_bytes(&w, "GFDP", 4);
		gr_write_u8(&w, FDP_VERSION);
		gr_write_u8(&w, header[5] % FDP_KINDS);
		gr_write_u8(&w, header[6] & 7);
		gr_write_u8(&w, 0);
		gr_write_u16(&w, sender);
		gr_write_u16(&w, (uint16_t)len);
	}
	w.len = 12;
	if (right & 2) {
		gr_write_u16(&w, 0);
		gr_write_u16(&w, 1);
	}
	w.len = 16;
	if (right & 4)
		gr_write_u64(&w, FUZZ_SESSION);
	w.len = 24;
	if (right & 8)
		gr_write_u64(&w, ++*sequence);
	w.len = 40;
	if (right & 2) {
		gr_write_u32(&w, (uint32_t)len);
		gr_write_u32(&w, (uint32_t)len);
	}
	fdp_wire_sign(1u << bytes[5] % 32 & FDP_HANDSHAKE ? p->master->params.key
		      : sender == FDP_SENDER_MASTER	   ? p->master->key_to_nodes
							   : p->master->node_keys[sender],
		      bytes, FDP_HEADER_BYTES + len);
	return FDP_HEADER_BYTES + len;
}

#endif
