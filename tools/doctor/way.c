#include <config.h> /* ppoll */

#include "tools/doctor/way.h"

#include "base/clock.h"
#include "tools/doctor/sysfile.h"

#include <errno.h>
#include <netinet/in.h>
#include <poll.h>
#include <sodium.h>
#include <string.h>
#include <unistd.h>

#define UNUSED_PORT 33434 /* where traceroute begins: no daemon lives there */
#define PATIENCE_NS (400 * GR_NS_PER_MS)
#define DATAGRAM_MOST 9000

static const char magic[8] = { 'G', 'R', 'd', 'o', 'c', 't', 'o', 'r' };
#define AT_KIND sizeof magic
#define AT_NONCE 16

void echo_make(uint8_t *bytes, size_t len, const uint8_t nonce[ECHO_NONCE])
{
	memset(bytes, 0, len);
	memcpy(bytes, magic, sizeof magic);
	bytes[AT_KIND] = 'q';
	memcpy(bytes + AT_NONCE, nonce, ECHO_NONCE);
}

bool echo_turn(uint8_t *bytes, size_t len)
{
	if (len < ECHO_LEAST || memcmp(bytes, magic, sizeof magic) || bytes[AT_KIND] != 'q')
		return false;
	bytes[AT_KIND] = 'a';
	return true;
}

bool echo_answers(const uint8_t *bytes, size_t len, const uint8_t nonce[ECHO_NONCE])
{
	return len >= ECHO_LEAST && !memcmp(bytes, magic, sizeof magic) && bytes[AT_KIND] == 'a' &&
	       !memcmp(bytes + AT_NONCE, nonce, ECHO_NONCE);
}

static int open_connected(const struct net_address *from, const struct net_address *to)
{
	bool v6 = to->sa.ss_family == AF_INET6;
	int one = 1, whole = v6 ? IPV6_PMTUDISC_DO : IP_PMTUDISC_DO;
	struct net_address own = *from;
	int fd = socket(to->sa.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0), error;

	if (fd < 0)
		return -1;
	if (own.sa.ss_family == AF_INET6)
		((struct sockaddr_in6 *)&own.sa)->sin6_port = 0;
	else
		((struct sockaddr_in *)&own.sa)->sin_port = 0;
	/* All that routers and hosts say is wanted, not only what ends a connection. */
	if (setsockopt(fd, v6 ? IPPROTO_IPV6 : IPPROTO_IP, v6 ? IPV6_RECVERR : IP_RECVERR, &one, sizeof one) == 0 &&
	    setsockopt(fd, v6 ? IPPROTO_IPV6 : IPPROTO_IP, v6 ? IPV6_MTU_DISCOVER : IP_MTU_DISCOVER, &whole,
		       sizeof whole) == 0 &&
	    bind(fd, (const struct sockaddr *)&own.sa, own.len) == 0 &&
	    connect(fd, (const struct sockaddr *)&to->sa, to->len) == 0)
		return fd;
	error = errno;
	close(fd);
	errno = error;
	return -1;
}

/* Until something comes; GR-like: 1 an echo, 0 nothing, -1 an error (errno). */
static int await_answer(int fd, const uint8_t nonce[ECHO_NONCE], int64_t until_ns)
{
	uint8_t bytes[DATAGRAM_MOST];

	for (;;) {
		struct pollfd poll_fd = { fd, POLLIN, 0 };
		int64_t left = until_ns - gr_clock_now(&gr_clock_monotonic);
		struct timespec patience = { left / GR_NS_PER_S, left % GR_NS_PER_S };
		ssize_t n;

		if (left <= 0 || ppoll(&poll_fd, 1, &patience, NULL) == 0)
			return 0;
		n = recv(fd, bytes, sizeof bytes, MSG_DONTWAIT);
		if (n >= 0 && echo_answers(bytes, (size_t)n, nonce))
			return 1;
		if (n < 0 && errno != EAGAIN && errno != EINTR)
			return -1;
	}
}

static void note_error(struct way_probe *out, int error)
{
	out->answer = error == ECONNREFUSED ? WAY_CLOSED : WAY_ERROR;
	out->error = error;
}

static void ask(int fd, size_t len, int64_t patience_ns, struct way_probe *out)
{
	uint8_t bytes[DATAGRAM_MOST], nonce[ECHO_NONCE];

	randombytes_buf(nonce, sizeof nonce);
	echo_make(bytes, len, nonce);
	for (int i = 0; i < 2 && out->answer == WAY_SILENT; i++) {
		int64_t sent_ns = gr_clock_now(&gr_clock_monotonic);
		int got;

		if (send(fd, bytes, len, MSG_NOSIGNAL) < 0) {
			note_error(out, errno);
			break;
		}
		got = await_answer(fd, nonce, sent_ns + patience_ns / 2);
		if (got < 0)
			note_error(out, errno);
		else if (got > 0)
			out->answer = WAY_ECHO;
		out->trip_ns = gr_clock_now(&gr_clock_monotonic) - sent_ns;
	}
}

void way_send(const struct net_address *from, const struct net_address *to, size_t len,
	      int64_t patience_ns, struct way_probe *out)
{
	bool v6 = to->sa.ss_family == AF_INET6;
	socklen_t size = sizeof out->mtu;
	int fd;

	*out = (struct way_probe){ 0 };
	if (len < ECHO_LEAST || len > DATAGRAM_MOST) {
		note_error(out, EMSGSIZE);
		return;
	}
	fd = open_connected(from, to);
	if (fd < 0) {
		note_error(out, errno);
		return;
	}
	ask(fd, len, patience_ns, out);
	if (getsockopt(fd, v6 ? IPPROTO_IPV6 : IPPROTO_IP, v6 ? IPV6_MTU : IP_MTU, &out->mtu, &size) < 0)
		out->mtu = 0;
	close(fd);
}

bool way_no_neighbour(const char *arp, const char *address)
{
	for (const char *line = arp; line && *line; line = strchr(line, '\n')) {
		char ip[48];
		unsigned flags;

		line += *line == '\n';
		/* "10.0.0.9  0x1  0x0  00:00:00:00:00:00  *  eth0"; flag 2: complete */
		if (sscanf(line, "%47s 0x%*x 0x%x", ip, &flags) == 2 && !strcmp(ip, address))
			return !(flags & 2);
	}
	return false;
}

static void set_port(struct net_address *address, uint16_t port)
{
	if (address->sa.ss_family == AF_INET6)
		((struct sockaddr_in6 *)&address->sa)->sin6_port = htons(port);
	else
		((struct sockaddr_in *)&address->sa)->sin_port = htons(port);
}

static bool look_for_neighbour(const char *root, const struct net_address *to)
{
	static char arp[SYSFILE_MOST]; /* too large for a stack, used by one thread */
	char text[NET_ADDRESS_TEXT];

	net_address_text(to, text);
	text[strcspn(text, ":")] = '\0';
	return to->sa.ss_family == AF_INET && sysfile_read(root, arp, sizeof arp, "/proc/net/arp") >= 0 &&
	       way_no_neighbour(arp, text);
}

void way_look(const char *root, const struct net_address *from, const struct net_address *to,
	      size_t datagram_max, bool live, struct way *out)
{
	struct net_address other = *to;

	*out = (struct way){ 0 };
	set_port(&other, UNUSED_PORT);
	if (!live)
		way_send(from, to, ECHO_LEAST, PATIENCE_NS, &out->port);
	if (out->port.answer == WAY_ECHO || out->port.answer == WAY_CLOSED) {
		way_send(from, to, datagram_max, PATIENCE_NS, &out->whole);
		return;
	}
	if (out->port.answer == WAY_SILENT)
		way_send(from, &other, ECHO_LEAST, PATIENCE_NS, &out->other);
	if (out->other.answer == WAY_CLOSED)
		way_send(from, &other, datagram_max, PATIENCE_NS, &out->whole);
	else
		out->no_neighbour = look_for_neighbour(root, to);
}

static struct finding judge_error(const char *who, const char *where, int error)
{
	struct finding f = finding(FINDING_FAIL, "%s (%s): %s", who, where, strerror(error));

	switch (error) {
	case EPERM:
	case EACCES: return finding_do(f, "a firewall of this machine forbids sending: accept UDP to there");
	case ENETUNREACH: return finding_do(f, "this machine has no route there: address, netmask, `ip route`");
	case EHOSTUNREACH:
		return finding_do(f, "no machine answers there, or a router refuses: is it on, in the same net, "
				  "its address as in the layout?");
	case EADDRNOTAVAIL: return finding_do(f, "check `address`: this machine does not have its own");
	default: return finding_do(f, "`ip route get ADDRESS` says which way it would go");
	}
}

struct finding way_judge(const char *who, const char *where, const struct way *way, bool live)
{
	int error = way->port.answer == WAY_ERROR ? way->port.error :
		    way->other.answer == WAY_ERROR ? way->other.error : 0;

	if (live)
		return finding(FINDING_OK, "%s (%s) and this side hear each other", who, where);
	if (way->port.answer == WAY_ECHO)
		return finding(FINDING_OK, "%s (%s): its doctor answers, there and back in %.0f us", who, where,
			       (double)way->port.trip_ns * 1e-3);
	if (way->port.answer == WAY_CLOSED)
		return finding_do(finding(FINDING_WARN, "%s (%s): the machine answers, nobody listens on the port",
					  who, where),
				  "start the daemon there, or `grotto doctor --listen 60` to try the port");
	if (error)
		return judge_error(who, where, error);
	if (way->other.answer == WAY_CLOSED)
		return finding_do(finding(FINDING_SKIP, "%s (%s): the machine answers, its port does not: a daemon "
					  "(which answers none but the room) or a firewall", who, where),
				  "status of the running master tells; or stop the daemon, `grotto doctor --listen "
				  "60` there, and look again");
	if (way->no_neighbour)
		return finding_do(finding(FINDING_FAIL, "%s (%s): no machine on this net has that address", who, where),
				  "is it on, its cable in, its address as in the layout?");
	return finding_do(finding(FINDING_WARN, "%s (%s): nothing comes back, not even a refusal", who, where),
			  "the machine is off or drops what it does not know: `grotto doctor --listen 60` there, and "
			  "look again; its firewall must let the port in");
}

struct finding way_judge_whole(const char *who, const struct way *way, size_t datagram_max)
{
	const struct way_probe *p = &way->whole;

	if (p->answer == WAY_ECHO || p->answer == WAY_CLOSED)
		return finding(FINDING_OK, "%s: datagrams of %zu bytes arrive whole", who, datagram_max);
	if (p->answer == WAY_ERROR && p->error == EMSGSIZE)
		return finding_do(finding(FINDING_FAIL, "%s: datagrams of %zu bytes do not fit: the path carries "
					  "packets of %d", who, datagram_max, p->mtu),
				  "network.mtu = %d in the layout of all machines, or raise the MTU of every "
				  "interface and switch on the way", p->mtu);
	if (way->port.answer == WAY_ECHO || way->port.answer == WAY_CLOSED || way->other.answer == WAY_CLOSED)
		return finding_do(finding(FINDING_FAIL, "%s: short datagrams arrive, those of %zu bytes do not", who,
					  datagram_max),
				  "a switch or tunnel on the way has a smaller MTU and does not say so: lower "
				  "network.mtu until they do");
	return finding(FINDING_SKIP, "%s: whether whole datagrams arrive cannot be told", who);
}
