#include "tools/doctor/link.h"

#include "tools/doctor/sysfile.h"

#include <inttypes.h>
#include <string.h>

/* A room's deltas are small, its snapshots and a shared light are not. */
#define SPEED_WANTED_MBIT 1000
/* More lost at the card than this and repairs are what the room is busy with. */
#define LOST_SHARE 1e-4

static int64_t counter(const char *root, const char *name, const char *which)
{
	int64_t value;

	return sysfile_number(root, &value, "/sys/class/net/%s/%s", name, which) && value >= 0 ?
		       value : LINK_UNKNOWN;
}

void link_read(const char *root, const char *name, struct link_facts *out)
{
	const struct { const char *file; int64_t *to; } counters[] = {
		{ "mtu", &out->mtu }, { "speed", &out->speed_mbit },
		{ "statistics/rx_packets", &out->rx_packets },
		{ "statistics/tx_packets", &out->tx_packets },
		{ "statistics/rx_errors", &out->rx_errors },
		{ "statistics/tx_errors", &out->tx_errors },
		{ "statistics/rx_dropped", &out->rx_dropped },
		{ "statistics/tx_dropped", &out->tx_dropped },
		{ "statistics/rx_missed_errors", &out->rx_missed },
	};
	int64_t type;

	*out = (struct link_facts){ .snooping = LINK_UNKNOWN, .querier = LINK_UNKNOWN };
	snprintf(out->name, sizeof out->name, "%s", name);
	for (size_t i = 0; i < sizeof counters / sizeof *counters; i++)
		*counters[i].to = LINK_UNKNOWN;
	/* A name with a slash would lead elsewhere. */
	if (!name[0] || strchr(name, '/') || !strcmp(name, ".") || !strcmp(name, ".."))
		return;
	out->present = sysfile_exists(root, "/sys/class/net/%s", name);
	if (!out->present)
		return;
	/* ARPHRD_LOOPBACK */
	out->loopback = sysfile_number(root, &type, "/sys/class/net/%s/type", name) && type == 772;
	sysfile_word(root, out->state, sizeof out->state, "/sys/class/net/%s/operstate", name);
	sysfile_word(root, out->duplex, sizeof out->duplex, "/sys/class/net/%s/duplex", name);
	sysfile_link(root, out->driver, sizeof out->driver, "/sys/class/net/%s/device/driver", name);
	for (size_t i = 0; i < sizeof counters / sizeof *counters; i++)
		*counters[i].to = counter(root, name, counters[i].file);
	if (sysfile_exists(root, "/sys/class/net/%s/bridge", name))
		snprintf(out->bridge, sizeof out->bridge, "%s", out->name);
	else
		sysfile_link(root, out->bridge, sizeof out->bridge, "/sys/class/net/%s/brport/bridge",
			     name);
	if (out->bridge[0]) {
		out->snooping = counter(root, out->bridge, "bridge/multicast_snooping");
		out->querier = counter(root, out->bridge, "bridge/multicast_querier");
	}
}

struct finding link_judge_state(const struct link_facts *f)
{
	if (!f->present)
		return finding_do(finding(FINDING_FAIL, "interface %s is not on this machine", f->name),
				  "`ip link` lists what there is; correct network.interface, or plug it in");
	if (f->loopback || !strcmp(f->state, "up"))
		return finding(FINDING_OK, "interface %s is up%s%s", f->name,
			       f->driver[0] ? ", driver " : "", f->driver);
	if (!f->state[0] || !strcmp(f->state, "unknown"))
		return finding(FINDING_SKIP, "interface %s does not say whether it is up", f->name);
	return finding_do(finding(FINDING_FAIL, "interface %s is %s", f->name, f->state),
			  "look at cable and switch; `ip link set %s up` where it was turned off", f->name);
}

struct finding link_judge_speed(const struct link_facts *f)
{
	if (f->loopback)
		return finding(FINDING_OK, "%s needs no cable", f->name);
	if (f->speed_mbit <= 0)
		return finding(FINDING_SKIP, "%s does not tell its speed", f->name);
	if (!strcmp(f->duplex, "half"))
		return finding_do(finding(FINDING_FAIL, "%s runs at half duplex, %" PRId64 " Mbit/s",
					  f->name, f->speed_mbit),
				  "let both ends negotiate: one of them is set to a fixed mode");
	if (f->speed_mbit < SPEED_WANTED_MBIT)
		return finding_do(finding(FINDING_WARN, "%s runs at %" PRId64 " Mbit/s", f->name,
					  f->speed_mbit),
				  "use 1 Gbit/s or more; a cable with a broken pair gives 100");
	return finding(FINDING_OK, "%s runs at %" PRId64 " Mbit/s", f->name, f->speed_mbit);
}

struct finding link_judge_mtu(const struct link_facts *f, int mtu)
{
	if (f->mtu <= 0)
		return finding(FINDING_SKIP, "%s does not tell its MTU", f->name);
	if (f->mtu < mtu)
		return finding_do(finding(FINDING_FAIL, "%s carries packets of %" PRId64
					  " bytes, the layout sends %d", f->name, f->mtu, mtu),
				  "network.mtu = %" PRId64 " in the layout of all machines, or "
				  "`ip link set %s mtu %d` on all and on the switch", f->mtu, f->name, mtu);
	return finding(FINDING_OK, "%s carries packets of %" PRId64 " bytes, the layout sends %d",
		       f->name, f->mtu, mtu);
}

static int64_t known(int64_t value)
{
	return value > 0 ? value : 0;
}

struct finding link_judge_counters(const struct link_facts *f)
{
	double lost = (double)known(f->rx_errors) + (double)known(f->tx_errors) +
		      (double)known(f->rx_missed) + (double)known(f->rx_dropped) +
		      (double)known(f->tx_dropped);
	double through = (double)known(f->rx_packets) + (double)known(f->tx_packets);

	if (f->rx_packets < 0 || f->rx_errors < 0)
		return finding(FINDING_SKIP, "%s does not tell its counters", f->name);
	if (lost > LOST_SHARE * (through + lost))
		return finding_do(finding(FINDING_WARN, "%s: %" PRId64 " receive and %" PRId64
					  " send errors, %" PRId64 " missed, %" PRId64 " and %" PRId64
					  " dropped, of %.0f packets", f->name, known(f->rx_errors),
					  known(f->tx_errors), known(f->rx_missed),
					  known(f->rx_dropped), known(f->tx_dropped), through),
				  "errors: change the cable; missed: longer rings (`ethtool -G %s rx 4096`); "
				  "if they do not grow they are old", f->name);
	return finding(FINDING_OK, "%s lost %.0f of %.0f packets", f->name, lost, through);
}

int64_t link_groups(const char *igmp, const char *name, char querier[8])
{
	querier[0] = '\0';
	for (const char *line = igmp; line && *line; line = strchr(line, '\n')) {
		char device[LINK_NAME + 1] = "";
		long long groups;
		unsigned index;

		line += *line == '\n';
		/* "2\teth0      :     1      V3" */
		if (sscanf(line, "%u %16[^: \t\n] : %lld %7s", &index, device, &groups, querier) == 4 &&
		    !strcmp(device, name) && groups >= 0)
			return groups;
	}
	querier[0] = '\0';
	return LINK_UNKNOWN;
}

struct finding link_judge_querier(const struct link_facts *f, const char *igmp)
{
	static const char remedy[] =
		"a switch that snoops and hears no querier forgets the members after minutes: turn "
		"on its IGMP querier, or its snooping off";
	char querier[8];
	int64_t groups = link_groups(igmp, f->name, querier);

	if (f->loopback)
		return finding(FINDING_OK, "no switch between the members");
	if (f->bridge[0] && f->snooping == 1 && f->querier == 0)
		return finding_do(finding(FINDING_WARN, "bridge %s snoops and is no querier", f->bridge),
				  "echo 1 > /sys/class/net/%s/bridge/multicast_querier, or 0 > "
				  "multicast_snooping, unless a router on it asks", f->bridge);
	if (f->bridge[0] && (f->querier == 1 || f->snooping == 0))
		return finding(FINDING_OK, "bridge %s %s", f->bridge,
			       f->querier == 1 ? "is the querier" : "does not snoop");
	if (groups > 0 && (!strcmp(querier, "V1") || !strcmp(querier, "V2")))
		return finding(FINDING_OK, "a querier (IGMP%s) was heard on %s", querier, f->name);
	return finding_do(finding(FINDING_WARN, "whether the switch behind %s has a querier cannot be seen "
				  "from here", f->name), "%s", remedy);
}
