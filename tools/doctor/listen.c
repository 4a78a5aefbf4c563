/* Echoes through the daemons' own sockets: what arrives here arrives there too. */
#include "tools/doctor/doctor.h"

#include "base/clock.h"
#include "base/result.h"
#include "tools/doctor/way.h"

#include <poll.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#define GROUP_PATIENCE_NS (600 * GR_NS_PER_MS)
#define GROUP_QUESTIONS 3
#define DATAGRAM_MOST 9000

struct listener {
	struct net *net;
	uint8_t nonce[ECHO_NONCE]; /* of our own questions */
	uint64_t answered;         /* bit per node */
	uint64_t echoes;
};

/* Never more than came, and once each: no use to who wants to have others flooded. */
static void turn_back(void *ctx, const uint8_t *bytes, size_t len, const struct net_address *from,
		      int64_t arrived_ns)
{
	struct listener *l = ctx;
	uint8_t answer[DATAGRAM_MOST];

	(void)arrived_ns;
	if (len > sizeof answer)
		return;
	memcpy(answer, bytes, len);
	if (!echo_turn(answer, len))
		return;
	net_send_to(l->net, from, answer, len);
	l->echoes++;
}

static void note_answer(void *ctx, const uint8_t *bytes, size_t len, const struct net_address *from,
			int64_t arrived_ns)
{
	struct listener *l = ctx;
	int node = net_peer(l->net, from);

	(void)arrived_ns;
	if (node >= 0 && echo_answers(bytes, len, l->nonce))
		l->answered |= UINT64_C(1) << node;
}

static void serve(struct listener *l, int64_t until_ns, net_receive_fn fn)
{
	int fds[2], count = net_fds(l->net, fds);

	for (;;) {
		struct pollfd polls[2] = { { fds[0], POLLIN, 0 }, { fds[1], POLLIN, 0 } };
		int64_t left = until_ns - gr_clock_now(&gr_clock_monotonic);

		if (left <= 0)
			return;
		poll(polls, (nfds_t)count, (int)(left / GR_NS_PER_MS) + 1);
		for (int i = 0; i < count; i++)
			net_receive(l->net, fds[i], 64, fn, l);
		net_flush(l->net);
	}
}

int doctor_listen(const struct layout *layout, int node, int seconds)
{
	struct listener l = { 0 };
	int r = node < 0 ? net_open_master(&l.net, layout, doctor_master(layout)) : net_open_node(&l.net, layout, (size_t)node);

	if (r < 0)
		return r;
	printf("answering the doctors of the other machines for %d s\n", seconds);
	fflush(stdout);
	serve(&l, gr_clock_now(&gr_clock_monotonic) + seconds * GR_NS_PER_S, turn_back);
	printf("%llu echoes\n", (unsigned long long)l.echoes);
	net_close(&l.net);
	return GR_OK;
}

int doctor_ask_group(const struct layout *layout, uint64_t *out_answered)
{
	size_t len = net_datagram_max(&layout->network);
	uint8_t bytes[DATAGRAM_MOST];
	struct listener l = { 0 };
	int r = len > sizeof bytes ? GR_ERR_RANGE : net_open_master(&l.net, layout, doctor_master(layout));

	*out_answered = 0;
	if (r < 0)
		return r;
	randombytes_buf(l.nonce, sizeof l.nonce);
	echo_make(bytes, len, l.nonce);
	for (int i = 0; i < GROUP_QUESTIONS; i++) {
		net_send(l.net, NET_TO_GROUP, bytes, len);
		net_flush(l.net);
		serve(&l, gr_clock_now(&gr_clock_monotonic) + GROUP_PATIENCE_NS / GROUP_QUESTIONS, note_answer);
	}
	*out_answered = l.answered;
	net_close(&l.net);
	return GR_OK;
}
