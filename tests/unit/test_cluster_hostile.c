/*
 * A cluster on a fake clock, and who means it harm or is of another make: states
 * that differ, recordings, bits that turn, other rooms and versions.
 */
#include "cluster_sim.h"

#include "base/result.h"

struct tamper {
	int target;
	bool also_hash;
	unsigned done;
};

/* A key holder in the middle: another head height, once. */
static bool spoil_delta(struct sim *s, int to, uint8_t *bytes, size_t len)
{
	struct tamper *t = s->tamper_ctx;
	const struct fdp_gate gate = {
		.keys = (const uint8_t(*)[FDP_KEY_BYTES])&s->master->key_to_nodes,
		.keyed = 1,
		.session = s->session,
		.kinds = 1u << FDP_DELTA,
		.first_sender = FDP_SENDER_MASTER,
		.last_sender = FDP_SENDER_MASTER,
	};
	struct fdp_header h;
	uint8_t *last = bytes + len - 1;

	if (to != t->target || t->done || fdp_gate_open(&gate, bytes, len, &h) != FDP_GOOD)
		return true;
	t->done++;
	last[-1] ^= 0x10; /* of the last parameter's last element */
	if (t->also_hash)
		bytes[FDP_HEADER_BYTES] ^= 1;
	fdp_wire_seal(&h, s->master->key_to_nodes, bytes);
	return true;
}

static void mismatch(void **state)
{
	struct tamper t = { .target = 1 };
	struct sim s;

	(void)state;
	/* The node sees it: its state is not what the master's hash says. */
	sim_start_running(&s, 3);
	s.tamper = spoil_delta;
	s.tamper_ctx = &t;
	sim_run_frames(&s, 10);
	assert_int_equal(t.done, 1);
	assert_int_equal(s.nodes[1].mismatches, 1);
	assert_int_equal(s.mismatches, 1);
	assert_int_equal(sim_peer(&s, 1).mismatches, 1);
	/* Repaired inside the frame: nobody was late and no frame was left out. */
	assert_int_equal(s.late, 0);
	assert_int_equal(s.nodes[1].swaps, 30);
	assert_int_equal(fdp_node_hash(s.nodes[1].node), fdp_master_hash(s.master));
	sim_finish(&s);
}

static uint64_t counted_mismatches;
static uint64_t mismatch_ours, mismatch_theirs;

static void count_mismatch(void *ctx, const struct fdp_master_event *e)
{
	(void)ctx;
	if (e->kind != FDP_MASTER_MISMATCH)
		return;
	counted_mismatches++;
	mismatch_ours = e->ours;
	mismatch_theirs = e->theirs;
}

/* A READY whose hash differs is not ready: the master compares on its own. */
static bool spoil_ready(struct sim *s, int to, uint8_t *bytes, size_t len)
{
	struct tamper *t = s->tamper_ctx;
	const struct fdp_gate gate = {
		.keys = (const uint8_t(*)[FDP_KEY_BYTES])s->master->node_keys + t->target,
		.keyed = 1,
		.session = s->session,
		.kinds = 1u << FDP_READY,
		.first_sender = (uint16_t)t->target,
		.last_sender = (uint16_t)t->target,
	};
	struct fdp_header h;

	if (to != -1 || t->done || fdp_gate_open(&gate, bytes, len, &h) != FDP_GOOD)
		return true;
	t->done++;
	bytes[FDP_HEADER_BYTES] ^= 1;
	fdp_wire_seal(&h, s->master->node_keys[t->target], bytes);
	return true;
}

static void master_compares(void **state)
{
	struct tamper t = { .target = 2 };
	struct sim s;

	(void)state;
	sim_start_running(&s, 3);
	s.tamper = spoil_ready;
	s.tamper_ctx = &t;
	s.master->ops.event = count_mismatch; /* one frame, seen through our own eyes */
	s.running = true;
	sim_run_ns(&s, 30 * SIM_MS);
	assert_int_equal(t.done, 1);
	assert_int_equal(counted_mismatches, 1);
	assert_int_equal(mismatch_ours ^ mismatch_theirs, 1);
	assert_int_equal(sim_peer(&s, 2).mismatches, 1);
	assert_true(fdp_master_idle(s.master)); /* and the frame was swapped all the same */
	assert_int_equal(sim_peer(&s, 2).missed, 0);
	sim_finish(&s);
}

/* All that one session said, both ways. */
struct recording {
	struct { int to; size_t len; uint8_t *bytes; } *items;
	size_t count, room;
};

static bool record(struct sim *s, int to, uint8_t *bytes, size_t len)
{
	struct recording *r = s->tamper_ctx;

	if (r->count == r->room) {
		r->room = r->room ? r->room * 2 : 256;
		r->items = realloc(r->items, r->room * sizeof *r->items);
		assert_non_null(r->items);
	}
	r->items[r->count].to = to;
	r->items[r->count].len = len;
	r->items[r->count++].bytes = unit_copy(bytes, len);
	return true;
}

static void play(struct sim *s, const struct recording *r)
{
	for (size_t i = 0; i < r->count; i++)
		sim_inject(s, r->items[i].to, r->items[i].bytes, r->items[i].len,
			   (int64_t)i * 100000);
}

/* A recording of an older session, or of this one, moves nothing. */
static void replay_into(bool same_number)
{
	struct fdp_counters before, after;
	struct recording r = { 0 };
	struct sim s;

	sim_init(&s, 3, 21);
	s.tamper = record;
	s.tamper_ctx = &r;
	sim_start_all(&s);
	sim_assemble(&s);
	sim_run_frames(&s, 30);
	s.tamper = NULL;
	/* Into the session that it is of. */
	fdp_master_counters(s.master, &before);
	play(&s, &r);
	sim_run_frames(&s, 40);
	sim_assert_all_swapped(&s, 70);
	assert_int_equal(s.joined, 3);
	fdp_master_counters(s.master, &after);
	assert_true(after.bad_replay > before.bad_replay + r.count / 4);
	/* Into the next one, even where its number is the same. */
	sim_kill_master(&s);
	s.session -= same_number;
	sim_start_master(&s);
	sim_assemble(&s);
	for (int i = 0; i < 3; i++)
		s.nodes[i].frames = s.nodes[i].swaps = 0;
	fdp_master_counters(s.master, &before);
	play(&s, &r);
	sim_run_frames(&s, 60);
	sim_assert_all_swapped(&s, 60);
	assert_int_equal(s.joined, 6);
	assert_int_equal(s.left + s.evicted + s.late, 0);
	fdp_master_counters(s.master, &after);
	/* Its keys are others. */
	assert_true(same_number ? after.bad_auth > before.bad_auth + r.count / 4
				: after.bad_session > before.bad_session + r.count / 4);
	for (size_t i = 0; i < r.count; i++)
		free(r.items[i].bytes);
	free(r.items);
	sim_finish(&s);
}

static void replays(void **state)
{
	(void)state;
	replay_into(false);
	replay_into(true);
}

/* How many of the recorded datagrams to the master are taken for the node's own of now. */
static size_t count_fresh(struct sim *s, const struct recording *r, size_t *out_answered)
{
	size_t count = 0;

	*out_answered = 0;
	for (size_t i = 0; i < r->count; i++) {
		uint8_t *copy;
		bool fresh = true;

		if (r->items[i].to >= 0)
			continue;
		copy = unit_copy(r->items[i].bytes, r->items[i].len);
		if (fdp_master_receive(s->master, copy, r->items[i].len, s->now_ns, &fresh) >= 0)
			++*out_answered;
		count += fresh;
		free(copy);
		assert_int_equal(fdp_master_answers(s->master), -1);
	}
	return count;
}

/* The source of a recording is not where the node is: nothing of it may teach an address. */
static void recordings_are_not_fresh(void **state)
{
	struct recording r = { 0 };
	size_t fresh, answered;
	struct sim s;

	(void)state;
	sim_init(&s, 3, 23);
	s.tamper = record;
	s.tamper_ctx = &r;
	sim_start_all(&s);
	sim_assemble(&s);
	sim_run_frames(&s, 10);
	s.tamper = NULL;
	assert_int_equal(s.fresh, 3); /* the JOINs that brought them in */
	fresh = count_fresh(&s, &r, &answered);
	assert_int_equal(fresh, 0);
	assert_true(answered >= 3); /* the first JOINs are answered all the same */
	printf("# %zu recorded datagrams again: %zu answered, %zu taken as fresh\n", r.count,
	       answered, fresh);
	/* To a master that has not heard of the nodes, and by chance has the same number. */
	sim_kill_master(&s);
	s.session--;
	sim_start_master(&s);
	assert_int_equal(count_fresh(&s, &r, &answered), 0);
	assert_int_equal(fdp_master_present(s.master), 0);
	/* To the next one. */
	sim_kill_master(&s);
	sim_start_master(&s);
	assert_int_equal(count_fresh(&s, &r, &answered), 0);
	sim_assemble(&s);
	assert_int_equal(count_fresh(&s, &r, &answered), 0);
	for (size_t i = 0; i < r.count; i++)
		free(r.items[i].bytes);
	free(r.items);
	sim_finish(&s);
}

/* Every datagram comes a second time with one bit turned: counted, and of no effect. */
static bool flip_copies(struct sim *s, int to, uint8_t *bytes, size_t len)
{
	uint8_t *copy = unit_copy(bytes, len);
	const uint32_t bit = unit_random_u32(&s->random) % (uint32_t)(len * 8);

	copy[bit / 8] = (uint8_t)(copy[bit / 8] ^ 1u << bit % 8);
	sim_inject(s, to, copy, len, 10000);
	free(copy);
	return true;
}

static void bit_flips(void **state)
{
	struct fdp_counters c;
	struct sim s;

	(void)state;
	sim_init(&s, 4, sim_seed_of("bit flips"));
	s.tamper = flip_copies;
	sim_start_all(&s);
	sim_assemble(&s);
	sim_run_frames(&s, 100);
	sim_assert_all_swapped(&s, 100);
	fdp_master_counters(s.master, &c);
	printf("# master dropped %llu of %llu: %llu by MAC, %llu by version, %llu by form, %llu by session\n",
	       (unsigned long long)(c.bad_auth + c.bad_version + c.bad_format + c.bad_session),
	       (unsigned long long)c.datagrams_in, (unsigned long long)c.bad_auth,
	       (unsigned long long)c.bad_version, (unsigned long long)c.bad_format,
	       (unsigned long long)c.bad_session);
	assert_int_equal((c.bad_auth + c.bad_version + c.bad_format + c.bad_session) * 2, c.datagrams_in);
	assert_int_equal(c.bad_replay + c.bad_short, 0);
	sim_finish(&s);
}

static void refuse_one(void (*spoil)(struct sim *s), const char *ours, const char *theirs)
{
	struct fdp_counters c;
	struct sim s;

	sim_init(&s, 2, 2);
	sim_start_all(&s);
	spoil(&s);
	sim_run_ns(&s, 1500 * SIM_MS);
	assert_int_equal(s.refused, 1); /* told once, though it asks for ever */
	assert_int_equal(s.nodes[1].refused, 1);
	assert_string_equal(s.reason, s.nodes[1].reason);
	assert_non_null(strstr(s.reason, ours));
	assert_non_null(strstr(s.reason, theirs));
	assert_int_equal(s.nodes[1].joined, 0);
	assert_int_equal(s.joined, 1);
	fdp_node_counters(s.nodes[1].node, &c);
	assert_true(c.datagrams_out >= 5); /* still asking */
	sim_finish(&s);
}

static void spoil_layout(struct sim *s)
{
	s->nodes[1].node->params.contents.layout_hash[0] = 0xab;
	s->nodes[1].node->items[9] ^= 1;
}

static void spoil_scene(struct sim *s)
{
	s->nodes[1].node->params.contents.scene_hash[7] = 0xcd;
	s->nodes[1].node->items[4 * 8 + 7] ^= 1;
}

/* A layout of fewer parts, which are as ours. */
static void cut_layout(struct sim *s)
{
	s->nodes[1].node->params.contents.layout_hash[0] = 0xab;
	s->nodes[1].node->params.contents.layout_count = 2;
	memmove(s->nodes[1].node->items + 16, s->nodes[1].node->items + 24, 16);
	memset(s->nodes[1].node->items + 32, 0, 8);
}

/* Only the hashes are said. */
static void hide_parts(struct sim *s)
{
	s->nodes[1].node->params.contents.layout_hash[0] = 0xab;
	s->nodes[1].node->params.contents.layout_count = s->nodes[1].node->params.contents.scene_count = 0;
	memset(s->nodes[1].node->items, 0, sizeof s->nodes[1].node->items);
}

static void spoil_name(struct sim *s) { strcpy(s->nodes[1].node->name, "floor"); }

static void refusals(void **state)
{
	(void)state;
	refuse_one(spoil_layout, "the master's 0400000000000000", "hash is ab00000000000000");
	refuse_one(spoil_layout, "another layout, first at walls[0] (front): ",
		   "; give the node the master's file");
	refuse_one(spoil_scene, "the master's 0500000000000000", "hash is 05000000000000cd");
	refuse_one(spoil_scene, "another scene, first at model: ", "");
	refuse_one(cut_layout, "another layout, first at rates.frame_hz: ", "");
	refuse_one(hide_parts, "another layout: the node's hash is", "");
	refuse_one(spoil_name, "wall1", "floor");
}

/* Who is first in the room says how light is computed; of two that differ one is told why not. */
static void other_plan(void **state)
{
	struct fdp_peer_status peer;
	struct sim s;
	unsigned in;

	(void)state;
	sim_init(&s, 2, 2);
	sim_start_all(&s);
	s.nodes[0].node->params.plan = 0x1234;
	s.nodes[1].node->params.plan = 0x1235;
	for (unsigned i = 0; i < 2; i++) {
		s.nodes[i].node->params.plan_cost = 2180;
		s.nodes[i].node->params.plan_error = 510;
	}
	sim_run_ns(&s, 1500 * SIM_MS);
	in = s.nodes[0].node->status == FDP_NODE_ASKING;
	assert_int_not_equal(s.nodes[in].node->status, FDP_NODE_ASKING);
	assert_int_equal(s.nodes[!in].node->status, FDP_NODE_ASKING);
	assert_int_equal(s.nodes[!in].refused, 1);
	assert_non_null(strstr(s.nodes[!in].reason, "another plan of the light"));
	assert_non_null(strstr(s.nodes[!in].reason, "0000000000001234"));
	assert_non_null(strstr(s.nodes[!in].reason, "0000000000001235"));
	fdp_master_peer(s.master, in, &peer);
	assert_int_equal(peer.plan, s.nodes[in].node->params.plan);
	assert_int_equal(peer.plan_cost, 2180);
	assert_int_equal(peer.plan_error, 510);
	assert_int_equal(s.nodes[!in].offered, s.nodes[in].node->params.plan);
	/* Alike they both come in; but who takes part does not change what it said. */
	assert_int_equal(fdp_node_replan(s.nodes[in].node, 1, 1, 1, 0), GR_ERR_STATE);
	assert_int_equal(fdp_node_replan(s.nodes[!in].node, s.nodes[!in].offered, 4400, 490, 4096), GR_OK);
	sim_run_ns(&s, 1500 * SIM_MS);
	fdp_master_peer(s.master, !in, &peer);
	assert_int_equal(peer.plan, s.nodes[in].node->params.plan);
	assert_int_equal(peer.plan_cost, 4400);
	assert_int_equal(s.nodes[!in].node->share.room, 4096);
	assert_int_not_equal(s.nodes[!in].node->status, FDP_NODE_ASKING);
	assert_int_not_equal(s.nodes[in].node->status, FDP_NODE_ASKING);
	sim_finish(&s);
}

/* A refusal for anything else offers no plan, whatever the node's is. */
static void other_things_have_no_plan(void **state)
{
	struct sim s;

	(void)state;
	sim_init(&s, 2, 2);
	sim_start_all(&s);
	s.nodes[0].node->params.plan = 0x1234;
	s.nodes[1].node->params.plan = 0x1235;
	spoil_scene(&s);
	sim_run_ns(&s, 1500 * SIM_MS);
	assert_int_equal(s.nodes[1].refused, 1);
	assert_non_null(strstr(s.nodes[1].reason, "another scene"));
	assert_int_equal(s.nodes[1].offered, 0);
	sim_finish(&s);
}

/* A JOIN in the form of a later version is answered, so that its operator learns why. */
static void other_version(void **state)
{
	const uint8_t key[FDP_KEY_BYTES] = { 1, 2, 3 };
	uint8_t bytes[FDP_HEADER_BYTES + FDP_JOIN_BYTES];
	struct fdp_join join = { .version = 9, .index = 0, .name = "wall0", .items = { 1, 2, 3 } };
	struct fdp_header h = {
		.version = 9, .kind = FDP_JOIN, .sender = 0, .payload_len = FDP_JOIN_BYTES,
		.count = 1, .sequence = 1, .message = 1,
		.message_len = FDP_JOIN_BYTES, .plain_len = FDP_JOIN_BYTES,
	};
	struct sim s;

	(void)state;
	sim_init(&s, 1, 2);
	sim_start_master(&s);
	fdp_join_encode(&join, bytes + FDP_HEADER_BYTES, FDP_JOIN_BYTES);
	fdp_wire_seal(&h, key, bytes);
	assert_int_equal(fdp_master_receive(s.master, bytes, sizeof bytes, s.now_ns, NULL), 0);
	assert_int_equal(s.refused, 1);
	assert_non_null(strstr(s.reason, "speaks 9, the master 4"));
	/* Version 2 sent 256 bytes, of which the first are as they still are. */
	join.version = h.version = 2;
	h.payload_len = 256;
	h.message_len = h.plain_len = 256;
	h.sequence++;
	fdp_join_encode(&join, bytes + FDP_HEADER_BYTES, FDP_JOIN_BYTES);
	fdp_wire_seal(&h, key, bytes);
	assert_int_equal(fdp_master_receive(s.master, bytes, FDP_HEADER_BYTES + 256, s.now_ns, NULL), 0);
	assert_non_null(strstr(s.reason, "speaks 2, the master 4"));
	/* Anything else of that version is not looked at. */
	h.kind = FDP_ACK;
	fdp_wire_seal(&h, key, bytes);
	assert_int_equal(fdp_master_receive(s.master, bytes, sizeof bytes, s.now_ns, NULL), GR_ERR_VERSION);
	sim_finish(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(mismatch),
		cmocka_unit_test(master_compares),
		cmocka_unit_test(replays),
		cmocka_unit_test(recordings_are_not_fresh),
		cmocka_unit_test(bit_flips),
		cmocka_unit_test(refusals),
		cmocka_unit_test(other_plan),
		cmocka_unit_test(other_things_have_no_plan),
		cmocka_unit_test(other_version),
	};

	if (getenv("GROTTO_TEST_FILTER"))
		cmocka_set_test_filter(getenv("GROTTO_TEST_FILTER"));
	return cmocka_run_group_tests(tests, NULL, NULL);
}
