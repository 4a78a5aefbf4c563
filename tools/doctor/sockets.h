/*
 * The kernel's tables of UDP: who holds a port, what it lost; and buffers.
 */
#ifndef GROTTO_TOOLS_DOCTOR_SOCKETS_H
#define GROTTO_TOOLS_DOCTOR_SOCKETS_H

#include "tools/doctor/finding.h"

#include <stdint.h>
#include <sys/types.h>

struct socket_facts {
	bool held;
	unsigned long inode;
	unsigned uid;
	uint64_t drops; /* datagrams that found the buffer full */
	/* Of the process, where it may be seen: */
	pid_t pid;      /* 0: unknown */
	char program[32];
};

/*
 * A socket on that local port in /proc/net/udp or udp6: on `address` (network order,
 * 4 or 16 bytes) or on all addresses. Lines that do not have the form are passed over.
 */
bool sockets_find(const char *table, const uint8_t *address, size_t address_len, uint16_t port,
		  struct socket_facts *out);
/* Looks through root/proc for who has the inode open: as root, or one's own. */
void sockets_find_owner(const char *root, struct socket_facts *facts);

/* program: "grotto-master" or "grotto-node", who should hold it. */
struct finding sockets_judge_port(const struct socket_facts *facts, uint16_t port, const char *program);
struct finding sockets_judge_drops(const struct socket_facts *facts, uint16_t port);

/* A counter of /proc/net/snmp: ("Udp", "RcvbufErrors"); -1 where there is none. */
int64_t sockets_snmp(const char *snmp, const char *protocol, const char *name);
struct finding sockets_judge_snmp(const char *snmp);

/*
 * which: "rmem_max"; most: its value, -1 unknown; wanted: what the daemons ask for;
 * got: what a socket of ours got (the kernel's doubling taken out), -1 unknown;
 * exempt: who runs the daemons may pass the limit (CAP_NET_ADMIN).
 */
struct finding sockets_judge_buffer(const char *which, int64_t most, int64_t wanted, int64_t got,
				    bool exempt);

#endif
