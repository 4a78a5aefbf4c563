/*
 * Datagrams that wait to be sent. They leave in one system call (sendmmsg), and
 * fragments to one address as one buffer that the kernel cuts up (UDP GSO, Linux
 * 4.18), where it can: what a datagram costs on its way down is then paid once
 * for up to 64. Datagrams to one address keep their order.
 *
 * Nothing is allocated after init; lost sends are counted, not retried.
 * Thread: the loop's.
 */
#ifndef GROTTO_DAEMON_SEND_QUEUE_H
#define GROTTO_DAEMON_SEND_QUEUE_H

#include <netinet/in.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/socket.h>

#define SEND_QUEUE 64
#define SEND_ALONE (-1) /* `way` of a datagram that is joined to no other */

struct net_address {
	struct sockaddr_storage sa;
	socklen_t len;
};

struct send_stats {
	uint64_t sent, failed; /* datagrams on the wire; refused by the system */
	uint64_t calls;        /* of sendmmsg */
	uint64_t joined;       /* datagrams of those sent that left in a buffer with others */
	int error;             /* errno of the last failure */
};

struct send_queue;
/* GR_OK or GR_ERR_NOMEM. */
int send_queue_create(struct send_queue **out, size_t datagram_max);
void send_queue_destroy(struct send_queue **queue);
unsigned send_queue_count(const struct send_queue *queue);
void send_queue_stats(const struct send_queue *queue, struct send_stats *out);
/*
 * Whether buffers are cut up by the kernel at all (at first yes), for
 * measurements; the queue itself says no when the kernel does.
 */
void send_queue_set_gso(struct send_queue *queue, bool gso);
/*
 * Holds less than SEND_QUEUE; len at most datagram_max. Who has the same `way`
 * (>= 0) may be sent to the address of the first of them in the queue.
 */
void send_queue_add(struct send_queue *queue, int way, const struct net_address *to,
		    const uint8_t *bytes, size_t len);
void send_queue_flush(struct send_queue *queue, int fd);

#endif
