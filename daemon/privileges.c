#include "config.h" /* _GNU_SOURCE */

#include "daemon/privileges.h"

#include "base/log.h"
#include "base/result.h"

#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

static int become(const char *user, const char *give)
{
	const struct passwd *entry;

	errno = 0;
	entry = getpwnam(user);
	if (!entry) {
		gr_error("--user %s: there is no such user; sysusers.d/grotto.conf makes 'grotto'", user);
		return GR_ERR_CONFIG;
	}
	if (entry->pw_uid == 0) {
		gr_error("--user %s: is root; name a user without privileges", user);
		return GR_ERR_CONFIG;
	}
	if (give && lchown(give, entry->pw_uid, entry->pw_gid) < 0) {
		gr_error("%s: cannot be given to %s: %s", give, user, strerror(errno));
		return GR_ERR_IO;
	}
	if (initgroups(user, entry->pw_gid) < 0 ||
	    setresgid(entry->pw_gid, entry->pw_gid, entry->pw_gid) < 0 ||
	    setresuid(entry->pw_uid, entry->pw_uid, entry->pw_uid) < 0) {
		gr_error("cannot become user %s: %s", user, strerror(errno));
		return GR_ERR_IO;
	}
	if (setuid(0) == 0 || geteuid() == 0) {
		gr_error("root came back after becoming %s; refusing to run", user);
		return GR_ERR_IO;
	}
	gr_info("running as user %s", user);
	return GR_OK;
}

int privileges_drop(const char *user, const char *give)
{
	if (user && geteuid() == 0) {
		int r = become(user, give);
		if (r < 0)
			return r;
	} else if (user) {
		gr_info("--user %s: not started as root, nothing to give up", user);
	} else if (geteuid() == 0) {
		gr_notice("running as root: --user NAME or the shipped units run it as a user without privileges");
	}
	if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) < 0) {
		gr_error("no_new_privs: %s", strerror(errno));
		return GR_ERR_IO;
	}
	return GR_OK;
}
