/*
 * A VRPN server that does what a test says, over real sockets on loopback: it
 * is reached either way, greets, names its devices, and says what is put into
 * `say`.
 */
#ifndef GROTTO_TESTS_UNIT_MOCK_VRPN_H
#define GROTTO_TESTS_UNIT_MOCK_VRPN_H

#include "tests/unit/net_device.h"
#include "tests/unit/vrpn_bytes.h"

struct mock_vrpn {
	int listener, udp; /* of one number */
	uint16_t port;
	int fd;		     /* the client; -1: none */
	uint16_t client_udp; /* where it wants datagrams; 0: nowhere */
	struct vrpn_bytes say;
	uint8_t heard[4096];
	size_t heard_len;
	unsigned pings, other; /* messages of the client */
	bool named;	       /* the client has introduced itself and the ping */
	bool answers;	       /* pings with pongs */
	int32_t sender, pose, button, channels, pong; /* numbers of names, as mock_vrpn_names gave them */
};

static inline void mock_vrpn_start(struct mock_vrpn *m)
{
	memset(m, 0, sizeof *m);
	m->fd = m->udp = -1;
	while (m->udp < 0) {
		m->listener = net_socket(SOCK_STREAM, "127.0.0.1", 0);
		m->port = net_port(m->listener);
		m->udp = net_socket(SOCK_DGRAM, "127.0.0.1", m->port);
		if (m->udp < 0)
			close(m->listener);
	}
	if (listen(m->listener, 4) < 0)
		abort();
}

static inline void mock_vrpn_hang_up(struct mock_vrpn *m)
{
	if (m->fd >= 0)
		close(m->fd);
	m->fd = -1;
	m->client_udp = 0;
	m->heard_len = 0;
	m->pings = m->other = 0;
	m->named = false;
}

static inline void mock_vrpn_stop(struct mock_vrpn *m)
{
	mock_vrpn_hang_up(m);
	close(m->listener);
	close(m->udp);
}

static inline void mock_vrpn_flush(struct mock_vrpn *m)
{
	for (size_t at = 0; at < m->say.len;) {
		const ssize_t n = send(m->fd, m->say.at + at, m->say.len - at, MSG_NOSIGNAL);

		if (n <= 0)
			break; /* the client has gone; the test sees it by its state */
		at += (size_t)n;
	}
	m->say.len = 0;
}

static inline void mock_vrpn_datagram(struct mock_vrpn *m, int from)
{
	const struct sockaddr_in to = net_at("127.0.0.1", m->client_udp);

	assert_int_equal(sendto(from, m->say.at, m->say.len, 0, (const struct sockaddr *)&to, sizeof to),
			 m->say.len);
	m->say.len = 0;
}

/* Exactly n bytes of the client. */
static inline void mock_vrpn_read(const struct mock_vrpn *m, void *bytes, size_t n)
{
	for (size_t at = 0; at < n;) {
		const ssize_t got = recv(m->fd, (char *)bytes + at, n - at, 0);

		assert_true(got > 0);
		at += (size_t)got;
	}
}

/* As an asking datagram says; false: whoever asked does not listen any more. */
static inline bool mock_vrpn_connect_back(struct mock_vrpn *m)
{
	char text[64] = "", host[32];
	struct sockaddr_in to;
	unsigned port;

	assert_true(recv(m->udp, text, sizeof text, 0) > 0);
	assert_int_equal(text[sizeof text - 1], 0);
	assert_int_equal(sscanf(text, "%31s %u", host, &port), 2);
	to = net_at(host, (uint16_t)port);
	m->fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	if (connect(m->fd, (struct sockaddr *)&to, sizeof to) == 0)
		return true;
	close(m->fd);
	m->fd = -1;
	return false;
}

/* The client's next connection: at the port (udp false), or asked for by a datagram. */
static inline void mock_vrpn_accept(struct mock_vrpn *m, bool udp)
{
	struct pollfd ready = { .fd = udp ? m->udp : m->listener, .events = POLLIN };

	do {
		assert_int_equal(poll(&ready, 1, (int)(NET_DEADLINE_NS / GR_NS_PER_MS)), 1);
		if (!udp)
			m->fd = accept(m->listener, NULL, NULL);
	} while (udp && !mock_vrpn_connect_back(m));
	assert_true(m->fd >= 0);
}

/* Names a device and what it says, by numbers that begin with `first`. */
static inline void mock_vrpn_names(struct mock_vrpn *m, const char *device, int32_t first)
{
	m->sender = first + 1;
	m->pose = first + 2;
	m->button = first;
	m->channels = first + 3;
	m->pong = first + 1;
	vrpn_name(&m->say, -1, first, "VRPN Control");
	vrpn_name(&m->say, -1, first + 5, "Somebody");
	vrpn_name(&m->say, -2, m->pose, "vrpn_Tracker Pos_Quat");
	vrpn_name(&m->say, -2, m->button, "vrpn_Button Change");
	vrpn_name(&m->say, -2, m->channels, "vrpn_Analog Channel");
	vrpn_name(&m->say, -2, m->pong, "vrpn_Base pong_message");
	vrpn_name(&m->say, -1, m->sender, device);
}

/* The cookie, and right behind it the names of a device unless it is NULL. */
static inline void mock_vrpn_greet(struct mock_vrpn *m, const char cookie[24], const char *device,
				   int32_t first)
{
	char theirs[24];

	memcpy(m->say.at, cookie, 24);
	m->say.len = 24;
	if (device)
		mock_vrpn_names(m, device, first);
	mock_vrpn_flush(m);
	mock_vrpn_read(m, theirs, sizeof theirs);
	assert_memory_equal(theirs, "vrpn: ver. 07.35  0\0\0\0\0", 24);
}

static inline uint32_t mock_vrpn_u32(const uint8_t *p)
{
	return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

static inline void mock_vrpn_message(struct mock_vrpn *m, int32_t sender, int32_t type,
				     const uint8_t *body, size_t len)
{
	static const char ping[] = "\0\0\0\x17vrpn_Base ping_message";

	if (type == -3) {
		m->client_udp = (uint16_t)sender;
		assert_string_equal((const char *)body, "127.0.0.1");
	} else if (type == -2) {
		assert_int_equal(len, sizeof ping);
		assert_memory_equal(body, ping, sizeof ping);
		m->named = true;
	} else if (type == 0 && len == 0) {
		m->pings++;
		if (m->answers) {
			vrpn_message(&m->say, 0, m->sender, m->pong, "", 0);
			mock_vrpn_flush(m);
		}
	} else {
		m->other++;
	}
}

/* Takes what the client has said so far; never waits. */
static inline void mock_vrpn_listen(struct mock_vrpn *m)
{
	const ssize_t n = recv(m->fd, m->heard + m->heard_len, sizeof m->heard - m->heard_len,
			       MSG_DONTWAIT);
	size_t at = 0;

	if (n > 0)
		m->heard_len += (size_t)n;
	while (m->heard_len - at >= 24) {
		const uint8_t *p = m->heard + at;
		const size_t len = mock_vrpn_u32(p) - 24, whole = 24 + (len + 7) / 8 * 8;

		assert_true(len <= 200);
		if (m->heard_len - at < whole)
			break;
		mock_vrpn_message(m, (int32_t)mock_vrpn_u32(p + 12), (int32_t)mock_vrpn_u32(p + 16),
				  p + 24, len);
		at += whole;
	}
	m->heard_len -= at;
	memmove(m->heard, m->heard + at, m->heard_len);
}

#endif
