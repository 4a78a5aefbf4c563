#include "config/address.h"
#include "config/layout_check.h"

#include <net/if.h>
#include <string.h>

/* Least MTU that IPv6 allows (RFC 8200, section 5). */
#define MTU_MIN_V6 1280

struct endpoint {
	const struct layout_file_node *node;       /* NULL: a master */
	const struct layout_file_standby *standby; /* NULL: a node, or the first master */
	struct address address;
	uint16_t port;
};

/* A machine's address, or false and a fault. */
static bool machine_address(struct options_reader *reader, const config_setting_t *at,
			    const char *key, const char *text, struct address *out)
{
	if (!address_parse(text, out)) {
		options_fault(reader, GR_DIAG_ERROR, at, key,
			      "\"%.80s\" is not a numeric IPv4 or IPv6 address%s", text,
			      !strcmp(text, "localhost") ? ", did you mean \"127.0.0.1\"?" :
							   "; write it as 192.0.2.1 or 2001:db8::1");
		return false;
	}
	if (!address_of_machine(out)) {
		options_fault(reader, GR_DIAG_ERROR, at, key,
			      "%.80s is not one machine's address; give the one that the others reach it by",
			      text);
		return false;
	}
	return true;
}

static bool end_is_first_master(const struct endpoint *end)
{
	return !end->node && !end->standby;
}

static const config_setting_t *end_at(const struct endpoint *end, const struct layout_file *file)
{
	return end->node ? end->node->at : end->standby ? end->standby->at : file->at;
}

static const char *end_address(const struct endpoint *end, const struct layout_file *file)
{
	return end->node      ? end->node->node.address
	       : end->standby ? end->standby->standby.address
			      : file->network.network.master_address;
}

static void check_clash(struct options_reader *reader, const struct layout_file *file,
			const struct endpoint *ends, size_t count)
{
	const struct endpoint *last = &ends[count - 1];

	for (size_t i = 0; i + 1 < count; i++) {
		if (ends[i].port != last->port || !address_equal(&ends[i].address, &last->address))
			continue;
		options_fault(reader, GR_DIAG_ERROR, end_at(last, file), "port",
			      "%s port %u is taken by %s%s%s; give each its own",
			      end_address(last, file), last->port,
			      ends[i].node ? "node \"" : ends[i].standby ? "a standby" : "the master",
			      ends[i].node ? ends[i].node->node.name : "", ends[i].node ? "\"" : "");
		return;
	}
}

static void check_group(struct options_reader *reader, const struct layout_file *file,
			const struct address *master)
{
	const struct layout_network *network = &file->network.network;
	const char *key = "network.group";
	const bool broadcast = network->cast == LAYOUT_BROADCAST;
	struct address group;

	if (network->cast == LAYOUT_UNICAST) {
		if (network->group)
			options_fault(reader, GR_DIAG_WARNING, file->at, key,
				      "not used: cast is \"unicast\"");
		return;
	}
	if (!network->group) {
		if (!options_given(file->network.at, "group"))
			options_fault(reader, GR_DIAG_ERROR, file->at, key,
				      "missing; cast = \"%s\" needs %s",
				      broadcast ? "broadcast" :
				      network->cast == LAYOUT_AUTO ? "auto" : "multicast",
				      broadcast ? "the net's broadcast address such as \"192.0.2.255\"" :
						  "a multicast group such as \"239.192.71.1\"");
		return;
	}
	if (!address_parse(network->group, &group)) {
		options_fault(reader, GR_DIAG_ERROR, file->at, key,
			      "\"%.80s\" is not a numeric IPv4 or IPv6 address", network->group);
	} else if (!broadcast && !address_multicast(&group)) {
		options_fault(reader, GR_DIAG_ERROR, file->at, key,
			      "%s is not a multicast group; those are 224.0.0.0 to 239.255.255.255 "
			      "(239.192.0.0/14 for a site's own) and ff00::/8",
			      network->group);
	} else if (broadcast &&
		   (!group.v4 || address_multicast(&group) || address_unspecified(&group) ||
		    /* the loopback net has one, too: a room on one machine */
		    (address_loopback(&group) && strcmp(network->group, "127.255.255.255")))) {
		options_fault(reader, GR_DIAG_ERROR, file->at, key,
			      "%s is not an IPv4 broadcast address; it looks like 192.0.2.255",
			      network->group);
	} else if (master && group.v4 != master->v4) {
		options_fault(reader, GR_DIAG_ERROR, file->at, key,
			      "is IPv%c, the master's address IPv%c; use one of the two",
			      group.v4 ? '4' : '6', master->v4 ? '4' : '6');
	}
}

static void check_interface(struct options_reader *reader, const struct layout_file *file)
{
	const char *name = file->network.network.interface;

	if (name && (strlen(name) >= IF_NAMESIZE || strpbrk(name, "/ ")))
		options_fault(reader, GR_DIAG_ERROR, file->at, "network.interface",
			      "\"%.80s\" is not an interface's name; those have 1 to %d bytes without '/' and "
			      "blanks, see \"ip link\"",
			      name, IF_NAMESIZE - 1);
}

/* A group that does not come back to its machine reaches no node there. */
static void check_loop(struct options_reader *reader, const struct layout_file *file,
		       const struct endpoint *ends, size_t count)
{
	const struct layout_network *network = &file->network.network;

	if (network->loop || network->cast == LAYOUT_UNICAST || network->cast == LAYOUT_BROADCAST)
		return;
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < count; k++) {
			if (!ends[i].node || ends[k].node || !address_equal(&ends[i].address, &ends[k].address))
				continue;
			options_fault(reader, GR_DIAG_ERROR, file->at, "network.loop",
				      "false, but node \"%s\" is on %s machine and would not hear "
				      "the group; leave it out",
				      ends[i].node->node.name, ends[k].standby ? "a standby's" : "the master's");
			return;
		}
}

#define NEEDS_KEY "so every machine needs the cluster's key: network.key_file = \"/etc/grotto/cluster.key\""

/* Where the group's datagrams go when there is no key. */
static void check_group_key(struct options_reader *reader, const struct layout_file *file)
{
	const struct layout_network *network = &file->network.network;
	struct address group;

	if (network->cast == LAYOUT_BROADCAST) {
		/* An interface does not hold a broadcast, its address does. */
		if (network->group && address_parse(network->group, &group) && !address_loopback(&group))
			options_fault(reader, GR_DIAG_ERROR, file->at, "network.group",
				      "%s is not on loopback, " NEEDS_KEY ", or cast to 127.255.255.255",
				      network->group);
	} else if (network->cast != LAYOUT_UNICAST && !network->interface) {
		options_fault(reader, GR_DIAG_ERROR, file->at, "network.interface",
			      "missing, and the system's choice is not loopback, " NEEDS_KEY
			      ", or say interface = \"lo\"");
	} else if (network->cast != LAYOUT_UNICAST && strcmp(network->interface, "lo")) {
		options_fault(reader, GR_DIAG_ERROR, file->at, "network.interface",
			      "\"%.80s\" is not loopback, " NEEDS_KEY ", or say \"lo\"",
			      network->interface);
	}
}

/* Who holds no key may only be talked to where nobody else listens. */
static void check_key(struct options_reader *reader, const struct layout_file *file,
		      const struct endpoint *ends, size_t count)
{
	const struct layout_network *network = &file->network.network;

	if (network->key_file || options_given(file->network.at, "key_file"))
		return;
	for (size_t i = 0; i < count; i++) {
		if (address_loopback(&ends[i].address))
			continue;
		options_fault(reader, GR_DIAG_ERROR, end_at(&ends[i], file),
			      end_is_first_master(&ends[i]) ? "network.master_address" : "address",
			      "%s is not on loopback, " NEEDS_KEY, end_address(&ends[i], file));
		return;
	}
	check_group_key(reader, file);
}

/* Faults stop walls: nobody is to meet them who is there for the room. */
static void check_test(struct options_reader *reader, const struct layout_file *file,
		       const struct endpoint *ends, size_t count)
{
	const struct layout_test *test = &file->test.test;
	bool off = false;

	for (size_t i = 0; i < count; i++)
		off = off || !address_loopback(&ends[i].address);
	if (test->faults && off && !test->off_loopback)
		options_fault(reader, GR_DIAG_ERROR, file->test.at, "faults",
			      "the room is not on loopback, and faults would stop its walls; if it is for tests "
			      "say off_loopback = true, too");
	if (test->off_loopback && !test->faults)
		options_fault(reader, GR_DIAG_WARNING, file->test.at, "off_loopback", "not used: faults is false");
}

/* How many there may be; what their addresses clash with is seen with the nodes'. */
static void check_standbys(struct options_reader *reader, const struct layout_file *file, size_t nodes)
{
	const size_t masters = 1 + file->standby_count;

	if (file->standby_count && nodes + masters > LAYOUT_MAX_NODES)
		options_fault(reader, GR_DIAG_ERROR, file->at, "standby",
			      "%zu nodes and %zu masters; a room with standbys has at most %d of both together",
			      nodes, masters, LAYOUT_MAX_NODES);
}

/* Adds a machine, unless its address is none: the fault is told. */
static void add_end(struct options_reader *reader, const struct layout_file *file,
		    struct endpoint *ends, size_t *count, const struct endpoint *end)
{
	const char *address = end_address(end, file);
	struct endpoint *last = &ends[*count];

	*last = *end;
	if (!address || !machine_address(reader, end_at(end, file),
					 end_is_first_master(end) ? "network.master_address" : "address",
					 address, &last->address))
		return;
	if (*count && end_is_first_master(&ends[0]) && last->address.v4 != ends[0].address.v4)
		options_fault(reader, GR_DIAG_ERROR, end_at(end, file), "address",
			      "is IPv%c, the master's IPv%c; use one of the two",
			      last->address.v4 ? '4' : '6', ends[0].address.v4 ? '4' : '6');
	++*count;
	check_clash(reader, file, ends, *count);
}

void layout_check_network(struct options_reader *reader, struct layout_file *file)
{
	const struct layout_network *network = &file->network.network;
	struct endpoint ends[LAYOUT_MAX_NODES + LAYOUT_MAX_STANDBY + 1];
	size_t count = 0, nodes = 0;
	bool master;

	add_end(reader, file, ends, &count, &(struct endpoint){ .port = network->master_port });
	master = count > 0;
	for (size_t i = 0; i < file->standby_count; i++) {
		const struct layout_file_standby *standby = &file->standby[i];

		if (standby->at)
			add_end(reader, file, ends, &count,
				&(struct endpoint){ .standby = standby, .port = standby->standby.port });
	}
	for (size_t w = 0; w < file->wall_count; w++)
		for (size_t n = 0; n < file->walls[w].node_count; n++) {
			const struct layout_file_node *node = &file->walls[w].nodes[n];

			if (nodes++ < LAYOUT_MAX_NODES && node->at)
				add_end(reader, file, ends, &count,
					&(struct endpoint){ .node = node, .port = node->node.port });
		}
	check_standbys(reader, file, nodes);
	check_group(reader, file, master ? &ends[0].address : NULL);
	check_interface(reader, file);
	check_loop(reader, file, ends, count);
	check_key(reader, file, ends, count);
	check_test(reader, file, ends, count);
	if (master && !ends[0].address.v4 && network->mtu < MTU_MIN_V6)
		options_fault(reader, GR_DIAG_ERROR, file->at, "network.mtu",
			      "%d bytes; IPv6 has at least %d", network->mtu, MTU_MIN_V6);
}
