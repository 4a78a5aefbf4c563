/*
 * Reports from a device's thread to whoever reads them, without locks: a ring
 * of which the writer overwrites the oldest. Neither side ever waits; a reader
 * has a place of its own, gets every report in order, and when it was away for
 * so long that some are gone it is told how many. Each slot is a value of
 * base/seqlock.h, so no report is ever torn.
 *
 * Thread: one writes, any read.
 */
#ifndef GROTTO_TRACKING_HANDOVER_H
#define GROTTO_TRACKING_HANDOVER_H

#include "base/seqlock.h"
#include "tracking/report.h"

#define TRACK_HANDOVER 1024 /* reports: half a second of two sensors at 1 kHz */

_Static_assert(sizeof(struct track_report) % sizeof(uint64_t) == 0, "handed over in words");

struct track_handover {
	_Atomic uint64_t written; /* ever */
	struct track_handover_slot {
		_Atomic uint64_t sequence;
		_Atomic uint64_t words[GR_SEQLOCK_WORDS(struct track_report)];
	} slots[TRACK_HANDOVER];
};

struct track_reader {
	uint64_t next;	 /* number of the report that is read next */
	uint64_t missed; /* overwritten before they were read */
};

/* All zero is an empty one. */
void track_handover_put(struct track_handover *handover, const struct track_report *report);
/* The next reports, oldest first, at most `room`; returns how many. */
int track_handover_take(const struct track_handover *handover, struct track_reader *reader,
			struct track_report *out, int room);

#endif
