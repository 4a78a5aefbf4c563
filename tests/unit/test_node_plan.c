/* Which plan of the light a node goes by: it follows the room, but not for ever. */
#include "tests/unit/unit.h"

#include "daemon/node_plan.h"

static const int64_t minute = INT64_C(60000000000);

static void follows_the_room(void **state)
{
	struct node_plan plan = { .present = 5 };

	(void)state;
	assert_false(node_plan_offered(&plan, 0, 1));
	assert_false(node_plan_offered(&plan, 5, 1)); /* it has that one: refused for something else */
	assert_int_equal(plan.wanted, 0);
	assert_true(node_plan_offered(&plan, 6, 1));
	assert_int_equal(plan.wanted, 6);
	node_plan_tried(&plan, 6);
	assert_int_equal(plan.present, 6);
	assert_int_equal(plan.wanted, 0);
	assert_int_equal(plan.impossible, 0);
	/* and back to what was its own */
	assert_true(node_plan_offered(&plan, 5, 2));
	node_plan_tried(&plan, 5);
	assert_int_equal(plan.present, 5);
}

static void what_cannot_be_had(void **state)
{
	struct node_plan plan = { .present = 5 };

	(void)state;
	assert_true(node_plan_offered(&plan, 6, 0));
	node_plan_tried(&plan, 5);
	assert_int_equal(plan.impossible, 6);
	assert_false(node_plan_offered(&plan, 6, minute));
	assert_true(node_plan_offered(&plan, 7, minute)); /* another may do */
	node_plan_tried(&plan, 7);
	node_plan_settled(&plan);
	/* much later the memory may be there */
	assert_true(node_plan_offered(&plan, 6, NODE_PLAN_AGAIN_NS));
}

static void bounded(void **state)
{
	struct node_plan plan = { .present = 1 };

	(void)state;
	for (uint64_t i = 0; i < 100; i++) {
		const bool taken = node_plan_offered(&plan, i + 2, (int64_t)i * minute / 20);

		assert_int_equal(taken, i < NODE_PLAN_TRIES);
		if (taken)
			node_plan_tried(&plan, i + 2);
	}
	assert_true(node_plan_offered(&plan, 200, NODE_PLAN_AGAIN_NS));
	node_plan_tried(&plan, 200);
	/* in step with the room all is forgotten */
	node_plan_settled(&plan);
	for (uint64_t i = 0; i < 100; i++) {
		assert_true(node_plan_offered(&plan, 300 + i, NODE_PLAN_AGAIN_NS + 1));
		node_plan_tried(&plan, 300 + i);
		node_plan_settled(&plan);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(follows_the_room),
		cmocka_unit_test(what_cannot_be_had),
		cmocka_unit_test(bounded),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
