#define _GNU_SOURCE /* SOCK_CLOEXEC, SOCK_NONBLOCK */
#include "tracking/net.h"

#include "base/result.h"

#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <sys/socket.h>
#include <unistd.h>

bool track_net_address(const char *text, uint16_t port, struct sockaddr_in *out)
{
	*out = (struct sockaddr_in){ .sin_family = AF_INET, .sin_port = htons(port) };
	return !text || inet_pton(AF_INET, text, &out->sin_addr) == 1;
}

const char *track_net_text(const struct sockaddr_in *address, char out[TRACK_NET_TEXT])
{
	char host[INET_ADDRSTRLEN] = "";

	(void)inet_ntop(AF_INET, &address->sin_addr, host, sizeof host);
	snprintf(out, TRACK_NET_TEXT, "%s:%u", host, (unsigned)ntohs(address->sin_port));
	return out;
}

int track_net_wait(const struct track_device *device, int fd, short events, int timeout_ms)
{
	struct pollfd fds[2] = { { .fd = fd, .events = events },
				 { .fd = track_device_wake_fd(device), .events = POLLIN } };

	if (poll(fds, 2, timeout_ms) <= 0)
		return GR_NOTHING;
	if (fds[1].revents)
		return GR_ERR_STATE;
	return GR_OK;
}

int track_net_left_ms(const struct track_device *device, int64_t until_ns)
{
	const int64_t left_ns = until_ns - track_device_now(device);

	return left_ns > 0 ? (int)((left_ns + GR_NS_PER_MS - 1) / GR_NS_PER_MS) : 0;
}

int track_net_socket(int type, const struct sockaddr_in *local)
{
	const int fd = socket(AF_INET, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	int error;

	if (fd < 0 || bind(fd, (const struct sockaddr *)local, sizeof *local) == 0)
		return fd;
	error = errno;
	close(fd);
	errno = error;
	return -1;
}

uint16_t track_net_port(int fd)
{
	struct sockaddr_in local = { 0 };
	socklen_t len = sizeof local;

	return getsockname(fd, (struct sockaddr *)&local, &len) == 0 ? ntohs(local.sin_port) : 0;
}

enum track_state track_net_state(int error)
{
	switch (error) {
	case EACCES:
	case EPERM: return TRACK_DENIED;
	case EADDRINUSE: return TRACK_BUSY;
	case EADDRNOTAVAIL:
	case ENODEV:
	case ENETDOWN:
	case ENETUNREACH:
	case EHOSTUNREACH:
	case ECONNREFUSED:
	case ECONNRESET:
	case ETIMEDOUT: return TRACK_ABSENT;
	default: return TRACK_FAILED;
	}
}
