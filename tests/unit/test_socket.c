/* Sockets of a room over loopback: unicast, multicast, broadcast; what is refused. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "daemon/socket.h"

#include <poll.h>
#include <unistd.h>

#define NODES 3

/* A layout of which only the network part is used, on ports that are free now. */
struct room {
	struct layout layout;
	struct layout_node nodes[NODES];
};

static uint16_t free_port(const char *address)
{
	struct net_address a;
	socklen_t len;
	int fd;
	uint16_t port;

	assert_int_equal(net_address_parse(address, 0, &a), GR_OK);
	fd = socket(a.sa.ss_family, SOCK_DGRAM, 0);
	assert_int_equal(bind(fd, (const struct sockaddr *)&a.sa, a.len), 0);
	len = sizeof a.sa;
	assert_int_equal(getsockname(fd, (struct sockaddr *)&a.sa, &len), 0);
	port = a.sa.ss_family == AF_INET6 ? ((struct sockaddr_in6 *)(void *)&a.sa)->sin6_port :
					    ((struct sockaddr_in *)(void *)&a.sa)->sin_port;
	close(fd);
	return ntohs(port);
}

static void make_room(struct room *room, const char *address)
{
	memset(room, 0, sizeof *room);
	room->layout.nodes = room->nodes;
	room->layout.node_count = NODES;
	room->layout.network.master_address = (char *)address;
	room->layout.network.master_port = free_port(address);
	room->layout.network.mtu = 1500;
	room->layout.network.ttl = 0;
	room->layout.network.loop = true;
	for (int i = 0; i < NODES; i++) {
		room->nodes[i].address = (char *)address;
		room->nodes[i].port = free_port(address);
	}
}

struct heard {
	int count;
	size_t len;
	uint8_t bytes[4096];
	struct net_address from;
	int64_t arrived_ns;
};

static void hear(void *ctx, const uint8_t *bytes, size_t len, const struct net_address *from,
		 int64_t arrived_ns)
{
	struct heard *h = ctx;

	h->count++;
	h->len = len;
	memcpy(h->bytes, bytes, len);
	h->from = *from;
	h->arrived_ns = arrived_ns;
}

static int listen_at(struct net *net, int which, struct heard *h)
{
	int fds[2];
	struct pollfd wait;

	assert_true(net_fds(net, fds) > which);
	wait = (struct pollfd){ fds[which], POLLIN, 0 };
	h->count = 0;
	if (poll(&wait, 1, 1000) <= 0)
		return 0;
	return net_receive(net, fds[which], 1000, hear, h);
}

/* A datagram that waited has the time at which it came, not that at which it was taken. */
static void arrival(void **state)
{
	struct room room;
	struct net *master, *node;
	struct heard h;
	int64_t before_ns, after_ns;
	bool stamped = false;

	(void)state;
	make_room(&room, "127.0.0.1");
	assert_int_equal(net_open_master(&master, &room.layout, 0), GR_OK);
	assert_int_equal(net_open_node(&node, &room.layout, 0), GR_OK);
	/* A kernel that nobody asked for stamps before begins with them a little later. */
	for (int i = 0; i < 20 && !stamped; i++) {
		before_ns = gr_clock_now(&gr_clock_monotonic);
		net_send(node, 0, (const uint8_t *)"x", 1);
		net_flush(node);
		after_ns = gr_clock_now(&gr_clock_monotonic);
		usleep(20000);
		assert_int_equal(listen_at(master, 0, &h), 1);
		/* Two clocks are read one after the other: some microseconds. */
		assert_true(h.arrived_ns >= before_ns - 20000);
		stamped = h.arrived_ns <= after_ns + 20000;
	}
	assert_true(stamped);
	net_close(&master);
	net_close(&node);
}

/* Masters hear each other and all nodes; what is for all nodes no master hears. */
static void several_masters(void **state)
{
	static struct heard h;
	struct layout_standby standby[2] = { { .address = (char *)"127.0.0.1" }, { .address = (char *)"127.0.0.1" } };
	struct room room;
	struct net *masters[3], *node;
	struct net_address address;

	(void)state;
	make_room(&room, "127.0.0.1");
	for (uint16_t i = 0; i < 2; i++)
		standby[i].port = free_port("127.0.0.1");
	room.layout.standby = standby;
	room.layout.standby_count = 2;
	assert_int_equal(net_masters(&room.layout), 3);
	for (size_t i = 0; i < 3; i++)
		assert_int_equal(net_open_master(&masters[i], &room.layout, i), GR_OK);
	assert_int_equal(net_open_node(&node, &room.layout, 0), GR_OK);
	for (int i = 0; i < 3; i++) { /* to each, and from each to the next */
		net_send(node, i, (const uint8_t *)"n", 1);
		net_send(masters[(i + 1) % 3], NODES + i, (const uint8_t *)"master", 6);
		net_send(masters[i], NET_TO_ALL, (const uint8_t *)"all", 3);
	}
	net_send(node, NET_TO_ALL, (const uint8_t *)"nn", 2);
	net_send(node, 3, (const uint8_t *)"nobody", 6);
	net_send(masters[0], NODES + 3, (const uint8_t *)"nobody", 6);
	net_flush(node);
	for (int i = 0; i < 3; i++)
		net_flush(masters[i]);
	for (int i = 0; i < 3; i++)
		assert_int_equal(listen_at(masters[i], 0, &h), 3);
	assert_int_equal(listen_at(node, 0, &h), 3);
	assert_true(net_peer(node, &h.from) >= 0);
	assert_int_equal(net_master_address(&room.layout, 2, &address), GR_OK);
	assert_int_equal(net_peer(masters[0], &address), NODES + 2);
	assert_int_equal(net_peer(node, &address), 2);
	assert_true(net_is_ours(&address)); /* though its port is taken */
	assert_int_equal(net_address_parse("192.0.2.7", 1, &address), GR_OK);
	assert_false(net_is_ours(&address));
	for (int i = 0; i < 3; i++)
		net_close(&masters[i]);
	net_close(&node);
}

static void unicast_over(const char *address)
{
	static struct heard h;
	struct room room;
	struct net *master, *nodes[NODES];
	uint8_t bytes[1472] = { 1, 2, 3 };

	make_room(&room, address);
	assert_int_equal(net_open_master(&master, &room.layout, 0), GR_OK);
	for (int i = 0; i < NODES; i++)
		assert_int_equal(net_open_node(&nodes[i], &room.layout, (size_t)i), GR_OK);
	/* To one: nobody else hears it. To all: each once. */
	net_send(master, 1, bytes, 3);
	net_send(master, NET_TO_ALL, bytes, 4);
	net_flush(master);
	for (int i = 0; i < NODES; i++) {
		assert_int_equal(listen_at(nodes[i], 0, &h), i == 1 ? 2 : 1);
		assert_int_equal(h.len, 4);
	}
	/* More than the queue holds; the socket keeps the order. */
	for (int i = 0; i < 200; i++) {
		bytes[0] = (uint8_t)i;
		net_send(nodes[2], 0, bytes, net_datagram_max(&room.layout.network));
	}
	net_flush(nodes[2]);
	assert_int_equal(listen_at(master, 0, &h), 200);
	assert_int_equal(h.bytes[0], 199);
	/* A node that answers from elsewhere is answered there. */
	net_learn(master, 0, &h.from);
	net_send(master, 0, bytes, 9);
	net_flush(master);
	assert_int_equal(listen_at(nodes[2], 0, &h), 1);
	assert_int_equal(h.len, 9);
	for (int i = 0; i < NODES; i++)
		net_close(&nodes[i]);
	/* Nobody there: no error that stops anything. */
	for (int i = 0; i < 10; i++) {
		net_send(master, NET_TO_ALL, bytes, 10);
		net_flush(master);
	}
	net_close(&master);
	assert_null(master);
}

static void unicast_ipv4(void **state)
{
	(void)state;
	unicast_over("127.0.0.1");
}

static void unicast_ipv6(void **state)
{
	struct net_address a;
	int fd;

	(void)state;
	net_address_parse("::1", 0, &a);
	fd = socket(AF_INET6, SOCK_DGRAM, 0);
	if (fd < 0 || bind(fd, (const struct sockaddr *)&a.sa, a.len) < 0) {
		printf("# no IPv6 loopback here\n");
		if (fd >= 0)
			close(fd);
		skip();
	}
	close(fd);
	unicast_over("::1");
}

static void group_over(enum layout_cast cast, const char *group)
{
	static struct heard h;
	struct room room;
	struct net *master, *nodes[NODES];
	uint8_t bytes[100] = { 7 };

	make_room(&room, "127.0.0.1");
	room.layout.network.cast = cast;
	room.layout.network.group = (char *)group;
	room.layout.network.group_port = free_port("127.0.0.1");
	room.layout.network.interface = (char *)"lo";
	assert_int_equal(net_open_master(&master, &room.layout, 0), GR_OK);
	for (int i = 0; i < NODES; i++)
		assert_int_equal(net_open_node(&nodes[i], &room.layout, (size_t)i), GR_OK);
	assert_true(net_has_group(master));
	net_send(master, NET_TO_GROUP, bytes, sizeof bytes);
	net_send(master, 0, bytes, 5);
	net_flush(master);
	struct net_stats stats;
	net_stats(master, &stats);
	assert_int_equal(stats.sent, 2); /* one send for all */
	for (int i = 0; i < NODES; i++) {
		assert_int_equal(listen_at(nodes[i], 1, &h), 1);
		assert_int_equal(h.len, sizeof bytes);
	}
	assert_int_equal(listen_at(nodes[0], 0, &h), 1);
	assert_int_equal(h.len, 5);
	net_send(nodes[1], 0, bytes, 6);
	net_flush(nodes[1]);
	assert_int_equal(listen_at(master, 0, &h), 1);
	for (int i = 0; i < NODES; i++)
		net_close(&nodes[i]);
	net_close(&master);
}

static void multicast_reaches_all(void **state)
{
	(void)state;
	group_over(LAYOUT_MULTICAST, "239.255.71.4");
}

static void broadcast_reaches_all(void **state)
{
	(void)state;
	group_over(LAYOUT_BROADCAST, "127.255.255.255");
}

/* What the layout says of the group is what the socket has. */
static void group_as_the_layout_says(void **state)
{
	struct room room;
	struct net *master;
	int fds[2], value;
	socklen_t len = sizeof value;

	(void)state;
	make_room(&room, "127.0.0.1");
	room.layout.network.cast = LAYOUT_AUTO;
	room.layout.network.group = (char *)"239.255.71.6";
	room.layout.network.group_port = free_port("127.0.0.1");
	room.layout.network.interface = (char *)"lo";
	for (int i = 0; i < 2; i++) {
		room.layout.network.loop = i;
		room.layout.network.ttl = 3 + i;
		assert_int_equal(net_open_master(&master, &room.layout, 0), GR_OK);
		net_fds(master, fds);
		assert_int_equal(getsockopt(fds[0], IPPROTO_IP, IP_MULTICAST_LOOP, &value, &len), 0);
		assert_int_equal(value, i);
		assert_int_equal(getsockopt(fds[0], IPPROTO_IP, IP_MULTICAST_TTL, &value, &len), 0);
		assert_int_equal(value, 3 + i);
		net_close(&master);
	}
}

/* With cast = "auto" a group that cannot be had is done without; with "multicast" it is not. */
static void auto_does_without(void **state)
{
	struct room room;
	struct net *net;

	(void)state;
	gr_log_set_level((enum gr_log_level)0);
	make_room(&room, "127.0.0.1");
	room.layout.network.group = (char *)"239.255.71.6";
	room.layout.network.group_port = room.layout.network.master_port;
	room.layout.network.interface = (char *)"lo";
	/* Not a group: it cannot be joined. */
	room.layout.network.group = (char *)"127.0.0.1";
	room.layout.network.group_port = free_port("127.0.0.1");
	room.layout.network.cast = LAYOUT_MULTICAST;
	assert_int_equal(net_open_node(&net, &room.layout, 0), GR_ERR_IO);
	room.layout.network.cast = LAYOUT_AUTO;
	assert_int_equal(net_open_node(&net, &room.layout, 0), GR_OK);
	assert_false(net_has_group(net));
	net_close(&net);
	room.layout.network.interface = (char *)"no-such-if0"; /* is a fault of the layout */
	assert_int_equal(net_open_node(&net, &room.layout, 0), GR_ERR_CONFIG);
	gr_log_set_level(GR_LOG_ERROR);
}

static void oversized_is_counted(void **state)
{
	static struct heard h;
	struct room room, large;
	struct net *master, *node;
	struct net_stats stats;
	uint8_t bytes[3000] = { 0 };

	(void)state;
	make_room(&room, "127.0.0.1");
	large = room;
	large.layout.nodes = large.nodes;
	large.layout.network.mtu = 9000;
	assert_int_equal(net_open_master(&master, &room.layout, 0), GR_OK);
	assert_int_equal(net_open_node(&node, &large.layout, 0), GR_OK);
	net_send(node, 0, bytes, sizeof bytes);
	net_send(node, 0, bytes, 10);
	net_flush(node);
	assert_int_equal(listen_at(master, 0, &h), 2);
	assert_int_equal(h.count, 1);
	net_stats(master, &stats);
	assert_int_equal(stats.oversized, 1);
	/* And none is sent that the layout does not allow. */
	net_send(master, 0, bytes, sizeof bytes);
	net_flush(master);
	net_stats(master, &stats);
	assert_int_equal(stats.send_failed, 1);
	net_close(&node);
	net_close(&master);
}

static void wrong_networks_are_refused(void **state)
{
	struct room room;
	struct net *first, *second;

	(void)state;
	gr_log_set_level((enum gr_log_level)0);
	make_room(&room, "127.0.0.1");
	assert_int_equal(net_open_master(&first, &room.layout, 0), GR_OK);
	assert_int_equal(net_open_master(&second, &room.layout, 0), GR_ERR_IO); /* port taken */
	assert_null(second);
	net_close(&first);
	room.nodes[1].address = (char *)"cave-left.example";
	assert_int_equal(net_open_master(&first, &room.layout, 0), GR_ERR_CONFIG);
	make_room(&room, "127.0.0.1");
	room.layout.network.master_address = (char *)"192.0.2.1"; /* not of this machine */
	assert_int_equal(net_open_master(&first, &room.layout, 0), GR_ERR_IO);
	make_room(&room, "127.0.0.1");
	room.layout.network.cast = LAYOUT_MULTICAST;
	room.layout.network.group = (char *)"239.255.71.4";
	room.layout.network.group_port = 4000;
	room.layout.network.interface = (char *)"no-such-if0";
	assert_int_equal(net_open_master(&first, &room.layout, 0), GR_ERR_CONFIG);
	assert_null(first);
	gr_log_set_level(GR_LOG_ERROR);
}

static void addresses_as_text(void **state)
{
	struct net_address a, b;
	char text[NET_ADDRESS_TEXT];

	(void)state;
	assert_int_equal(net_address_parse("10.1.2.3", 4400, &a), GR_OK);
	net_address_text(&a, text);
	assert_string_equal(text, "10.1.2.3:4400");
	assert_int_equal(net_address_parse("fd00::1", 1, &b), GR_OK);
	net_address_text(&b, text);
	assert_string_equal(text, "[fd00::1]:1");
	assert_false(net_address_equal(&a, &b));
	assert_true(net_address_equal(&b, &b));
	assert_int_equal(net_address_parse("localhost", 1, &b), GR_ERR_FORMAT);
	assert_int_equal(net_address_parse(NULL, 1, &b), GR_ERR_FORMAT);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(arrival), cmocka_unit_test(several_masters), cmocka_unit_test(unicast_ipv4),
		cmocka_unit_test(unicast_ipv6),
		cmocka_unit_test(multicast_reaches_all),
		cmocka_unit_test(broadcast_reaches_all),
		cmocka_unit_test(group_as_the_layout_says),
		cmocka_unit_test(auto_does_without),
		cmocka_unit_test(oversized_is_counted),
		cmocka_unit_test(wrong_networks_are_refused),
		cmocka_unit_test(addresses_as_text),
	};

	gr_log_init("test", GR_LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
