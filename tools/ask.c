#include <config.h> /* ppoll */

#include "tools/ask.h"

#include "base/clock.h"
#include "base/result.h"

#include <errno.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

/* Waits for events until until_ns. */
static int await(int fd, short events, int64_t until_ns)
{
	for (;;) {
		struct pollfd poll_fd = { fd, events, 0 };
		int64_t left = until_ns - gr_clock_now(&gr_clock_monotonic);
		struct timespec patience = { left / GR_NS_PER_S, left % GR_NS_PER_S };
		int n;

		if (left <= 0)
			return GR_ERR_TIMEOUT;
		n = ppoll(&poll_fd, 1, &patience, NULL);
		if (n > 0)
			return GR_OK;
		if (n == 0)
			return GR_ERR_TIMEOUT;
		if (errno != EINTR)
			return GR_ERR_IO;
	}
}

static int send_all(int fd, const char *bytes, size_t len, int64_t until_ns)
{
	while (len > 0) {
		ssize_t n;
		int result = await(fd, POLLOUT, until_ns);

		if (result != GR_OK)
			return result;
		n = send(fd, bytes, len, MSG_NOSIGNAL | MSG_DONTWAIT);
		if (n < 0 && errno != EINTR && errno != EAGAIN)
			return GR_ERR_IO;
		if (n > 0) {
			bytes += n;
			len -= (size_t)n;
		}
	}
	return GR_OK;
}

static int receive_line(int fd, char *answer, size_t size, int64_t until_ns)
{
	size_t len = 0;

	for (;;) {
		char *end;
		ssize_t n;
		int result = await(fd, POLLIN, until_ns);

		if (result != GR_OK)
			return result;
		n = recv(fd, answer + len, size - len, MSG_DONTWAIT);
		if (n < 0 && (errno == EINTR || errno == EAGAIN))
			continue;
		if (n < 0)
			return GR_ERR_IO;
		if (n == 0)
			return GR_ERR_FORMAT;
		end = memchr(answer + len, '\n', (size_t)n);
		len += (size_t)n;
		if (end) {
			*end = '\0';
			return GR_OK;
		}
		if (len == size)
			return GR_ERR_FORMAT;
	}
}

int ask_master(const char *path, const char *request, int64_t patience_ns, char *answer,
	       size_t size)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	int64_t until_ns = gr_clock_now(&gr_clock_monotonic) + patience_ns;
	int result = GR_ERR_IO;
	int error;
	int fd;

	if (strlen(path) >= sizeof address.sun_path || size < 2)
		return GR_ERR_RANGE;
	strcpy(address.sun_path, path);
	fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (fd < 0)
		return GR_ERR_IO;
	/* A Unix socket connects at once or not at all. */
	if (connect(fd, (const struct sockaddr *)&address, sizeof address) == 0)
		result = send_all(fd, request, strlen(request), until_ns);
	if (result == GR_OK)
		result = send_all(fd, "\n", 1, until_ns);
	if (result == GR_OK)
		result = receive_line(fd, answer, size, until_ns);
	error = errno;
	close(fd);
	errno = error;
	return result;
}
