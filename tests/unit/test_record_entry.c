/* What a session record is made of: entries, the session, and blocks with their checksums. */
#include "tests/unit/record_make.h"

#include "base/result.h"

static struct record_entry random_entry(struct unit_random *r, uint8_t *delta, size_t delta_len)
{
	struct record_entry e = { .kind = RECORD_SAMPLE + (enum record_entry_kind)(unit_random_u32(r) % 8),
				  .time_ns = unit_random_u32(r) };

	switch (e.kind) {
	case RECORD_SAMPLE:
		e.sample = (struct record_sample){ .body = unit_random_u32(r) % 2, .flags = unit_random_u32(r) % 8,
						   .axis_count = (uint8_t)(unit_random_u32(r) % 9), .time_ns = -5,
						   .T_room_body = GR_POSE_IDENTITY, .buttons = unit_random_u32(r), .device_ns = -1 - (int64_t)unit_random_u32(r) };
		for (int i = 0; i < e.sample.axis_count; i++)
			e.sample.axes[i] = (float)unit_random_range(r, -1, 1);
		break;
	case RECORD_STATE:
	case RECORD_DELTA:
		e.frame = (struct record_frame){ 9, 4, unit_random_u32(r), unit_random_u32(r), 3, delta, delta_len };
		delta[0] = e.kind == RECORD_STATE ? 0 : 4;
		break;
	case RECORD_REPORT:
		e.report = (struct record_report){ 1, 6, 3, unit_random_u32(r), 2, 8, -7, 1, unit_random_u32(r) };
		break;
	case RECORD_SWAP: e.swap = (struct record_swap){ 4, unit_random_u32(r) }; break;
	case RECORD_EVENT:
		e.event = (struct record_event){ RECORD_MISMATCH, RECORD_ALL_NODES, 3, 4, 5, "why" };
		break;
	case RECORD_LOST: e.lost = (struct record_lost){ 5, 2, 4 }; break;
	case RECORD_SHOWN: e.shown = (struct record_shown){ 1, 7, -5, unit_random_u32(r) }; break;
	}
	return e;
}

static void entries_come_back(void **state)
{
	struct unit_random r = unit_random_start("entries");
	struct record_maker m;
	uint8_t delta[64] = { 0 };
	uint8_t bytes[RECORD_ENTRY_MAX], again[RECORD_ENTRY_MAX];

	(void)state;
	record_maker_init(&m, 10, r);
	for (int i = 0; i < 2000; i++) {
		struct record_entry e = random_entry(&r, delta, 10 + unit_random_u32(&r) % 50), back;
		size_t len = record_entry_encode(&e, bytes, sizeof bytes);
		struct gr_reader reader = gr_reader(bytes, len);

		assert_true(len > RECORD_ENTRY_HEAD);
		assert_true(record_entry_decode(&reader, &m.session, &back) && gr_reader_done(&reader));
		assert_int_equal(record_entry_encode(&back, again, sizeof again), len);
		assert_memory_equal(bytes, again, len);
		for (size_t cut = 0; cut < len; cut++) {
			uint8_t *copy = unit_copy(bytes, cut);
			reader = gr_reader(copy, cut);
			assert_false(record_entry_decode(&reader, &m.session, &back));
			assert_int_equal(record_entry_encode(&e, copy, cut), 0);
			free(copy);
		}
	}
	record_maker_finish(&m);
}

static void fields_are_checked(void **state)
{
	static const struct { struct record_entry e; const char *what; } bad[] = {
		{ { RECORD_SAMPLE, 1, { .sample = { .tracker = 1 } } }, "tracker" },
		{ { RECORD_SAMPLE, 1, { .sample = { .body = 2 } } }, "body" },
		{ { RECORD_SAMPLE, 1, { .sample = { .flags = 8 } } }, "flags" },
		{ { RECORD_SAMPLE, 1, { .sample = { .flags = 3 } } }, "pose" },
		{ { RECORD_SWAP, -1, { .swap = { 1, 0 } } }, "time" },
		{ { RECORD_SWAP, 1, { .swap = { 0, 0 } } }, "frame 0" },
		{ { RECORD_REPORT, 1, { .report = { .node = 2, .kind = 6 } } }, "node" },
		{ { RECORD_REPORT, 1, { .report = { .node = 1, .kind = 7 } } }, "kind" },
		{ { RECORD_EVENT, 1, { .event = { .kind = 8 } } }, "event" },
		{ { RECORD_EVENT, 1, { .event = { .kind = 1, .text = "\033[2J" } } }, "text" },
		{ { RECORD_LOST, 1, { .lost = { 1, 2, 0 } } }, "frames" },
		{ { RECORD_SHOWN, 1, { .shown = { 2, 1, 0, 0 } } }, "node" },
	};
	struct record_maker m;
	uint8_t bytes[RECORD_ENTRY_MAX];

	(void)state;
	record_maker_init(&m, 10, (struct unit_random){ 1 });
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct gr_reader reader;
		struct record_entry back;
		size_t len = record_entry_encode(&bad[i].e, bytes, sizeof bytes);

		reader = gr_reader(bytes, len);
		if (!len || record_entry_decode(&reader, &m.session, &back))
			fail_msg("took a wrong %s", bad[i].what);
	}
	record_maker_finish(&m);
}

static void session_comes_back(void **state)
{
	struct record_session back;
	struct record_maker m;
	uint8_t bytes[RECORD_SESSION_MAX], again[RECORD_SESSION_MAX];
	size_t len;

	(void)state;
	record_maker_init(&m, 10, (struct unit_random){ 1 });
	m.session.zero_ns = -7200 * INT64_C(1000000000); /* scene time of a master that ran for longer */
	len = record_session_encode(&m.session, bytes, sizeof bytes);
	assert_int_equal(record_session_decode(bytes, len, &back), GR_OK);
	assert_int_equal(record_session_encode(&back, again, sizeof again), len);
	assert_memory_equal(bytes, again, len);
	for (size_t cut = 0; cut < len; cut++) {
		uint8_t *copy = unit_copy(bytes, cut);
		assert_int_equal(record_session_decode(copy, cut, &back), GR_ERR_FORMAT);
		free(copy);
	}
	record_maker_finish(&m);
}

/* Every bit of a block counts. */
static void a_flipped_bit_is_seen(void **state)
{
	struct record_head head = { .kind = RECORD_END, .len = RECORD_END_BYTES, .recording = 5, .sequence = 3 };
	const struct record_end end = { RECORD_END_ASKED, 10, 0 };
	uint8_t bytes[RECORD_HEAD_BYTES + RECORD_END_BYTES], again[RECORD_HEAD_BYTES];
	struct record_head back;

	(void)state;
	record_end_encode(&end, bytes + RECORD_HEAD_BYTES);
	record_head_sum(&head, bytes + RECORD_HEAD_BYTES);
	record_head_encode(&head, bytes);
	assert_int_equal(record_head_decode(bytes, &back), GR_OK);
	record_head_encode(&back, again);
	assert_memory_equal(again, bytes, sizeof again);
	for (size_t bit = 0; bit < 8 * sizeof bytes; bit++) {
		bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
		assert_false(record_head_decode(bytes, &back) == GR_OK &&
			     record_payload_sound(&back, bytes + RECORD_HEAD_BYTES));
		bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(entries_come_back),
		cmocka_unit_test(fields_are_checked),
		cmocka_unit_test(session_comes_back),
		cmocka_unit_test(a_flipped_bit_is_seen),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
