/*
 * The bytes of a session record: blocks, and the entries in them. Pure; what
 * is decoded comes from outside and is checked field by field.
 * docs/recording.md gives every byte.
 *
 * A file is one block after the other: a header of RECORD_HEAD_BYTES, a
 * payload. A recording begins with a SESSION block, goes on with ENTRIES and
 * ends, unless it was cut off, with END. Several may follow each other in one
 * file. Checksums are BLAKE2b without a key: they find damage, not forgery.
 *
 * Times: ns of the master's CLOCK_MONOTONIC, unless it says otherwise.
 */
#ifndef GROTTO_RECORD_FORMAT_H
#define GROTTO_RECORD_FORMAT_H

#include "base/cursor.h"
#include "base/pose.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RECORD_VERSION 1
#define RECORD_HEAD_BYTES 64
#define RECORD_SUM_BYTES 16
#define RECORD_PAYLOAD_MAX 65536
#define RECORD_BODY_MAX 4096 /* of an entry */
#define RECORD_ENTRY_HEAD 12
#define RECORD_ENTRY_MAX (RECORD_ENTRY_HEAD + RECORD_BODY_MAX)
#define RECORD_NODES 64
#define RECORD_TRACKERS 16
#define RECORD_NAME_BYTES 64 /* with the final NUL */
#define RECORD_PATH_BYTES 1024
#define RECORD_TEXT_BYTES 256
#define RECORD_AXES 8
#define RECORD_ALL_NODES 255

enum record_block_kind { RECORD_SESSION = 1, RECORD_ENTRIES, RECORD_END };

/* The first entry is a whole state: a replay can begin with this block. */
#define RECORD_WHOLE 1u

struct record_head {
	uint8_t kind, flags;
	uint32_t len;   /* of the payload, 1..RECORD_PAYLOAD_MAX */
	uint32_t count; /* entries; 0 but in ENTRIES */
	uint64_t recording; /* random, not 0: which recording the block is of */
	uint64_t sequence;  /* of the block in the recording, from 0 */
	uint64_t frame;     /* last frame before the first entry; 0: none */
	uint8_t sum[RECORD_SUM_BYTES]; /* of the payload */
};

/* head->sum is that of `payload`. */
void record_head_sum(struct record_head *head, const uint8_t *payload);
void record_head_encode(const struct record_head *head, uint8_t bytes[RECORD_HEAD_BYTES]);
/* GR_OK, GR_ERR_VERSION (sound, but of another version), GR_ERR_FORMAT. */
int record_head_decode(const uint8_t bytes[RECORD_HEAD_BYTES], struct record_head *out);
bool record_payload_sound(const struct record_head *head, const uint8_t *payload);

#define RECORD_FRAME_CLOCK 1u /* scene time is frame number over rate, not real time */
#define RECORD_OF_REPLAY 2u   /* the master replayed a recording while this one was made */

/* What a recording is of. All texts are printable and NUL-terminated. */
struct record_session {
	uint16_t protocol; /* version of FDP */
	uint16_t flags;
	uint64_t session, table_hash;
	uint8_t layout_hash[32], scene_hash[32];
	int64_t wall_ns;  /* CLOCK_REALTIME when the recording began */
	int64_t start_ns; /* the same moment */
	int64_t zero_ns;  /* where the scale of samples and scene times begins (real clock) */
	float frame_hz;
	char grotto[RECORD_NAME_BYTES]; /* version of the program */
	char layout[RECORD_NAME_BYTES], scene[RECORD_NAME_BYTES];
	char layout_path[RECORD_PATH_BYTES], scene_path[RECORD_PATH_BYTES]; /* as the master had them; "" unknown */
	uint16_t node_count, tracker_count;
	char nodes[RECORD_NODES][RECORD_NAME_BYTES];
	char trackers[RECORD_TRACKERS][RECORD_NAME_BYTES];
};
#define RECORD_SESSION_MAX 16384

/* Bytes written; 0 when the room is too small or a field outside its range. */
size_t record_session_encode(const struct record_session *session, uint8_t *bytes, size_t size);
int record_session_decode(const uint8_t *bytes, size_t len, struct record_session *out);

enum record_end_reason {
	RECORD_END_ASKED = 1, /* somebody asked for the end */
	RECORD_END_MASTER,    /* the master ended */
	RECORD_END_SIZE,      /* the file had reached its largest size */
};
struct record_end {
	enum record_end_reason reason;
	uint64_t entries, lost; /* written; given up because the disk was too slow */
};
#define RECORD_END_BYTES 24
void record_end_encode(const struct record_end *end, uint8_t bytes[RECORD_END_BYTES]);
int record_end_decode(const uint8_t *bytes, size_t len, struct record_end *out);
const char *record_end_name(enum record_end_reason reason);

enum record_entry_kind {
	RECORD_SAMPLE = 1, /* a tracker said */
	RECORD_STATE,      /* a frame began: its whole state */
	RECORD_DELTA,      /* a frame began: what differs from the frame before */
	RECORD_REPORT,     /* ACK, READY or SWAPPED of a node arrived */
	RECORD_SWAP,       /* SWAP went out */
	RECORD_EVENT,
	RECORD_LOST,       /* entries that are missing here */
	RECORD_SHOWN,      /* a node has told that it swapped a frame */
};

#define RECORD_VALID 1u /* the device had the body */
#define RECORD_TAKEN 2u /* the master used it */
#define RECORD_TIMED 4u /* the device said when it was, by its own clock */
struct record_sample {
	uint8_t tracker, body; /* of the layout, in its order; enum track_body */
	uint8_t flags, axis_count;
	int64_t time_ns; /* when the body was there; scale of scene times */
	int64_t device_ns; /* with RECORD_TIMED: the same by the device's own clock */
	struct gr_pose T_room_body; /* as it came: sound only with both flags */
	uint32_t buttons;
	float axes[RECORD_AXES];
};

/* STATE, DELTA. The bytes are in the block. */
struct record_frame {
	uint64_t frame, previous_frame;
	uint64_t hash, previous_hash; /* chained, see params.h */
	uint64_t live; /* nodes that count in its barrier */
	const uint8_t *delta; /* as in FDP; base 0 in STATE, previous_frame in DELTA */
	size_t delta_len;
};
#define RECORD_FRAME_HEAD 40

struct record_report {
	uint8_t node, kind; /* kind: of FDP: 6 ACK, 9 READY, 11 SWAPPED */
	uint64_t frame, hash;
	uint64_t swapped_frame, swapped_count;
	int64_t swap_ns; /* the node's CLOCK_MONOTONIC, as it says */
	uint32_t render_us;
	uint64_t slice;
};

struct record_swap {
	uint64_t frame;
	int64_t at_ns; /* when the nodes were told to show it; 0: at once */
};

enum record_event_kind {
	RECORD_JOINED = 1, RECORD_LEFT, RECORD_REFUSED, RECORD_LATE, RECORD_EVICTED,
	RECORD_MISMATCH, RECORD_SETTING,
};
struct record_event {
	uint8_t kind, node; /* RECORD_ALL_NODES: about all */
	uint64_t frame, ours, theirs;
	char text[RECORD_TEXT_BYTES]; /* reason; the request of a SETTING; or "" */
};

struct record_lost {
	uint64_t entries, frames; /* frames: of these, those that began a frame */
	int64_t since_ns; /* of the first */
};

struct record_shown {
	uint8_t node;
	uint64_t frame;
	int64_t node_ns;   /* its CLOCK_MONOTONIC, as it says */
	int64_t master_ns; /* the same by the master's, as estimated then; 0: not known */
};

struct record_entry {
	enum record_entry_kind kind;
	int64_t time_ns; /* when it arrived or happened at the master */
	union {
		struct record_sample sample;
		struct record_frame frame;
		struct record_report report;
		struct record_swap swap;
		struct record_event event;
		struct record_lost lost;
		struct record_shown shown;
	};
};

/* Bytes written; 0 when the room is too small or a field outside its range. */
size_t record_entry_encode(const struct record_entry *entry, uint8_t *bytes, size_t size);
/*
 * The next entry at the cursor, whose node and tracker must be of the session.
 * False (and the cursor's failure) when it is not one.
 */
bool record_entry_decode(struct gr_reader *r, const struct record_session *session,
			 struct record_entry *out);
const char *record_event_name(uint8_t kind);
/* "ack", "ready", "swapped". */
const char *record_report_name(uint8_t kind);

#endif
