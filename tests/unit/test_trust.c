/*
 * Who holds no key moves nothing: a room in operation gets garbage, forgeries,
 * pieces, flipped bits and everything that it ever said itself, in this session
 * and in those before. Nothing of it may change a state, be answered with more
 * bytes than it has, or make a wall late.
 */
#include "cluster_sim.h"

#include "base/result.h"

#include <sodium.h>

#define TAPE 4096   /* datagrams of the room that are remembered */
#define BATCH 64    /* inputs between two looks at the whole state */
#define NODES 3

enum input {
	NOISE,    /* random bytes */
	DRESSED,  /* random bytes behind a header that looks right */
	REPLAYED, /* as it was said, to whom it was said */
	ASTRAY,   /* as it was said, to somebody else */
	FLIPPED,
	CUT,
	GROWN,
	SPLICED,  /* the header of one, the payload of another */
	RENUMBERED, /* with a session, sequence or sender of now, the MAC as it was */
	FORGED,   /* changed at will and signed with a key that is not ours */
	INPUTS
};
static const char *const input_names[INPUTS] = {
	[NOISE] = "noise", [DRESSED] = "noise behind a header", [REPLAYED] = "replayed",
	[ASTRAY] = "to another", [FLIPPED] = "bits flipped", [CUT] = "cut", [GROWN] = "grown",
	[SPLICED] = "spliced", [RENUMBERED] = "renumbered", [FORGED] = "forged",
};

struct said {
	int to; /* -1: the master */
	size_t len;
	uint8_t bytes[1472];
};

struct attack {
	struct sim sim;
	struct said *tape;
	size_t said;
	uint8_t bytes[2048];
	size_t len;
	int to;
	size_t out; /* bytes sent since the input was handed in */
	uint64_t tried[INPUTS], taken[INPUTS], answered[INPUTS];
	/* As they were before the batch. */
	struct fdp_master *master;
	struct fdp_node *nodes[NODES];
	uint64_t hashes[NODES + 1];
};

static bool record(struct sim *s, int to, uint8_t *bytes, size_t len)
{
	struct attack *a = s->tamper_ctx;
	struct said *said = &a->tape[a->said++ % TAPE];

	assert_true(len <= sizeof said->bytes);
	said->to = to;
	said->len = len;
	memcpy(said->bytes, bytes, len);
	return true;
}

static void count_from_master(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct sim *s = ctx;
	struct attack *a = s->tamper_ctx;

	(void)bytes;
	assert_true(to >= 0); /* an answer to all would be many */
	a->out += len;
}

static void count_from_node(void *ctx, int to, const uint8_t *bytes, size_t len)
{
	struct sim_node *n = ctx;
	struct attack *a = n->sim->tamper_ctx;

	(void)bytes;
	(void)to;
	a->out += len;
}

static void no_master_event(void *ctx, const struct fdp_master_event *event)
{
	(void)ctx;
	(void)event;
	fail_msg("an input from outside became an event of the master");
}

static void no_node_event(void *ctx, const struct fdp_node_event *event)
{
	(void)ctx;
	(void)event;
	fail_msg("an input from outside became an event of a node");
}

static const struct said *pick(struct attack *a)
{
	const size_t kept = a->said < TAPE ? a->said : TAPE;

	return &a->tape[unit_random_u32(&a->sim.random) % kept];
}

static void fill(struct attack *a, size_t from, size_t to)
{
	for (size_t i = from; i < to; i++)
		a->bytes[i] = (uint8_t)unit_random_u32(&a->sim.random);
}

static void put(uint8_t *at, uint64_t value, unsigned bytes)
{
	for (unsigned i = 0; i < bytes; i++)
		at[i] = (uint8_t)(value >> 8 * i);
}

/* A header of the session that is running, with numbers that would be new. */
static void renumber(struct attack *a)
{
	const uint32_t which = unit_random_u32(&a->sim.random);

	if (which & 1)
		put(a->bytes + 16, a->sim.session, 8);
	if (which & 2)
		put(a->bytes + 24, (UINT64_C(1) << 40) * (1 + (which >> 8) % 4) + (which >> 12), 8);
	if (which & 4)
		put(a->bytes + 8, a->to < 0 ? which >> 16 & 3 : FDP_SENDER_MASTER, 2);
	if (which & 8)
		a->bytes[7] = 0;
	if (!(which & 15))
		a->bytes[5] = (uint8_t)(1 + (which >> 8) % (FDP_KINDS - 1));
}

static void make_noise(struct attack *a, enum input kind)
{
	struct sim *s = &a->sim;

	a->to = (int)(unit_random_u32(&s->random) % (NODES + 1)) - 1;
	a->len = unit_random_u32(&s->random) % 1473;
	fill(a, 0, a->len);
	if (kind == NOISE || a->len < FDP_HEADER_BYTES)
		return;
	memcpy(a->bytes, (const uint8_t[]){ 'G', 'F', 'D', 'P', FDP_VERSION }, 5);
	a->bytes[5] = (uint8_t)(1 + a->bytes[5] % (FDP_KINDS - 1));
	a->bytes[6] &= 1;
	a->bytes[7] = 0;
	put(a->bytes + 8, a->to < 0 ? a->bytes[8] % NODES : FDP_SENDER_MASTER, 2);
	put(a->bytes + 10, a->len - FDP_HEADER_BYTES, 2);
	put(a->bytes + 12, 0x10000, 4);
	put(a->bytes + 16, s->session, 8);
	put(a->bytes + 40, a->len - FDP_HEADER_BYTES, 4);
	put(a->bytes + 44, a->len - FDP_HEADER_BYTES, 4);
}

/* Never just what was said: that is REPLAYED. */
static void spoil(struct attack *a, enum input kind)
{
	struct sim *s = &a->sim;
	const struct said *other = pick(a);
	uint8_t key[FDP_KEY_BYTES];

	switch (kind) {
	case FLIPPED:
		for (unsigned n = 1 + unit_random_u32(&s->random) % 4; n; n--) {
			const uint32_t bit = unit_random_u32(&s->random) % (uint32_t)(a->len * 8);
			a->bytes[bit / 8] = (uint8_t)(a->bytes[bit / 8] ^ 1u << bit % 8);
		}
		break;
	case CUT: a->len = unit_random_u32(&s->random) % a->len; break;
	case GROWN:
		fill(a, a->len, sizeof a->bytes);
		a->len += 1 + unit_random_u32(&s->random) % 64;
		put(a->bytes + 10, a->len - FDP_HEADER_BYTES, 2);
		break;
	case SPLICED:
		memcpy(a->bytes + FDP_HEADER_BYTES, other->bytes + FDP_HEADER_BYTES,
		       other->len - FDP_HEADER_BYTES);
		a->len = other->len;
		break;
	case RENUMBERED: renumber(a); break;
	case FORGED:
		renumber(a);
		randombytes_buf(key, sizeof key);
		memset(key, 0, unit_random_u32(&s->random) & 1 ? sizeof key : 0);
		fdp_wire_sign(key, a->bytes, a->len);
		break;
	default: break;
	}
}

/* False when what was made is what was once said. */
static bool make_input(struct attack *a, enum input kind)
{
	const struct said *said = pick(a);

	if (kind == NOISE || kind == DRESSED) {
		make_noise(a, kind);
		return true;
	}
	memcpy(a->bytes, said->bytes, said->len);
	a->len = said->len;
	a->to = said->to;
	if (kind == ASTRAY)
		a->to = (a->to + 2 + (int)(unit_random_u32(&a->sim.random) % NODES)) % (NODES + 1) - 1;
	if (kind == REPLAYED || kind == ASTRAY)
		return true;
	spoil(a, kind);
	return a->len != said->len || memcmp(a->bytes, said->bytes, said->len);
}

static void hand_in(struct attack *a, enum input kind)
{
	uint8_t *exact = unit_copy(a->bytes, a->len);
	struct sim *s = &a->sim;
	bool fresh = false;
	int r;

	a->out = 0;
	if (a->to < 0)
		r = fdp_master_receive(s->master, exact, a->len, s->now_ns, &fresh);
	else
		r = fdp_node_receive(s->nodes[a->to].node, exact, a->len, s->now_ns);
	free(exact);
	a->tried[kind]++;
	a->taken[kind] += fresh;
	a->answered[kind] += a->out > 0;
	assert_true(a->out <= a->len);
	/* What was signed when there was no session yet is good once more: to be answered. */
	if (kind != REPLAYED && kind != ASTRAY) {
		assert_true(r < 0);
		assert_int_equal(a->out, 0);
	}
}

/* All but counters and the numbers of what was answered. */
static void remember(struct attack *a)
{
	struct sim *s = &a->sim;

	memcpy(a->master, s->master, sizeof *s->master);
	a->hashes[NODES] = param_state_hash(s->master->state, 0);
	for (int i = 0; i < NODES; i++) {
		memcpy(a->nodes[i], s->nodes[i].node, sizeof *a->nodes[i]);
		a->hashes[i] = param_state_hash(s->nodes[i].node->state, 0);
	}
}

static void compare(struct attack *a)
{
	struct sim *s = &a->sim;

	a->master->counters = s->master->counters;
	a->master->out = s->master->out;
	a->master->now_ns = s->master->now_ns; /* of the call, whatever it was about */
	assert_memory_equal(a->master, s->master, sizeof *s->master);
	assert_int_equal(a->hashes[NODES], param_state_hash(s->master->state, 0));
	for (int i = 0; i < NODES; i++) {
		struct fdp_node *before = a->nodes[i];
		const struct fdp_node *after = s->nodes[i].node;

		before->counters = after->counters;
		before->out = after->out;
		/* Of a recorded beacon: when it last asked. */
		before->asked = after->asked;
		before->asked_ns = after->asked_ns;
		memcpy(before->calls, after->calls, sizeof before->calls);
		assert_memory_equal(before, after, sizeof *after);
		assert_int_equal(a->hashes[i], param_state_hash(after->state, 0));
	}
}

static void run_batch(struct attack *a)
{
	struct sim *s = &a->sim;
	const struct fdp_master_ops master_ops = s->master->ops;
	struct fdp_node_ops node_ops[NODES];

	s->master->ops.send = count_from_master;
	s->master->ops.event = no_master_event;
	for (int i = 0; i < NODES; i++) {
		node_ops[i] = s->nodes[i].node->ops;
		s->nodes[i].node->ops.send = count_from_node;
		s->nodes[i].node->ops.event = no_node_event;
	}
	remember(a);
	for (int i = 0; i < BATCH; i++) {
		const enum input kind = unit_random_u32(&s->random) % INPUTS;

		if (make_input(a, kind))
			hand_in(a, kind);
	}
	compare(a);
	s->master->ops = master_ops;
	for (int i = 0; i < NODES; i++)
		s->nodes[i].node->ops = node_ops[i];
}

/* Another incarnation of a node, or another session; what was said stays on the tape. */
static void move_on(struct attack *a, unsigned round)
{
	struct sim *s = &a->sim;
	const int node = (int)(round % NODES);

	if (round % 4 == 3) {
		sim_kill_master(s);
		s->session -= round % 8 == 7; /* a number that comes again */
		sim_start_master(s);
	} else {
		fdp_node_leave(s->nodes[node].node, s->now_ns);
		sim_kill_node(s, node);
		sim_run_ns(s, SIM_MS);
		sim_start_node(s, node);
	}
	sim_assemble(s);
	sim_run_frames(s, 3);
}

static void attack_room(bool multicast, uint64_t batches)
{
	static struct attack a; /* large */
	uint64_t tried = 0, taken = 0, answered = 0;

	memset(&a, 0, sizeof a);
	a.tape = calloc(TAPE, sizeof *a.tape);
	a.master = malloc(sizeof *a.master);
	for (int i = 0; i < NODES; i++)
		a.nodes[i] = malloc(sizeof *a.nodes[i]);
	sim_init(&a.sim, NODES, 31 + multicast);
	a.sim.multicast = multicast;
	a.sim.datagram_max = multicast ? FDP_DATAGRAM_MIN : 1472;
	a.sim.lamps = true;
	a.sim.tamper = record;
	a.sim.tamper_ctx = &a;
	sim_start_all(&a.sim);
	sim_assemble(&a.sim);
	sim_run_frames(&a.sim, 20);
	for (uint64_t i = 0; i < batches; i++) {
		run_batch(&a);
		if (i % 8 == 7)
			sim_run_frames(&a.sim, 1);
		if (i % 128 == 127)
			move_on(&a, (unsigned)(i / 128));
	}
	sim_run_frames(&a.sim, 3);
	assert_int_equal(a.sim.late + a.sim.evicted + a.sim.mismatches, 0);
	for (int i = 0; i < INPUTS; i++) {
		printf("# %s: %s: %llu, %llu answered\n", multicast ? "multicast" : "unicast",
		       input_names[i], (unsigned long long)a.tried[i],
		       (unsigned long long)a.answered[i]);
		assert_true(a.tried[i] > 0);
		tried += a.tried[i];
		taken += a.taken[i];
		answered += a.answered[i];
	}
	printf("# %s: %llu tried, %llu accepted, %llu answered (with no more bytes), %llu walls late in "
	       "%llu frames\n",
	       multicast ? "multicast" : "unicast", (unsigned long long)tried,
	       (unsigned long long)taken, (unsigned long long)answered,
	       (unsigned long long)a.sim.late, (unsigned long long)a.sim.swapped);
	assert_int_equal(taken, 0);
	assert_true(a.answered[REPLAYED] > 0); /* the test sees answers when there are any */
	sim_finish(&a.sim);
	free(a.tape);
	free(a.master);
	for (int i = 0; i < NODES; i++)
		free(a.nodes[i]);
}

static void strangers_move_nothing(void **state)
{
	const uint64_t inputs = getenv("GROTTO_LONG") ? 9000000 : 100000;

	(void)state;
	attack_room(true, inputs / 2 / BATCH);
	attack_room(false, inputs / 2 / BATCH);
}

/* Each thing that a key is made from makes another one. */
static void keys_differ(void **state)
{
	uint8_t cluster[FDP_KEY_BYTES] = { 1 }, nonce[3][FDP_NONCE_BYTES] = { { 2 }, { 3 }, { 4 } };
	uint8_t keys[12][FDP_KEY_BYTES];
	unsigned n = 0;

	(void)state;
	fdp_key_to_nodes(cluster, 7, nonce[0], keys[n++]);
	fdp_key_to_nodes(cluster, 8, nonce[0], keys[n++]);
	fdp_key_to_nodes(cluster, 7, nonce[1], keys[n++]);
	fdp_key_to_master(cluster, 7, 0, nonce[0], nonce[1], nonce[2], keys[n++]);
	fdp_key_to_master(cluster, 8, 0, nonce[0], nonce[1], nonce[2], keys[n++]);
	fdp_key_to_master(cluster, 7, 1, nonce[0], nonce[1], nonce[2], keys[n++]);
	fdp_key_to_master(cluster, 7, 0, nonce[1], nonce[1], nonce[2], keys[n++]);
	fdp_key_to_master(cluster, 7, 0, nonce[0], nonce[2], nonce[2], keys[n++]);
	fdp_key_to_master(cluster, 7, 0, nonce[0], nonce[1], nonce[1], keys[n++]);
	cluster[31] = 1;
	fdp_key_to_nodes(cluster, 7, nonce[0], keys[n++]);
	fdp_key_to_master(cluster, 7, 0, nonce[0], nonce[1], nonce[2], keys[n++]);
	memcpy(keys[n++], cluster, sizeof cluster);
	for (unsigned i = 0; i < n; i++)
		for (unsigned j = 0; j < i; j++)
			assert_memory_not_equal(keys[i], keys[j], FDP_KEY_BYTES);
}

static void challenges_differ(void **state)
{
	uint8_t cluster[FDP_KEY_BYTES] = { 1 }, nonce[3][FDP_NONCE_BYTES] = { { 2 }, { 3 }, { 4 } };
	uint8_t all[7][FDP_NONCE_BYTES];

	(void)state;
	fdp_challenge(cluster, 7, 0, 0, nonce[0], nonce[1], all[0]);
	fdp_challenge(cluster, 8, 0, 0, nonce[0], nonce[1], all[1]);
	fdp_challenge(cluster, 7, 1, 0, nonce[0], nonce[1], all[2]);
	fdp_challenge(cluster, 7, 0, 1, nonce[0], nonce[1], all[3]);
	fdp_challenge(cluster, 7, 0, 0, nonce[2], nonce[1], all[4]);
	fdp_challenge(cluster, 7, 0, 0, nonce[0], nonce[2], all[5]);
	cluster[0] = 2;
	fdp_challenge(cluster, 7, 0, 0, nonce[0], nonce[1], all[6]);
	for (unsigned i = 0; i < 7; i++)
		for (unsigned j = 0; j < i; j++)
			assert_memory_not_equal(all[i], all[j], FDP_NONCE_BYTES);
}

/* A key is there as long as it is good, and no longer. */
static void keys_are_forgotten(void **state)
{
	struct fdp_node *n;
	struct sim s;

	(void)state;
	sim_init(&s, NODES, 5);
	sim_start_all(&s);
	n = s.nodes[0].node;
	assert_true(sodium_is_zero(n->key_to_master, FDP_KEY_BYTES));
	sim_assemble(&s);
	assert_false(sodium_is_zero(n->key_to_master, FDP_KEY_BYTES));
	assert_memory_equal(n->key_to_nodes[0], s.master->key_to_nodes, FDP_KEY_BYTES);
	for (int i = 0; i < NODES; i++)
		assert_memory_equal(s.nodes[i].node->key_to_master, s.master->node_keys[i], FDP_KEY_BYTES);
	fdp_master_leave(s.master, s.now_ns);
	sim_run_ns(&s, SIM_MS);
	assert_int_equal(fdp_node_status(n), FDP_NODE_ASKING);
	assert_true(sodium_is_zero(n->key_to_master, FDP_KEY_BYTES));
	assert_true(sodium_is_zero(n->key_to_nodes[0], FDP_KEY_BYTES));
	sim_run_ns(&s, 1000 * SIM_MS);
	fdp_node_leave(s.nodes[1].node, s.now_ns);
	assert_true(sodium_is_zero(s.nodes[1].node->key_to_master, FDP_KEY_BYTES));
	sim_finish(&s);
}

/* What one node was told another does not take, though both hold the key that signed it. */
static bool divert(struct sim *s, int to, uint8_t *bytes, size_t len)
{
	uint64_t *diverted = s->tamper_ctx;

	/* Before its own copy comes. */
	if (to == 0 && bytes[7] == 1 && ++*diverted)
		sim_inject(s, 1, bytes, len, 0);
	return true;
}

static void for_one_node_alone(void **state)
{
	struct fdp_counters c;
	uint64_t diverted = 0;
	struct sim s;

	(void)state;
	sim_init(&s, 2, 6);
	s.multicast = false;
	sim_start_all(&s);
	sim_assemble(&s);
	s.tamper = divert;
	s.tamper_ctx = &diverted;
	sim_run_frames(&s, 40);
	fdp_node_counters(s.nodes[1].node, &c);
	assert_true(diverted >= 40);
	assert_int_equal(c.bad_replay, diverted);
	assert_int_equal(s.nodes[1].swaps, 40);
	assert_int_equal(s.late, 0);
	sim_finish(&s);
}

/* No beacon where nobody is missing; where one is, nobody in the session minds it. */
static void beacons(void **state)
{
	struct fdp_counters before, after;
	struct sim s;

	(void)state;
	sim_init(&s, 2, 7);
	sim_start_all(&s);
	sim_assemble(&s);
	fdp_master_counters(s.master, &before);
	sim_run_ns(&s, 1000 * SIM_MS);
	fdp_master_counters(s.master, &after);
	assert_true(after.bytes_out - before.bytes_out < 4 * 200);
	fdp_node_leave(s.nodes[1].node, s.now_ns);
	sim_kill_node(&s, 1);
	fdp_master_counters(s.master, &before);
	fdp_node_counters(s.nodes[0].node, &(struct fdp_counters){ 0 });
	sim_run_ns(&s, 1000 * SIM_MS);
	fdp_master_counters(s.master, &after);
	assert_true(after.bytes_out - before.bytes_out >= 4 * (FDP_HEADER_BYTES + FDP_JOIN_BYTES));
	fdp_node_counters(s.nodes[0].node, &after);
	assert_int_equal(after.bad_format + after.bad_replay + after.bad_session + after.bad_auth, 0);
	assert_int_equal(s.nodes[0].joined, 1);
	sim_finish(&s);
}

/*
 * A datagram of a node in its session may be a copy, thrown in by who listens, when the node's own was
 * lost: it says nothing of where the node is. A JOIN does, which the node repeats until it is in.
 */
static void only_a_join_teaches(void **state)
{
	struct sim s;
	uint64_t fresh;

	(void)state;
	sim_start_running(&s, NODES);
	assert_int_equal(s.fresh, NODES);
	fresh = s.fresh;
	sim_run_frames(&s, 50);
	assert_int_equal(s.fresh, fresh);
	sim_finish(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(strangers_move_nothing), cmocka_unit_test(keys_differ),
		cmocka_unit_test(keys_are_forgotten),	  cmocka_unit_test(for_one_node_alone),
		cmocka_unit_test(challenges_differ),	  cmocka_unit_test(beacons),
		cmocka_unit_test(only_a_join_teaches),
	};

	if (getenv("GROTTO_TEST_FILTER"))
		cmocka_set_test_filter(getenv("GROTTO_TEST_FILTER"));
	return cmocka_run_group_tests(tests, NULL, NULL);
}
