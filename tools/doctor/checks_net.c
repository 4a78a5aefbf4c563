/* Checks of this machine's net: address, interface, port, buffers, firewall. */
#include <config.h> /* pipe2 */

#include "tools/doctor/doctor.h"

#include "base/result.h"
#include "tools/doctor/firewall.h"
#include "tools/doctor/sysfile.h"

#include <errno.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define RULES_MOST (1024 * 1024)
#define RULES_PATIENCE_MS 3000

static const char *role_address(const struct doctor *d)
{
	const size_t master = d->node < 0 ? doctor_master(d->layout) : 0;

	return d->node >= 0 ? d->layout->nodes[d->node].address
	       : master	    ? d->layout->standby[master - 1].address
			    : d->layout->network.master_address;
}

/* The bytes of an address alone; len 4 or 16. */
static const uint8_t *address_bytes(const struct sockaddr *sa, size_t *len)
{
	*len = sa->sa_family == AF_INET6 ? 16 : 4;
	return sa->sa_family == AF_INET6 ? (const void *)&((const struct sockaddr_in6 *)sa)->sin6_addr :
					   (const void *)&((const struct sockaddr_in *)sa)->sin_addr;
}

/* The whole net of lo is this machine's, though an interface names 127.0.0.1 alone. */
static bool is_loopback(const struct sockaddr *sa)
{
	size_t len;
	const uint8_t *bytes = address_bytes(sa, &len);

	return len == 4 ? bytes[0] == 127 : IN6_IS_ADDR_LOOPBACK((const struct in6_addr *)(const void *)bytes);
}

static void find_interface(struct doctor *d)
{
	const struct sockaddr *own = (const struct sockaddr *)&d->own.sa;
	struct ifaddrs *all = NULL;
	size_t len;
	const uint8_t *bytes = address_bytes(own, &len);

	if (is_loopback(own)) {
		d->own_here = true;
		link_read(d->root, "lo", &d->link);
		return;
	}
	if (getifaddrs(&all) < 0)
		return;
	for (const struct ifaddrs *one = all; one && !d->own_here; one = one->ifa_next) {
		size_t other;

		if (!one->ifa_addr || one->ifa_addr->sa_family != own->sa_family ||
		    memcmp(address_bytes(one->ifa_addr, &other), bytes, len))
			continue;
		d->own_here = true;
		link_read(d->root, one->ifa_name, &d->link);
	}
	freeifaddrs(all);
}

void check_address(struct doctor *d)
{
	const char *wanted = d->layout->network.interface, *address = role_address(d);

	if (net_address_parse(address, doctor_port(d), &d->own) < 0) {
		findings_add(&d->found, finding(FINDING_FAIL, "%s is no numeric address", address));
		return;
	}
	find_interface(d);
	if (!d->own_here)
		findings_add(&d->found,
			     finding_do(finding(FINDING_FAIL, "no interface of this machine has the address %s",
						address),
					"`ip address add %s/24 dev %s`, or correct the layout; or this machine has "
					"another role (--node NAME, --master)", address, wanted ? wanted : "IF"));
	else if (wanted && strcmp(wanted, d->link.name))
		findings_add(&d->found,
			     finding_do(finding(FINDING_WARN, "%s is on %s, the layout's group goes by %s", address,
						d->link.name, wanted),
					"network.interface = \"%s\", if that is the room's net", d->link.name));
	else
		findings_add(&d->found, finding(FINDING_OK, "%s is on interface %s", address, d->link.name));
}

void check_nic(struct doctor *d)
{
	if (!d->own_here) {
		findings_add(&d->found, finding(FINDING_SKIP, "no interface to look at"));
		return;
	}
	findings_add(&d->found, link_judge_state(&d->link));
	findings_add(&d->found, link_judge_speed(&d->link));
	findings_add(&d->found, link_judge_mtu(&d->link, d->layout->network.mtu));
	findings_add(&d->found, link_judge_counters(&d->link));
}

void check_port(struct doctor *d)
{
	static char table[SYSFILE_MOST]; /* too large for a stack, used by one thread */
	bool v6 = d->own.sa.ss_family == AF_INET6;
	size_t len;
	const uint8_t *bytes = address_bytes((const struct sockaddr *)&d->own.sa, &len);

	if (sysfile_read(d->root, table, sizeof table, v6 ? "/proc/net/udp6" : "/proc/net/udp") < 0) {
		findings_add(&d->found, finding(FINDING_SKIP, "the kernel's table of UDP cannot be read"));
		return;
	}
	if (sockets_find(table, bytes, len, doctor_port(d), &d->port))
		sockets_find_owner(d->root, &d->port);
	findings_add(&d->found, sockets_judge_port(&d->port, doctor_port(d), doctor_program(d)));
}

void check_drops(struct doctor *d)
{
	char snmp[16384];

	findings_add(&d->found, sockets_judge_drops(&d->port, doctor_port(d)));
	if (sysfile_read(d->root, snmp, sizeof snmp, "/proc/net/snmp") < 0)
		snmp[0] = '\0';
	findings_add(&d->found, sockets_judge_snmp(snmp));
}

/* What a socket gets that asks as the daemons do; -1 unknown. */
static int64_t buffer_got(int option)
{
	int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0), size = NET_BUFFER_BYTES;
	socklen_t len = sizeof size;
	int64_t got = -1;

	if (fd < 0)
		return -1;
	/* The kernel doubles what it is asked for, and says the double. */
	if (setsockopt(fd, SOL_SOCKET, option, &size, sizeof size) == 0 &&
	    getsockopt(fd, SOL_SOCKET, option, &size, &len) == 0)
		got = size / 2;
	close(fd);
	return got;
}

void check_buffers(struct doctor *d)
{
	static const struct { const char *name; int option; } buffers[] = {
		{ "rmem_max", SO_RCVBUF }, { "wmem_max", SO_SNDBUF },
	};

	for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) {
		int64_t most;

		if (!sysfile_number(d->root, &most, "/proc/sys/net/core/%s", buffers[i].name))
			most = -1;
		/* The shipped units have no capabilities, so no daemon is exempt. */
		findings_add(&d->found, sockets_judge_buffer(buffers[i].name, most, NET_BUFFER_BYTES,
							     buffer_got(buffers[i].option), false));
	}
}

/* Reads until the end, RULES_MOST or the patience is over; NULL then. Caller frees. */
static char *read_all(int fd)
{
	char *text = malloc(RULES_MOST);
	size_t len = 0;

	while (text) {
		struct pollfd poll_fd = { fd, POLLIN, 0 };
		ssize_t n = poll(&poll_fd, 1, RULES_PATIENCE_MS) > 0 ? read(fd, text + len, RULES_MOST - 1 - len) : -1;

		if (n == 0) {
			text[len] = '\0';
			return text;
		}
		len += n > 0 ? (size_t)n : 0;
		if (n < 0 || len == RULES_MOST - 1)
			break;
	}
	free(text);
	return NULL;
}

/* What a program of the system prints; NULL where it is not there, says no, or says too much. */
static char *run_program(const char *path, char *const argv[])
{
	static char *const environment[] = { "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "LC_ALL=C", NULL };
	posix_spawn_file_actions_t actions;
	char *text = NULL;
	int fds[2], status = -1;
	pid_t pid;

	if (access(path, X_OK) != 0 || pipe2(fds, O_CLOEXEC) < 0)
		return NULL;
	posix_spawn_file_actions_init(&actions);
	posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
	posix_spawn_file_actions_adddup2(&actions, fds[1], 1);
	posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
	if (posix_spawn(&pid, path, &actions, NULL, argv, environment) == 0) {
		close(fds[1]);
		fds[1] = -1;
		text = read_all(fds[0]);
		if (!text)
			kill(pid, SIGKILL);
		while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
			;
	}
	posix_spawn_file_actions_destroy(&actions);
	close(fds[0]);
	if (fds[1] >= 0)
		close(fds[1]);
	if (status != 0) {
		free(text);
		return NULL;
	}
	return text;
}

void check_firewall(struct doctor *d)
{
	static char *const nft[] = { "nft", "list", "ruleset", NULL };
	static char *const iptables[] = { "iptables", "-S", NULL }, *const ip6tables[] = { "ip6tables", "-S", NULL };
	bool v6 = d->own.sa.ss_family == AF_INET6;
	struct firewall_symptom symptom;
	char *rules;

	if (d->link.loopback) {
		findings_add(&d->found, finding(FINDING_OK, "a room on loopback passes no firewall of a net"));
		return;
	}
	rules = run_program("/usr/sbin/nft", nft);
	if (rules)
		symptom = firewall_read_nft(rules, doctor_port(d));
	findings_add(&d->found, firewall_judge("nft", rules ? &symptom : NULL, doctor_port(d)));
	free(rules);
	rules = run_program(v6 ? "/usr/sbin/ip6tables" : "/usr/sbin/iptables", v6 ? ip6tables : iptables);
	if (rules) {
		symptom = firewall_read_iptables(rules, doctor_port(d));
		findings_add(&d->found, firewall_judge(v6 ? "ip6tables" : "iptables", &symptom, doctor_port(d)));
	}
	free(rules);
}
