/* The doctor's judges, with files of /proc and /sys that no healthy machine has. */
#include <config.h> /* mkdtemp, symlink */

#include "tests/unit/unit.h"

#include "base/result.h"
#include "tools/doctor/finding.h"
#include "tools/doctor/firewall.h"
#include "tools/doctor/link.h"
#include "tools/doctor/machine.h"
#include "tools/doctor/room.h"
#include "tools/doctor/sockets.h"
#include "tools/doctor/sysfile.h"
#include "tools/doctor/way.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <sys/stat.h>
#include <unistd.h>

static char root[64];

static int make_root(void **state)
{
	(void)state;
	strcpy(root, "/tmp/grotto-doctor-XXXXXX");
	return mkdtemp(root) ? 0 : -1;
}

static int remove_one(const char *path, const struct stat *status, int type, struct FTW *at)
{
	(void)status;
	(void)type;
	(void)at;
	return remove(path);
}

static int remove_root(void **state)
{
	(void)state;
	return nftw(root, remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

/* Makes root/path and the folders above it. */
static void put_bytes(const char *path, const void *bytes, size_t len)
{
	char whole[512];
	int fd;

	snprintf(whole, sizeof whole, "%s%s", root, path);
	for (char *slash = whole + strlen(root) + 1; (slash = strchr(slash, '/')); *slash++ = '/') {
		*slash = '\0';
		mkdir(whole, 0700);
	}
	fd = open(whole, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
	assert_true(fd >= 0);
	assert_int_equal(write(fd, bytes, len), (ssize_t)len);
	close(fd);
}

static void put(const char *path, const char *text)
{
	put_bytes(path, text, strlen(text));
}

#define assert_level(finding_, level_)                                                          \
	do {                                                                                    \
		struct finding f_ = (finding_);                                                 \
		if (f_.level != (level_))                                                       \
			print_error("\"%s\" -> \"%s\"\n", f_.text, f_.remedy);                  \
		assert_int_equal(f_.level, level_);                                             \
		/* Whatever is wrong, something can be done. */                                 \
		assert_true((f_.level < FINDING_WARN) || f_.remedy[0]);                         \
	} while (0)

static void test_small_files(void **state)
{
	char text[32], *large = malloc(5000);
	int64_t number;

	(void)state;
	memset(large, '7', 5000);
	put("/n/good", " 1500\n");
	put("/n/words", "15 16\n");
	put("/n/letters", "15x\n");
	put("/n/empty", "");
	put("/n/huge", "99999999999999999999\n");
	put_bytes("/n/large", large, 5000);
	put_bytes("/n/nul", "12\0" "34", 5);
	assert_true(sysfile_number(root, &number, "/n/%s", "good"));
	assert_int_equal(number, 1500);
	for (size_t i = 0; i < 5; i++) {
		static const char *const bad[] = { "words", "letters", "empty", "huge", "none" };
		assert_false(sysfile_number(root, &number, "/n/%s", bad[i]));
		assert_int_equal(number, 0);
	}
	assert_int_equal(sysfile_read(root, text, sizeof text, "/n/large"), GR_ERR_RANGE);
	assert_string_equal(text, "");
	assert_int_equal(sysfile_read(root, text, sizeof text, "/n"), GR_ERR_IO); /* a folder */
	assert_int_equal(sysfile_read(root, text, sizeof text, "/n/nul"), GR_OK);
	assert_string_equal(text, "12");
	large[4999] = '\0';
	assert_int_equal(sysfile_read(root, text, sizeof text, "/%s", large), GR_ERR_RANGE);
	assert_false(sysfile_exists(root, "/%s", large));
	free(large);
}

static void put_link(const char *mtu, const char *speed, const char *state, const char *missed)
{
	put("/sys/class/net/eth7/type", "1\n");
	put("/sys/class/net/eth7/mtu", mtu);
	put("/sys/class/net/eth7/speed", speed);
	put("/sys/class/net/eth7/operstate", state);
	put("/sys/class/net/eth7/duplex", "full\n");
	put("/sys/class/net/eth7/statistics/rx_packets", "1000000\n");
	put("/sys/class/net/eth7/statistics/rx_errors", "0\n");
	put("/sys/class/net/eth7/statistics/rx_missed_errors", missed);
}

static void test_link(void **state)
{
	struct link_facts f;

	(void)state;
	put_link("1500\n", "1000\n", "up\n", "3\n");
	link_read(root, "eth7", &f);
	assert_level(link_judge_state(&f), FINDING_OK);
	assert_level(link_judge_speed(&f), FINDING_OK);
	assert_level(link_judge_mtu(&f, 1500), FINDING_OK);
	assert_level(link_judge_mtu(&f, 1501), FINDING_FAIL);
	assert_level(link_judge_counters(&f), FINDING_OK);
	put_link("1400\n", "100\n", "down\n", "900\n");
	link_read(root, "eth7", &f);
	assert_level(link_judge_state(&f), FINDING_FAIL);
	assert_level(link_judge_speed(&f), FINDING_WARN);
	assert_level(link_judge_mtu(&f, 1500), FINDING_FAIL);
	assert_level(link_judge_counters(&f), FINDING_WARN);
	put("/sys/class/net/eth7/duplex", "half\n");
	link_read(root, "eth7", &f);
	assert_level(link_judge_speed(&f), FINDING_FAIL);
	/* A card without a cable says -1; rubbish is unknown and no fault of the card. */
	put_link("\x1b[2J", "-1\n", "\x1b[2J\n", "-5\n");
	link_read(root, "eth7", &f);
	assert_level(link_judge_speed(&f), FINDING_SKIP);
	assert_level(link_judge_mtu(&f, 1500), FINDING_SKIP);
	assert_int_equal(f.rx_missed, LINK_UNKNOWN);
	link_read(root, "../net/eth7", &f);
	assert_false(f.present);
	link_read(root, "a name much longer than any", &f);
	assert_level(link_judge_state(&f), FINDING_FAIL);
}

static void test_multicast(void **state)
{
	static const char igmp[] =
		"Idx\tDevice    : Count Querier\tGroup    Users Timer\tReporter\n"
		"1\tlo        :     1      V3\n\t\t\t\t010000E0     1 0:00000000\t\t0\n"
		"2\teth7      :     2      V2\n\t\t\t\t010000E0     1 0:00000000\t\t0\n"
		"3\teth77     :     1      V3\n";
	struct link_facts f = { .name = "eth7", .present = true };
	char querier[8];

	(void)state;
	assert_int_equal(link_groups(igmp, "eth7", querier), 2);
	assert_string_equal(querier, "V2");
	assert_int_equal(link_groups(igmp, "eth", querier), LINK_UNKNOWN);
	assert_int_equal(link_groups("2\teth7 : -3 V2\n", "eth7", querier), LINK_UNKNOWN);
	assert_int_equal(link_groups("", "eth7", querier), LINK_UNKNOWN);
	f.snooping = f.querier = LINK_UNKNOWN;
	assert_level(link_judge_querier(&f, igmp), FINDING_OK);
	strcpy(f.name, "eth77");
	assert_level(link_judge_querier(&f, igmp), FINDING_WARN);
	strcpy(f.bridge, "br0");
	f.snooping = 1;
	f.querier = 0;
	assert_level(link_judge_querier(&f, igmp), FINDING_WARN);
	f.querier = 1;
	assert_level(link_judge_querier(&f, igmp), FINDING_OK);
}

#define UDP_HEAD "   sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode ref pointer drops\n"
#define UDP_LINE(local, inode, drops) \
	"  12: " local " 00000000:0000 07 00000000:00000000 00:00000000 00000000   994        0 " inode " 2 0000000000000000 " drops "\n"

static void test_port(void **state)
{
	static const uint8_t loopback[4] = { 127, 0, 0, 1 }, other[4] = { 10, 0, 0, 1 };
	struct socket_facts f;
	char whole[256];

	(void)state;
	/* 27100 is 0x69DC; the address stands in the machine's byte order. */
	assert_true(sockets_find(UDP_HEAD UDP_LINE("0100007F:69DC", "4242", "17"), loopback, 4, 27100, &f));
	assert_int_equal(f.inode, 4242);
	assert_int_equal(f.uid, 994);
	assert_int_equal(f.drops, 17);
	assert_level(sockets_judge_drops(&f, 27100), FINDING_WARN);
	assert_false(sockets_find(UDP_LINE("0100007F:69DC", "1", "0"), other, 4, 27100, &f));
	assert_true(sockets_find(UDP_LINE("00000000:69DC", "1", "0"), other, 4, 27100, &f));
	assert_false(sockets_find(UDP_LINE("0100007F:69DD", "1", "0"), loopback, 4, 27100, &f));
	/* Not of this form: passed over, whatever they are. */
	for (size_t i = 0; i < 5; i++) {
		static const char *const bad[] = { UDP_LINE("0100007:69DC", "1", "0"), UDP_LINE("zz", "1", "0"),
						   "12: 0100007F:69DC", "\n\n\n", "12: 0100007F:69DC 0:0 7 0:0 0:0 0 -1" };
		assert_false(sockets_find(bad[i], loopback, 4, 27100, &f));
		assert_level(sockets_judge_port(&f, 27100, "grotto-master"), FINDING_OK);
	}
	/* Its owner, by the links of /proc/PID/fd. */
	put("/proc/77/comm", "grotto-master\n");
	put("/proc/77/fd/x", "");
	snprintf(whole, sizeof whole, "%s/proc/77/fd/5", root);
	assert_int_equal(symlink("socket:[4242]", whole), 0);
	f = (struct socket_facts){ .held = true, .inode = 4242 };
	sockets_find_owner(root, &f);
	assert_int_equal(f.pid, 77);
	assert_level(sockets_judge_port(&f, 27100, "grotto-master"), FINDING_OK);
	assert_level(sockets_judge_port(&f, 27100, "grotto-node"), FINDING_FAIL);
	f = (struct socket_facts){ .held = true, .inode = 4243 };
	sockets_find_owner(root, &f);
	assert_int_equal(f.pid, 0);
	assert_level(sockets_judge_port(&f, 27100, "grotto-master"), FINDING_SKIP);
}

static void test_counters(void **state)
{
	static const char snmp[] = "Ip: Forwarding DefaultTTL\nIp: 1 64\n"
				   "Udp: InDatagrams NoPorts InErrors RcvbufErrors InCsumErrors\nUdp: 900 1 2 3 0\n";

	(void)state;
	assert_int_equal(sockets_snmp(snmp, "Udp", "RcvbufErrors"), 3);
	assert_int_equal(sockets_snmp(snmp, "Udp", "Rcvbuf"), -1);
	assert_int_equal(sockets_snmp("Udp: A B\nUdp: 1\n", "Udp", "B"), -1);
	assert_int_equal(sockets_snmp("Udp: A\nUdp: -4\n", "Udp", "A"), -1);
	assert_int_equal(sockets_snmp("Udp: A\nUdp: 4x\n", "Udp", "A"), -1);
	assert_level(sockets_judge_snmp(snmp), FINDING_WARN);
	assert_level(sockets_judge_snmp(""), FINDING_SKIP);
	assert_level(sockets_judge_snmp("Udp: InDatagrams RcvbufErrors\nUdp: 5 0\n"), FINDING_OK);
	assert_level(sockets_judge_buffer("rmem_max", 212992, 4 << 20, 212992, false), FINDING_WARN);
	assert_level(sockets_judge_buffer("rmem_max", 212992, 4 << 20, 212992, true), FINDING_OK);
	assert_level(sockets_judge_buffer("rmem_max", 4 << 20, 4 << 20, 4 << 20, false), FINDING_OK);
	assert_level(sockets_judge_buffer("rmem_max", -1, 4 << 20, 4 << 20, false), FINDING_OK);
	assert_level(sockets_judge_buffer("rmem_max", -1, 4 << 20, 212992, false), FINDING_WARN);
	assert_level(sockets_judge_buffer("rmem_max", -1, 4 << 20, -1, false), FINDING_SKIP);
}

static void test_firewall(void **state)
{
	static const struct {
		enum firewall_verdict verdict;
		const char *rules;
	} nft[] = {
		{ FIREWALL_OPEN, "" },
		{ FIREWALL_OPEN, "table inet f {\n\tchain output {\n\t\ttype filter hook output priority 0; policy drop;\n"
				 "\t\tudp dport 27100 drop\n\t}\n}\n" },
		{ FIREWALL_DROPS, "table inet f {\n\tchain i {\n\t\ttype filter hook input priority 0; policy accept;\n"
				  "\t\tudp dport { 53, 27000-27200 } counter packets 4 bytes 100 drop\n\t}\n}\n" },
		{ FIREWALL_OPENED, "table inet f {\n\tchain i {\n\t\ttype filter hook input priority 0; policy drop;\n"
				   "\t\tudp dport 27100 accept\n\t\tudp dport 27100 drop\n\t}\n}\n" },
		{ FIREWALL_POLICY, "table inet f {\n\tchain i {\n\t\ttype filter hook input priority 0; policy drop;\n"
				   "\t\tudp dport 27101 accept\n\t\ttcp dport 27100 accept\n\t}\n}\n" },
		{ FIREWALL_POLICY, "table inet f {\n\tchain i {\n\t\ttype filter hook input priority 0; policy accept;\n"
				   "\t\tct state established accept\n\t\tcounter packets 1 bytes 2 reject\n\t}\n}\n" },
		{ FIREWALL_OPENED, "table inet f {\n\tchain i {\n\t\ttype filter hook input priority 0; policy drop;\n"
				   "\t\tjump z\n\t}\n\tchain z {\n\t\tudp dport 27100 accept\n\t}\n}\n" },
		{ FIREWALL_DROPS, "table inet f {\n\tchain i {\n\t\ttype filter hook input priority 0; policy accept;\n"
				  "\t\taccept\n\t}\n}\ntable netdev g {\n\tchain h {\n"
				  "\t\ttype filter hook ingress device \"e\" priority 0; policy accept;\n"
				  "\t\tudp dport 27100 drop\n\t}\n}\n" },
		{ FIREWALL_OPEN, "chain chain chain {{{{\n\x01\xff\ntype\nudp dport\n}\n}\n" },
	};
	static const struct {
		enum firewall_verdict verdict;
		const char *rules;
	} iptables[] = {
		{ FIREWALL_OPEN, "-P INPUT ACCEPT\n-A OUTPUT -p udp -m udp --dport 27100 -j DROP\n" },
		{ FIREWALL_DROPS, "-P INPUT ACCEPT\n-A INPUT -p udp -m udp --dport 27100 -j DROP\n" },
		{ FIREWALL_DROPS, "-A INPUT -p udp -m multiport --dports 53,27000:27200 -j REJECT --reject-with x\n" },
		{ FIREWALL_OPENED, "-P INPUT DROP\n-A INPUT -p udp -m udp --dport 27100 -j ACCEPT\n-A INPUT -j DROP\n" },
		{ FIREWALL_POLICY, "-P INPUT DROP\n-A INPUT -p tcp -m tcp --dport 27100 -j ACCEPT\n" },
		{ FIREWALL_POLICY, "-P INPUT ACCEPT\n-A INPUT -j REJECT --reject-with icmp-port-unreachable\n" },
		{ FIREWALL_OPENED, "-P INPUT DROP\n-A INPUT -j zone\n-A zone -p udp -m udp --dport 27100 -j ACCEPT\n" },
	};
	char long_line[4000];
	struct firewall_symptom s;

	(void)state;
	for (size_t i = 0; i < sizeof nft / sizeof *nft; i++) {
		s = firewall_read_nft(nft[i].rules, 27100);
		if (s.verdict != nft[i].verdict)
			print_error("nft %zu: %s\n", i, s.rule);
		assert_int_equal(s.verdict, nft[i].verdict);
	}
	for (size_t i = 0; i < sizeof iptables / sizeof *iptables; i++) {
		s = firewall_read_iptables(iptables[i].rules, 27100);
		if (s.verdict != iptables[i].verdict)
			print_error("iptables %zu: %s\n", i, s.rule);
		assert_int_equal(s.verdict, iptables[i].verdict);
	}
	memset(long_line, '9', sizeof long_line - 1);
	long_line[sizeof long_line - 1] = '\0';
	memcpy(long_line, "-A INPUT -p udp --dport ", 24);
	assert_int_equal(firewall_read_iptables(long_line, 27100).verdict, FIREWALL_OPEN);
	assert_level(firewall_judge("nft", NULL, 27100), FINDING_SKIP);
	s = firewall_read_nft(nft[2].rules, 27100);
	assert_level(firewall_judge("nft", &s, 27100), FINDING_FAIL);
	s = firewall_read_nft(nft[4].rules, 27100);
	assert_level(firewall_judge("nft", &s, 27100), FINDING_WARN);
}

static void test_limits(void **state)
{
	static const char limits[] =
		"Limit                     Soft Limit           Hard Limit           Units     \n"
		"Max locked memory         8388608              unlimited            bytes     \n"
		"Max realtime priority     5                    5                    \n";

	(void)state;
	assert_int_equal(machine_limit(limits, "Max realtime priority"), 5);
	assert_int_equal(machine_limit("Max locked memory unlimited", "Max locked memory"), MACHINE_UNLIMITED);
	assert_int_equal(machine_limit("Max locked memory -3", "Max locked memory"), -1);
	assert_int_equal(machine_limit("Max locked memory 99999999999999999999", "Max locked memory"), -1);
	assert_int_equal(machine_limit("Max locked memory", "Max locked memory"), -1);
	assert_level(machine_judge_realtime(limits, "the daemon's", 5), FINDING_OK);
	assert_level(machine_judge_realtime(limits, "the daemon's", 6), FINDING_WARN);
	assert_level(machine_judge_realtime("", "the daemon's", 5), FINDING_SKIP);
}

static void test_machine(void **state)
{
	(void)state;
	assert_level(machine_judge_governor(root), FINDING_SKIP);
	put("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n");
	put("/sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "powersave\n");
	assert_level(machine_judge_governor(root), FINDING_WARN);
	put("/sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "performance\n");
	assert_level(machine_judge_governor(root), FINDING_OK);
	assert_level(machine_judge_clocksource(root), FINDING_SKIP);
	put("/sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet\n");
	assert_level(machine_judge_clocksource(root), FINDING_WARN);
	put("/sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n");
	assert_level(machine_judge_clocksource(root), FINDING_OK);

	assert_level(machine_judge_unit(root, "grotto-node@front.service"), FINDING_SKIP);
	put("/run/systemd/system/x", "");
	assert_level(machine_judge_unit(root, "grotto-node@front.service"), FINDING_WARN);
	put("/usr/lib/systemd/system/grotto-node@.service", "");
	put("/sys/fs/cgroup/system.slice/system-grotto\\x2dnode.slice/grotto-node@front.service/x", "");
	assert_level(machine_judge_unit(root, "grotto-node@front.service"), FINDING_WARN);
	put("/etc/systemd/system/multi-user.target.wants/grotto-node@front.service", "");
	assert_level(machine_judge_unit(root, "grotto-node@front.service"), FINDING_OK);
	assert_level(machine_judge_unit(root, "grotto-node@left.service"), FINDING_WARN);
}

static void test_rights(void **state)
{
	const struct machine_user user = { true, "grotto", 994, 993 };
	struct stat s = { .st_mode = S_IFREG | 0640, .st_uid = 0, .st_gid = 993 };

	(void)state;
	assert_level(machine_judge_key("/k", &s, &user), FINDING_OK);
	s.st_gid = 0;
	assert_level(machine_judge_key("/k", &s, &user), FINDING_FAIL);
	s.st_uid = 994;
	assert_level(machine_judge_key("/k", &s, &user), FINDING_OK);
	s.st_mode = S_IFREG | 0644;
	assert_level(machine_judge_key("/k", &s, &user), FINDING_FAIL);
	s.st_mode = S_IFIFO | 0640;
	assert_level(machine_judge_key("/k", &s, &user), FINDING_FAIL);
	assert_level(machine_judge_key("/k", NULL, &user), FINDING_FAIL);
	s = (struct stat){ .st_mode = S_IFDIR | 0750, .st_uid = 994 };
	assert_level(machine_judge_folder("/f", &s, &user, "it"), FINDING_OK);
	s.st_uid = 0;
	assert_level(machine_judge_folder("/f", &s, &user, "it"), FINDING_FAIL);
	s.st_mode = S_IFREG | 0777;
	assert_level(machine_judge_folder("/f", &s, &user, "it"), FINDING_FAIL);
	assert_level(machine_judge_folder("/f", NULL, &user, "it"), FINDING_SKIP);
}

static enum finding_level clock_level(const char *text)
{
	struct json_object *node = json_tokener_parse(text);
	enum finding_level level = room_judge_clock(node, 4000000).level;

	json_object_put(node);
	return level;
}

static enum finding_level node_level(const char *text)
{
	struct json_object *node = json_tokener_parse(text);
	enum finding_level level = room_judge_node(node).level;

	json_object_put(node);
	return level;
}

static void test_room(void **state)
{
	(void)state;
	assert_int_equal(node_level("{\"name\":\"a\",\"state\":\"live\"}"), FINDING_OK);
	assert_int_equal(node_level("{\"name\":\"a\",\"state\":\"late\"}"), FINDING_WARN);
	assert_int_equal(node_level("{\"name\":\"a\",\"state\":\"dead\"}"), FINDING_FAIL);
	assert_int_equal(node_level("{\"name\":\"a\",\"state\":\"live\",\"mismatches\":1}"), FINDING_WARN);
	assert_int_equal(node_level("{}"), FINDING_FAIL);
	assert_int_equal(node_level("[]"), FINDING_FAIL);
	assert_int_equal(clock_level("{\"clock\":{\"known\":false}}"), FINDING_SKIP);
	assert_int_equal(clock_level("{\"clock\":7}"), FINDING_SKIP);
	assert_int_equal(clock_level("{\"clock\":{\"known\":true,\"error_us\":40,\"skew_ppm\":-12}}"), FINDING_OK);
	assert_int_equal(clock_level("{\"clock\":{\"known\":true,\"error_us\":4001,\"skew_ppm\":0}}"), FINDING_WARN);
	assert_int_equal(clock_level("{\"clock\":{\"known\":true,\"error_us\":4,\"skew_ppm\":-900}}"), FINDING_WARN);
	assert_int_equal(clock_level("{\"clock\":{\"known\":true,\"error_us\":NaN,\"skew_ppm\":0}}"), FINDING_WARN);
}

static void test_way(void **state)
{
	static const char arp[] = "IP address       HW type     Flags       HW address            Mask     Device\n"
				  "10.0.0.9         0x1         0x0         00:00:00:00:00:00     *        eth0\n"
				  "10.0.0.10        0x1         0x2         02:00:00:00:00:01     *        eth0\n";
	struct way way = { .port = { .answer = WAY_ECHO } };

	(void)state;
	assert_true(way_no_neighbour(arp, "10.0.0.9"));
	assert_false(way_no_neighbour(arp, "10.0.0.10"));
	assert_false(way_no_neighbour(arp, "10.0.0.1"));
	assert_false(way_no_neighbour("", "10.0.0.9"));
	assert_level(way_judge("a", "b", &way, false), FINDING_OK);
	assert_level(way_judge_whole("a", &way, 1472), FINDING_FAIL); /* the long one was not answered */
	way.whole = (struct way_probe){ .answer = WAY_ERROR, .error = EMSGSIZE, .mtu = 1400 };
	assert_level(way_judge_whole("a", &way, 1472), FINDING_FAIL);
	way.whole.answer = WAY_CLOSED;
	assert_level(way_judge_whole("a", &way, 1472), FINDING_OK);
	way = (struct way){ 0 };
	assert_level(way_judge("a", "b", &way, false), FINDING_WARN);
	assert_level(way_judge("a", "b", &way, true), FINDING_OK);
	assert_level(way_judge_whole("a", &way, 1472), FINDING_SKIP);
	way.no_neighbour = true;
	assert_level(way_judge("a", "b", &way, false), FINDING_FAIL);
	way.port = (struct way_probe){ .answer = WAY_ERROR, .error = EPERM };
	assert_level(way_judge("a", "b", &way, false), FINDING_FAIL);
}

static void test_echo(void **state)
{
	static const uint8_t nonce[ECHO_NONCE] = { 1, 2, 3, 4, 5, 6, 7, 8 }, wrong[ECHO_NONCE] = { 9 };
	uint8_t bytes[64];

	(void)state;
	for (size_t len = 0; len < sizeof bytes; len++) {
		uint8_t *copy;

		echo_make(bytes, sizeof bytes, nonce);
		copy = unit_copy(bytes, len);
		assert_int_equal(echo_turn(copy, len), len >= ECHO_LEAST);
		assert_int_equal(echo_answers(copy, len, nonce), len >= ECHO_LEAST);
		assert_false(echo_answers(copy, len, wrong));
		/* An answer is no question: two doctors never answer each other for ever. */
		assert_false(echo_turn(copy, len));
		free(copy);
	}
}

static void test_findings(void **state)
{
	struct findings all = { .check = "a" };
	char *text = NULL;
	size_t len;
	FILE *file = open_memstream(&text, &len);
	struct json_object *root_object;

	(void)state;
	for (int i = 0; i < 200; i++)
		findings_add(&all, finding_do(finding(i % FINDING_LEVELS, "\x1b[31m%d\"", i), "do\n"));
	assert_int_equal(all.count, 200);
	assert_int_equal(all.of[FINDING_FAIL], 50);
	assert_int_equal(findings_print_json(&all, file), GR_OK);
	findings_print(&all, file);
	fclose(file);
	assert_null(strchr(text, '\x1b'));
	root_object = json_tokener_parse(text);
	assert_non_null(root_object);
	assert_false(json_object_get_boolean(json_object_object_get(root_object, "ok")));
	assert_int_equal(json_object_array_length(json_object_object_get(root_object, "findings")), 200);
	json_object_put(root_object);
	free(text);
	findings_finish(&all);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_small_files), cmocka_unit_test(test_link),
		cmocka_unit_test(test_multicast), cmocka_unit_test(test_port),
		cmocka_unit_test(test_counters), cmocka_unit_test(test_firewall),
		cmocka_unit_test(test_limits), cmocka_unit_test(test_machine),
		cmocka_unit_test(test_rights), cmocka_unit_test(test_room),
		cmocka_unit_test(test_way), cmocka_unit_test(test_echo),
		cmocka_unit_test(test_findings),
	};

	return cmocka_run_group_tests(tests, make_root, remove_root);
}
