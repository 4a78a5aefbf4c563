#include "tools/doctor/sockets.h"

#include "tools/doctor/sysfile.h"

#include <ctype.h>
#include <dirent.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define OWNER_FDS_MOST 4096 /* of one process that are looked at */

/* Words of native byte order, as the kernel prints them: "0100007F". */
static bool parse_address(const char *hex, size_t digits, uint8_t out[16])
{
	for (size_t word = 0; word < digits / 8; word++) {
		char text[9];
		uint32_t value;

		memcpy(text, hex + 8 * word, 8);
		text[8] = '\0';
		value = (uint32_t)strtoul(text, NULL, 16);
		memcpy(out + 4 * word, &value, sizeof value);
	}
	return digits == 8 || digits == 32;
}

static bool parse_line(const char *line, uint8_t address[16], size_t *address_len, unsigned *port,
		       struct socket_facts *out)
{
	char local[33] = "";
	unsigned long long drops;
	unsigned long inode;
	unsigned uid;
	int at = 0;
	size_t digits;

	/* sl local rem st tx:rx tr:tm retrnsmt uid timeout inode ref pointer drops */
	if (sscanf(line, " %*u: %32[0-9A-Fa-f]:%4x %*[0-9A-Fa-f]:%*x %*x %*x:%*x %*x:%*x %*x %u %*d %lu%n",
		   local, port, &uid, &inode, &at) != 4 || at == 0)
		return false;
	if (sscanf(line + at, " %*u %*s %llu", &drops) != 1)
		return false;
	digits = strlen(local);
	if ((digits != 8 && digits != 32) || !parse_address(local, digits, address))
		return false;
	*address_len = digits / 2;
	*out = (struct socket_facts){ .held = true, .inode = inode, .uid = uid, .drops = drops };
	return true;
}

bool sockets_find(const char *table, const uint8_t *address, size_t address_len, uint16_t port,
		  struct socket_facts *out)
{
	static const uint8_t any[16];

	*out = (struct socket_facts){ 0 };
	for (const char *line = table; line && *line; line = strchr(line, '\n')) {
		struct socket_facts facts;
		uint8_t local[16];
		unsigned local_port;
		size_t len;

		line += *line == '\n';
		if (!parse_line(line, local, &len, &local_port, &facts) || local_port != port ||
		    len != address_len)
			continue;
		if (!memcmp(local, address, len) || !memcmp(local, any, len)) {
			*out = facts;
			return true;
		}
	}
	return false;
}

static bool holds(const char *root, const char *pid, unsigned long inode)
{
	char path[SYSFILE_PATH], wanted[64], name[64];
	int looked = 0;
	bool found = false;
	DIR *dir;

	if (snprintf(path, sizeof path, "%s/proc/%s/fd", root, pid) >= (int)sizeof path)
		return false;
	dir = opendir(path);
	if (!dir)
		return false;
	snprintf(wanted, sizeof wanted, "socket:[%lu]", inode);
	for (struct dirent *entry; !found && looked < OWNER_FDS_MOST && (entry = readdir(dir)); looked++)
		found = isdigit((unsigned char)entry->d_name[0]) &&
			sysfile_link(root, name, sizeof name, "/proc/%.16s/fd/%.16s", pid, entry->d_name) &&
			!strcmp(name, wanted);
	closedir(dir);
	return found;
}

void sockets_find_owner(const char *root, struct socket_facts *facts)
{
	char path[SYSFILE_PATH];
	DIR *dir;

	if (!facts->held || facts->inode == 0 ||
	    snprintf(path, sizeof path, "%s/proc", root) >= (int)sizeof path)
		return;
	dir = opendir(path);
	for (struct dirent *entry; dir && facts->pid == 0 && (entry = readdir(dir));) {
		if (!isdigit((unsigned char)entry->d_name[0]) || !holds(root, entry->d_name, facts->inode))
			continue;
		facts->pid = (pid_t)strtol(entry->d_name, NULL, 10);
		sysfile_word(root, facts->program, sizeof facts->program, "/proc/%d/comm", (int)facts->pid);
	}
	if (dir)
		closedir(dir);
}

struct finding sockets_judge_port(const struct socket_facts *f, uint16_t port, const char *program)
{
	if (!f->held)
		return finding(FINDING_OK, "UDP port %u is free", port);
	if (f->pid == 0)
		return finding_do(finding(FINDING_SKIP, "UDP port %u is held by a process of user %u that may "
					  "not be seen", port, f->uid),
				  "ask again as root, or as that user");
	if (!strcmp(f->program, program))
		return finding(FINDING_OK, "UDP port %u is held by %s, process %d", port, program, (int)f->pid);
	return finding_do(finding(FINDING_FAIL, "UDP port %u is held by %s, process %d, and not by %s", port,
				  f->program[0] ? f->program : "a program", (int)f->pid, program),
			  "end that program, or give the daemon another port in the layout");
}

struct finding sockets_judge_drops(const struct socket_facts *f, uint16_t port)
{
	if (!f->held)
		return finding(FINDING_SKIP, "no daemon on port %u: nothing to count", port);
	if (f->drops > 0)
		return finding_do(finding(FINDING_WARN, "%" PRIu64 " datagrams came to port %u and found its "
					  "buffer full", f->drops, port),
				  "raise net.core.rmem_max (check `buffers`), give the daemon --priority");
	return finding(FINDING_OK, "no datagram to port %u found its buffer full", port);
}

int64_t sockets_snmp(const char *snmp, const char *protocol, const char *name)
{
	size_t n = strlen(protocol);
	const char *heads = NULL;

	for (const char *line = snmp; line && *line; line = strchr(line, '\n')) {
		const char *head, *value;

		line += *line == '\n';
		if (strncmp(line, protocol, n) || line[n] != ':')
			continue;
		if (!heads) {
			heads = line;
			continue;
		}
		/* The line of names, and now that of values: word by word. */
		head = heads + n + 1;
		value = line + n + 1;
		for (;;) {
			size_t head_len, value_len;

			head += strspn(head, " ");
			value += strspn(value, " ");
			head_len = strcspn(head, " \n");
			value_len = strcspn(value, " \n");
			if (!head_len || !value_len)
				return -1;
			if (head_len == strlen(name) && !strncmp(head, name, head_len)) {
				char *end;
				long long number = strtoll(value, &end, 10);
				return end == value + value_len && number >= 0 ? number : -1;
			}
			head += head_len;
			value += value_len;
		}
	}
	return -1;
}

struct finding sockets_judge_snmp(const char *snmp)
{
	int64_t full = sockets_snmp(snmp, "Udp", "RcvbufErrors");
	int64_t sums = sockets_snmp(snmp, "Udp", "InCsumErrors");
	int64_t in = sockets_snmp(snmp, "Udp", "InDatagrams");

	if (full < 0 || in < 0)
		return finding(FINDING_SKIP, "the kernel's UDP counters cannot be read");
	if (sums > 0)
		return finding_do(finding(FINDING_WARN, "%" PRId64 " datagrams had a wrong checksum (of all "
					  "programs, since the start)", sums),
				  "something on the way damages packets: change cable, card, switch port");
	if (full > 0)
		return finding_do(finding(FINDING_WARN, "%" PRId64 " of %" PRId64 " datagrams found a full buffer "
					  "(of all programs, since the start)", full, full + in),
				  "where it grows while the room runs: raise net.core.rmem_max");
	return finding(FINDING_OK, "no datagram of %" PRId64 " found a full buffer or had a wrong checksum", in);
}

struct finding sockets_judge_buffer(const char *which, int64_t most, int64_t wanted, int64_t got,
				    bool exempt)
{
	if (most < 0 && got < 0)
		return finding(FINDING_SKIP, "net.core.%s cannot be read", which);
	if (exempt || most >= wanted || (most < 0 && got >= wanted))
		return finding(FINDING_OK, "net.core.%s allows the %" PRId64 " bytes that a daemon asks for%s",
			       which, wanted, most < wanted && exempt ? " (to this user)" : "");
	return finding_do(finding(FINDING_WARN, "net.core.%s allows %" PRId64 " bytes, a daemon asks for %" PRId64
				  "%s", which, most < 0 ? got : most, wanted,
				  got >= 0 && got < wanted ? "; a socket got no more" : ""),
			  "sysctl -w net.core.%s=%" PRId64 ", and the same line in /etc/sysctl.d/grotto.conf",
			  which, wanted);
}
