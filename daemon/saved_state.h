/*
 * What a master leaves behind for its successor, so that a room whose master
 * died goes on where it was: scene time, where the room stands, lamps and other
 * settings, what the hand does. A small file with a checksum. Encoding and
 * decoding are pure; state_keeper.h writes it.
 *
 * The file: "GRSS", u32 version, layout hash (32), scene hash (32), i64 when it
 * was saved (CLOCK_REALTIME, ns), u64 frame, i64 scene time in ns, position and
 * rotation of the room (7 f32), the settings in the order of struct
 * master_settings, of the hand buttons, layout and flags (u32 each), hue, and
 * position and direction of the torch (7 f32), BLAKE2b-256 of all before. Little
 * endian.
 */
#ifndef GROTTO_DAEMON_SAVED_STATE_H
#define GROTTO_DAEMON_SAVED_STATE_H

#include "daemon/master_state.h"

/* Older than this, the file is of another visit. */
#define SAVED_STATE_AGE_MOST_NS (600 * INT64_C(1000000000))
#define SAVED_STATE_BYTES 444
#define SAVED_STATE_REASON 200

struct saved_state {
	uint8_t layout_hash[32], scene_hash[32];
	int64_t saved_ns; /* CLOCK_REALTIME */
	uint64_t frame;
	int64_t time_ns; /* scene time of that frame */
	struct gr_pose T_scene_room;
	struct master_settings settings;
	struct saved_hand {
		uint32_t buttons, mode;
		uint32_t flags; /* HAND_FLAG_QUALITY, HAND_FLAG_PUT_DOWN */
		float hue;
		vec3 position, direction; /* with HAND_FLAG_PUT_DOWN */
	} hand;
};

void saved_state_encode(const struct saved_state *state, uint8_t bytes[SAVED_STATE_BYTES]);
/*
 * GR_OK; GR_ERR_FORMAT: not such a file, damaged, or with values that are in no
 * parameter's range; `why` says what.
 */
int saved_state_decode(const uint8_t *bytes, size_t len, struct saved_state *out,
		       char why[SAVED_STATE_REASON]);
/*
 * Is it this room's, and of this visit? GR_OK, GR_ERR_MISMATCH (another layout
 * or scene) or GR_NOTHING (too old, or of a time to come); `why` says what.
 */
int saved_state_fits(const struct saved_state *state, const uint8_t layout_hash[32],
		     const uint8_t scene_hash[32], int64_t real_ns, char why[SAVED_STATE_REASON]);
/* The file at `path`, decoded. GR_NOTHING when there is none; GR_ERR_IO. */
int saved_state_load(const char *path, struct saved_state *out, char why[SAVED_STATE_REASON]);

/* From a master's state, and into a new one's. */
void saved_state_take(struct saved_state *out, const struct master_state *state);
void saved_state_give(const struct saved_state *saved, struct master_state *state);

#endif
