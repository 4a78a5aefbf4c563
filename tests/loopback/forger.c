/*
 * forger MASTER_PORT FIRST_NODE_PORT NODES COUNT A_SECOND: who listens on the
 * loopback wire and holds no key. Throws COUNT datagrams at a room's daemons, made
 * of what it hears them say: as it was, to another, cut, with flipped bits, with
 * other numbers, signed with a key of its own; and noise. Prints how many of each, and
 * what came back. 77: may not listen (needs CAP_NET_RAW).
 */
#include "base/clock.h"
#include "protocol/wire.h"
#include "tests/unit/unit.h"

#include <arpa/inet.h>
#include <errno.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <netpacket/packet.h>
#include <sodium.h>
#include <unistd.h>

#define TAPE 4096

enum kind { NOISE, REPLAYED, ASTRAY, CUT, FLIPPED, RENUMBERED, FORGED, KINDS };
static const char *const kind_names[KINDS] = {
	"noise", "replayed", "to another", "cut", "flipped", "renumbered", "forged",
};

struct heard {
	uint16_t port; /* to which */
	size_t len;
	uint8_t bytes[1472];
};

struct forger {
	int wire, fd;
	uint16_t master_port, node_port, nodes;
	struct unit_random random;
	struct heard *tape;
	size_t heard;
	uint64_t thrown[KINDS], bytes_out, answers, bytes_in, at_master;
};

static uint32_t dice(struct forger *f, uint32_t sides)
{
	return unit_random_u32(&f->random) % sides;
}

static bool of_room(const struct forger *f, uint16_t port)
{
	return port == f->master_port || (port >= f->node_port && port < f->node_port + f->nodes);
}

/* On the loopback wire everything is seen twice, out and in: one of the two is taken. */
static void listen_in(struct forger *f)
{
	uint8_t packet[2048];
	struct sockaddr_ll from;
	socklen_t len = sizeof from;
	ssize_t n;

	while ((n = recvfrom(f->wire, packet, sizeof packet, MSG_DONTWAIT, (struct sockaddr *)&from,
			     &len)) > 0) {
		struct iphdr ip;
		struct udphdr udp;
		size_t at;

		len = sizeof from;
		if (from.sll_pkttype == PACKET_OUTGOING || (size_t)n < sizeof ip + sizeof udp)
			continue;
		memcpy(&ip, packet, sizeof ip);
		at = (size_t)ip.ihl * 4;
		if (ip.protocol != IPPROTO_UDP || at + sizeof udp >= (size_t)n)
			continue;
		memcpy(&udp, packet + at, sizeof udp);
		at += sizeof udp;
		/* Between daemons of the room, not what we throw ourselves. */
		if (!of_room(f, ntohs(udp.dest)) || !of_room(f, ntohs(udp.source)) ||
		    (size_t)n - at < FDP_HEADER_BYTES || (size_t)n - at > 1472)
			continue;
		struct heard *h = &f->tape[f->heard++ % TAPE];
		h->port = ntohs(udp.dest);
		h->len = (size_t)n - at;
		memcpy(h->bytes, packet + at, h->len);
	}
}

static void throw_at(struct forger *f, enum kind kind, uint16_t port, const uint8_t *bytes,
		     size_t len)
{
	struct sockaddr_in to = { .sin_family = AF_INET, .sin_port = htons(port),
				  .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };

	if (sendto(f->fd, bytes, len, 0, (const struct sockaddr *)&to, sizeof to) < 0)
		return;
	f->thrown[kind]++;
	f->at_master += port == f->master_port;
	f->bytes_out += len;
}

static uint16_t any_port(struct forger *f)
{
	const uint32_t i = dice(f, f->nodes + 1u);

	return (uint16_t)(i == f->nodes ? f->master_port : f->node_port + i);
}

static void throw_noise(struct forger *f)
{
	uint8_t bytes[1472];
	const size_t len = dice(f, sizeof bytes + 1);

	for (size_t i = 0; i < len; i++)
		bytes[i] = (uint8_t)unit_random_u32(&f->random);
	if (len > 5 && dice(f, 2))
		memcpy(bytes, (const uint8_t[]){ 'G', 'F', 'D', 'P', FDP_VERSION }, 5);
	throw_at(f, NOISE, any_port(f), bytes, len);
}

static void throw_one(struct forger *f)
{
	const enum kind kind = (enum kind)dice(f, KINDS);
	const size_t kept = f->heard < TAPE ? f->heard : TAPE;
	struct heard h;
	uint8_t key[FDP_KEY_BYTES];

	if (kind == NOISE || !kept) {
		throw_noise(f);
		return;
	}
	h = f->tape[dice(f, (uint32_t)kept)];
	switch (kind) {
	case ASTRAY:
		for (const uint16_t was = h.port; h.port == was;)
			h.port = any_port(f);
		break;
	case CUT: h.len = dice(f, (uint32_t)h.len); break;
	case FLIPPED:
		h.bytes[dice(f, (uint32_t)h.len)] ^= (uint8_t)(1u << dice(f, 8));
		break;
	case RENUMBERED: h.bytes[24 + dice(f, 8)] ^= (uint8_t)(1 + dice(f, 255)); break;
	case FORGED:
		randombytes_buf(key, sizeof key);
		memset(key, 0, dice(f, 2) ? sizeof key : 0);
		h.bytes[24 + dice(f, 4)] ^= (uint8_t)(1 + dice(f, 255));
		fdp_wire_sign(key, h.bytes, h.len);
		break;
	default: break;
	}
	throw_at(f, kind, h.port, h.bytes, h.len);
}

static void take_answers(struct forger *f)
{
	uint8_t bytes[2048];
	ssize_t n;

	while ((n = recv(f->fd, bytes, sizeof bytes, MSG_DONTWAIT)) >= 0 || errno == ECONNREFUSED)
		if (n >= 0) {
			f->answers++;
			f->bytes_in += (uint64_t)n;
		}
}

static void run(struct forger *f, uint64_t count, uint64_t a_second)
{
	const int64_t from_ns = gr_clock_now(&gr_clock_monotonic);

	for (uint64_t i = 0; i < count; i++) {
		const int64_t due_ns = from_ns + (int64_t)((double)i * 1e9 / (double)a_second);

		if (i % 16 == 0)
			listen_in(f);
		throw_one(f);
		if (i % 16 == 0)
			take_answers(f);
		while (i % 16 == 0 && gr_clock_now(&gr_clock_monotonic) < due_ns)
			usleep(200);
	}
	usleep(300000);
	take_answers(f);
}

int main(int argc, char **argv)
{
	struct forger f = { .random = { 77 } };
	struct sockaddr_ll at = { .sll_family = AF_PACKET, .sll_protocol = htons(ETH_P_IP),
				  .sll_ifindex = (int)if_nametoindex("lo") };
	uint64_t all = 0;

	if (argc != 6 || sodium_init() < 0)
		return 2;
	f.master_port = (uint16_t)atoi(argv[1]);
	f.node_port = (uint16_t)atoi(argv[2]);
	f.nodes = (uint16_t)atoi(argv[3]);
	f.wire = socket(AF_PACKET, SOCK_DGRAM, htons(ETH_P_IP));
	f.fd = socket(AF_INET, SOCK_DGRAM, 0);
	f.tape = calloc(TAPE, sizeof *f.tape);
	if (f.wire < 0 || bind(f.wire, (const struct sockaddr *)&at, sizeof at) < 0) {
		perror("cannot listen on the loopback wire");
		return 77;
	}
	if (f.fd < 0 || !f.tape)
		return 1;
	/* What is said at the joining is the most worth having: until it has been heard, wait. */
	printf("listens\n");
	fflush(stdout);
	for (int i = 0; i < 600 && f.heard < 500; i++) {
		listen_in(&f);
		usleep(100000);
	}
	run(&f, strtoull(argv[4], NULL, 10), strtoull(argv[5], NULL, 10));
	for (int i = 0; i < KINDS; i++) {
		all += f.thrown[i];
		printf("%s %llu\n", kind_names[i], (unsigned long long)f.thrown[i]);
	}
	printf("heard %zu thrown %llu at_master %llu bytes %llu answers %llu answer_bytes %llu\n", f.heard,
	       (unsigned long long)all, (unsigned long long)f.at_master,
	       (unsigned long long)f.bytes_out, (unsigned long long)f.answers,
	       (unsigned long long)f.bytes_in);
	free(f.tape);
	return 0;
}
