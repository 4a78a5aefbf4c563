#include "config.h" /* _GNU_SOURCE */

#include "daemon/socket.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"

#include <errno.h>
#include <net/if.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

#define NET_BATCH 16
#define NET_GROUP LAYOUT_MAX_NODES /* the way to the group */

#define NET_STAMP_MOST_NS GR_NS_PER_S /* a datagram may have waited so long for us */
#define NET_READ_MOST_NS 5000         /* between the readings of two clocks */

/* Room for the kernel's time stamp, aligned as the kernel wants it. */
union net_control {
	struct cmsghdr head;
	char bytes[CMSG_SPACE(sizeof(struct timespec))];
};

struct net {
	int fd;       /* bound to our address */
	int group_fd; /* node: bound to the group's port, or -1 */
	bool has_group;
	struct net_address group;
	struct net_address peers[LAYOUT_MAX_NODES]; /* master: nodes, then masters; node: masters */
	size_t peer_count, all_count; /* all: of NET_TO_ALL, the first */
	size_t datagram_max;
	uint64_t oversized, too_long; /* arrived; asked to be sent */
	struct send_queue *out;

	struct mmsghdr in[NET_BATCH];
	struct iovec in_iov[NET_BATCH];
	struct net_address in_from[NET_BATCH];
	union net_control in_control[NET_BATCH];
	uint8_t *in_bytes; /* NET_BATCH * datagram_max */
};

int net_address_parse(const char *text, uint16_t port, struct net_address *out)
{
	struct addrinfo hints = { .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE,
				  .ai_socktype = SOCK_DGRAM };
	struct addrinfo *found = NULL;
	char service[8];

	memset(out, 0, sizeof *out);
	snprintf(service, sizeof service, "%u", port);
	if (!text || getaddrinfo(text, service, &hints, &found) != 0)
		return GR_ERR_FORMAT;
	memcpy(&out->sa, found->ai_addr, found->ai_addrlen);
	out->len = found->ai_addrlen;
	freeaddrinfo(found);
	return GR_OK;
}

void net_address_text(const struct net_address *address, char text[NET_ADDRESS_TEXT])
{
	char host[48], service[8];

	if (getnameinfo((const struct sockaddr *)&address->sa, address->len, host, sizeof host,
			service, sizeof service, NI_NUMERICHOST | NI_NUMERICSERV) != 0)
		snprintf(text, NET_ADDRESS_TEXT, "unknown address");
	else if (address->sa.ss_family == AF_INET6)
		snprintf(text, NET_ADDRESS_TEXT, "[%s]:%s", host, service);
	else
		snprintf(text, NET_ADDRESS_TEXT, "%s:%s", host, service);
}

bool net_address_equal(const struct net_address *a, const struct net_address *b)
{
	if (a->sa.ss_family != b->sa.ss_family)
		return false;
	if (a->sa.ss_family == AF_INET) {
		const struct sockaddr_in *x = (const void *)&a->sa, *y = (const void *)&b->sa;
		return x->sin_port == y->sin_port && x->sin_addr.s_addr == y->sin_addr.s_addr;
	}
	const struct sockaddr_in6 *x = (const void *)&a->sa, *y = (const void *)&b->sa;
	return x->sin6_port == y->sin6_port && x->sin6_scope_id == y->sin6_scope_id &&
	       !memcmp(&x->sin6_addr, &y->sin6_addr, sizeof x->sin6_addr);
}

size_t net_datagram_max(const struct layout_network *network)
{
	size_t headers = strchr(network->master_address, ':') ? 48 : 28;

	return (size_t)network->mtu > headers ? (size_t)network->mtu - headers : 0;
}

static void say(const char *what, const struct net_address *address)
{
	char text[NET_ADDRESS_TEXT];

	net_address_text(address, text);
	gr_error("UDP %s: %s: %s", text, what, strerror(errno));
}

static void set_option(int fd, int level, int name, int value)
{
	/* Options that make it better but are not needed to work. */
	if (setsockopt(fd, level, name, &value, sizeof value) < 0)
		gr_debug("socket option %d/%d: %s", level, name, strerror(errno));
}

static void set_buffers(int fd)
{
	int size = NET_BUFFER_BYTES;

	/* FORCE passes net.core.rmem_max, but needs CAP_NET_ADMIN. */
	if (setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &size, sizeof size) < 0)
		set_option(fd, SOL_SOCKET, SO_RCVBUF, size);
	if (setsockopt(fd, SOL_SOCKET, SO_SNDBUFFORCE, &size, sizeof size) < 0)
		set_option(fd, SOL_SOCKET, SO_SNDBUF, size);
}

static int open_bound(const struct net_address *address, bool shared)
{
	int one = 1;
	int fd = socket(address->sa.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);

	if (fd < 0) {
		say("no socket", address);
		return -1;
	}
	set_buffers(fd);
	set_option(fd, SOL_SOCKET, SO_PRIORITY, 6);
	set_option(fd, SOL_SOCKET, SO_TIMESTAMPNS, 1);
	/* A datagram over the path's MTU is refused here, not cut up unseen. */
	if (address->sa.ss_family == AF_INET6)
		set_option(fd, IPPROTO_IPV6, IPV6_MTU_DISCOVER, IPV6_PMTUDISC_DO);
	else
		set_option(fd, IPPROTO_IP, IP_MTU_DISCOVER, IP_PMTUDISC_DO);
	if ((shared && setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one) < 0) ||
	    bind(fd, (const struct sockaddr *)&address->sa, address->len) < 0) {
		say("cannot be opened (is another daemon on it, is it an address of this machine?)",
		    address);
		close(fd);
		return -1;
	}
	return fd;
}

static int interface_index(const struct layout_network *network, unsigned *out)
{
	*out = 0;
	if (!network->interface)
		return GR_OK;
	*out = if_nametoindex(network->interface);
	if (*out == 0) {
		gr_error("network interface '%s': %s; `ip link` lists them", network->interface,
			 strerror(errno));
		return GR_ERR_CONFIG;
	}
	return GR_OK;
}

/* Master: where group datagrams leave, how far they go, and whether they are heard here too. */
static int set_group_out(struct net *net, const struct layout_network *network)
{
	int family = net->group.sa.ss_family, one = 1, loop = network->loop, r;
	unsigned index;
	bool ok;

	r = interface_index(network, &index);
	if (r < 0)
		return r;
	if (network->cast == LAYOUT_BROADCAST) {
		ok = setsockopt(net->fd, SOL_SOCKET, SO_BROADCAST, &one, sizeof one) == 0;
	} else if (family == AF_INET6) {
		ok = setsockopt(net->fd, IPPROTO_IPV6, IPV6_MULTICAST_IF, &index, sizeof index) == 0 &&
		     setsockopt(net->fd, IPPROTO_IPV6, IPV6_MULTICAST_HOPS, &network->ttl,
				sizeof network->ttl) == 0 &&
		     setsockopt(net->fd, IPPROTO_IPV6, IPV6_MULTICAST_LOOP, &loop, sizeof loop) == 0;
	} else {
		struct ip_mreqn where = { .imr_ifindex = (int)index };
		ok = setsockopt(net->fd, IPPROTO_IP, IP_MULTICAST_IF, &where, sizeof where) == 0 &&
		     setsockopt(net->fd, IPPROTO_IP, IP_MULTICAST_TTL, &network->ttl,
				sizeof network->ttl) == 0 &&
		     setsockopt(net->fd, IPPROTO_IP, IP_MULTICAST_LOOP, &loop, sizeof loop) == 0;
	}
	if (!ok) {
		say("group cannot be sent to", &net->group);
		return GR_ERR_IO;
	}
	return GR_OK;
}

/* Node: a socket of its own on the group's address, so that it hears nothing else. */
static int join_group(struct net *net, const struct layout_network *network)
{
	struct group_req request = { 0 };
	int level = net->group.sa.ss_family == AF_INET6 ? IPPROTO_IPV6 : IPPROTO_IP, r;
	unsigned index;

	r = interface_index(network, &index);
	if (r < 0)
		return r;
	net->group_fd = open_bound(&net->group, true);
	if (net->group_fd < 0)
		return GR_ERR_IO;
	if (network->cast == LAYOUT_BROADCAST)
		return GR_OK;
	request.gr_interface = index;
	memcpy(&request.gr_group, &net->group.sa, net->group.len);
	if (setsockopt(net->group_fd, level, MCAST_JOIN_GROUP, &request, sizeof request) < 0) {
		say("group cannot be joined", &net->group);
		return GR_ERR_IO;
	}
	/* Only groups that this socket joined, not those of others on this machine. */
	set_option(net->group_fd, level, level == IPPROTO_IP ? IP_MULTICAST_ALL : IPV6_MULTICAST_ALL, 0);
	return GR_OK;
}

static int parse_or_say(const char *text, uint16_t port, struct net_address *out)
{
	int r = net_address_parse(text, port, out);

	if (r < 0)
		gr_error("'%s' is not a numeric IPv4 or IPv6 address", text ? text : "");
	return r < 0 ? GR_ERR_CONFIG : GR_OK;
}

static void prepare_messages(struct net *net)
{
	for (int i = 0; i < NET_BATCH; i++) {
		net->in_iov[i] = (struct iovec){ net->in_bytes + (size_t)i * net->datagram_max,
						 net->datagram_max };
		net->in[i].msg_hdr = (struct msghdr){ .msg_name = &net->in_from[i].sa,
						      .msg_iov = &net->in_iov[i],
						      .msg_iovlen = 1,
						      .msg_control = &net->in_control[i] };
	}
}

static int net_new(struct net **out, const struct layout_network *network)
{
	struct net *net = calloc(1, sizeof *net);

	*out = NULL;
	if (!net)
		return GR_ERR_NOMEM;
	net->fd = net->group_fd = -1;
	net->datagram_max = net_datagram_max(network);
	net->has_group = network->cast != LAYOUT_UNICAST;
	net->in_bytes = malloc(NET_BATCH * net->datagram_max + 1);
	*out = net;
	if (send_queue_create(&net->out, net->datagram_max) < 0 || !net->in_bytes) {
		net_close(out);
		return GR_ERR_NOMEM;
	}
	prepare_messages(net);
	if (net->has_group && parse_or_say(network->group, network->group_port, &net->group) < 0) {
		net_close(out);
		return GR_ERR_CONFIG;
	}
	return GR_OK;
}

/* With cast = "auto" a group that cannot be opened is done without; the log has said why. */
static int without_group(struct net *net, const struct layout_network *network, int result)
{
	if (result != GR_ERR_IO || network->cast != LAYOUT_AUTO)
		return result;
	gr_warning("goes on without multicast (network.cast = \"auto\")");
	net->has_group = false;
	if (net->group_fd >= 0)
		close(net->group_fd);
	net->group_fd = -1;
	return GR_OK;
}

size_t net_masters(const struct layout *layout)
{
	return 1 + layout->standby_count;
}

int net_master_address(const struct layout *layout, size_t index, struct net_address *out)
{
	if (index == 0)
		return parse_or_say(layout->network.master_address, layout->network.master_port, out);
	return parse_or_say(layout->standby[index - 1].address, layout->standby[index - 1].port, out);
}

bool net_is_ours(const struct net_address *address)
{
	struct net_address any = *address;
	int fd = socket(address->sa.ss_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	bool ours;

	/* Another port than its own, which may be taken. */
	if (any.sa.ss_family == AF_INET6)
		((struct sockaddr_in6 *)(void *)&any.sa)->sin6_port = 0;
	else
		((struct sockaddr_in *)(void *)&any.sa)->sin_port = 0;
	ours = fd >= 0 && bind(fd, (const struct sockaddr *)&any.sa, any.len) == 0;
	if (fd >= 0)
		close(fd);
	return ours;
}

size_t net_own_standby(const struct layout *layout)
{
	struct net_address address;

	for (size_t i = 1; i < net_masters(layout); i++)
		if (net_master_address(layout, i, &address) == GR_OK && net_is_ours(&address))
			return i;
	return 0;
}

/* The layout's masters, from `at` on; where there is one alone a master has no peer but nodes. */
static int add_masters(struct net *net, const struct layout *layout, size_t at)
{
	int r = GR_OK;

	for (size_t i = 0; r == GR_OK && i < net_masters(layout); i++)
		r = net_master_address(layout, i, &net->peers[at + i]);
	net->peer_count = at + net_masters(layout);
	return r;
}

int net_open_master(struct net **out, const struct layout *layout, size_t index)
{
	const struct layout_network *network = &layout->network;
	struct net_address own;
	int r = net_new(out, network);

	if (r < 0)
		return r;
	r = net_master_address(layout, index, &own);
	(*out)->peer_count = (*out)->all_count =
		layout->node_count < LAYOUT_MAX_NODES ? layout->node_count : LAYOUT_MAX_NODES;
	for (size_t i = 0; r == GR_OK && i < (*out)->all_count; i++)
		r = parse_or_say(layout->nodes[i].address, layout->nodes[i].port, &(*out)->peers[i]);
	if (r == GR_OK && layout->standby_count)
		r = add_masters(*out, layout, (*out)->all_count);
	if (r == GR_OK && ((*out)->fd = open_bound(&own, false)) < 0)
		r = GR_ERR_IO;
	if (r == GR_OK && (*out)->has_group)
		r = without_group(*out, network, set_group_out(*out, network));
	if (r < 0)
		net_close(out);
	return r;
}

int net_open_node(struct net **out, const struct layout *layout, size_t index)
{
	const struct layout_network *network = &layout->network;
	struct net_address own;
	int r = net_new(out, network);

	if (r < 0)
		return r;
	r = add_masters(*out, layout, 0);
	(*out)->all_count = (*out)->peer_count;
	if (r == GR_OK)
		r = parse_or_say(layout->nodes[index].address, layout->nodes[index].port, &own);
	if (r == GR_OK && ((*out)->fd = open_bound(&own, false)) < 0)
		r = GR_ERR_IO;
	if (r == GR_OK && (*out)->has_group)
		r = without_group(*out, network, join_group(*out, network));
	if (r < 0)
		net_close(out);
	return r;
}

void net_close(struct net **net)
{
	struct net *n = *net;

	if (!n)
		return;
	if (n->fd >= 0)
		close(n->fd);
	if (n->group_fd >= 0)
		close(n->group_fd);
	send_queue_destroy(&n->out);
	free(n->in_bytes);
	free(n);
	*net = NULL;
}

int net_fds(const struct net *net, int fds[2])
{
	fds[0] = net->fd;
	fds[1] = net->group_fd;
	return net->group_fd >= 0 ? 2 : 1;
}

uint32_t net_receive_bytes(const struct net *net)
{
	int fds[2], least = 0;
	const int count = net_fds(net, fds);

	for (int i = 0; i < count; i++) {
		socklen_t len = sizeof least;
		int bytes;

		if (getsockopt(fds[i], SOL_SOCKET, SO_RCVBUF, &bytes, &len) == 0 && bytes > 0 &&
		    (!least || bytes < least))
			least = bytes;
	}
	return (uint32_t)least;
}

bool net_has_group(const struct net *net)
{
	return net->has_group;
}

void net_stats(const struct net *net, struct net_stats *out)
{
	struct send_stats sent;

	send_queue_stats(net->out, &sent);
	*out = (struct net_stats){
		.sent = sent.sent, .send_failed = sent.failed + net->too_long,
		.oversized = net->oversized, .send_errno = sent.error,
		.send_calls = sent.calls, .joined = sent.joined,
	};
	if (!out->send_errno && net->too_long)
		out->send_errno = EMSGSIZE;
}

/* way: peer's index, NET_GROUP or SEND_ALONE. */
static void queue(struct net *net, int way, const struct net_address *to, const uint8_t *bytes,
		  size_t len)
{
	if (send_queue_count(net->out) == SEND_QUEUE)
		net_flush(net);
	send_queue_add(net->out, way, to, bytes, len);
}

static bool too_long(struct net *net, size_t len)
{
	net->too_long += len > net->datagram_max;
	return len > net->datagram_max;
}

void net_send_to(struct net *net, const struct net_address *to, const uint8_t *bytes, size_t len)
{
	if (!too_long(net, len))
		queue(net, SEND_ALONE, to, bytes, len);
}

void net_send(struct net *net, int to, const uint8_t *bytes, size_t len)
{
	if (too_long(net, len))
		return;
	if (to >= 0 && (size_t)to < net->peer_count) {
		queue(net, to, &net->peers[to], bytes, len);
	} else if (to == NET_TO_GROUP && net->has_group) {
		queue(net, NET_GROUP, &net->group, bytes, len);
	} else if (to == NET_TO_ALL) {
		for (size_t i = 0; i < net->all_count; i++)
			queue(net, (int)i, &net->peers[i], bytes, len);
	}
}

void net_flush(struct net *net)
{
	send_queue_flush(net->out, net->fd);
}

int net_peer(const struct net *net, const struct net_address *from)
{
	for (size_t i = 0; i < net->peer_count; i++)
		if (net_address_equal(&net->peers[i], from))
			return (int)i;
	return -1;
}

void net_learn(struct net *net, int node, const struct net_address *from)
{
	if (node >= 0 && (size_t)node < net->peer_count && !net_address_equal(&net->peers[node], from))
		net->peers[node] = *from;
}

struct net_now {
	int64_t monotonic_ns, real_ns;
};

static int64_t ns_of(const struct timespec *ts)
{
	return (int64_t)ts->tv_sec * GR_NS_PER_S + ts->tv_nsec;
}

/* Both clocks at one time: again, if something came between the readings. */
static struct net_now net_now(void)
{
	struct net_now now = { 0, 0 };

	for (int i = 0; i < 4; i++) {
		const int64_t before_ns = gr_clock_now(&gr_clock_monotonic);
		struct timespec ts;

		if (clock_gettime(CLOCK_REALTIME, &ts) < 0)
			break;
		now.monotonic_ns = gr_clock_now(&gr_clock_monotonic);
		if (now.monotonic_ns - before_ns > NET_READ_MOST_NS)
			continue;
		now.real_ns = ns_of(&ts);
		return now;
	}
	now.monotonic_ns = gr_clock_now(&gr_clock_monotonic); /* and no stamp makes sense with 0 */
	return now;
}

/*
 * The kernel stamps with CLOCK_REALTIME, which may be set at any time: only how
 * long ago it was is taken from it, and only if that makes sense.
 */
static int64_t arrival(struct msghdr *message, const struct net_now *now)
{
	for (struct cmsghdr *c = CMSG_FIRSTHDR(message); c; c = CMSG_NXTHDR(message, c)) {
		struct timespec stamp;
		int64_t age_ns;

		if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPNS ||
		    c->cmsg_len < CMSG_LEN(sizeof stamp))
			continue;
		memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
		age_ns = now->real_ns - ns_of(&stamp);
		if (age_ns >= 0 && age_ns <= NET_STAMP_MOST_NS)
			return now->monotonic_ns - age_ns;
	}
	return now->monotonic_ns;
}

int net_receive(struct net *net, int fd, int most, net_receive_fn fn, void *ctx)
{
	int taken = 0;

	while (taken < most) {
		struct net_now now;
		int room = most - taken < NET_BATCH ? most - taken : NET_BATCH, n;

		for (int i = 0; i < room; i++) {
			net->in[i].msg_hdr.msg_namelen = sizeof net->in_from[i].sa;
			net->in[i].msg_hdr.msg_controllen = sizeof net->in_control[i];
		}
		n = recvmmsg(fd, net->in, (unsigned)room, MSG_DONTWAIT, NULL);
		if (n <= 0)
			break; /* nothing left, or an error that the next event reports again */
		now = net_now();
		for (int i = 0; i < n; i++) {
			net->in_from[i].len = net->in[i].msg_hdr.msg_namelen;
			if (net->in[i].msg_hdr.msg_flags & MSG_TRUNC)
				net->oversized++;
			else
				fn(ctx, net->in_iov[i].iov_base, net->in[i].msg_len, &net->in_from[i],
				   arrival(&net->in[i].msg_hdr, &now));
		}
		taken += n;
		if (n < room)
			break;
	}
	return taken;
}
