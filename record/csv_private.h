/* Inside record/: the table of frames needs what comes after each. */
#ifndef GROTTO_RECORD_CSV_PRIVATE_H
#define GROTTO_RECORD_CSV_PRIVATE_H

#include "record/csv.h"
#include "record/states.h"

#define CSV_OPEN 64 /* frames whose reports may still come */

struct csv_pose {
	float p[3], q[4];
};

struct csv_spread {
	uint64_t nodes; /* bit per node */
	int64_t first_ns, last_ns;
};

struct csv_frame {
	uint64_t frame; /* 0: unused */
	uint64_t hash, live, acked, ready; /* bit per node */
	int64_t begun_ns, sent_ns, at_ns, acked_ns, ready_ns; /* 0: not known */
	struct csv_spread raw, by_master; /* of the swaps; the nodes' own clocks, the master's */
	bool whole, held; /* held: the rest is known */
	uint64_t scene_ns;
	struct csv_pose head, wand, room;
	uint32_t buttons, flags, hand_layout;
};

struct csv_frames {
	FILE *file; /* NULL: not wanted */
	int64_t start_ns;
	struct record_states states;
	bool states_known;
	struct csv_frame open[CSV_OPEN];
};

void csv_seconds(FILE *file, int64_t ns);
void csv_text(FILE *file, const char *text);
void csv_floats(FILE *file, const float *values, int count);

void csv_frames_head(FILE *file);
void csv_frames_note(struct csv_frames *frames, const struct record_entry *entry);
/* Writes what is still open. */
void csv_frames_end(struct csv_frames *frames);

#endif
