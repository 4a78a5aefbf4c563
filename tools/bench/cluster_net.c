#include <config.h> /* unshare */

#include "tools/bench/cluster_net.h"

#include <errno.h>
#include <sched.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

#define WORDS_MOST 20

extern char **environ;

static bool ip(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* iproute2 with these words, which are ours and have no blanks in them. */
static bool ip(const char *format, ...)
{
	char line[160], *words[WORDS_MOST + 2] = { (char *)"ip" }, *rest = NULL;
	size_t count = 1;
	va_list args;
	int status;
	pid_t pid;

	va_start(args, format);
	vsnprintf(line, sizeof line, format, args);
	va_end(args);
	for (char *word = strtok_r(line, " ", &rest); word && count <= WORDS_MOST;
	     word = strtok_r(NULL, " ", &rest))
		words[count++] = word;
	if (posix_spawnp(&pid, "ip", NULL, NULL, words, environ) != 0 || waitpid(pid, &status, 0) < 0)
		return false;
	return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool cluster_net_hub(void)
{
	if (unshare(CLONE_NEWNET) < 0) {
		fprintf(stderr, "no network namespaces (%s): loopback\n", strerror(errno));
		return false;
	}
	if (ip("link add br0 type bridge") && ip("link set br0 up"))
		return true;
	fprintf(stderr, "no bridge by ip(8): loopback\n");
	ip("link set lo up");
	return false;
}

bool cluster_net_leave(void)
{
	return unshare(CLONE_NEWNET) == 0;
}

/*
 * A veth hands on a buffer of many datagrams whole, and what drops it drops them all. On
 * a wire each is by itself: so they are behind the bridge's ports. (At eth0 itself TCP
 * would build its segments one by one, as behind no card.)
 */
bool cluster_net_connect(unsigned end, pid_t pid)
{
	return ip("link add p%u type veth peer name eth0 netns %d", end, (int)pid) &&
	       ip("link set p%u master br0", end) && ip("link set p%u gso_max_segs 1 up", end);
}

bool cluster_net_address(const char *address)
{
	return ip("address add %s/24 dev eth0", address) && ip("link set eth0 up") && ip("link set lo up");
}
