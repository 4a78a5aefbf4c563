/* What a recording's file holds, in numbers: one pass over all of it. */
#ifndef GROTTO_RECORD_SURVEY_H
#define GROTTO_RECORD_SURVEY_H

#include "record/reader.h"
#include "record/rules.h"

struct record_survey {
	struct record_session session;
	uint64_t recording; /* the random number that its blocks bear */
	bool ended; /* with an END block; else cut off, or still being written */
	struct record_end end;
	uint64_t blocks, bytes;
	int64_t first_ns, last_ns; /* of its entries; 0 without any */
	uint64_t frames, wholes;   /* that began; of these, with a whole state */
	uint64_t first_frame, last_frame;
	uint64_t frames_missing;   /* numbers between first and last */
	uint64_t frames_wrong;     /* not what their hash says */
	uint64_t frames_unusable;  /* deltas whose base is missing */
	bool states_known; /* of this program's parameters; else the last two were not looked at */
	uint64_t samples[RECORD_TRACKERS], samples_invalid, samples_refused;
	uint64_t reports[RECORD_NODES], shown[RECORD_NODES];
	uint64_t swaps, events[8]; /* by enum record_event_kind */
	uint64_t lost, lost_frames; /* given up because the disk was too slow */
	struct record_rules rules;
	uint64_t gaps; /* places at which blocks are missing or damaged */
};

/*
 * Called for each recording, in the file's order; the survey is valid during
 * the call.
 */
typedef void (*record_survey_fn)(void *ctx, const struct record_survey *survey);
/* GR_OK, GR_NOTHING (no recording in it), GR_ERR_IO, GR_ERR_NOMEM. */
int record_survey(struct record_reader *reader, record_survey_fn fn, void *ctx);

#endif
