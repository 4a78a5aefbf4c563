/* Trackers that come by the network: addresses, ports, names. */
#include "config/address.h"
#include "config/layout_check.h"

#include <ctype.h>
#include <net/if.h>
#include <string.h>

#define DEVICE_MOST 99 /* bytes of a VRPN device's name */

static void check_machine(struct options_reader *reader, const config_setting_t *at,
			  const char *text)
{
	struct address address;

	if (!text)
		return;
	if (!address_parse(text, &address) || !address.v4)
		options_fault(reader, GR_DIAG_ERROR, at, "address",
			      "\"%.80s\" is not a numeric IPv4 address; write it as 192.0.2.1",
			      text);
	else if (!address_of_machine(&address))
		options_fault(reader, GR_DIAG_ERROR, at, "address",
			      "%.80s is not one machine's address", text);
}

/* Two that hear one port: each would get a part of what comes. */
static void check_port(struct options_reader *reader, const struct layout_file *file, size_t i)
{
	const struct layout_file_tracker *entry = &file->trackers[i];
	const uint16_t port = entry->dtrack.dtrack.port;
	const config_setting_t *at = entry->dtrack.at ? entry->dtrack.at : entry->at;
	const char *key = entry->dtrack.at ? "port" : "dtrack";

	for (size_t j = 0; j < i; j++)
		if (file->trackers[j].tracker.kind == LAYOUT_TRACKER_DTRACK &&
		    file->trackers[j].dtrack.dtrack.port == port)
			options_fault(reader, GR_DIAG_ERROR, at, key,
				      "UDP port %u is tracker \"%s\"'s; give each controller its own",
				      port, file->trackers[j].tracker.name);
	if (port == file->network.network.master_port)
		options_fault(reader, GR_DIAG_ERROR, at, key,
			      "UDP port %u is the master's own (network.master_port)", port);
}

static void check_group(struct options_reader *reader, const struct layout_file_dtrack *dtrack)
{
	const char *group = dtrack->dtrack.group, *interface = dtrack->dtrack.interface;
	struct address address;

	if (group && (!address_parse(group, &address) || !address.v4 ||
		      !address_multicast(&address)))
		options_fault(reader, GR_DIAG_ERROR, dtrack->at, "group",
			      "\"%.80s\" is not an IPv4 multicast group; those are 224.0.0.0 to "
			      "239.255.255.255",
			      group);
	if (interface && strlen(interface) >= IF_NAMESIZE)
		options_fault(reader, GR_DIAG_ERROR, dtrack->at, "interface",
			      "\"%.80s\" is not an interface's name; those have 1 to %d bytes",
			      interface, IF_NAMESIZE - 1);
	if (interface && !group)
		options_fault(reader, GR_DIAG_WARNING, dtrack->at, "interface",
			      "not used: only a group is heard on an interface");
}

static void check_dtrack(struct options_reader *reader, const struct layout_file *file, size_t i)
{
	const struct layout_file_dtrack *dtrack = &file->trackers[i].dtrack;

	check_machine(reader, dtrack->at, dtrack->dtrack.address);
	check_group(reader, dtrack);
	check_port(reader, file, i);
	if (dtrack->dtrack.knock && !dtrack->dtrack.address)
		options_fault(reader, GR_DIAG_ERROR, dtrack->at, "knock",
			      "needs the controller's address to send to");
}

static void check_device_name(struct options_reader *reader, const config_setting_t *at,
			      const char *name)
{
	if (strlen(name) > DEVICE_MOST)
		options_fault(reader, GR_DIAG_ERROR, at, "device", "too long; at most %d bytes",
			      DEVICE_MOST);
	if (strchr(name, '@'))
		options_fault(reader, GR_DIAG_ERROR, at, "device",
			      "\"%.80s\" has an @; the name goes before it, the server is `address`",
			      name);
	for (const char *c = name; *c; c++)
		if (!isprint((unsigned char)*c)) {
			options_fault(reader, GR_DIAG_ERROR, at, "device",
				      "byte %d is no printable ASCII character",
				      (int)(c - name) + 1);
			break;
		}
}

static void check_vrpn(struct options_reader *reader, const struct layout_file_tracker *entry)
{
	const struct layout_file_vrpn *vrpn = &entry->vrpn;

	if (!vrpn->at) {
		options_fault(reader, GR_DIAG_ERROR, entry->at, "vrpn",
			      "missing; say which device of which server: vrpn = { device = "
			      "\"Tracker0\"; address = \"192.0.2.1\"; }");
		return;
	}
	check_machine(reader, vrpn->at, vrpn->vrpn.address);
	if (vrpn->vrpn.device)
		check_device_name(reader, vrpn->at, vrpn->vrpn.device);
}

void layout_check_tracker_network(struct options_reader *reader, const struct layout_file *file,
				  size_t i)
{
	const struct layout_file_tracker *entry = &file->trackers[i];
	const struct layout_tracker *tracker = &entry->tracker;

	if (tracker->kind == LAYOUT_TRACKER_DTRACK)
		check_dtrack(reader, file, i);
	else if (tracker->kind == LAYOUT_TRACKER_VRPN)
		check_vrpn(reader, entry);
	else
		return;
	if (tracker->serial || tracker->number)
		options_fault(reader, GR_DIAG_WARNING, entry->at,
			      tracker->serial ? "serial" : "number",
			      "not used: what comes by the network is told apart by its address");
}
