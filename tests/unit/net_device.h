/*
 * A tracking device of the network on its own thread, as a room has it: the
 * test sends over loopback and waits for what the device has become of it,
 * never for a time to pass.
 */
#ifndef GROTTO_TESTS_UNIT_NET_DEVICE_H
#define GROTTO_TESTS_UNIT_NET_DEVICE_H

#include "base/clock.h"
#include "base/result.h"
#include "tracking/device.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#define NET_DEADLINE_NS (60 * GR_NS_PER_S)

static inline struct sockaddr_in net_at(const char *host, uint16_t port)
{
	struct sockaddr_in at = { .sin_family = AF_INET, .sin_port = htons(port) };

	if (inet_pton(AF_INET, host, &at.sin_addr) != 1)
		abort();
	return at;
}

static inline uint16_t net_port(int fd)
{
	struct sockaddr_in at;
	socklen_t len = sizeof at;

	if (getsockname(fd, (struct sockaddr *)&at, &len) < 0)
		abort();
	return ntohs(at.sin_port);
}

/* Bound there; port 0 is any. -1 when that is taken. */
static inline int net_socket(int type, const char *host, uint16_t port)
{
	const struct sockaddr_in at = net_at(host, port);
	const int fd = socket(AF_INET, type | SOCK_CLOEXEC, 0), one = 1;

	if (fd < 0 || (type == SOCK_STREAM &&
		       setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one) < 0))
		abort();
	if (bind(fd, (const struct sockaddr *)&at, sizeof at) == 0)
		return fd;
	close(fd);
	return -1;
}

/* A port that nobody has just now. */
static inline uint16_t net_free_port(int type)
{
	const int fd = net_socket(type, "0.0.0.0", 0);
	const uint16_t port = net_port(fd);

	close(fd);
	return port;
}

static inline struct track_status net_status(const struct track_device *device)
{
	struct track_status status;

	track_device_status(device, &status);
	return status;
}

static inline struct track_counters net_counters(const struct track_device *device)
{
	struct track_counters counters;

	track_device_counters(device, &counters);
	return counters;
}

/* Sleeps a little; fails the test when that went on for too long. */
static inline void net_again(int64_t since_ns, const struct track_device *device)
{
	const struct timespec nap = { .tv_nsec = 1000000 };
	struct track_status status;

	nanosleep(&nap, NULL);
	if (gr_clock_now(&gr_clock_monotonic) - since_ns < NET_DEADLINE_NS)
		return;
	status = net_status(device);
	fail_msg("waited for too long; the device is %s: %s",
		 track_state_name((enum track_state)status.state), status.why);
}

/* Until it is so. */
#define net_wait(device, condition)                                                 \
	do {                                                                        \
		const int64_t since = gr_clock_now(&gr_clock_monotonic);            \
		while (!(condition))                                                \
			net_again(since, device);                                   \
	} while (0)

static inline bool net_is(const struct track_device *device, enum track_state state)
{
	return net_status(device).state == (uint64_t)state;
}

#endif
