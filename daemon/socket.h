/*
 * The UDP sockets of a room, as the layout's network section says: the
 * master's fans out to all nodes (unicast, one send for all by multicast or
 * broadcast), a node's speaks to its master.
 *
 * A room with standbys has several masters: the first is master_address, the others follow.
 *
 * Sends are queued and leave in batches (send_queue.h); datagrams arrive in
 * batches (recvmmsg) into fixed buffers. Nothing is allocated after opening.
 * Lost sends are counted, not retried: the protocol repairs.
 *
 * Thread: the loop's.
 */
#ifndef GROTTO_DAEMON_SOCKET_H
#define GROTTO_DAEMON_SOCKET_H

#include "config/layout.h"
#include "daemon/send_queue.h"

#define NET_ADDRESS_TEXT 64
#define NET_TO_ALL (-1)
#define NET_TO_GROUP (-2)
#define NET_BUFFER_BYTES (4 << 20) /* of each direction, where the system gives so much */

/* Numeric IPv4 or IPv6 (with %scope); GR_ERR_FORMAT otherwise. */
int net_address_parse(const char *text, uint16_t port, struct net_address *out);
/* "10.0.0.1:4400" or "[fe80::1%3]:4400" */
void net_address_text(const struct net_address *address, char text[NET_ADDRESS_TEXT]);
bool net_address_equal(const struct net_address *a, const struct net_address *b);

/* UDP payload that fits the layout's MTU: less the IP header (20, IPv6 40) and UDP's 8. */
size_t net_datagram_max(const struct layout_network *network);

struct net_stats {
	uint64_t sent, send_failed; /* datagrams on the wire; refused by the system */
	uint64_t oversized;         /* arrived longer than the layout allows */
	int send_errno;             /* of the last failure */
	uint64_t send_calls, joined; /* system calls; datagrams that left together (UDP GSO) */
};

struct net;
/* How many masters the layout has, and the address of one of them (0: master_address). */
size_t net_masters(const struct layout *layout);
int net_master_address(const struct layout *layout, size_t index, struct net_address *out);
/* Whether an address is one of this machine. */
bool net_is_ours(const struct net_address *address);
/* Index of the first of the layout's standbys that is this machine; 0: none is. */
size_t net_own_standby(const struct layout *layout);
/* The socket of master `index`, on its address and port. The log names what fails. */
int net_open_master(struct net **out, const struct layout *layout, size_t index);
/* Node `index`'s sockets: its own port, and the group's where there is one. */
int net_open_node(struct net **out, const struct layout *layout, size_t index);
void net_close(struct net **net);

/* Descriptors to wait on; count 1 or 2. */
int net_fds(const struct net *net, int fds[2]);
void net_stats(const struct net *net, struct net_stats *out);
/* Of the smallest receive buffer, as the kernel counts it (SO_RCVBUF); 0: not known. */
uint32_t net_receive_bytes(const struct net *net);

/* Whether there is a group: as the layout says, and with cast = "auto" where it can be opened. */
bool net_has_group(const struct net *net);
/*
 * Master: queues a datagram to node `to` (from the number of nodes on: to a master), to each node (NET_TO_ALL), or once to
 * the group (NET_TO_GROUP; nothing where there is none).
 * Node: `to` is a master's index, or NET_TO_ALL of them. net_flush sends the queue.
 */
void net_send(struct net *net, int to, const uint8_t *bytes, size_t len);
void net_flush(struct net *net);
/* Master: queues an answer to where a datagram came from. */
void net_send_to(struct net *net, const struct net_address *to, const uint8_t *bytes, size_t len);
/* Which node, or from their number on master, (on a node: which master) speaks from there, as the layout says; -1: nobody. */
int net_peer(const struct net *net, const struct net_address *from);
/* Master: node `node` was heard from there, and it was no recording. */
void net_learn(struct net *net, int node, const struct net_address *from);

/* arrived_ns: when the kernel had it, CLOCK_MONOTONIC; the present where it does not say. */
typedef void (*net_receive_fn)(void *ctx, const uint8_t *bytes, size_t len,
			       const struct net_address *from, int64_t arrived_ns);
/* Takes what waits at fd, at most `most` datagrams; returns how many. */
int net_receive(struct net *net, int fd, int most, net_receive_fn fn, void *ctx);

#endif
