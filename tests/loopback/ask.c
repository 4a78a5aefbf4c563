/* ask SOCKET WORD...: one request to a control socket, the answer to stdout. ask --now: CLOCK_MONOTONIC, ns. */
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

int main(int argc, char **argv)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	char bytes[70000];
	size_t len = 0;
	ssize_t n;
	int fd;

	if (argc == 2 && !strcmp(argv[1], "--now")) {
		struct timespec ts;

		clock_gettime(CLOCK_MONOTONIC, &ts);
		printf("%lld%09ld\n", (long long)ts.tv_sec, ts.tv_nsec);
		return 0;
	}
	if (argc < 3 || strlen(argv[1]) >= sizeof address.sun_path)
		return 2;
	strcpy(address.sun_path, argv[1]);
	for (int i = 2; i < argc; i++)
		len += (size_t)snprintf(bytes + len, sizeof bytes - len, "%s%s", argv[i],
					i + 1 < argc ? " " : "\n");
	fd = socket(AF_UNIX, SOCK_STREAM, 0);
	if (fd < 0 || connect(fd, (const struct sockaddr *)&address, sizeof address) < 0 ||
	    write(fd, bytes, len) != (ssize_t)len || shutdown(fd, SHUT_WR) < 0)
		return 1;
	while ((n = read(fd, bytes, sizeof bytes)) > 0)
		fwrite(bytes, 1, (size_t)n, stdout);
	close(fd);
	return n < 0;
}
