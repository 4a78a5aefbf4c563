#include "tools/doctor/machine.h"

#include "tools/doctor/sysfile.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define CPUS_MOST 4096

int64_t machine_limit(const char *limits, const char *name)
{
	size_t n = strlen(name);

	for (const char *line = limits; line && *line; line = strchr(line, '\n')) {
		const char *value;
		char *end;
		long long number;

		line += *line == '\n';
		if (strncmp(line, name, n) || line[n] != ' ')
			continue;
		value = line + n + strspn(line + n, " ");
		if (!strncmp(value, "unlimited", 9))
			return MACHINE_UNLIMITED;
		errno = 0;
		number = strtoll(value, &end, 10);
		return end == value || errno != 0 || number < 0 ? -1 : number;
	}
	return -1;
}

struct finding machine_judge_realtime(const char *limits, const char *whose, int wanted)
{
	int64_t limit = machine_limit(limits, "Max realtime priority");

	if (limit < 0)
		return finding(FINDING_SKIP, "%s limit of real-time priority cannot be read", whose);
	if (limit < wanted)
		return finding_do(finding(FINDING_WARN, "%s limit of real-time priority is %" PRId64
					  ", the units ask for %d", whose, limit, wanted),
				  "start the daemons by their units (LimitRTPRIO=%d), or `@grotto - rtprio %d` in "
				  "/etc/security/limits.conf", wanted, wanted);
	return finding(FINDING_OK, "%s limit of real-time priority is enough for %d", whose, wanted);
}

struct finding machine_judge_memlock(const char *limits, const char *whose)
{
	int64_t limit = machine_limit(limits, "Max locked memory");

	if (limit < 0)
		return finding(FINDING_SKIP, "%s limit of locked memory cannot be read", whose);
	if (limit == MACHINE_UNLIMITED)
		return finding(FINDING_OK, "%s locked memory has no limit", whose);
	/* No daemon locks memory; drivers of GPUs and trackers may. */
	return finding(FINDING_OK, "%s limit of locked memory is %" PRId64 " KiB; grotto locks none", whose,
		       limit / 1024);
}

struct finding machine_judge_governor(const char *root)
{
	char word[32], other[32] = "";
	int cpus = 0, slow = 0;

	for (int i = 0; i < CPUS_MOST; i++) {
		if (!sysfile_word(root, word, sizeof word,
				  "/sys/devices/system/cpu/cpu%d/cpufreq/scaling_governor", i))
			break;
		cpus++;
		if (strcmp(word, "performance") != 0) {
			slow++;
			memcpy(other, word, sizeof other);
		}
	}
	if (cpus == 0)
		return finding(FINDING_SKIP, "the processors' frequency governor cannot be read (a virtual "
			       "machine has none)");
	if (slow > 0)
		return finding_do(finding(FINDING_WARN, "%d of %d processors run under governor %s", slow, cpus,
					  other),
				  "`cpupower frequency-set -g performance`: a clocked-down core wakes late for "
				  "a swap");
	return finding(FINDING_OK, "all %d processors run under governor performance", cpus);
}

struct finding machine_judge_clocksource(const char *root)
{
	static const char *const slow[] = { "hpet", "acpi_pm", "jiffies", "refined-jiffies", "pit" };
	char word[32];

	if (!sysfile_word(root, word, sizeof word,
			  "/sys/devices/system/clocksource/clocksource0/current_clocksource"))
		return finding(FINDING_SKIP, "the clock source cannot be read");
	for (size_t i = 0; i < sizeof slow / sizeof *slow; i++)
		if (!strcmp(word, slow[i]))
			return finding_do(finding(FINDING_WARN, "the clock source is %s: reading the time is slow "
						  "or coarse", word),
					  "see `dmesg` for why the kernel gave up tsc (unsynchronised cores, a "
					  "BIOS that changes it)");
	return finding(FINDING_OK, "the clock source is %s", word);
}

static bool unit_file(const char *root, const char *unit)
{
	static const char *const folders[] = { "/etc/systemd/system", "/run/systemd/system",
					       "/usr/local/lib/systemd/system",
					       "/usr/lib/systemd/system", "/lib/systemd/system" };
	char name[96];
	const char *at = strchr(unit, '@'), *dot = strrchr(unit, '.');

	/* An instance has its template's file. */
	if (at && dot)
		snprintf(name, sizeof name, "%.*s%s", (int)(at + 1 - unit), unit, dot);
	else
		snprintf(name, sizeof name, "%s", unit);
	for (size_t i = 0; i < sizeof folders / sizeof *folders; i++)
		if (sysfile_exists(root, "%s/%s", folders[i], name) ||
		    sysfile_exists(root, "%s/%s", folders[i], unit))
			return true;
	return false;
}

static bool unit_runs(const char *root, const char *unit)
{
	const char *at = strchr(unit, '@');

	/* The control group of a unit lives as long as its processes. */
	if (!at)
		return sysfile_exists(root, "/sys/fs/cgroup/system.slice/%s", unit);
	return sysfile_exists(root, "/sys/fs/cgroup/system.slice/system-grotto\\x2dnode.slice/%s", unit) ||
	       sysfile_exists(root, "/sys/fs/cgroup/system.slice/%s", unit);
}

struct finding machine_judge_unit(const char *root, const char *unit)
{
	bool file = unit_file(root, unit), runs = unit_runs(root, unit);
	bool enabled = sysfile_exists(root, "/etc/systemd/system/multi-user.target.wants/%s", unit);

	if (!sysfile_exists(root, "/run/systemd/system"))
		return finding(FINDING_SKIP, "systemd does not run this machine");
	if (!file)
		return finding_do(finding(FINDING_WARN, "%s is not installed", unit),
				  "`make install` puts it below the prefix; then `systemctl daemon-reload`");
	if (!runs)
		return finding_do(finding(FINDING_WARN, "%s is installed%s and does not run", unit,
					  enabled ? " and enabled" : ", not enabled,"),
				  "`systemctl %s %s`; if it failed `journalctl -u %s` says why",
				  enabled ? "start" : "enable --now", unit, unit);
	if (!enabled)
		return finding_do(finding(FINDING_WARN, "%s runs and is not enabled", unit),
				  "`systemctl enable %s`, or it is gone after the next boot", unit);
	return finding(FINDING_OK, "%s runs and is enabled", unit);
}

bool machine_may_write(const struct stat *status, const struct machine_user *user)
{
	if (!status || !S_ISDIR(status->st_mode))
		return false;
	if (user->uid == 0)
		return true;
	if (status->st_uid == user->uid)
		return (status->st_mode & 0300) == 0300;
	if (status->st_gid == user->gid)
		return (status->st_mode & 0030) == 0030;
	return (status->st_mode & 0003) == 0003;
}

struct finding machine_judge_folder(const char *path, const struct stat *status,
				    const struct machine_user *user, const char *made_by)
{
	if (!status)
		return finding(FINDING_SKIP, "%s is not there; %s makes it", path, made_by);
	if (!S_ISDIR(status->st_mode))
		return finding_do(finding(FINDING_FAIL, "%s is no folder", path), "move that file away");
	if (!machine_may_write(status, user))
		return finding_do(finding(FINDING_FAIL, "%s cannot be written by %s (user %u, mode %03o)", path,
					  user->name, (unsigned)status->st_uid,
					  (unsigned)status->st_mode & 0777U),
				  "chown %s %s", user->name, path);
	return finding(FINDING_OK, "%s can be written by %s", path, user->name);
}

struct finding machine_judge_key(const char *path, const struct stat *status,
				 const struct machine_user *user)
{
	unsigned mode = status ? (unsigned)status->st_mode & 0777U : 0;

	if (!status)
		return finding_do(finding(FINDING_FAIL, "%s is not there", path),
				  "copy the cluster's key over a channel that you trust, or make one: grotto key %s",
				  path);
	if (!S_ISREG(status->st_mode))
		return finding_do(finding(FINDING_FAIL, "%s is no regular file", path),
				  "network.key_file names the key itself");
	if (mode & 0027U)
		return finding_do(finding(FINDING_FAIL, "%s has mode %03o: others may read or write it", path, mode),
				  "chmod 640 %s; if strangers could read it, make another: grotto key", path);
	if (!user->known)
		return finding(FINDING_OK, "%s has mode %03o", path, mode);
	if (user->uid != 0 && !(status->st_uid == user->uid && mode & 0400U) &&
	    !(status->st_gid == user->gid && mode & 0040U))
		return finding_do(finding(FINDING_FAIL, "%s cannot be read by %s (user %u, group %u, mode %03o)",
					  path, user->name, (unsigned)status->st_uid,
					  (unsigned)status->st_gid, mode),
				  "chgrp %s %s && chmod 640 %s", user->name, path, path);
	return finding(FINDING_OK, "%s has mode %03o and can be read by %s", path, mode, user->name);
}
