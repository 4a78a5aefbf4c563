#include "tools/doctor/firewall.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#define LINE 1024

/* The next line without its newline and indentation, cut to LINE - 1; NULL at the end. */
static const char *next_line(const char *at, char line[LINE])
{
	size_t n;

	if (!*at)
		return NULL;
	at += strspn(at, " \t");
	n = strcspn(at, "\n");
	snprintf(line, LINE, "%.*s", (int)(n < LINE - 1 ? n : LINE - 1), at);
	return at[n] ? at + n + 1 : at + n;
}

static bool has_word(const char *line, const char *word)
{
	size_t n = strlen(word);

	for (const char *at = strstr(line, word); at; at = strstr(at + 1, word))
		if ((at == line || !isalnum((unsigned char)at[-1])) && !isalnum((unsigned char)at[n]))
			return true;
	return false;
}

/*
 * Ports as nft and iptables write them: "27100", "27100-27110", "27100:27110",
 * "{ 53, 27100-27110 }", "53,27100". Up to the first thing that is none.
 */
static bool ports_hold(const char *text, uint16_t port)
{
	text += strspn(text, " {");
	while (isdigit((unsigned char)*text)) {
		char *end;
		unsigned long first = strtoul(text, &end, 10), last = first;

		if ((*end == '-' || *end == ':') && isdigit((unsigned char)end[1]))
			last = strtoul(end + 1, &end, 10);
		if (first <= port && port <= last)
			return true;
		text = end + strspn(end, " ,");
	}
	return false;
}

static bool drops(const char *line)
{
	return has_word(line, "drop") || has_word(line, "reject") || has_word(line, "DROP") ||
	       has_word(line, "REJECT");
}

static bool accepts(const char *line)
{
	return has_word(line, "accept") || has_word(line, "ACCEPT");
}

static void keep(struct firewall_symptom *symptom, enum firewall_verdict verdict, const char *line)
{
	symptom->verdict = verdict;
	snprintf(symptom->rule, sizeof symptom->rule, "%.*s", (int)sizeof symptom->rule - 1, line);
}

/* The rule's own word on the port, the first of a chain wins. True: it has one. */
static bool read_rule(const char *line, const char *key, uint16_t port, struct firewall_symptom *symptom)
{
	const char *at = strstr(line, key);

	if (!at || !ports_hold(at + strlen(key), port) || (!drops(line) && !accepts(line)))
		return false;
	keep(symptom, drops(line) ? FIREWALL_DROPS : FIREWALL_OPENED, line);
	return true;
}

/* What a rule without any condition does: behind counters a lone verdict. */
static const char *lone_verdict(const char *line)
{
	unsigned long long packets, bytes;
	int n = 0;

	if (sscanf(line, "counter packets %llu bytes %llu %n", &packets, &bytes, &n) == 2 && n > 0)
		line += n;
	return !strncmp(line, "accept", 6) || !strncmp(line, "drop", 4) || !strncmp(line, "reject", 6) ?
		       line : NULL;
}

static bool read_lone(const char *line, struct firewall_symptom *symptom)
{
	const char *verdict = lone_verdict(line);

	if (!strcmp(line, "meta l4proto udp accept") || !strcmp(line, "ip protocol udp accept"))
		verdict = "accept";
	if (verdict)
		keep(symptom, verdict[0] == 'a' ? FIREWALL_OPENED : FIREWALL_POLICY, line);
	return verdict != NULL;
}

/* Of two chains the worse counts: a datagram must pass both. */
static void worse(struct firewall_symptom *all, const struct firewall_symptom *chain)
{
	static const int rank[] = { [FIREWALL_OPEN] = 0, [FIREWALL_OPENED] = 1, [FIREWALL_POLICY] = 2,
				    [FIREWALL_DROPS] = 3 };

	if (rank[chain->verdict] > rank[all->verdict])
		*all = *chain;
}

/* Chains that are jumped to are not followed: that one of them accepts is believed. */
static void believe(struct firewall_symptom *all, const struct firewall_symptom *elsewhere)
{
	if (all->verdict == FIREWALL_POLICY && elsewhere->verdict == FIREWALL_OPENED)
		*all = *elsewhere;
}

struct firewall_symptom firewall_read_nft(const char *ruleset, uint16_t port)
{
	struct firewall_symptom all = { 0 }, chain = { 0 }, elsewhere = { 0 };
	bool base = false, decided = false;
	char line[LINE];

	for (const char *at = ruleset; at && (at = next_line(at, line)) != NULL;) {
		struct firewall_symptom rule = { 0 };

		if (!strncmp(line, "chain ", 6)) {
			base = decided = false;
			chain = (struct firewall_symptom){ 0 };
		} else if (!strncmp(line, "type ", 5)) {
			base = has_word(line, "input") || has_word(line, "ingress") ||
			       has_word(line, "prerouting");
			if (base && strstr(line, "policy drop"))
				keep(&chain, FIREWALL_POLICY, line);
		} else if (line[0] == '}') {
			if (base)
				worse(&all, &chain);
			base = false;
		} else if (read_rule(line, "udp dport", port, &rule) ||
			   read_rule(line, "th dport", port, &rule) || (base && read_lone(line, &rule))) {
			if (!base && rule.verdict == FIREWALL_OPENED)
				elsewhere = rule;
			else if (base && !decided)
				chain = rule;
			decided = true;
		}
	}
	believe(&all, &elsewhere);
	return all;
}

static bool iptables_lone(const char *line, struct firewall_symptom *symptom)
{
	if (!strcmp(line, "-A INPUT -j ACCEPT") || !strcmp(line, "-A INPUT -p udp -j ACCEPT"))
		keep(symptom, FIREWALL_OPENED, line);
	else if (!strncmp(line, "-A INPUT -j DROP", 16) || !strncmp(line, "-A INPUT -j REJECT", 18))
		keep(symptom, FIREWALL_POLICY, line);
	else
		return false;
	return true;
}

struct firewall_symptom firewall_read_iptables(const char *rules, uint16_t port)
{
	struct firewall_symptom chain = { 0 }, elsewhere = { 0 };
	bool decided = false;
	char line[LINE];

	for (const char *at = rules; at && (at = next_line(at, line)) != NULL;) {
		struct firewall_symptom rule = { 0 };
		bool input = !strncmp(line, "-A INPUT ", 9);

		if (!strcmp(line, "-P INPUT DROP") && !decided) {
			keep(&chain, FIREWALL_POLICY, line);
		} else if ((strstr(line, "-p udp") && (read_rule(line, "--dport ", port, &rule) ||
						       read_rule(line, "--dports ", port, &rule))) ||
			   (input && iptables_lone(line, &rule))) {
			if (!input && rule.verdict == FIREWALL_OPENED)
				elsewhere = rule;
			else if (input && !decided)
				chain = rule;
			decided = decided || input;
		}
	}
	believe(&chain, &elsewhere);
	return chain;
}

struct finding firewall_judge(const char *tool, const struct firewall_symptom *symptom, uint16_t port)
{
	if (!symptom)
		return finding(FINDING_SKIP, "the rules of %s cannot be read (as root they can)", tool);
	switch (symptom->verdict) {
	case FIREWALL_OPEN: return finding(FINDING_OK, "%s has no rule that drops UDP port %u", tool, port);
	case FIREWALL_OPENED:
		return finding(FINDING_OK, "%s lets UDP port %u in: %s", tool, port, symptom->rule);
	case FIREWALL_DROPS:
		return finding_do(finding(FINDING_FAIL, "%s drops UDP port %u: %s", tool, port, symptom->rule),
				  "take that rule away for the room's interface");
	case FIREWALL_POLICY: break;
	}
	return finding_do(finding(FINDING_WARN, "%s drops what no rule accepts, and none accepts UDP port %u", tool,
				  port),
			  "accept it on the room's interface: `%s`", !strcmp(tool, "nft") ?
				  "nft add rule inet filter input udp dport PORT accept" :
				  "iptables -A INPUT -p udp --dport PORT -j ACCEPT");
}
