/* Keyboard and mouse of a node's window: on the wire, through loss and disorder. */
#include "cluster_sim.h"

#include "base/result.h"

#include <math.h>

static void codec(void **state)
{
	const struct fdp_input in = { 0x80000011u, { -1, 0.5f }, { 1, -0.25f }, -12 };
	uint8_t bytes[FDP_INPUT_BYTES + 1] = { 0 }, again[FDP_INPUT_BYTES];
	const float bad[] = { NAN, INFINITY, -INFINITY, 1.0001f, -1e30f, 1e4f };
	struct fdp_input out;

	(void)state;
	assert_int_equal(fdp_input_encode(&in, bytes, sizeof bytes), FDP_INPUT_BYTES);
	for (size_t n = 0; n <= sizeof bytes; n++) {
		uint8_t *exact = unit_copy(bytes, n);

		assert_int_equal(fdp_input_decode(exact, n, &out), n == FDP_INPUT_BYTES ? GR_OK : GR_ERR_FORMAT);
		if (n < FDP_INPUT_BYTES)
			assert_int_equal(fdp_input_encode(&in, again, n), 0);
		free(exact);
	}
	assert_int_equal(fdp_input_decode(bytes, FDP_INPUT_BYTES, &out), GR_OK);
	assert_memory_equal(&out, &in, sizeof in);
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		for (int field = 0; field < 5; field++) {
			struct fdp_input wrong = in;
			float *numbers[5] = { &wrong.axes[0], &wrong.axes[1], &wrong.pointer[0],
					      &wrong.pointer[1], &wrong.wheel };

			if (field == 4 && fabsf(bad[i]) < FDP_INPUT_WHEEL_MOST)
				continue;
			*numbers[field] = bad[i];
			fdp_input_encode(&wrong, bytes, sizeof bytes);
			assert_int_equal(fdp_input_decode(bytes, FDP_INPUT_BYTES, &out), GR_ERR_FORMAT);
		}
}

/* What the master has heard of each node. */
struct heard {
	struct fdp_input last[2];
	uint64_t count[2];
};

static struct heard heard;

static void on_input(void *ctx, unsigned node, const struct fdp_input *input)
{
	(void)ctx;
	assert_true(node < 2);
	heard.last[node] = *input;
	heard.count[node]++;
}

/* Whatever is lost or overtaken, the master has the last state soon; at rest nothing is said. */
static void arrives(void **state)
{
	struct fdp_input in = { 0 };
	uint64_t before, quiet;
	struct sim s;

	(void)state;
	memset(&heard, 0, sizeof heard);
	sim_init(&s, 2, sim_seed_of("input"));
	s.loss = 0.2;
	s.jitter_ns = 5 * SIM_MS;
	sim_start_all(&s);
	sim_assemble(&s);
	s.master->ops.input = on_input;
	sim_run_frames(&s, 3);
	assert_int_equal(heard.count[0], 0);
	for (int round = 0; round < 50; round++) {
		/* Changed far more often than it may be said. */
		before = heard.count[0];
		for (int i = 0; i < 10; i++) {
			in.buttons++;
			in.pointer[0] = sinf((float)in.buttons);
			fdp_node_input(s.nodes[0].node, &in);
			sim_run_ns(&s, SIM_MS);
		}
		assert_true(heard.count[0] - before <= 3);
		in.buttons = ((uint32_t)round + 1) << 8;
		fdp_node_input(s.nodes[0].node, &in);
		/* As good as never are twenty lost in a row. */
		for (int i = 0; i < 200 && heard.last[0].buttons != in.buttons; i++)
			sim_run_ns(&s, 10 * SIM_MS);
		assert_memory_equal(&heard.last[0], &in, sizeof in);
	}
	/* Held, it is said again and again. */
	quiet = heard.count[0];
	sim_run_ns(&s, 1000 * SIM_MS);
	assert_true(heard.count[0] - quiet >= 4 && heard.count[0] - quiet <= 11);
	in = (struct fdp_input){ .pointer = { 0.5f, 0.5f } };
	fdp_node_input(s.nodes[0].node, &in);
	sim_run_ns(&s, 1000 * SIM_MS);
	quiet = heard.count[0];
	sim_run_ns(&s, 2000 * SIM_MS);
	assert_int_equal(heard.count[0], quiet);
	assert_int_equal(heard.count[1], 0);
	sim_finish(&s);
}

/* A node that comes again begins its numbers anew, and is heard. */
static void restarted_node_is_heard(void **state)
{
	struct fdp_input in = { .buttons = 7 };
	struct sim s;

	(void)state;
	memset(&heard, 0, sizeof heard);
	sim_init(&s, 2, 5);
	sim_start_all(&s);
	sim_assemble(&s);
	s.master->ops.input = on_input;
	fdp_node_input(s.nodes[1].node, &in);
	sim_run_frames(&s, 10);
	assert_int_equal(heard.last[1].buttons, 7);
	sim_kill_node(&s, 1);
	sim_run_frames(&s, 10);
	sim_start_node(&s, 1);
	sim_assemble(&s);
	in.buttons = 9;
	fdp_node_input(s.nodes[1].node, &in);
	sim_run_frames(&s, 10);
	assert_int_equal(heard.last[1].buttons, 9);
	/* A master that begins hears what the windows have, though nothing changes there. */
	in = (struct fdp_input){ .pointer = { 0.5f, -0.5f } };
	fdp_node_input(s.nodes[1].node, &in);
	sim_run_ns(&s, 2000 * SIM_MS);
	sim_kill_master(&s);
	memset(&heard, 0, sizeof heard);
	sim_start_master(&s);
	s.master->ops.input = on_input;
	sim_assemble(&s);
	sim_run_ns(&s, 1000 * SIM_MS);
	assert_memory_equal(&heard.last[1], &in, sizeof in);
	assert_int_equal(heard.count[0], 0);
	sim_finish(&s);
}

/* What is looked at of a wall: the same, and said again for those who were not there. */
static struct fdp_glance glanced[2];
static uint64_t glances[2];

static void on_glance(void *ctx, unsigned node, const struct fdp_glance *glance)
{
	(void)ctx;
	assert_true(node < 2);
	glanced[node] = *glance;
	glances[node]++;
}

static void glance_codec(void **state)
{
	const struct fdp_glance in = { -0.25f, 0.0239f, 1e9f };
	const float bad[] = { NAN, INFINITY, -INFINITY };
	uint8_t bytes[FDP_GLANCE_BYTES + 1] = { 0 };
	struct fdp_glance out;

	(void)state;
	for (size_t n = 0; n < FDP_GLANCE_BYTES; n++)
		assert_int_equal(fdp_glance_encode(&in, bytes, n), 0);
	assert_int_equal(fdp_glance_encode(&in, bytes, sizeof bytes), FDP_GLANCE_BYTES);
	for (size_t n = 0; n <= sizeof bytes; n++) {
		uint8_t *exact = unit_copy(bytes, n);

		assert_int_equal(fdp_glance_decode(exact, n, &out), n == FDP_GLANCE_BYTES ? GR_OK : GR_ERR_FORMAT);
		free(exact);
	}
	assert_int_equal(fdp_glance_decode(bytes, FDP_GLANCE_BYTES, &out), GR_OK);
	assert_memory_equal(&out, &in, sizeof in);
	for (int i = 0; i < 3 * 3 + 2; i++) {
		struct fdp_glance wrong = in;
		float *numbers[3] = { &wrong.log_sum, &wrong.solid_angle, &wrong.max };

		*numbers[i < 9 ? i / 3 : i - 8] = i < 9 ? bad[i % 3] : -1e-6f;
		fdp_glance_encode(&wrong, bytes, sizeof bytes);
		assert_int_equal(fdp_glance_decode(bytes, FDP_GLANCE_BYTES, &out), GR_ERR_FORMAT);
	}
}

static void glance_arrives(void **state)
{
	struct fdp_glance in = { 0.1f, 0.02f, 10 };
	uint64_t before;
	struct sim s;

	(void)state;
	memset(glances, 0, sizeof glances);
	sim_init(&s, 2, sim_seed_of("glance"));
	s.loss = 0.2;
	s.jitter_ns = 5 * SIM_MS;
	sim_start_all(&s);
	sim_assemble(&s);
	s.master->ops.glance = on_glance;
	sim_run_frames(&s, 3);
	assert_int_equal(glances[0] + glances[1], 0);
	for (int round = 0; round < 50; round++) {
		in.max += 1;
		fdp_node_glance(s.nodes[1].node, &in);
		sim_run_frames(&s, 1);
	}
	assert_true(glances[1] > 20 && glances[1] <= 50 + 10);
	/* The last one gets there though one in five is lost; the other wall has said nothing. */
	sim_run_frames(&s, 120);
	assert_memory_equal(&glanced[1], &in, sizeof in);
	assert_int_equal(glances[0], 0);
	/* At rest four a second. */
	s.loss = 0;
	before = glances[1];
	for (int i = 0; i < 60; i++) {
		fdp_node_glance(s.nodes[1].node, &in);
		sim_run_frames(&s, 1);
	}
	assert_true(glances[1] - before >= 2 && glances[1] - before <= 5);
	sim_finish(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(codec),
		cmocka_unit_test(arrives),
		cmocka_unit_test(restarted_node_is_heard),
		cmocka_unit_test(glance_codec), cmocka_unit_test(glance_arrives),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
