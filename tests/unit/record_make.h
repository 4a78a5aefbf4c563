/*
 * Recordings for tests: a made-up session whose every frame's hash is kept,
 * so that what is read can be compared.
 */
#ifndef GROTTO_TESTS_RECORD_MAKE_H
#define GROTTO_TESTS_RECORD_MAKE_H

#include "tests/unit/unit.h"

#include "protocol/params.h"
#include "record/format.h"
#include "record/writer.h"

#define MAKE_FRAMES_MAX 4096
#define MAKE_FRAME_NS INT64_C(16666667)
#define MAKE_START_NS INT64_C(5000000000)

struct record_maker {
	struct record_session session;
	struct param_state *state;
	uint64_t frame, hash;
	uint64_t hashes[MAKE_FRAMES_MAX];
	unsigned whole_every; /* frames */
	bool need_whole;
	struct unit_random random;
};

void record_maker_init(struct record_maker *maker, unsigned whole_every, struct unit_random random);
void record_maker_finish(struct record_maker *maker);
/* The next frame with its samples, reports and swap: each entry is handed to put. */
typedef bool (*record_maker_put)(void *ctx, const struct record_entry *entry);
void record_maker_frame(struct record_maker *maker, record_maker_put put, void *ctx);
bool record_maker_to_writer(void *writer, const struct record_entry *entry);

#endif
