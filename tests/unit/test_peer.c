/* protocol/peer.h and barrier.h: the whole table, and who is waited for. */
#include "unit.h"

#include "protocol/barrier.h"
#include "protocol/node.h"
#include "protocol/peer.h"

#define ABSENT FDP_PEER_ABSENT
#define JOINING FDP_PEER_JOINING
#define LIVE FDP_PEER_LIVE
#define LATE FDP_PEER_LATE
#define DEAD FDP_PEER_DEAD
#define FOLLOWS FDP_PEER_FOLLOWS

/* The table of docs/protocol.md. */
static const enum fdp_peer_state table[][FDP_PEER_EVENTS] = {
	/*           joins    commits readies misses expires leaves followed */
	[ABSENT]  = { JOINING, ABSENT, ABSENT, ABSENT, ABSENT, ABSENT, ABSENT },
	[JOINING] = { JOINING, LIVE, JOINING, JOINING, DEAD, ABSENT, FOLLOWS },
	[LIVE]    = { JOINING, LIVE, LIVE, LATE, DEAD, ABSENT, LIVE },
	[LATE]    = { JOINING, LATE, LIVE, LATE, DEAD, ABSENT, LATE },
	[DEAD]    = { JOINING, DEAD, DEAD, DEAD, DEAD, DEAD, DEAD },
	[FOLLOWS] = { JOINING, FOLLOWS, FOLLOWS, FOLLOWS, DEAD, ABSENT, FOLLOWS },
};

static void every_step(void **state)
{
	(void)state;
	for (int s = ABSENT; s <= FOLLOWS; s++) {
		for (int e = 0; e < FDP_PEER_EVENTS; e++)
			assert_int_equal(fdp_peer_next((enum fdp_peer_state)s, (enum fdp_peer_event)e),
					 table[s][e]);
		assert_int_equal(fdp_peer_next((enum fdp_peer_state)s, FDP_PEER_EVENTS), s);
		assert_int_equal(fdp_peer_counts((enum fdp_peer_state)s), s == LIVE || s == LATE);
		assert_int_equal(fdp_peer_present((enum fdp_peer_state)s), s != ABSENT && s != DEAD);
		assert_string_not_equal(fdp_peer_state_name((enum fdp_peer_state)s), "unknown");
	}
	assert_string_equal(fdp_peer_state_name((enum fdp_peer_state)77), "unknown");
	for (int s = FDP_NODE_ALONE; s <= FDP_NODE_LIVE; s++)
		assert_string_not_equal(fdp_node_state_name((enum fdp_node_state)s), "unknown");
}

static void barrier(void **state)
{
	struct fdp_barrier b;

	(void)state;
	fdp_barrier_start(&b, 5, 0, 100, 10);
	assert_true(fdp_barrier_complete(&b)); /* nobody to wait for */
	fdp_barrier_start(&b, 5, 0xb, 100, 10);
	assert_int_equal(fdp_barrier_unready(&b), 0xb);
	b.acked = 0x1;
	b.ready = 0x2;
	assert_int_equal(fdp_barrier_unacked(&b), 0x8); /* who is ready has it */
	assert_false(fdp_barrier_over(&b, 109));
	assert_true(fdp_barrier_over(&b, 110));
	b.ready = 0x3;
	assert_false(fdp_barrier_complete(&b));
	fdp_barrier_drop(&b, 3);
	assert_true(fdp_barrier_over(&b, 100));
	fdp_barrier_start(&b, 6, UINT64_MAX, 0, 1);
	b.ready = UINT64_MAX;
	assert_true(fdp_barrier_complete(&b));
	fdp_barrier_drop(&b, 63);
	assert_int_equal(b.live, UINT64_MAX >> 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_step), cmocka_unit_test(barrier),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
