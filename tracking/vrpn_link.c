#define _GNU_SOURCE /* accept4 */
#include "tracking/vrpn_link.h"
#include "tracking/net.h"

#include "base/result.h"

#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define ASK_NS (500 * GR_NS_PER_MS) /* between two datagrams that ask to be connected */
#define DATAGRAMS_MOST 64	    /* of strangers, passed over in one go */

static void close_fd(int *fd)
{
	if (*fd >= 0)
		close(*fd);
	*fd = -1;
}

void track_vrpn_link_close(struct track_vrpn_link *link)
{
	close_fd(&link->tcp);
	close_fd(&link->udp);
	link->in_len = link->out_len = 0;
}

static bool same_host(const struct sockaddr_in *a, const struct sockaddr_in *b)
{
	return a->sin_addr.s_addr == b->sin_addr.s_addr;
}

static enum track_state no_answer(const struct track_vrpn_link *link, int error, char *why,
				  size_t size)
{
	char text[TRACK_NET_TEXT];

	snprintf(why, size, "no VRPN server answers at %s: %s", track_net_text(&link->server, text),
		 strerror(error));
	return track_net_state(error);
}

/* ---- way A: to the server's port ---- */

static enum track_state connect_there(struct track_vrpn_link *link, struct track_device *device,
				      char *why, size_t size)
{
	const int64_t until_ns = track_device_now(device) + link->patience_ns;
	struct sockaddr_in any;
	int error = 0;
	socklen_t len = sizeof error;

	(void)track_net_address(NULL, 0, &any);
	link->tcp = track_net_socket(SOCK_STREAM, &any);
	if (link->tcp < 0)
		return no_answer(link, errno, why, size);
	if (connect(link->tcp, (const struct sockaddr *)&link->server, sizeof link->server) == 0)
		return TRACK_RUNNING;
	if (errno != EINPROGRESS)
		return no_answer(link, errno, why, size);
	if (track_net_wait(device, link->tcp, POLLOUT, track_net_left_ms(device, until_ns)) != GR_OK)
		return no_answer(link, ETIMEDOUT, why, size);
	if (getsockopt(link->tcp, SOL_SOCKET, SO_ERROR, &error, &len) < 0)
		error = errno;
	return error ? no_answer(link, error, why, size) : TRACK_RUNNING;
}

/* ---- way B: the server connects back ---- */

/* Our address on the way to the server; nothing is sent for it. */
static bool find_local(struct track_vrpn_link *link)
{
	struct sockaddr_in any;
	socklen_t len = sizeof link->local;
	bool found;
	int fd;

	(void)track_net_address(NULL, 0, &any);
	fd = track_net_socket(SOCK_DGRAM, &any);
	if (fd < 0)
		return false;
	found = connect(fd, (const struct sockaddr *)&link->server, sizeof link->server) == 0 &&
		getsockname(fd, (struct sockaddr *)&link->local, &len) == 0;
	link->local.sin_port = 0;
	close(fd);
	return found;
}

static void ask(const struct track_vrpn_link *link, int listener)
{
	char host[INET_ADDRSTRLEN] = "", text[INET_ADDRSTRLEN + 8];
	int len;

	(void)inet_ntop(AF_INET, &link->local.sin_addr, host, sizeof host);
	len = snprintf(text, sizeof text, "%s %u", host, (unsigned)track_net_port(listener));
	/* With its NUL. Lost or refused: it is asked again. */
	(void)sendto(link->udp, text, (size_t)len + 1, MSG_DONTWAIT,
		     (const struct sockaddr *)&link->server, sizeof link->server);
}

/* The connection of the server; those of others are closed. */
static int accept_server(const struct track_vrpn_link *link, int listener)
{
	struct sockaddr_in from = { 0 };
	socklen_t len = sizeof from;
	int fd = accept4(listener, (struct sockaddr *)&from, &len, SOCK_CLOEXEC | SOCK_NONBLOCK);

	if (fd >= 0 && !same_host(&from, &link->server))
		close_fd(&fd);
	return fd;
}

static enum track_state wait_for_server(struct track_vrpn_link *link, struct track_device *device,
					int listener, char *why, size_t size)
{
	const int64_t until_ns = track_device_now(device) + link->patience_ns;
	int64_t asked_ns = track_device_now(device) - ASK_NS;
	int r = GR_NOTHING;

	while (r != GR_ERR_STATE && track_device_now(device) < until_ns) {
		if (track_device_now(device) - asked_ns >= ASK_NS) {
			ask(link, listener);
			asked_ns = track_device_now(device);
		}
		r = track_net_wait(device, listener, POLLIN,
				   track_net_left_ms(device, asked_ns + ASK_NS));
		if (r == GR_OK)
			link->tcp = accept_server(link, listener);
		if (link->tcp >= 0)
			return TRACK_RUNNING;
	}
	return no_answer(link, ETIMEDOUT, why, size);
}

static enum track_state be_connected(struct track_vrpn_link *link, struct track_device *device,
				     char *why, size_t size)
{
	enum track_state state;
	int listener;

	if (!find_local(link))
		return no_answer(link, errno, why, size);
	link->udp = track_net_socket(SOCK_DGRAM, &link->local);
	listener = track_net_socket(SOCK_STREAM, &link->local);
	if (link->udp < 0 || listener < 0 || listen(listener, 4) < 0)
		state = no_answer(link, errno, why, size);
	else
		state = wait_for_server(link, device, listener, why, size);
	if (link->udp >= 0)
		link->local.sin_port = htons(track_net_port(link->udp));
	close_fd(&listener);
	return state;
}

/* ---- cookies ---- */

static void flush(struct track_vrpn_link *link)
{
	const ssize_t n = send(link->tcp, link->out, link->out_len, MSG_DONTWAIT | MSG_NOSIGNAL);

	/* An error shows at the next receive, too. */
	if (n <= 0)
		return;
	link->out_len -= (size_t)n;
	memmove(link->out, link->out + n, link->out_len);
}

static enum track_state greet(struct track_vrpn_link *link, struct track_device *device, char *why,
			      size_t size)
{
	const int64_t until_ns = track_device_now(device) + link->patience_ns;
	char text[TRACK_NET_TEXT];
	int r;

	track_vrpn_cookie(link->out);
	link->out_len = TRACK_VRPN_COOKIE;
	flush(link);
	while (link->in_len < TRACK_VRPN_COOKIE) {
		if (track_net_wait(device, link->tcp, POLLIN, track_net_left_ms(device, until_ns)) !=
		    GR_OK)
			return no_answer(link, ETIMEDOUT, why, size);
		if (track_vrpn_link_receive(link, why, size) == GR_ERR_IO)
			return TRACK_ABSENT;
	}
	r = track_vrpn_check_cookie(link->in);
	track_vrpn_link_pass(link, TRACK_VRPN_COOKIE);
	if (r == GR_OK)
		return TRACK_RUNNING;
	snprintf(why, size, "what answers at %s is no VRPN server%s",
		 track_net_text(&link->server, text),
		 r == GR_ERR_VERSION ? " of version 07, the one that is spoken here" : "");
	return TRACK_FAILED;
}

enum track_state track_vrpn_link_open(struct track_vrpn_link *link, struct track_device *device,
				      bool udp, char *why, size_t size)
{
	enum track_state state = udp ? be_connected(link, device, why, size) :
				       connect_there(link, device, why, size);

	return state == TRACK_RUNNING ? greet(link, device, why, size) : state;
}

/* ---- once it is open ---- */

void track_vrpn_link_wait(const struct track_vrpn_link *link, const struct track_device *device,
			  int timeout_ms)
{
	struct pollfd fds[3] = {
		{ .fd = link->tcp, .events = (short)(link->out_len ? POLLIN | POLLOUT : POLLIN) },
		{ .fd = link->udp, .events = POLLIN }, /* -1: poll passes it by */
		{ .fd = track_device_wake_fd(device), .events = POLLIN },
	};

	(void)poll(fds, 3, timeout_ms);
}

int track_vrpn_link_receive(struct track_vrpn_link *link, char *why, size_t size)
{
	const size_t room = sizeof link->in - link->in_len;
	const ssize_t n = recv(link->tcp, link->in + link->in_len, room, MSG_DONTWAIT);
	char text[TRACK_NET_TEXT];

	if (link->out_len)
		flush(link);
	if (n > 0) {
		link->in_len += (size_t)n;
		return GR_OK;
	}
	if (n < 0 && (errno == EAGAIN || errno == EINTR))
		return GR_NOTHING;
	snprintf(why, size, "the VRPN server at %s %s%s", track_net_text(&link->server, text),
		 n == 0 ? "has closed the connection" : "is lost: ", n == 0 ? "" : strerror(errno));
	return GR_ERR_IO;
}

void track_vrpn_link_pass(struct track_vrpn_link *link, size_t used)
{
	link->in_len -= used;
	memmove(link->in, link->in + used, link->in_len);
}

ssize_t track_vrpn_link_datagram(struct track_vrpn_link *link, uint8_t *bytes, size_t size)
{
	for (int i = 0; link->udp >= 0 && i < DATAGRAMS_MOST; i++) {
		struct sockaddr_in from = { 0 };
		socklen_t len = sizeof from;
		const ssize_t n = recvfrom(link->udp, bytes, size, MSG_DONTWAIT,
					   (struct sockaddr *)&from, &len);

		if (n < 0 || same_host(&from, &link->server))
			return n;
	}
	return -1;
}

void track_vrpn_link_send(struct track_vrpn_link *link, const struct track_vrpn_message *message)
{
	(void)track_vrpn_encode(message, link->out, sizeof link->out, &link->out_len);
	flush(link);
}

void track_vrpn_link_describe(struct track_vrpn_link *link, int32_t what, int32_t id,
			      const char *name)
{
	(void)track_vrpn_describe(what, id, name, link->out, sizeof link->out, &link->out_len);
	flush(link);
}
