/* SCHED_RESET_ON_FORK is a GNU extension: config.h asks for it. */
#include <config.h>

#include "daemon/priority.h"

#include "base/log.h"

#include <errno.h>
#include <sched.h>
#include <string.h>
#include <sys/resource.h>

int priority_take(int priority)
{
	struct sched_param param = { .sched_priority = priority };
	struct rlimit limit = { 0 };
	int error;

	if (priority <= 0)
		return 0;
	if (sched_setscheduler(0, SCHED_RR | SCHED_RESET_ON_FORK, &param) == 0) {
		gr_info("real-time priority %d", priority);
		return priority;
	}
	error = errno;
	if (error == EPERM && getrlimit(RLIMIT_RTPRIO, &limit) == 0 && limit.rlim_cur > 0 &&
	    limit.rlim_cur < (rlim_t)priority) {
		param.sched_priority = (int)limit.rlim_cur;
		if (sched_setscheduler(0, SCHED_RR | SCHED_RESET_ON_FORK, &param) == 0) {
			gr_info("real-time priority %d: RLIMIT_RTPRIO allows no %d",
				param.sched_priority, priority);
			return param.sched_priority;
		}
		error = errno;
	}
	gr_notice("ordinary priority, not %d: %s (LimitRTPRIO= in the unit allows it)", priority,
		  strerror(error));
	return 0;
}
