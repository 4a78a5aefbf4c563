/* Relit surfels whose work nodes share: equal bytes, what it costs a node, what is lost and hostile. */
#include "base/log.h"
#include "base/result.h"
#include "tests/accuracy/surfels_gl.h"
#include "tests/unit/unit.h"
#include "tools/bench/lpv_bench.h"
#include "tools/bench/room.h"

#include <epoxy/gl.h>
#include <math.h>

static struct surfel_set *fine, *coarse;

#define NODES 4

struct cluster {
	struct surfel_rig rig;
	struct gi_method *nodes[NODES], *local;
	uint8_t *slice;
	size_t size, bytes, sent;
	int lost; /* node whose slices do not arrive; -1: none */
	double node_ms[NODES], local_ms;
};

static void cluster_begin(struct cluster *c, const struct surfel_set *set)
{
	const struct truth_spot spot = bench_spot();

	memset(c, 0, sizeof *c);
	assert_int_equal(surfel_rig_init(&c->rig, lit_room.scene, &spot, 1, 512), GR_OK);
	c->local = lit_method(set, 4, false);
	for (unsigned i = 0; i < NODES; i++) {
		c->nodes[i] = lit_method(set, 4, false);
		assert_int_equal(c->nodes[i]->ops->share->set(c->nodes[i], i, NODES), GR_OK);
	}
	c->size = c->nodes[0]->ops->share->bytes_max(c->nodes[0], NODES);
	c->slice = test_malloc(c->size);
	c->lost = -1;
}

static void cluster_end(struct cluster *c)
{
	c->local->ops->destroy(c->local);
	for (int i = 0; i < NODES; i++)
		c->nodes[i]->ops->destroy(c->nodes[i]);
	surfel_rig_finish(&c->rig);
	test_free(c->slice);
	assert_int_equal(glGetError(), GL_NO_ERROR);
}

static double timed_update(struct cluster *c, struct gi_method *method, const struct gi_light *light)
{
	double start = lit_cpu_milliseconds();

	assert_true(method->ops->update(method, &c->rig.frame, light) >= GR_OK);
	glFinish();
	return lit_cpu_milliseconds() - start;
}

static void cluster_frame(struct cluster *c)
{
	const struct gi_light light = surfel_rig_light(&c->rig);

	glFinish();
	c->local_ms = timed_update(c, c->local, &light);
	for (int i = 0; i < NODES; i++)
		c->node_ms[i] = timed_update(c, c->nodes[i], &light);
	c->bytes = c->sent = 0;
	for (int i = 0; i < NODES; i++) {
		const struct gi_share_ops *share = c->nodes[i]->ops->share;
		size_t len;
		int result = share->take(c->nodes[i], c->slice, c->size, &len);

		assert_true(result == GR_OK || (result == GR_NOTHING && len == 0));
		c->bytes += len;
		c->sent += result == GR_OK;
		for (int k = 0; k < NODES && result == GR_OK; k++)
			if (k != i && i != c->lost)
				assert_int_equal(share->put(c->nodes[k], c->slice, len), GR_OK);
	}
	c->rig.frame.frame++;
}

static bool all_equal(const struct cluster *c)
{
	uint64_t first = c->nodes[0]->ops->hash(c->nodes[0]);

	for (int i = 1; i < NODES; i++)
		if (c->nodes[i]->ops->hash(c->nodes[i]) != first)
			return false;
	return true;
}

/* Root of the mean square of the difference over the mean, of what shading sees. */
static double apart(struct gi_method *a, struct gi_method *b)
{
	static float of_a[3 * LIT_POINTS], of_b[3 * LIT_POINTS];
	double sum = 0, mean = lit_mean_at(b, lit_room.samples, lit_room.count, of_b);

	lit_mean_at(a, lit_room.samples, lit_room.count, of_a);
	for (size_t k = 0; k < 3 * lit_room.count; k++)
		sum += pow((double)(of_a[k] - of_b[k]), 2);
	return sqrt(sum / (3 * (double)lit_room.count)) / mean;
}

static double median(double *values, int count)
{
	for (int i = 1; i < count; i++)
		for (int k = i; k > 0 && values[k] < values[k - 1]; k--) {
			double swap = values[k];

			values[k] = values[k - 1];
			values[k - 1] = swap;
		}
	return values[count / 2];
}

static void shared_work(void **state)
{
	struct cluster c;
	double local[9], node[NODES][9], slowest = 0;
	size_t bytes = 0;
	int frames = 0;

	(void)state;
	cluster_begin(&c, fine);
	cluster_frame(&c);
	assert_int_equal(c.sent, NODES); /* after a restart each slice, once */
	assert_true(all_equal(&c));
	printf("# 4 nodes, after a restart: %.2e off what one alone finds\n", apart(c.nodes[1], c.local));
	assert_true(apart(c.nodes[1], c.local) < 1e-3);
	for (int i = 0; i < 9; i++) {
		c.rig.frame.lamps[0].position[0] = 2 - 0.02f * (float)i;
		cluster_frame(&c);
		assert_true(all_equal(&c));
		local[i] = c.local_ms;
		for (int k = 0; k < NODES; k++)
			node[k][i] = c.node_ms[k];
		bytes = c.bytes;
	}
	for (int k = 0; k < NODES; k++)
		slowest = fmax(slowest, median(node[k], 9));
	printf("# lamp moving, 4 nodes: slowest node %.2f of one alone (%.1f of %.1f ms of processor time), "
	       "%zu bytes a frame of all nodes together\n",
	       slowest / median(local, 9), slowest, median(local, 9), bytes);
	assert_true(slowest < 0.35 * median(local, 9));
	do {
		cluster_frame(&c);
		assert_true(all_equal(&c));
		frames++;
	} while (c.sent > 0 && frames < 100);
	printf("# then still: slices sent for %d frames more, then none; %.2e off what one alone finds\n",
	       frames - 1, apart(c.nodes[2], c.local));
	assert_true(frames < 40);
	assert_true(apart(c.nodes[2], c.local) < 5e-3);
	for (int i = 0; i < 40; i++)
		cluster_frame(&c);
	for (int i = 0; i < NODES; i++) {
		struct gi_stats stats;

		c.nodes[i]->ops->stats(c.nodes[i], &stats);
		assert_false(stats.ran);
	}
	cluster_end(&c);
}

/* A slice that is lost keeps what it had; a new epoch mends it. */
static void lost_slices(void **state)
{
	struct cluster c;

	(void)state;
	cluster_begin(&c, coarse);
	cluster_frame(&c);
	cluster_frame(&c);
	assert_true(all_equal(&c));
	c.lost = 2;
	memcpy(c.rig.frame.lamps[0].intensity, (float[3]){ 10, 20, 30 }, sizeof(vec3));
	for (int i = 0; i < 40; i++)
		cluster_frame(&c);
	assert_false(all_equal(&c));
	/* those that lost the same hold the same */
	assert_true(c.nodes[0]->ops->hash(c.nodes[0]) == c.nodes[1]->ops->hash(c.nodes[1]));
	double off = apart(c.nodes[0], c.local);
	printf("# slices of one node lost: the others are %.0f %% off, finite\n", 100 * off);
	assert_true(off > 0.01);
	c.lost = -1;
	c.rig.frame.gi_epoch++;
	cluster_frame(&c);
	assert_true(all_equal(&c));
	assert_int_equal(c.sent, NODES);
	/* another division, without a restart */
	for (unsigned i = 0; i < NODES; i++)
		assert_int_equal(c.nodes[i]->ops->share->set(c.nodes[i], NODES - 1 - i, NODES), GR_OK);
	for (int i = 0; i < 3; i++) {
		cluster_frame(&c);
		assert_true(all_equal(&c));
	}
	assert_true(apart(c.nodes[0], c.local) < 5e-3);
	/* and each alone again */
	for (unsigned i = 0; i < NODES; i++)
		assert_int_equal(c.nodes[i]->ops->share->set(c.nodes[i], 0, 1), GR_OK);
	for (int i = 0; i < 30; i++)
		for (int k = 0; k <= NODES; k++) {
			const struct gi_light light = surfel_rig_light(&c.rig);
			struct gi_method *m = k < NODES ? c.nodes[k] : c.local;

			m->ops->update(m, &c.rig.frame, &light);
		}
	printf("# each alone again: %.1e off\n", apart(c.nodes[3], c.local));
	assert_true(apart(c.nodes[3], c.local) < 1e-4);
	cluster_end(&c);
}

/* Bytes from outside: all that are no slice are refused, and change nothing. */
static void hostile_slices(void **state)
{
	struct cluster c;
	uint8_t *bad;
	size_t len, first;
	uint64_t before;

	(void)state;
	cluster_begin(&c, coarse);
	cluster_frame(&c);
	const struct gi_share_ops *share = c.nodes[0]->ops->share;

	memcpy(c.rig.frame.lamps[0].intensity, (float[3]){ 10, 20, 30 }, sizeof(vec3));
	const struct gi_light light = surfel_rig_light(&c.rig);
	c.nodes[1]->ops->update(c.nodes[1], &c.rig.frame, &light);
	glFinish();
	assert_int_equal(share->take(c.nodes[1], c.slice, c.size, &len), GR_OK);
	before = c.nodes[0]->ops->hash(c.nodes[0]);
	assert_int_equal(share->put(c.nodes[1], c.slice, len), GR_ERR_FORMAT); /* its own */
	assert_int_equal(share->put(c.local, c.slice, len), GR_ERR_FORMAT);    /* shares nothing */
	for (size_t cut = 0; cut < len; cut += cut < 64 ? 1 : 97) {
		bad = test_malloc(cut + 1);
		memcpy(bad, c.slice, cut);
		assert_int_equal(share->put(c.nodes[0], bad, cut), GR_ERR_FORMAT);
		test_free(bad);
	}
	first = 28; /* the header */
	for (size_t at = 0; at < first - 4; at++) {
		c.slice[at] ^= 0x41;
		assert_int_equal(share->put(c.nodes[0], c.slice, len), GR_ERR_FORMAT);
		c.slice[at] ^= 0x41;
	}
	/* NaN is one word; others with its exponent are none */
	c.slice[first + 3] |= 0xf8;
	c.slice[first] |= 1;
	assert_int_equal(share->put(c.nodes[0], c.slice, len), GR_ERR_FORMAT);
	assert_true(c.nodes[0]->ops->hash(c.nodes[0]) == before);
	assert_int_equal(share->set(c.nodes[0], 4, 4), GR_ERR_RANGE);
	assert_int_equal(share->set(c.nodes[0], 0, 0), GR_ERR_RANGE);
	assert_int_equal(share->set(c.nodes[0], 0, SURFELS_SLICES_MAX + 1), GR_ERR_RANGE);
	cluster_end(&c);
}

static int open_room(void **state)
{
	(void)state;
	fine = lit_bake(lit_room.scene, 0.16f, 256, 64, 0);
	coarse = lit_bake(lit_room.scene, 0.3f, 128, 16, 4);
	return 0;
}

static int close_room(void **state)
{
	(void)state;
	surfel_set_destroy(&fine);
	surfel_set_destroy(&coarse);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shared_work),
		cmocka_unit_test(lost_slices),
		cmocka_unit_test(hostile_slices),
	};
	int failed = lit_open("test_surfels_share_gl");

	if (failed)
		return failed;
	failed = cmocka_run_group_tests(tests, open_room, close_room);
	lit_close();
	return failed;
}
