/*
 * What the rules of nft and iptables say of a UDP port, as far as they can be
 * read without following them: named sets, maps, jumps and other conditions of a
 * rule are not understood, so an answer is a symptom and no proof.
 */
#ifndef GROTTO_TOOLS_DOCTOR_FIREWALL_H
#define GROTTO_TOOLS_DOCTOR_FIREWALL_H

#include "tools/doctor/finding.h"

#include <stdint.h>

enum firewall_verdict {
	FIREWALL_OPEN,   /* nothing is seen that would drop it */
	FIREWALL_OPENED, /* a rule accepts the port */
	FIREWALL_DROPS,  /* a rule drops or rejects the port */
	FIREWALL_POLICY, /* the chain drops what no rule accepts, and none is seen that does */
};

struct firewall_symptom {
	enum firewall_verdict verdict;
	char rule[160]; /* what says so, "" for none */
};

/* `nft list ruleset`: base chains at hook input, ingress or prerouting. */
struct firewall_symptom firewall_read_nft(const char *ruleset, uint16_t port);
/* `iptables -S`: chain INPUT. */
struct firewall_symptom firewall_read_iptables(const char *rules, uint16_t port);

/* tool: "nft"; symptom NULL: its rules could not be read. */
struct finding firewall_judge(const char *tool, const struct firewall_symptom *symptom, uint16_t port);

#endif
