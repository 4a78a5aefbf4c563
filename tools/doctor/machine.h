/*
 * The machine: limits of processes, processors and clock, units of systemd,
 * folders, key file. root as in sysfile.h.
 */
#ifndef GROTTO_TOOLS_DOCTOR_MACHINE_H
#define GROTTO_TOOLS_DOCTOR_MACHINE_H

#include "tools/doctor/finding.h"

#include <stdint.h>
#include <sys/stat.h>

#define MACHINE_UNLIMITED INT64_MAX

/*
 * A soft limit of /proc/PID/limits: ("Max realtime priority"). MACHINE_UNLIMITED;
 * -1 where the text does not have it.
 */
int64_t machine_limit(const char *limits, const char *name);
/* whose: "the daemon's" or "this shell's"; units give the daemons 5. */
struct finding machine_judge_realtime(const char *limits, const char *whose, int wanted);
struct finding machine_judge_memlock(const char *limits, const char *whose);

struct finding machine_judge_governor(const char *root);
struct finding machine_judge_clocksource(const char *root);

/* unit: "grotto-master.service" or "grotto-node@front.service". */
struct finding machine_judge_unit(const char *root, const char *unit);

/* Who the daemons run as. */
struct machine_user {
	bool known; /* in the machine's user table */
	char name[32];
	uid_t uid;
	gid_t gid;
};
/* Can that user write the folder, as its owner or through its group? status NULL: it is not there. */
bool machine_may_write(const struct stat *status, const struct machine_user *user);
/* made_by: what makes the folder when it is missing. */
struct finding machine_judge_folder(const char *path, const struct stat *status,
				    const struct machine_user *user, const char *made_by);
/* Rights and owner of the key; what it holds is the loader's to say. */
struct finding machine_judge_key(const char *path, const struct stat *status,
				 const struct machine_user *user);

#endif
