/* Frames of a recording as the master's frame loop gets them, and the comparison of hashes. */
#include "tests/unit/record_make.h"

#include "base/clock.h"
#include "base/result.h"
#include "daemon/loop.h"
#include "daemon/replay_source.h"
#include "record/output.h"

#include <unistd.h>

#define FRAMES 120
#define PAUSE_AFTER 60
#define HERE_NS INT64_C(900000000000) /* the clock of the replay has nothing to do with the record's */

struct fixture {
	struct record_maker maker;
	char path[64];
	int64_t shift_ns;
	struct record_output *output;
	uint64_t first_state;
};

static bool to_output(void *ctx, const struct record_entry *entry)
{
	struct fixture *f = ctx;
	struct record_entry moved = *entry;
	uint8_t bytes[RECORD_ENTRY_MAX];
	size_t len;

	moved.time_ns += f->shift_ns;
	len = record_entry_encode(&moved, bytes, sizeof bytes);
	return len > 0 && record_output_add(f->output, bytes, (uint32_t)len) == GR_OK;
}

/* 120 frames, with ten seconds in their middle in which nothing was shown. */
static int setup(void **state)
{
	const struct record_output_params params = { 1 << 24, GR_NS_PER_S, GR_NS_PER_S, NULL };
	const struct record_end end = { .reason = RECORD_END_ASKED };
	struct fixture *f = calloc(1, sizeof *f);
	uint8_t session[RECORD_SESSION_MAX];
	size_t len;
	int fd;

	record_maker_init(&f->maker, 30, (struct unit_random){ 5 });
	strcpy(f->path, "/tmp/grotto-replay-XXXXXX");
	fd = mkstemp(f->path);
	if (fd < 0 || record_output_create(&f->output, &params) != GR_OK)
		return -1;
	close(fd);
	len = record_session_encode(&f->maker.session, session, sizeof session);
	if (record_output_open(f->output, f->path, session, (uint32_t)len) != GR_OK)
		return -1;
	for (int i = 1; i <= FRAMES; i++) {
		record_maker_frame(&f->maker, to_output, f);
		if (i == PAUSE_AFTER)
			f->shift_ns = 10 * GR_NS_PER_S;
	}
	if (record_output_flush(f->output, 0) != GR_OK || record_output_end(f->output, &end) != GR_OK)
		return -1;
	record_output_destroy(&f->output);
	*state = f;
	return 0;
}

static int teardown(void **state)
{
	struct fixture *f = *state;

	unlink(f->path);
	record_maker_finish(&f->maker);
	free(f);
	return 0;
}

static struct replay_source *open_source(struct fixture *f, struct replay_params params)
{
	const struct replay_room room = { f->maker.session.layout_hash, f->maker.session.scene_hash };
	struct gr_diag diag = { 0 };
	struct replay_source *source;

	params.path = f->path;
	params.recording = 1;
	assert_int_equal(replay_source_create(&source, &params, &room, &diag), GR_OK);
	assert_int_equal(diag.errors, 0);
	gr_diag_finish(&diag);
	return source;
}

/* Goes through all frames; every node answers rightly but where `lie` says. Returns the last one's due time. */
static int64_t run(struct fixture *f, struct replay_source *source, uint64_t lie, uint64_t silent)
{
	struct frame_source *frames = replay_source_frames(source);
	struct param_state *state;
	int64_t now_ns = HERE_NS, due_ns = HERE_NS;
	uint64_t last = 0;

	assert_int_equal(param_state_create(&state), GR_OK);
	while (!frames->ops->over(frames)) {
		struct frame_moment moment = { .now_ns = now_ns, .last = last };
		struct frame_next next;

		due_ns = frames->ops->due(frames);
		assert_int_not_equal(due_ns, LOOP_NEVER);
		now_ns = due_ns > now_ns ? due_ns : now_ns;
		moment.now_ns = now_ns;
		assert_int_equal(frames->ops->next(frames, &moment, state, &next), GR_OK);
		assert_int_equal(next.jumps, last == 0);
		assert_int_equal(param_state_hash(state, next.previous_hash), f->maker.hashes[next.frame]);
		frames->ops->begun(frames, 3, f->maker.hashes[next.frame], now_ns);
		for (unsigned node = 0; node < 2; node++)
			if (next.frame != silent || node != 1)
				frames->ops->held(frames, node, next.frame,
						  f->maker.hashes[next.frame] + (next.frame == lie && node == 1));
		last = next.frame;
	}
	assert_int_equal(last, FRAMES);
	assert_int_equal(frames->ops->next(frames, &(struct frame_moment){ 0 }, state,
					   &(struct frame_next){ 0 }), GR_NOTHING);
	param_state_destroy(&state);
	return now_ns - HERE_NS;
}

static void frames_come_at_their_distances(void **state)
{
	/* The pause is cut to two seconds. */
	const int64_t there_ns = (FRAMES - 1) * MAKE_FRAME_NS - MAKE_FRAME_NS + REPLAY_PAUSE_NS;
	static const double speeds[] = { 0.25, 1, 4 };

	for (size_t i = 0; i < 3; i++) {
		struct replay_source *source = open_source(*state, (struct replay_params){ .speed = speeds[i] });
		int64_t took_ns = run(*state, source, 0, 0);

		assert_true(llabs(took_ns - (int64_t)((double)there_ns / speeds[i])) < 1000);
		assert_true(replay_source_end(source));
		replay_source_destroy(&source);
	}
}

static void a_node_that_differs_is_found(void **state)
{
	struct replay_source *source = open_source(*state, (struct replay_params){ .speed = 1 });

	run(*state, source, 77, 0);
	assert_false(replay_source_end(source));
	replay_source_destroy(&source);
	source = open_source(*state, (struct replay_params){ .speed = 1 });
	run(*state, source, 0, FRAMES);
	assert_false(replay_source_end(source));
	replay_source_destroy(&source);
}

static void steps_are_waited_for(void **state)
{
	struct replay_source *source = open_source(*state, (struct replay_params){ .speed = 1, .step = true });
	struct frame_source *frames = replay_source_frames(source);
	struct param_state *params;
	struct frame_next next;
	uint64_t last = 0;

	assert_int_equal(param_state_create(&params), GR_OK);
	assert_int_equal(frames->ops->due(frames), LOOP_NEVER);
	assert_int_equal(replay_source_step(source, 3), GR_OK);
	for (int i = 0; i < 3; i++) {
		const struct frame_moment moment = { .now_ns = HERE_NS, .last = last };
		assert_int_equal(frames->ops->due(frames), 0);
		assert_int_equal(frames->ops->next(frames, &moment, params, &next), GR_OK);
		frames->ops->begun(frames, 0, ((struct fixture *)*state)->maker.hashes[next.frame], HERE_NS);
		last = next.frame;
	}
	assert_int_equal(last, 3);
	assert_int_equal(frames->ops->due(frames), LOOP_NEVER);
	replay_source_destroy(&source);
	param_state_destroy(&params);
	source = open_source(*state, (struct replay_params){ .speed = 1 });
	assert_int_equal(replay_source_step(source, 1), GR_ERR_STATE);
	replay_source_destroy(&source);
}

static void another_room_is_refused(void **state)
{
	struct fixture *f = *state;
	const struct replay_params params = { .path = f->path, .recording = 1, .speed = 1 };
	const uint8_t other[32] = { 1 };
	const struct replay_room rooms[] = { { other, f->maker.session.scene_hash },
					     { f->maker.session.layout_hash, other }, { NULL, other } };
	const struct replay_params second = { .path = f->path, .recording = 2, .speed = 1 };
	struct gr_diag diag = { 0 };
	struct replay_source *source;

	for (size_t i = 0; i < 3; i++) {
		assert_int_equal(replay_source_create(&source, &params, &rooms[i], &diag), GR_ERR_CONFIG);
		assert_int_equal(diag.errors, i + 1);
		assert_null(source);
	}
	assert_int_equal(replay_source_create(&source, &second, &rooms[0], &diag), GR_ERR_FORMAT);
	gr_diag_finish(&diag);
}

static void the_check_knows_who_said_what(void **state)
{
	struct replay_check c = { 0 };

	(void)state;
	assert_false(replay_check_passed(&c)); /* nothing was compared */
	replay_check_begin(&c, 5, 50, 50, 3);
	replay_check_held(&c, 0, 5, 50);
	replay_check_held(&c, 1, 5, 51);
	replay_check_held(&c, 1, 5, 50); /* after its snapshot */
	replay_check_held(&c, 0, 4, 1);  /* of no frame that was begun */
	replay_check_held(&c, 64, 5, 1);
	assert_int_equal(c.node_equal, 1);
	assert_int_equal(c.different, 1);
	assert_int_equal(c.first.frame, 5);
	assert_int_equal(c.first.node, 1);
	assert_int_equal(c.first.found, 51);
	replay_check_begin(&c, 5 + REPLAY_CHECK_OPEN, 60, 61, 1);
	assert_int_equal(c.unanswered, 0);
	assert_int_equal(c.different, 2);
	assert_int_equal(c.first.frame, 5);
	replay_check_begin(&c, 6 + REPLAY_CHECK_OPEN, 62, 62, 7);
	replay_check_end(&c, 6 + REPLAY_CHECK_OPEN);
	assert_int_equal(c.unanswered, 1);
	assert_false(replay_check_passed(&c));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(frames_come_at_their_distances),
		cmocka_unit_test(a_node_that_differs_is_found),
		cmocka_unit_test(steps_are_waited_for),
		cmocka_unit_test(another_room_is_refused),
		cmocka_unit_test(the_check_knows_who_said_what),
	};

	return cmocka_run_group_tests(tests, setup, teardown);
}
