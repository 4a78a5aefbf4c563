/* What tests ask of a simulated cluster: who is in step, and how long things took. */
#include "cluster_sim.h"

struct fdp_peer_status sim_peer(const struct sim *s, int node)
{
	struct fdp_peer_status status;

	fdp_master_peer(s->master, (size_t)node, &status);
	return status;
}

static int compare_ns(const void *a, const void *b)
{
	const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;

	return (x > y) - (x < y);
}

int64_t sim_delivery_quantile(struct sim *s, double q)
{
	if (!s->delivery_count)
		return 0;
	qsort(s->delivery_ns, s->delivery_count, sizeof *s->delivery_ns, compare_ns);
	return s->delivery_ns[(size_t)(q * (double)(s->delivery_count - 1))];
}

int64_t sim_spread_quantile(struct sim *s, double q)
{
	if (!s->spread_count)
		return 0;
	qsort(s->spread_ns, s->spread_count, sizeof *s->spread_ns, compare_ns);
	return s->spread_ns[(size_t)(q * (double)(s->spread_count - 1))];
}

uint64_t sim_seed_of(const char *name)
{
	struct unit_random r = unit_random_start(name);

	return unit_random_u32(&r);
}

void sim_assert_in_step(struct sim *s)
{
	for (size_t i = 0; i < s->node_count; i++) {
		assert_non_null(s->nodes[i].node);
		assert_int_equal(sim_peer(s, (int)i).state, FDP_PEER_LIVE);
		assert_int_equal(fdp_node_hash(s->nodes[i].node), fdp_master_hash(s->master));
		assert_int_equal(s->nodes[i].mismatches, 0);
	}
	assert_int_equal(s->mismatches, 0);
}

void sim_assert_all_swapped(struct sim *s, uint64_t frames)
{
	for (size_t i = 0; i < s->node_count; i++) {
		assert_int_equal(s->nodes[i].frames, frames);
		assert_int_equal(s->nodes[i].swaps, frames);
		assert_int_equal(sim_peer(s, (int)i).swapped, frames);
	}
	sim_assert_in_step(s);
}
