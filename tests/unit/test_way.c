/* Multicast while every node hears it: a cluster on a fake clock, some of it deaf to the group. */
#include "cluster_sim.h"

#include "base/result.h"

static void start(struct sim *s, size_t nodes)
{
	sim_init(s, nodes, 17);
	s->probe_group = true;
	sim_start_all(s);
}

static void assert_all_live(struct sim *s)
{
	for (size_t i = 0; i < s->node_count; i++) {
		assert_int_equal(sim_peer(s, (int)i).state, FDP_PEER_LIVE);
		assert_int_equal(s->nodes[i].joined, 1);
		assert_int_equal(s->nodes[i].last_swap, s->frame);
	}
	assert_int_equal(s->late + s->evicted + s->mismatches, 0);
}

static void all_hear(void **state)
{
	struct fdp_counters before, after;
	struct sim s;

	(void)state;
	start(&s, 4);
	assert_int_equal(fdp_master_way(s.master), FDP_WAY_EACH); /* nobody has said anything yet */
	sim_assemble(&s);
	sim_run_frames(&s, 3);
	assert_int_equal(fdp_master_way(s.master), FDP_WAY_GROUP);
	assert_int_equal(s.ways, 1);
	assert_int_equal(s.way, FDP_WAY_GROUP);
	fdp_master_counters(s.master, &before);
	sim_run_frames(&s, 100);
	fdp_master_counters(s.master, &after);
	assert_all_live(&s);
	assert_int_equal(s.ways, 1);
	printf("# four nodes, all hear: %.1f datagrams out a frame\n",
	       (double)(after.datagrams_out - before.datagrams_out) / 100);
	assert_true(after.datagrams_out - before.datagrams_out < 100 * 4);
	sim_finish(&s);
}

/* Each by itself, and once it is sure the one who is the reason is named. */
static void one_is_deaf(void **state)
{
	struct sim s;

	(void)state;
	start(&s, 4);
	s.nodes[2].deaf = true;
	sim_assemble(&s);
	sim_run_frames(&s, 30);
	assert_int_equal(s.ways, 0);
	sim_run_frames(&s, 60);
	assert_int_equal(s.ways, 1);
	assert_int_equal(s.way, FDP_WAY_EACH);
	assert_int_equal(s.deaf, 2);
	assert_int_equal(fdp_master_way(s.master), FDP_WAY_EACH);
	assert_true(sim_peer(&s, 1).hears_group);
	assert_false(sim_peer(&s, 2).hears_group);
	assert_all_live(&s);
	/* Mended: back to the group within a PROBE or two. */
	s.nodes[2].deaf = false;
	sim_run_frames(&s, 40);
	assert_int_equal(s.ways, 2);
	assert_int_equal(s.way, FDP_WAY_GROUP);
	assert_int_equal(fdp_master_way(s.master), FDP_WAY_GROUP);
	assert_all_live(&s);
	sim_finish(&s);
}

/* A switch forgets a member in mid-show: repairs keep its wall alive until the room goes the other way. */
static void one_goes_deaf(void **state)
{
	struct sim s;

	(void)state;
	start(&s, 4);
	sim_assemble(&s);
	sim_run_frames(&s, 20);
	assert_int_equal(fdp_master_way(s.master), FDP_WAY_GROUP);
	s.nodes[1].deaf = true;
	sim_run_frames(&s, 120);
	assert_int_equal(fdp_master_way(s.master), FDP_WAY_EACH);
	assert_int_equal(s.deaf, 1);
	assert_all_live(&s);
	sim_finish(&s);
}

/* Without the choice a deaf node lives by repairs alone: late by two of them, and never left out. */
static void deaf_to_the_only_way(void **state)
{
	struct sim s;

	(void)state;
	sim_init(&s, 3, 18);
	sim_start_all(&s);
	sim_assemble(&s);
	s.nodes[1].deaf = true;
	sim_run_frames(&s, 60);
	assert_all_live(&s);
	assert_int_equal(fdp_master_way(s.master), FDP_WAY_GROUP);
	printf("# deaf to the group: a frame's state after %.1f ms at most\n",
	       (double)sim_delivery_quantile(&s, 1) * 1e-6);
	assert_true(sim_delivery_quantile(&s, 1) < SIM_DEADLINE_NS);
	sim_finish(&s);
}

/* Who comes in late neither stops the group nor fills the log. */
static void joiners(void **state)
{
	struct sim s;

	(void)state;
	start(&s, 3);
	sim_kill_node(&s, 2);
	sim_run_ns(&s, 300 * SIM_MS);
	sim_run_frames(&s, 10);
	assert_int_equal(fdp_master_way(s.master), FDP_WAY_GROUP);
	for (int i = 0; i < 5; i++) {
		s.nodes[2].joined = 0;
		sim_start_node(&s, 2);
		sim_assemble(&s);
		sim_run_frames(&s, 10);
		assert_int_equal(fdp_master_way(s.master), FDP_WAY_GROUP);
		assert_all_live(&s);
		fdp_node_leave(s.nodes[2].node, s.now_ns);
		sim_kill_node(&s, 2);
		sim_run_frames(&s, 5);
	}
	assert_int_equal(s.ways, 1);
	sim_finish(&s);
}

/* Loss takes single datagrams of the group: no reason to leave it. */
static void in_loss(void **state)
{
	struct sim s;

	(void)state;
	start(&s, 4);
	s.evict_frames = 10;
	s.loss = 0.05;
	sim_assemble(&s);
	sim_run_frames(&s, 600);
	printf("# 5 %% loss, 600 frames: the way changed %llu times\n", (unsigned long long)s.ways);
	assert_int_equal(s.ways, 1);
	assert_int_equal(fdp_master_way(s.master), FDP_WAY_GROUP);
	sim_finish(&s);
}

/* A group to probe must be there. */
static void nothing_to_probe(void **state)
{
	const struct fdp_master_params p = {
		.session = 1, .node_names = (const char *const[]){ "a" }, .node_count = 1,
		.datagram_max = 1472, .deadline_ns = 1000, .evict_frames = 1, .probe_group = true,
	};
	const struct fdp_master_ops ops = { 0 };
	struct fdp_master *m;

	(void)state;
	assert_int_equal(fdp_master_create(&m, &p, &ops), GR_ERR_RANGE);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(all_hear),	cmocka_unit_test(one_is_deaf),
		cmocka_unit_test(one_goes_deaf), cmocka_unit_test(deaf_to_the_only_way),
		cmocka_unit_test(joiners),	cmocka_unit_test(in_loss),
		cmocka_unit_test(nothing_to_probe),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
