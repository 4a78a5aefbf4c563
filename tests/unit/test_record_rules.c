/* The rules of the protocol, judged from a record: each is seen broken, and what excuses it. */
#include "tests/unit/unit.h"

#include "record/format.h"
#include "record/rules.h"

static void note_frame(struct record_rules *rules, uint64_t frame, uint64_t live)
{
	const struct record_entry e = { .kind = RECORD_STATE, .frame = { .frame = frame, .hash = frame + 7, .live = live } };

	record_rules_note(rules, &e);
}

static void note_ready(struct record_rules *rules, uint8_t node, uint64_t frame, uint64_t hash)
{
	const struct record_entry e = { .kind = RECORD_REPORT,
					.report = { .node = node, .kind = 9, .frame = frame, .hash = hash } };

	record_rules_note(rules, &e);
}

static void note_event(struct record_rules *rules, uint8_t kind, uint8_t node, uint64_t frame)
{
	const struct record_entry e = { .kind = RECORD_EVENT, .event = { .kind = kind, .node = node, .frame = frame } };

	record_rules_note(rules, &e);
}

static void note_swap(struct record_rules *rules, uint64_t frame)
{
	const struct record_entry e = { .kind = RECORD_SWAP, .swap = { frame, 0 } };

	record_rules_note(rules, &e);
}

static void rules_are_judged(void **state)
{
	struct record_rules r = { 0 };

	(void)state;
	note_frame(&r, 1, 7);
	note_ready(&r, 0, 1, 8);
	note_ready(&r, 0, 1, 8);
	note_event(&r, RECORD_LATE, 1, 1);
	note_event(&r, RECORD_LEFT, 2, 0);
	note_swap(&r, 1);
	assert_int_equal(r.equal, 1);
	assert_int_equal(r.different + r.early + r.back, 0);
	note_frame(&r, 2, 3);
	note_ready(&r, 0, 2, 9);
	note_event(&r, RECORD_LATE, 1, 1); /* of another frame */
	note_swap(&r, 2);
	assert_int_equal(r.early, 1);
	note_ready(&r, 1, 2, 1);
	assert_int_equal(r.different, 1);
	note_swap(&r, 2);
	assert_int_equal(r.back, 1);
	note_frame(&r, 3, 3);
	record_rules_gap(&r);
	note_swap(&r, 3); /* nobody knows who was ready */
	assert_int_equal(r.back, 1);
	assert_int_equal(r.early, 2); /* the second SWAP of frame 2 as well */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rules_are_judged),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
