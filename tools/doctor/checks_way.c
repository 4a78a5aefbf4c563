/* Checks of the other side: ways, group, and what a running master says. */
#include "tools/doctor/doctor.h"

#include "base/result.h"
#include "tools/doctor/room.h"
#include "tools/doctor/sysfile.h"
#include "tools/doctor/way.h"
#include "tools/report.h"

#include <errno.h>
#include <math.h>
#include <net/if.h>
#include <netinet/in.h>
#include <string.h>
#include <unistd.h>

/* The master's word on a node; NULL without a master here. */
static struct json_object *status_of(const struct doctor *d, size_t node)
{
	return d->status ? report_named(d->status, "nodes", d->layout->nodes[node].name) : NULL;
}

static bool is_live(const struct doctor *d, size_t node)
{
	struct json_object *entry = status_of(d, node);
	const char *state = entry ? report_text(entry, "state") : "";

	return !strcmp(state, "live") || !strcmp(state, "late");
}

/* looked: another node of that machine was, whose whole datagrams tell of this one's too. */
static void look_at(struct doctor *d, const char *who, const char *address, uint16_t port, bool live,
		    bool looked)
{
	size_t datagram_max = net_datagram_max(&d->layout->network);
	char where[NET_ADDRESS_TEXT];
	struct net_address to;
	struct way way;

	if (net_address_parse(address, port, &to) < 0)
		return;
	net_address_text(&to, where);
	way_look(d->root, &d->own, &to, datagram_max, live, &way);
	findings_add(&d->found, way_judge(who, where, &way, live));
	if (!looked)
		findings_add(&d->found, way_judge_whole(who, &way, datagram_max));
}

/* Masters that stand by, and the first where this machine has one that does; own: not that one. */
static void look_at_standbys(struct doctor *d, size_t own)
{
	const struct layout *layout = d->layout;

	if (own != 0 && own <= layout->standby_count)
		look_at(d, "the master", layout->network.master_address, layout->network.master_port, false,
			false);
	for (size_t i = 0; i < layout->standby_count; i++) {
		char who[32];

		snprintf(who, sizeof who, "standby %zu", i + 1);
		if (i + 1 != own)
			look_at(d, who, layout->standby[i].address, layout->standby[i].port, false, false);
	}
}

void check_ways(struct doctor *d)
{
	const struct layout *layout = d->layout;

	if (!d->own_here) {
		findings_add(&d->found, finding(FINDING_SKIP, "without the role's address nothing can be sent from it"));
		return;
	}
	if (d->node >= 0) {
		look_at(d, "the master", layout->network.master_address, layout->network.master_port,
			is_live(d, (size_t)d->node), false);
		look_at_standbys(d, layout->standby_count + 1);
		return;
	}
	for (size_t i = 0; i < layout->node_count; i++) {
		char who[LAYOUT_NAME_MAX + 8];
		bool looked = false;

		for (size_t k = 0; k < i; k++)
			looked = looked || !strcmp(layout->nodes[k].address, layout->nodes[i].address);
		snprintf(who, sizeof who, "node %s", layout->nodes[i].name);
		look_at(d, who, layout->nodes[i].address, layout->nodes[i].port, is_live(d, i), looked);
	}
	look_at_standbys(d, doctor_master(layout));
}

/* Joins as a node does, on a socket of its own that is closed again. */
static struct finding try_membership(const struct layout_network *network)
{
	struct net_address group;
	struct group_req request = { 0 };
	int fd, level, error = 0;

	if (net_address_parse(network->group, network->group_port, &group) < 0)
		return finding(FINDING_FAIL, "%s is no numeric address", network->group);
	request.gr_interface = network->interface ? if_nametoindex(network->interface) : 0;
	if (network->interface && request.gr_interface == 0)
		return finding_do(finding(FINDING_FAIL, "interface %s is not on this machine", network->interface),
				  "`ip link` lists what there is; correct network.interface");
	level = group.sa.ss_family == AF_INET6 ? IPPROTO_IPV6 : IPPROTO_IP;
	memcpy(&request.gr_group, &group.sa, group.len);
	fd = socket(group.sa.ss_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	if (fd < 0 || setsockopt(fd, level, MCAST_JOIN_GROUP, &request, sizeof request) < 0)
		error = errno;
	if (fd >= 0)
		close(fd);
	if (error)
		return finding_do(finding(FINDING_FAIL, "group %s cannot be joined on %s: %s", network->group,
					  network->interface ? network->interface : "the system's interface",
					  strerror(error)),
				  "network.interface names the room's net; `ip link` must show MULTICAST, and "
				  "`ip route` a way for 224.0.0.0/4 or a default");
	return finding(FINDING_OK, "group %s can be joined on %s", network->group,
		       network->interface ? network->interface : "the system's interface");
}

/* By the master alone, and only where no master runs: it needs the port. */
static void look_at_group(struct doctor *d)
{
	uint64_t answered = 0;
	size_t count = 0;

	if (d->port.held || d->node >= 0 || !d->own_here)
		return;
	if (doctor_ask_group(d->layout, &answered) < 0) {
		findings_add(&d->found, finding(FINDING_FAIL, "the group cannot be sent to; the log says why"));
		return;
	}
	for (size_t i = 0; i < d->layout->node_count; i++)
		count += answered >> i & 1;
	if (count == 0)
		findings_add(&d->found, finding_do(finding(FINDING_SKIP, "nobody answered the group"),
						   "`grotto doctor --node NAME --listen 60` on the nodes' machines, "
						   "and look again"));
	for (size_t i = 0; count > 0 && i < d->layout->node_count; i++) {
		const char *name = d->layout->nodes[i].name;
		if (answered >> i & 1)
			findings_add(&d->found, finding(FINDING_OK, "the group reaches node %s", name));
		else
			findings_add(&d->found,
				     finding_do(finding(FINDING_WARN, "node %s did not answer the group", name),
						"if its doctor listens: switch (snooping without querier), "
						"network.interface on both sides, firewall; or cast = \"unicast\""));
	}
}

void check_multicast(struct doctor *d)
{
	const struct layout_network *network = &d->layout->network;
	char igmp[16384];
	struct link_facts link = d->link;

	if (network->cast == LAYOUT_UNICAST) {
		findings_add(&d->found, finding(FINDING_OK, "the room does without: cast = \"unicast\""));
		return;
	}
	if (network->cast != LAYOUT_BROADCAST) {
		struct finding joined = try_membership(network);

		/* The room then goes on by unicast. */
		if (network->cast == LAYOUT_AUTO && joined.level == FINDING_FAIL)
			joined.level = FINDING_WARN;
		findings_add(&d->found, joined);
		if (sysfile_read(d->root, igmp, sizeof igmp, "/proc/net/igmp") < 0)
			igmp[0] = '\0';
		if (network->interface)
			link_read(d->root, network->interface, &link);
		findings_add(&d->found, link_judge_querier(&link, igmp));
	}
	look_at_group(d);
}

void check_room(struct doctor *d)
{
	if (!d->status) {
		findings_add(&d->found, finding(FINDING_SKIP, "no master answers at %s", d->layout->control_socket));
		return;
	}
	for (size_t i = 0; i < d->layout->node_count; i++)
		if (d->node < 0 || (size_t)d->node == i)
			findings_add(&d->found, status_of(d, i) ? room_judge_node(status_of(d, i)) :
				     finding_do(finding(FINDING_FAIL, "the running master has no node %s",
							d->layout->nodes[i].name),
						"it runs with another layout: restart it"));
	if (d->node < 0)
		room_judge_wire(d->status, &d->found);
}

void check_clocks(struct doctor *d)
{
	double lead_ns = (double)d->layout->swap.lead_most * 1e9 / (double)d->layout->rates.frame_hz;

	if (!d->status) {
		findings_add(&d->found, finding(FINDING_SKIP, "the running master knows the clocks of its nodes; none "
						"answers here"));
		return;
	}
	for (size_t i = 0; i < d->layout->node_count; i++)
		if ((d->node < 0 || (size_t)d->node == i) && is_live(d, i))
			findings_add(&d->found, room_judge_clock(status_of(d, i), llrint(lead_ns)));
}
