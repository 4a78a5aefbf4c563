/*
 * A network interface as /sys/class/net tells it, and what the kernel's tables
 * say of bridges and of groups.
 */
#ifndef GROTTO_TOOLS_DOCTOR_LINK_H
#define GROTTO_TOOLS_DOCTOR_LINK_H

#include "tools/doctor/finding.h"

#include <stdint.h>

#define LINK_NAME 16 /* IF_NAMESIZE */
#define LINK_UNKNOWN (-1)

struct link_facts {
	char name[LINK_NAME];
	bool present, loopback;
	char state[16], duplex[16], driver[32]; /* "" where it is not told */
	int64_t mtu, speed_mbit;                /* LINK_UNKNOWN */
	/* Counters since the interface came up; LINK_UNKNOWN. */
	int64_t rx_packets, tx_packets, rx_errors, tx_errors, rx_dropped, tx_dropped, rx_missed;
	/* The bridge that it is, or is a port of; "" for none. */
	char bridge[LINK_NAME];
	int64_t snooping, querier; /* of the bridge, 0 or 1; LINK_UNKNOWN */
};

/* Never fails: what is not there is unknown. */
void link_read(const char *root, const char *name, struct link_facts *out);

struct finding link_judge_state(const struct link_facts *facts);
struct finding link_judge_speed(const struct link_facts *facts);
/* mtu: the layout's. */
struct finding link_judge_mtu(const struct link_facts *facts, int mtu);
/* Errors and drops, against what went through. */
struct finding link_judge_counters(const struct link_facts *facts);

/*
 * Multicast membership. igmp: /proc/net/igmp, whose "Querier" column is V1 or V2
 * once a query of that version was heard, and V3 otherwise too.
 */
struct finding link_judge_querier(const struct link_facts *facts, const char *igmp);
/* How many groups are joined on the interface; LINK_UNKNOWN where the table does not have it. */
int64_t link_groups(const char *igmp, const char *name, char querier[8]);

#endif
