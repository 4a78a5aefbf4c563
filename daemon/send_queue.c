#include "config.h" /* _GNU_SOURCE */

#include "daemon/send_queue.h"

#include "base/log.h"
#include "base/result.h"

#include <errno.h>
#include <netinet/udp.h>
#include <stdlib.h>
#include <string.h>

#ifndef UDP_SEGMENT
#define UDP_SEGMENT 103 /* linux/udp.h; not in every libc */
#endif

#define GSO_PARTS_MAX 64    /* UDP_MAX_SEGMENTS of the oldest kernel that has it */
#define GSO_BYTES_MAX 65000 /* with any header less than an IP packet can have */

struct send_queue {
	size_t datagram_max;
	bool gso; /* until the kernel, or the way, says no */
	struct send_stats stats;
	unsigned count;
	uint8_t *bytes; /* SEND_QUEUE * datagram_max */
	size_t len[SEND_QUEUE];
	int way[SEND_QUEUE];
	struct net_address to[SEND_QUEUE];
	/* Made at the flush. */
	unsigned messages;
	struct mmsghdr message[SEND_QUEUE];
	struct iovec iov[SEND_QUEUE];
	unsigned parts[SEND_QUEUE];
	union {
		char bytes[CMSG_SPACE(sizeof(uint16_t))];
		struct cmsghdr align;
	} control[SEND_QUEUE];
};

int send_queue_create(struct send_queue **out, size_t datagram_max)
{
	struct send_queue *q = calloc(1, sizeof *q);

	*out = q;
	if (!q)
		return GR_ERR_NOMEM;
	q->datagram_max = datagram_max;
	q->gso = true;
	q->bytes = malloc(SEND_QUEUE * datagram_max + 1);
	if (!q->bytes) {
		send_queue_destroy(out);
		return GR_ERR_NOMEM;
	}
	return GR_OK;
}

void send_queue_destroy(struct send_queue **queue)
{
	struct send_queue *q = *queue;

	*queue = NULL;
	if (!q)
		return;
	free(q->bytes);
	free(q);
}

unsigned send_queue_count(const struct send_queue *queue)
{
	return queue->count;
}

void send_queue_stats(const struct send_queue *queue, struct send_stats *out)
{
	*out = queue->stats;
}

void send_queue_set_gso(struct send_queue *queue, bool gso)
{
	queue->gso = gso;
}

void send_queue_add(struct send_queue *queue, int way, const struct net_address *to,
		    const uint8_t *bytes, size_t len)
{
	const unsigned i = queue->count++;

	memcpy(queue->bytes + i * queue->datagram_max, bytes, len);
	queue->len[i] = len;
	queue->way[i] = way;
	queue->to[i] = *to;
}

/*
 * From the first, the datagrams that may follow it in one buffer: to the same
 * address, as long as a datagram can be, the last perhaps shorter. Short ones
 * stay alone: what is sent twice against loss may not be lost as one.
 */
static unsigned find_parts(const struct send_queue *q, unsigned first, const bool *taken,
			   unsigned parts[GSO_PARTS_MAX])
{
	size_t total = q->len[first];
	unsigned n = 0;

	parts[n++] = first;
	if (!q->gso || q->way[first] == SEND_ALONE || q->len[first] < q->datagram_max)
		return n;
	for (unsigned i = first + 1; i < q->count && n < GSO_PARTS_MAX; i++) {
		if (taken[i] || q->way[i] != q->way[first])
			continue;
		total += q->len[i];
		/* What does not fit ends the buffer: nothing of one way overtakes. */
		if (!q->len[i] || total > GSO_BYTES_MAX)
			break;
		parts[n++] = i;
		if (q->len[i] < q->len[first])
			break;
	}
	return n;
}

static void set_segment(struct msghdr *header, void *control, size_t size, uint16_t segment)
{
	struct cmsghdr *c;

	header->msg_control = control;
	header->msg_controllen = size;
	c = CMSG_FIRSTHDR(header);
	c->cmsg_level = IPPROTO_UDP;
	c->cmsg_type = UDP_SEGMENT;
	c->cmsg_len = CMSG_LEN(sizeof segment);
	memcpy(CMSG_DATA(c), &segment, sizeof segment);
}

static void make_messages(struct send_queue *q)
{
	bool taken[SEND_QUEUE] = { false };
	unsigned used = 0;

	q->messages = 0;
	for (unsigned first = 0; first < q->count; first++) {
		const unsigned m = q->messages;
		unsigned parts[GSO_PARTS_MAX], n;

		if (taken[first])
			continue;
		n = find_parts(q, first, taken, parts);
		q->message[m].msg_hdr = (struct msghdr){
			.msg_name = &q->to[first].sa, .msg_namelen = q->to[first].len,
			.msg_iov = &q->iov[used], .msg_iovlen = n,
		};
		for (unsigned i = 0; i < n; i++) {
			taken[parts[i]] = true;
			q->iov[used++] = (struct iovec){ q->bytes + parts[i] * q->datagram_max,
							 q->len[parts[i]] };
		}
		if (n > 1)
			set_segment(&q->message[m].msg_hdr, q->control[m].bytes,
				    sizeof q->control[m].bytes, (uint16_t)q->len[first]);
		q->parts[m] = n;
		q->messages++;
	}
}

/* The kernel cuts nothing up here (no checksums by the card, IPsec, an old kernel): one by one. */
static void send_singly(struct send_queue *q, int fd, unsigned m)
{
	for (unsigned i = 0; i < q->parts[m]; i++) {
		struct msghdr one = q->message[m].msg_hdr;
		ssize_t n;

		one.msg_iov += i;
		one.msg_iovlen = 1;
		one.msg_control = NULL;
		one.msg_controllen = 0;
		do
			n = sendmsg(fd, &one, MSG_NOSIGNAL);
		while (n < 0 && errno == EINTR);
		q->stats.calls++;
		q->stats.sent += n >= 0;
		if (n < 0) {
			q->stats.failed++;
			q->stats.error = errno;
		}
	}
}

static bool refuses_gso(int error)
{
	return error == EIO || error == EINVAL || error == EOPNOTSUPP || error == ENOPROTOOPT;
}

void send_queue_flush(struct send_queue *q, int fd)
{
	unsigned done = 0;

	make_messages(q);
	while (done < q->messages) {
		int n = sendmmsg(fd, q->message + done, q->messages - done, MSG_NOSIGNAL);

		q->stats.calls++;
		for (int i = 0; i < n; i++, done++) {
			q->stats.sent += q->parts[done];
			q->stats.joined += q->parts[done] > 1 ? q->parts[done] : 0;
		}
		if (n >= 0 || errno == EINTR)
			continue;
		if (q->parts[done] > 1 && refuses_gso(errno)) {
			if (q->gso)
				gr_info("datagrams are sent one by one: UDP GSO: %s", strerror(errno));
			q->gso = false;
			send_singly(q, fd, done);
		} else {
			/* Full buffer, no route, a node that is not there: this one is lost. */
			q->stats.failed += q->parts[done];
			q->stats.error = errno;
		}
		done++;
	}
	q->count = 0;
}
