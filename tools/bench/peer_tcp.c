/* TCP, a connection to each, Nagle's algorithm off: an update behind its length. */
#include <config.h> /* accept4 */

#include "tools/bench/peer.h"

#include "base/cursor.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define HEAD 4
#define BUFFER (4 << 20) /* what the wire does not take for a while must fit */

struct tcp {
	struct peer_place place;
	int fd; /* sender: that listens; receiver: connected, or -1 */
	int nodes[CLUSTER_NODES_MOST];
	unsigned count;
	size_t have;     /* of the update that is coming, its head included */
	uint8_t bytes[]; /* HEAD + update_bytes */
};

static struct sockaddr_in sender_address(const struct peer_place *place)
{
	struct sockaddr_in at = { .sin_family = AF_INET, .sin_port = htons(place->port) };

	inet_pton(AF_INET, place->cluster->addresses[place->cluster->node_count], &at.sin_addr);
	return at;
}

static void set_options(int fd)
{
	const int one = 1, size = BUFFER;

	setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
	setsockopt(fd, SOL_SOCKET, SO_SNDBUFFORCE, &size, sizeof size);
	setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &size, sizeof size);
}

static int listening(const struct peer_place *place)
{
	const struct sockaddr_in at = sender_address(place);
	const int one = 1, fd = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);

	if (fd < 0)
		return -1;
	setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
	if (bind(fd, (const struct sockaddr *)&at, sizeof at) < 0 || listen(fd, CLUSTER_NODES_MOST) < 0) {
		close(fd);
		return -1;
	}
	return fd;
}

static void *tcp_open(const struct peer_place *place)
{
	struct tcp *t = calloc(1, sizeof *t + HEAD + place->update_bytes);

	if (!t)
		return NULL;
	t->place = *place;
	t->fd = place->sender ? listening(place) : -1;
	if (place->sender && t->fd < 0) {
		fprintf(stderr, "TCP: port %u: %s\n", place->port, strerror(errno));
		free(t);
		return NULL;
	}
	return t;
}

static void tcp_close(void *end)
{
	struct tcp *t = end;

	for (unsigned i = 0; i < t->count; i++)
		close(t->nodes[i]);
	if (t->fd >= 0)
		close(t->fd);
	free(t);
}

/* All of it: where the buffer is full the sender waits, as TCP wants it to. */
static void write_whole(int fd, const uint8_t *bytes, size_t len)
{
	while (len) {
		const ssize_t n = send(fd, bytes, len, MSG_NOSIGNAL | MSG_DONTWAIT);
		struct pollfd out = { .fd = fd, .events = POLLOUT };

		if (n > 0) {
			bytes += n;
			len -= (size_t)n;
		} else if (errno != EAGAIN || poll(&out, 1, 1000) <= 0) {
			return; /* it is gone */
		}
	}
}

static bool tcp_send(void *end, const uint8_t *bytes, size_t len)
{
	struct tcp *t = end;
	struct gr_writer w = gr_writer(t->bytes, HEAD + t->place.update_bytes);

	gr_write_u32(&w, (uint32_t)len);
	gr_write_bytes(&w, bytes, len);
	for (unsigned i = 0; w.ok && i < t->count; i++)
		write_whole(t->nodes[i], t->bytes, w.len);
	return true;
}

/* Loss may delay it, but the kernel tries again for a minute and more. */
static bool connect_receiver(struct tcp *t)
{
	const struct sockaddr_in at = sender_address(&t->place);
	const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

	if (fd < 0)
		return false;
	set_options(fd);
	if (connect(fd, (const struct sockaddr *)&at, sizeof at) < 0) {
		close(fd);
		return false;
	}
	fcntl(fd, F_SETFL, O_NONBLOCK);
	t->fd = fd;
	return true;
}

static void read_updates(struct tcp *t, peer_take_fn *take, void *ctx)
{
	for (;;) {
		struct gr_reader r = gr_reader(t->bytes, HEAD);
		const size_t len = gr_read_u32(&r);
		const size_t want = t->have < HEAD ? HEAD : HEAD + len;
		ssize_t n;

		if (want > HEAD + t->place.update_bytes)
			return;
		n = recv(t->fd, t->bytes + t->have, want - t->have, 0);
		if (n <= 0)
			return;
		t->have += (size_t)n;
		if (t->have > HEAD && t->have == want) {
			take(ctx, t->bytes + HEAD, len);
			t->have = 0;
		}
	}
}

static void tcp_serve(void *end, int64_t until_ns, peer_take_fn *take, void *ctx)
{
	struct tcp *t = end;

	if (t->fd < 0 && !connect_receiver(t)) {
		peer_wait(NULL, 0, until_ns);
		return;
	}
	peer_wait(&t->fd, 1, until_ns);
	if (!t->place.sender) {
		read_updates(t, take, ctx);
		return;
	}
	while (t->count < t->place.node) {
		const int fd = accept4(t->fd, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC);

		if (fd < 0)
			break;
		set_options(fd);
		t->nodes[t->count++] = fd;
	}
}

const struct peer peer_tcp = { "TCP, no delay", tcp_open, tcp_close, tcp_send, tcp_serve };
