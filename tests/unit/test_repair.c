/*
 * What is asked for when something of a state is lost, when, how often it is answered and
 * at what price; on the fake clock, with states of 4 KB in eleven fragments.
 */
#include "cluster_sim.h"

#include "base/result.h"
#include "protocol/parity.h"

#define NODES 4
#define BYTE_NS 8 /* at 1 Gbit/s: datagrams come one after the other */
#define FRAGMENTS 11

/* The parts of a header that a test needs; docs/protocol.md says where they stand. */
static unsigned index_of(const uint8_t *bytes)
{
	return bytes[12] | (unsigned)bytes[13] << 8;
}

static bool again(const uint8_t *bytes)
{
	return bytes[6] & 4;
}

/* What is lost of a frame's first copies, and what is seen on the wire. */
struct eyes {
	uint64_t lose[FDP_MAX_NODES]; /* bit i: fragment or parity fragment i does not reach the node */
	bool lose_repairs;
	bool lie; /* parity that has a wrong byte, and the right MAC */
	unsigned parts, nacks, repairs; /* repairs: datagrams, for each receiver one */
	int64_t arrives_ns[FDP_MAX_NODES][FDP_PARTS_MAX]; /* first copies */
	int64_t nack_ns[FDP_MAX_NODES]; /* first; 0: none */
	uint32_t asked[FDP_MAX_NODES];  /* fragments that it named in the first */
};

static bool look_to_node(struct sim *s, struct eyes *e, int to, uint8_t *bytes, size_t len)
{
	const unsigned i = index_of(bytes);

	if (again(bytes)) {
		e->repairs++;
		return !e->lose_repairs;
	}
	e->parts = i + 1 > e->parts ? i + 1 : e->parts;
	e->arrives_ns[to][i] = s->link_free_ns + s->delay_ns;
	if (e->lie && i >= bytes[14]) {
		bytes[FDP_HEADER_BYTES + 20] ^= 1;
		fdp_wire_sign(s->master->key_to_nodes, bytes, len);
	}
	return !(e->lose[to] >> i & 1);
}

static bool look(struct sim *s, int to, uint8_t *bytes, size_t len)
{
	struct eyes *e = s->tamper_ctx;
	struct fdp_nack nack;

	if (to >= 0)
		return bytes[5] != FDP_DELTA || look_to_node(s, e, to, bytes, len);
	if (bytes[5] != FDP_NACK)
		return true;
	assert_int_equal(fdp_nack_decode(bytes + FDP_HEADER_BYTES, len - FDP_HEADER_BYTES, &nack), GR_OK);
	e->nacks++;
	if (e->nack_ns[bytes[8]])
		return true;
	e->nack_ns[bytes[8]] = s->now_ns;
	memcpy(&e->asked[bytes[8]], nack.missing, sizeof e->asked[0]);
	return true;
}

static void set_ballast(struct sim *s, uint64_t frame)
{
	uint32_t words[BALLAST_WORDS];

	for (size_t i = 0; i < BALLAST_WORDS; i++)
		words[i] = unit_random_u32(&s->random); /* does not pack */
	assert_true(param_set(s->state, PARAM_BALLAST, words, frame) >= 0);
}

/* A room that has shown ten frames; every datagram takes the same time. */
static void start(struct sim *s, struct eyes *e, bool multicast, enum fdp_parity parity)
{
	sim_init(s, NODES, 5);
	s->multicast = multicast;
	s->parity = parity;
	s->datagram_max = FDP_DATAGRAM_MIN;
	s->jitter_ns = 0;
	s->byte_ns = BYTE_NS;
	s->more_state = set_ballast;
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, 10);
	*e = (struct eyes){ .parts = 0 };
	s->tamper = look;
	s->tamper_ctx = e;
}

static struct fdp_counters counters(const struct sim *s)
{
	struct fdp_counters c;

	fdp_master_counters(s->master, &c);
	return c;
}

static uint64_t healed(const struct sim *s, int node)
{
	struct fdp_counters c;

	fdp_node_counters(s->nodes[node].node, &c);
	return c.healed;
}

/* Any one fragment lost: asked for in the moment in which its successor arrives, exactly, and once. */
static void asked_at_once(void **state)
{
	static struct sim s;
	struct eyes e;

	(void)state;
	for (unsigned lost = 0; lost + 1 < FRAGMENTS; lost++) {
		uint64_t before;

		start(&s, &e, true, FDP_PARITY_OFF);
		e.lose[2] = UINT64_C(1) << lost;
		before = counters(&s).repairs;
		sim_run_frames(&s, 1);
		assert_int_equal(e.parts, FRAGMENTS);
		assert_int_equal(e.nack_ns[2], e.arrives_ns[2][lost + 1]);
		assert_int_equal(e.asked[2], 1u << lost);
		assert_int_equal(e.nacks, 1);
		assert_int_equal(counters(&s).repairs, before + 1);
		sim_assert_in_step(&s);
		/* There and back, and the datagram itself: no time-out is in it. */
		assert_true(sim_delivery_quantile(&s, 1) < e.arrives_ns[2][FRAGMENTS - 1] - s.begun_ns +
								     2 * s.delay_ns + 50000);
		sim_finish(&s);
	}
}

/* With parity: only when more is lost than it can make good, in that moment, and only the rest. */
static void asked_beyond_parity(void **state)
{
	static struct sim s;
	struct eyes e;
	unsigned parity, cases = 0;

	(void)state;
	for (unsigned lost = 1; lost <= 6; lost++) {
		for (unsigned from = 0; from + lost < FRAGMENTS; from++) {
			uint64_t repairs;

			start(&s, &e, true, FDP_PARITY_ON);
			parity = s.master->delta.parity;
			assert_int_equal(s.master->delta.count, FRAGMENTS);
			assert_in_range(parity, 1, 4);
			e.lose[1] = ((UINT64_C(1) << lost) - 1) << from;
			repairs = counters(&s).repairs;
			sim_run_frames(&s, 1);
			assert_int_equal(e.parts, FRAGMENTS + parity);
			cases++;
			if (lost <= parity) {
				assert_int_equal(e.nacks, 0);
				assert_int_equal(counters(&s).repairs, repairs);
				assert_int_equal(healed(&s, 1), lost);
			} else {
				/* The first that arrives after the burst tells. */
				assert_int_equal(e.nack_ns[1], e.arrives_ns[1][from + lost]);
				assert_int_equal(e.asked[1], ((1u << (lost - parity)) - 1) << from);
				assert_int_equal(counters(&s).repairs, repairs + lost - parity);
			}
			sim_assert_in_step(&s);
			sim_finish(&s);
		}
	}
	printf("# %u bursts of one to six of %d fragments, %u of parity\n", cases, FRAGMENTS, parity);
}

/* All nodes miss the same fragments: to the group each of them goes once, to each by itself once each. */
static void answered_once(void **state)
{
	static struct sim s;
	struct eyes e;

	(void)state;
	for (int multicast = 0; multicast < 2; multicast++) {
		uint64_t repairs;

		start(&s, &e, multicast, FDP_PARITY_OFF);
		for (int i = 0; i < NODES; i++)
			e.lose[i] = 0x18; /* two in a row */
		repairs = counters(&s).repairs;
		sim_run_frames(&s, 1);
		for (int i = 0; i < NODES; i++)
			assert_int_equal(e.asked[i], 0x18);
		assert_int_equal(e.nacks, NODES);
		assert_int_equal(e.repairs, 2 * NODES); /* every receiver sees each once */
		assert_int_equal(counters(&s).repairs - repairs, multicast ? 2 : 2 * NODES);
		sim_assert_in_step(&s);
		sim_finish(&s);
	}
}

/* Nothing that is asked for arrives, and all ask all the time: a frame costs so much and no more. */
static void bounded(void **state)
{
	static struct sim s;
	struct eyes e;

	(void)state;
	for (int multicast = 0; multicast < 2; multicast++) {
		const size_t message = FDP_STATE_HEAD_MAX + param_delta_max();
		const size_t whole = message + fdp_fragment_count(message, FDP_DATAGRAM_MIN) * FDP_HEADER_BYTES;
		const uint64_t most = (8u + (multicast ? 4u : 4u * NODES)) * whole;
		struct fdp_nack nack = { .count = FRAGMENTS };
		uint64_t sent, asked = 0;
		int64_t until;

		start(&s, &e, multicast, FDP_PARITY_OFF);
		memset(nack.missing, 0xff, sizeof nack.missing);
		for (int i = 0; i < NODES; i++)
			e.lose[i] = UINT64_C(1) << 3;
		e.lose_repairs = true;
		s.running = true;
		s.stop_at = s.swapped + 1;
		sim_run_ns(&s, SIM_PERIOD_NS); /* the frame has begun, and nobody holds it */
		sent = counters(&s).bytes_out;
		nack.message = s.master->delta.number;
		nack.frame = s.frame;
		for (until = s.now_ns + 10 * SIM_MS; s.now_ns < until;) {
			for (unsigned i = 0; i < NODES; i++, asked++)
				fdp_master_on_nack(s.master, i, &nack, s.now_ns);
			sim_run_ns(&s, 20000);
		}
		sent = counters(&s).bytes_out - sent;
		printf("# %s: %llu requests for all of a state of %zu bytes in 10 ms: %llu bytes sent, budget %llu\n",
		       multicast ? "multicast" : "unicast", (unsigned long long)asked, whole,
		       (unsigned long long)sent, (unsigned long long)most);
		assert_true(asked >= 500 * NODES);
		/* PROBEs and SWAPs are besides it. */
		assert_in_range(sent, most / 2, most + 100 * 400);
		memset(e.lose, 0, sizeof e.lose);
		e.lose_repairs = false;
		sim_run_frames(&s, 3);
		for (size_t i = 0; i < NODES; i++)
			assert_int_equal(fdp_node_hash(s.nodes[i].node), fdp_master_hash(s.master));
		sim_finish(&s);
	}
}

/* Off: never. Auto: from the first loss on, until 512 frames have passed without one. On: always. */
static void switched(void **state)
{
	static struct sim s;
	struct eyes e;
	uint64_t before;

	(void)state;
	start(&s, &e, true, FDP_PARITY_AUTO);
	assert_int_equal(counters(&s).parity, 0);
	e.lose[0] = 2;
	sim_run_frames(&s, 1);
	assert_int_equal(counters(&s).parity, 0); /* nobody could know */
	e.lose[0] = 0;
	sim_run_frames(&s, 2); /* the next report tells */
	assert_true(counters(&s).parity > 0);
	assert_true(sim_peer(&s, 0).loss > 0);
	assert_true(sim_peer(&s, 1).loss <= 0);
	/* It wanes with what it is measured by: one fragment at last. */
	sim_run_frames(&s, 400);
	before = counters(&s).parity;
	sim_run_frames(&s, 10);
	assert_int_equal(counters(&s).parity, before + 10);
	sim_run_frames(&s, FDP_LOSS_FRAMES);
	before = counters(&s).parity;
	sim_run_frames(&s, 10);
	assert_int_equal(counters(&s).parity, before);
	assert_true(sim_peer(&s, 0).loss <= 0);
	sim_finish(&s);

	start(&s, &e, true, FDP_PARITY_OFF);
	e.lose[0] = 2;
	sim_run_frames(&s, 5);
	assert_int_equal(counters(&s).parity + counters(&s).parity_bytes, 0);
	sim_finish(&s);

	start(&s, &e, false, FDP_PARITY_ON);
	assert_true(counters(&s).parity >= 10 * NODES);
	sim_finish(&s);
}

/* Everything lost that can be: parity is never more than half of a state, rounded up. */
static void half_at_most(void **state)
{
	static struct sim s;
	struct eyes e;

	(void)state;
	start(&s, &e, true, FDP_PARITY_AUTO);
	s.loss = 0.4;
	s.evict_frames = 1000;
	for (int i = 0; i < 60; i++) {
		sim_run_frames(&s, 1);
		assert_true(s.master->delta.parity <= (s.master->delta.count + 1) / 2);
	}
	assert_int_equal(s.master->delta.parity, (FRAGMENTS + 1) / 2);
	sim_finish(&s);
}

/* A lie with the right MAC rebuilds a wrong state: it is not taken, and put right within the frame. */
static void lies(void **state)
{
	static struct sim s;
	struct fdp_counters c;
	struct eyes e;

	(void)state;
	for (unsigned lost = 0; lost < FRAGMENTS; lost++) {
		start(&s, &e, true, FDP_PARITY_ON);
		e.lie = true;
		e.lose[1] = UINT64_C(1) << lost;
		sim_run_frames(&s, 1);
		fdp_node_counters(s.nodes[1].node, &c);
		assert_int_equal(c.healed, 1);
		assert_true(c.bad_format + s.nodes[1].mismatches > 0);
		/* The simulation compares every state that a node takes with what the master said. */
		assert_int_equal(fdp_node_hash(s.nodes[1].node), fdp_master_hash(s.master));
		assert_int_equal(s.nodes[1].last_frame, s.frame);
		assert_int_equal(s.late, 0);
		sim_finish(&s);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(asked_at_once), cmocka_unit_test(asked_beyond_parity),
		cmocka_unit_test(answered_once), cmocka_unit_test(bounded),
		cmocka_unit_test(switched), cmocka_unit_test(half_at_most), cmocka_unit_test(lies),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
