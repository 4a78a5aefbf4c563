#include <config.h> /* unshare */

#include "tools/bench/barrier.h"

#include <errno.h>
#include <sched.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

#define WORDS_MOST 20

extern char **environ;

/* iproute2 with these words, up to NULL. */
static bool ip(const char *first, ...)
{
	char *words[WORDS_MOST + 2] = { (char *)"ip", (char *)first };
	size_t count = 2;
	va_list args;
	int status;
	pid_t pid;

	va_start(args, first);
	while (count < WORDS_MOST && (words[count] = va_arg(args, char *)))
		count++;
	va_end(args);
	if (posix_spawnp(&pid, "ip", NULL, NULL, words, environ) != 0 || waitpid(pid, &status, 0) < 0)
		return false;
	return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool barrier_net_hub(void)
{
	if (unshare(CLONE_NEWNET) < 0) {
		fprintf(stderr, "no network namespaces (%s): loopback\n", strerror(errno));
		return false;
	}
	if (ip("link", "add", "br0", "type", "bridge", NULL) && ip("link", "set", "br0", "up", NULL))
		return true;
	fprintf(stderr, "no bridge by ip(8): loopback\n");
	ip("link", "set", "lo", "up", NULL);
	return false;
}

bool barrier_net_leave(void)
{
	return unshare(CLONE_NEWNET) == 0;
}

bool barrier_net_connect(unsigned end, pid_t pid)
{
	char port[16], there[16];

	snprintf(port, sizeof port, "p%u", end);
	snprintf(there, sizeof there, "%d", (int)pid);
	return ip("link", "add", port, "type", "veth", "peer", "name", "eth0", "netns", there, NULL) &&
	       ip("link", "set", port, "master", "br0", NULL) && ip("link", "set", port, "up", NULL);
}

bool barrier_net_address(const char *address)
{
	char with_net[24];

	snprintf(with_net, sizeof with_net, "%s/24", address);
	return ip("address", "add", with_net, "dev", "eth0", NULL) &&
	       ip("link", "set", "eth0", "up", NULL) && ip("link", "set", "lo", "up", NULL);
}
