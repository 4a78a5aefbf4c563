/* The light that nodes share out: a made-up light in a whole cluster on a fake clock. */
#include "cluster_sim.h"

#include "base/cursor.h"
#include "base/result.h"

#define LIGHT_HEAD 12

/* What a node's renderer holds: which frame's slice of each rank. */
struct light {
	unsigned index, count;
	uint64_t now[FDP_MAX_NODES];  /* used in the frame that is being drawn */
	uint64_t next[FDP_MAX_NODES]; /* put, or made; used from the next frame on */
	bool fresh;                   /* nobody has ours */
	uint64_t due, on_time, restarts;
};

struct room {
	struct sim sim;
	struct light lights[FDP_MAX_NODES];
	size_t bytes;          /* of all slices */
	uint64_t still_after;  /* the light moves up to this frame */
	uint64_t made[FDP_MAX_NODES]; /* by rank, the newest of the present division */
};

static struct room *room_of(struct sim_node *n)
{
	return (struct room *)n->sim; /* its first member */
}

static uint8_t light_byte(uint64_t frame, unsigned index, size_t at)
{
	return (uint8_t)(frame * 151 + index * 31 + at * 7 + (at >> 8));
}

static size_t light_make(uint8_t *bytes, size_t all, uint64_t frame, unsigned index, unsigned count)
{
	struct gr_writer w = gr_writer(bytes, LIGHT_HEAD);
	const size_t len = all / count < LIGHT_HEAD + 1 ? LIGHT_HEAD + 1 : all / count;

	gr_write_u64(&w, frame);
	gr_write_u16(&w, (uint16_t)index);
	gr_write_u16(&w, (uint16_t)count);
	for (size_t i = LIGHT_HEAD; i < len; i++)
		bytes[i] = light_byte(frame, index, i);
	return len;
}

/* What is put is what that node made, whole, of our division, and in order. */
static void put(void *ctx, const uint8_t *bytes, size_t len)
{
	struct sim_node *n = ctx;
	struct room *room = room_of(n);
	struct light *light = &room->lights[n->index];
	struct gr_reader r = gr_reader(bytes, len);
	const uint64_t frame = gr_read_u64(&r);
	const unsigned index = gr_read_u16(&r), count = gr_read_u16(&r);

	assert_true(r.ok);
	assert_int_equal(count, light->count);
	assert_int_not_equal(index, light->index);
	assert_int_equal(len, room->bytes / count < LIGHT_HEAD + 1 ? LIGHT_HEAD + 1 : room->bytes / count);
	assert_true(frame > light->next[index]);
	for (size_t i = LIGHT_HEAD; i < len; i++)
		assert_int_equal(bytes[i], light_byte(frame, index, i));
	light->next[index] = frame;
}

static void begin_light(struct sim_node *n, uint64_t frame)
{
	struct room *room = room_of(n);
	struct light *light = &room->lights[n->index];
	unsigned index, count;

	assert_true(fdp_node_division(n->node, &index, &count));
	if (index != light->index || count != light->count || light->fresh ||
	    n->node->shared_since == frame) {
		memset(light->next, 0, sizeof light->next);
		light->index = index;
		light->count = count;
		light->fresh = true;
		light->restarts++;
	}
	fdp_node_slices(n->node, frame, put, n);
	memcpy(light->now, light->next, sizeof light->now);
	for (unsigned i = 0; i < count; i++) {
		/* Made in the frame before: it is due now. */
		if (i == index || room->made[i] + 1 != frame || frame <= n->node->shared_since)
			continue;
		light->due++;
		light->on_time += light->now[i] + 1 == frame;
	}
}

static void light_done(struct sim_node *n, uint64_t frame)
{
	static uint8_t bytes[FDP_SHARE_MAX];
	struct room *room = room_of(n);
	struct light *light = &room->lights[n->index];
	size_t len;
	int result;

	if (!light->fresh && frame > room->still_after)
		return;
	len = light_make(bytes, room->bytes, frame, light->index, light->count);
	result = fdp_node_slice(n->node, frame, bytes, len, n->sim->now_ns);
	if (light->count == 1 || result == GR_NOTHING)
		return;
	assert_int_equal(result, GR_OK);
	light->fresh = false;
	light->next[light->index] = room->made[light->index] = frame;
}

static void room_init(struct room *room, size_t nodes, size_t bytes, uint64_t seed)
{
	memset(room, 0, sizeof *room);
	sim_init(&room->sim, nodes, seed);
	room->bytes = bytes;
	room->still_after = UINT64_MAX;
	room->sim.share_bytes = bytes < 2048 ? 4096 : bytes;
	room->sim.begin_light = begin_light;
	room->sim.light_done = light_done;
}

/* All nodes' renderers hold the same, and the newest of all. */
static void assert_same_light(struct room *room)
{
	const struct light *first = &room->lights[0];

	for (size_t i = 0; i < room->sim.node_count; i++) {
		assert_int_equal(room->lights[i].count, first->count);
		assert_memory_equal(room->lights[i].now, first->now, sizeof first->now);
	}
	for (unsigned i = 0; i < first->count; i++) {
		assert_true(first->now[i] > 0);
		assert_int_equal(first->now[i], room->made[i]);
	}
}

static struct fdp_share_counts node_counts(const struct room *room)
{
	struct fdp_share_counts sum = { 0 };

	for (size_t i = 0; i < room->sim.node_count; i++) {
		struct fdp_share_counts c;

		fdp_node_share(room->sim.nodes[i].node, &c);
		sum.sent += c.sent;
		sum.bytes_sent += c.bytes_sent;
		sum.received += c.received;
		sum.late += c.late;
		sum.lost += c.lost;
		sum.asked += c.asked;
		sum.repairs += c.repairs;
	}
	return sum;
}

static void run_weather(size_t nodes, size_t bytes, bool multicast, double loss, bool rough)
{
	const uint64_t frames = getenv("GROTTO_LONG") ? 3000 : nodes > 10 ? 40 : 150;
	struct fdp_share_counts c, master;
	struct fdp_counters wire;
	uint64_t due = 0, on_time = 0;
	struct room room;
	struct sim *s = &room.sim;

	room_init(&room, nodes, bytes, 5);
	s->multicast = multicast;
	s->jitter_ns = rough ? 200000 : 0;
	s->loss = loss;
	s->duplicate = rough ? 0.01 : 0;
	s->evict_frames = 10;
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, frames);
	for (size_t i = 0; i < nodes; i++) {
		due += room.lights[i].due;
		on_time += room.lights[i].on_time;
	}
	c = node_counts(&room);
	fdp_master_share(s->master, &master);
	fdp_master_counters(s->master, &wire);
	printf("# %zu nodes, %zu bytes of light, %s, loss %.0f %%%s: %.4f in time; late %llu, lost %llu "
	       "of %llu; slices %.0f bytes in and %.0f out a frame, repairs %.2f pieces; %llu barriers missed\n",
	       nodes, bytes, multicast ? "multicast" : "unicast", loss * 100,
	       rough ? ", overtaking" : "", due ? (double)on_time / (double)due : 0,
	       (unsigned long long)c.late, (unsigned long long)c.lost,
	       (unsigned long long)(c.sent * (nodes - 1)), (double)c.bytes_sent / (double)frames,
	       (double)master.bytes_sent / (double)frames,
	       (double)(master.repairs + c.repairs) / (double)frames, (unsigned long long)s->late);
	if (!loss && !rough) {
		assert_int_equal(on_time, due);
		assert_int_equal(c.late + c.lost + c.asked + master.asked, 0);
		assert_int_equal(c.sent, frames * nodes);
	}
	assert_true((double)on_time >= (loss > 0.02 ? 0.98 : loss > 0 ? 0.99 : 1) * (double)due);
	assert_int_equal(s->evicted + s->mismatches, 0);
	/* The light comes to rest, in the same weather: everybody ends with the same. */
	room.still_after = s->frame;
	sim_run_frames(s, 60);
	assert_same_light(&room);
	sim_finish(s);
}

static void weather(void **state)
{
	(void)state;
	for (int rough = 0; rough < 2; rough++) {
		run_weather(2, 17000, true, 0, rough);
		run_weather(4, 17000, true, 0, rough);
		run_weather(4, 17000, false, 0, rough);
		run_weather(10, 50000, true, 0, rough);
		run_weather(64, 50000, true, 0, rough);
	}
	run_weather(4, 17000, true, 0.01, false);
	run_weather(4, 17000, true, 0.05, false);
	run_weather(4, 17000, false, 0.05, false);
	run_weather(4, 17000, true, 0.01, true);
	run_weather(4, 17000, false, 0.01, true);
	run_weather(4, 17000, true, 0.05, true);
	run_weather(4, 17000, false, 0.05, true);
	run_weather(4, 400000, false, 0.01, true);
	run_weather(10, 50000, true, 0.05, true);
}

/* Nothing is sent of a light that rests; the words about it are those of the frames. */
static void still_room(void **state)
{
	struct fdp_counters before, after, plain_before, plain_after;
	struct room room, plain;
	struct fdp_share_counts c, again;

	(void)state;
	room_init(&room, 4, 17000, 3);
	room.sim.jitter_ns = 0; /* nothing overtakes, so that nothing looks lost */
	sim_start_all(&room.sim);
	sim_assemble(&room.sim);
	sim_run_frames(&room.sim, 10);
	room.still_after = room.sim.frame;
	sim_run_frames(&room.sim, 80);
	assert_same_light(&room);
	fdp_master_share(room.sim.master, &c);
	fdp_master_counters(room.sim.master, &before);
	sim_run_frames(&room.sim, 100);
	fdp_master_share(room.sim.master, &again);
	fdp_master_counters(room.sim.master, &after);
	assert_int_equal(c.bytes_sent, again.bytes_sent);
	assert_int_equal(c.asked + c.repairs, again.asked + again.repairs);

	/* The same room with nothing to share. */
	room_init(&plain, 4, 17000, 3);
	plain.sim.share_bytes = 0;
	plain.sim.jitter_ns = 0;
	plain.sim.begin_light = plain.sim.light_done = NULL;
	sim_start_all(&plain.sim);
	sim_assemble(&plain.sim);
	sim_run_frames(&plain.sim, 90);
	fdp_master_counters(plain.sim.master, &plain_before);
	sim_run_frames(&plain.sim, 100);
	fdp_master_counters(plain.sim.master, &plain_after);
	printf("# a still room of 4: master out %.1f bytes a frame shared, %.1f unshared\n",
	       (double)(after.bytes_out - before.bytes_out) / 100,
	       (double)(plain_after.bytes_out - plain_before.bytes_out) / 100);
	assert_true(after.bytes_out - before.bytes_out <=
		    plain_after.bytes_out - plain_before.bytes_out + 100 * 4);
	sim_finish(&room.sim);
	sim_finish(&plain.sim);
}

/* A dead node's part goes to the others; when it is back it has one again. */
static void dies_and_returns(void **state)
{
	struct fdp_share_counts c;
	struct room room;
	struct sim *s = &room.sim;

	(void)state;
	room_init(&room, 4, 17000, 11);
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, 20);
	assert_int_equal(fdp_master_share(s->master, &c), 4);
	sim_kill_node(s, 1);
	sim_run_frames(s, 10);
	assert_int_equal(s->evicted, 1);
	assert_int_equal(fdp_master_share(s->master, &c), 3);
	assert_int_equal(room.lights[0].count, 3);
	assert_int_equal(room.lights[2].index, 1);
	assert_int_equal(room.lights[3].index, 2);
	memset(&room.lights[1], 0, sizeof room.lights[1]);
	sim_start_node(s, 1);
	sim_run_frames(s, 60);
	assert_int_equal(fdp_master_share(s->master, &c), 4);
	room.still_after = s->frame;
	sim_run_frames(s, 5);
	assert_same_light(&room);
	/* Alone, nothing is sent. */
	for (int i = 1; i < 4; i++)
		sim_kill_node(s, i);
	sim_run_frames(s, 10);
	assert_int_equal(fdp_master_share(s->master, &c), 1);
	assert_int_equal(room.lights[0].count, 1);
	sim_finish(s);
}

/* One node hears nothing of the last slices; it is told, and asks. */
struct deaf {
	int to;
	enum fdp_kind kind;
	unsigned done;
};

static bool deaf_to_slices(struct sim *s, int to, uint8_t *bytes, size_t len)
{
	struct deaf *deaf = s->tamper_ctx;

	(void)len;
	if (to != deaf->to || bytes[5] != deaf->kind)
		return true;
	deaf->done++;
	return false;
}

static void run_deaf(int to)
{
	struct deaf deaf = { .to = to, .kind = FDP_SLICE };
	struct fdp_share_counts c;
	struct room room;
	struct sim *s = &room.sim;

	room_init(&room, 3, 3000, 17);
	room.still_after = 20;
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, 19);
	s->tamper = deaf_to_slices;
	s->tamper_ctx = &deaf;
	sim_run_frames(s, 3);
	assert_true(deaf.done > 0);
	if (to >= 0) {
		assert_int_not_equal(room.lights[to].now[0], 20);
		fdp_node_share(s->nodes[to].node, &c);
		assert_int_equal(c.late, 2);
	}
	s->tamper = NULL;
	sim_run_frames(s, 3); /* at the latest: what was asked for is asked for again */
	assert_same_light(&room);
	sim_finish(s);
}

static void the_last_is_not_lost(void **state)
{
	(void)state;
	run_deaf(1);
	run_deaf(-1); /* on the way to the master */
}

/*
 * A node that has nothing of a light of 4 MiB asks for it beside the frames, on a
 * link of 1 Gbit/s: no frame's delta waits for more than a burst of it, and no wall is
 * late. Sent as fast as it is asked for it would stop the room.
 */
static uint64_t run_bulk(bool paced)
{
	struct deaf deaf = { .to = 1, .kind = FDP_SLICE };
	struct room room;
	struct sim *s = &room.sim;
	double worst;
	int64_t begun_ns;
	uint64_t late;

	room_init(&room, 4, FDP_SHARE_MAX, 17);
	room.still_after = 2;
	s->multicast = false;
	sim_start_all(s);
	sim_assemble(s);
	if (!paced)
		s->master->bulk_node = s->master->bulk_all = (struct fdp_rate){ UINT32_MAX, UINT32_MAX };
	s->tamper = deaf_to_slices;
	s->tamper_ctx = &deaf;
	sim_run_frames(s, 12);
	s->byte_ns = 8;
	s->delivery_count = 0;
	s->tamper = NULL;
	begun_ns = s->now_ns;
	for (int frames = 0; room.lights[1].now[0] != room.made[0] || room.lights[1].now[2] != room.made[2] ||
			     room.lights[1].now[3] != room.made[3]; frames++) {
		assert_true(frames < 300);
		sim_run_frames(s, 1);
	}
	worst = (double)sim_delivery_quantile(s, 1) * 1e-6;
	late = s->late;
	printf("# 3 MiB of light to one of 4 nodes beside the frames, 1 Gbit/s, %s: whole in %.0f ms, deltas under way "
	       "for at most %.2f ms, %llu barriers missed\n", paced ? "paced" : "all at once",
	       (double)(s->now_ns - begun_ns) * 1e-6, worst, (unsigned long long)late);
	if (paced) {
		assert_true(worst < 1.2); /* FDP_BULK_ALL_BURST takes 1.05 */
		assert_true(s->now_ns - begun_ns < 1000 * SIM_MS);
	}
	assert_same_light(&room);
	sim_finish(s);
	return late;
}

static void bulk_is_paced(void **state)
{
	(void)state;
	assert_true(run_bulk(false) > 0);
	assert_int_equal(run_bulk(true), 0);
}

/* A key holder lies: nothing of it reaches another node's light, nobody is disturbed. */
static uint16_t say_slice(struct room *room, struct fdp_piece piece, size_t len, int node)
{
	static uint8_t bytes[4096];
	struct fdp_node *n = room->sim.nodes[node].node;
	struct fdp_header h = {
		.version = FDP_VERSION, .kind = FDP_SLICE, .sender = (uint16_t)node,
		.payload_len = (uint16_t)(FDP_PIECE_HEAD + len), .count = 1,
		.session = n->out.session, .sequence = ++n->out.sequence,
		.message = ++n->out.message, .message_len = (uint32_t)(FDP_PIECE_HEAD + len),
		.plain_len = (uint32_t)(FDP_PIECE_HEAD + len),
	};
	struct fdp_counters before, after;
	struct fdp_share_counts shared_before, shared_after;
	uint8_t *exact;
	int r;

	memset(bytes, 0x5a, sizeof bytes);
	fdp_piece_encode(&piece, bytes + FDP_HEADER_BYTES, FDP_PIECE_HEAD);
	fdp_wire_seal(&h, n->key_to_master, bytes);
	fdp_master_counters(room->sim.master, &before);
	fdp_master_share(room->sim.master, &shared_before);
	exact = unit_copy(bytes, FDP_HEADER_BYTES + h.payload_len);
	r = fdp_master_receive(room->sim.master, exact, FDP_HEADER_BYTES + h.payload_len,
			       room->sim.now_ns, NULL);
	fdp_master_counters(room->sim.master, &after);
	fdp_master_share(room->sim.master, &shared_after);
	assert_int_equal(shared_before.bytes_sent, shared_after.bytes_sent);
	/* Sent once more it is a replay, whatever it says. */
	assert_int_equal(fdp_master_receive(room->sim.master, exact, FDP_HEADER_BYTES + h.payload_len,
					    room->sim.now_ns, NULL),
			 room->sim.master->share.room ? GR_ERR_REPLAY : GR_ERR_FORMAT);
	free(exact);
	assert_int_equal(r < 0, after.bad_format > before.bad_format);
	return (uint16_t)(after.bad_format - before.bad_format);
}

static void hostile(void **state)
{
	struct fdp_piece p, good;
	struct room room;
	struct sim *s = &room.sim;

	(void)state;
	room_init(&room, 4, 4000, 23);
	sim_start_all(s);
	sim_assemble(s);
	sim_run_frames(s, 20);
	good = (struct fdp_piece){ .since = s->master->share.since, .frame = s->frame, .index = 2,
				   .count = 4, .chunk = 100, .len = 100 };
#define BAD(bad, size, ...) do { p = good; __VA_ARGS__; \
		assert_int_equal(say_slice(&room, p, size, 2), bad); } while (0)
	BAD(1, 100, p.index = 1);            /* another's slice */
	BAD(1, 100, p.index = 4);
	BAD(1, 100, p.count = 3);            /* another division of the same name */
	BAD(1, 100, p.count = 65);
	BAD(1, 100, p.since = s->frame);     /* a division that is not */
	BAD(1, 100, p.since = 0);
	BAD(1, 100, p.frame = s->frame + 1); /* not begun */
	BAD(1, 100, p.frame = UINT64_MAX);
	BAD(1, 100, p.chunk = 0);
	BAD(1, 100, p.len = 0);
	BAD(1, 100, p.len = 99);
	BAD(1, 99, (void)0);
	BAD(1, 100, p.len = 101);            /* not that of the slice that came whole */
	BAD(1, 100, p.len = 1100; p.at = 1000); /* longer than a quarter of what there is room for */
	BAD(1, 100, p.len = UINT32_MAX);
	BAD(1, 100, p.at = 100);
	BAD(1, 50, p.at = 50);
	BAD(1, 1, p.chunk = 1; p.len = 10000); /* more pieces than can be counted */
	BAD(0, 100, p.frame = good.since + 1; p.since = good.since); /* two newer ones are known */
	if (good.since > 1)
		BAD(0, 100, p.since = good.since - 1); /* a division gone by */
#undef BAD
	sim_run_frames(s, 20);
	room.still_after = s->frame;
	sim_run_frames(s, 5);
	assert_same_light(&room);
	assert_int_equal(s->late + s->evicted + s->mismatches, 0);
	sim_finish(s);
}

/* A master without a shared light takes none. */
static void not_shared(void **state)
{
	struct fdp_share_counts c;
	unsigned index, count;
	struct room room;
	struct sim *s = &room.sim;

	(void)state;
	room_init(&room, 2, 4000, 29);
	s->begin_light = s->light_done = NULL;
	s->share_bytes = 0;
	sim_start_master(s);
	s->share_bytes = 4096;
	for (int i = 0; i < 2; i++)
		sim_start_node(s, i);
	sim_assemble(s);
	sim_run_frames(s, 5);
	assert_false(fdp_node_division(s->nodes[0].node, &index, &count));
	assert_int_equal(fdp_node_slice(s->nodes[0].node, s->frame, (const uint8_t *)"x", 1, s->now_ns),
			 GR_NOTHING);
	assert_int_equal(say_slice(&room, (struct fdp_piece){ 1, 1, 0, 2, 10, 10, 0 }, 10, 0), 1);
	assert_int_equal(fdp_master_share(s->master, &c), 0);
	assert_int_equal(c.received, 0);
	sim_finish(s);
}

/* Every length of both bodies; whatever is taken is written again as it was. */
static void bodies(void **state)
{
	const struct fdp_piece piece = { 5, 9, 1, 4, 10, 35, 30 };
	const struct fdp_lack lack = { 5, 9, 1, 11, 3, { 0xff, 0x07 } };
	struct unit_random r = unit_random_start("share bodies");
	uint8_t bytes[FDP_PIECE_HEAD + 16] = { 0 }, again[FDP_BODY_MAX];
	struct fdp_piece piece_out;
	struct fdp_lack lack_out;
	size_t len;

	(void)state;
	assert_int_equal(fdp_piece_encode(&piece, bytes, FDP_PIECE_HEAD - 1), 0);
	assert_int_equal(fdp_piece_encode(&piece, bytes, sizeof bytes), FDP_PIECE_HEAD);
	assert_memory_equal(bytes, "\5\0\0\0\0\0\0\0\11\0\0\0\0\0\0\0\1\0\4\0\12\0\0\0\43\0\0\0\36\0\0\0", 32);
	for (size_t n = 0; n <= sizeof bytes; n++) {
		uint8_t *exact = unit_copy(bytes, n);

		assert_int_equal(fdp_piece_decode(exact, n, &piece_out),
				 n == FDP_PIECE_HEAD + 5 ? GR_OK : GR_ERR_FORMAT);
		free(exact);
	}
	for (int i = 0; i < 20000; i++) {
		fdp_piece_encode(&piece, bytes, sizeof bytes);
		bytes[unit_random_u32(&r) % FDP_PIECE_HEAD] = (uint8_t)unit_random_u32(&r);
		if (fdp_piece_decode(bytes, FDP_PIECE_HEAD + 5, &piece_out))
			continue;
		assert_int_equal(fdp_piece_encode(&piece_out, again, sizeof again), FDP_PIECE_HEAD);
		assert_memory_equal(bytes, again, FDP_PIECE_HEAD);
	}
	len = fdp_lack_encode(&lack, bytes, sizeof bytes);
	assert_int_equal(len, 26);
	for (size_t n = 0; n < sizeof bytes; n++) {
		uint8_t *exact = unit_copy(bytes, n);

		assert_int_equal(fdp_lack_decode(exact, n, &lack_out), n == len ? GR_OK : GR_ERR_FORMAT);
		assert_int_equal(fdp_lack_encode(&lack, again, n < len ? n : len), n < len ? 0 : len);
		free(exact);
	}
	for (int i = 0; i < 20000; i++) {
		fdp_lack_encode(&lack, bytes, sizeof bytes);
		bytes[unit_random_u32(&r) % len] = (uint8_t)unit_random_u32(&r);
		if (fdp_lack_decode(bytes, len, &lack_out))
			continue;
		assert_int_equal(fdp_lack_encode(&lack_out, again, sizeof again), len);
		assert_memory_equal(bytes, again, len);
	}
}

/* Nodes come and go while datagrams get lost: all end with the same light. */
static void storm(void **state)
{
	struct unit_random seeds = unit_random_start("share storm");
	const uint64_t seed = unit_random_u32(&seeds);
	const unsigned rounds = getenv("GROTTO_LONG") ? 200 : 12;

	(void)state;
	for (unsigned round = 0; round < rounds; round++) {
		const size_t nodes = 2 + round % 6;
		struct room room;
		struct sim *s = &room.sim;

		room_init(&room, nodes, 9000, seed + round);
		s->loss = 0.03;
		s->duplicate = 0.02;
		s->jitter_ns = 300000;
		s->multicast = round & 1;
		s->datagram_max = round & 2 ? FDP_DATAGRAM_MIN : 1472;
		sim_start_all(s);
		for (int step = 0; step < 20; step++) {
			struct sim_node *n = &s->nodes[unit_random_u32(&s->random) % nodes];
			const uint32_t what = unit_random_u32(&s->random) % 10;

			sim_run_frames(s, 1 + unit_random_u32(&s->random) % 8);
			if (what < 4 && n->node) {
				sim_kill_node(s, n->index);
				memset(&room.lights[n->index], 0, sizeof *room.lights);
			} else if (what < 8 && !n->node) {
				sim_start_node(s, n->index);
			} else if (what == 8) {
				n->cut = !n->cut;
			} else if (what == 9) {
				sim_kill_master(s);
				sim_start_master(s);
				memset(room.made, 0, sizeof room.made);
			}
		}
		for (size_t i = 0; i < nodes; i++) {
			s->nodes[i].cut = false;
			if (!s->nodes[i].node)
				sim_start_node(s, (int)i);
		}
		s->loss = s->duplicate = 0;
		sim_run_ns(s, 1000 * SIM_MS);
		sim_run_frames(s, 60);
		s->loss = 0.03;
		sim_run_frames(s, 10);
		room.still_after = s->frame;
		sim_run_frames(s, 60);
		assert_same_light(&room);
		sim_finish(s);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bodies),	  cmocka_unit_test(weather),
		cmocka_unit_test(still_room),	  cmocka_unit_test(dies_and_returns),
		cmocka_unit_test(the_last_is_not_lost), cmocka_unit_test(bulk_is_paced), cmocka_unit_test(hostile),
		cmocka_unit_test(not_shared),	  cmocka_unit_test(storm),
	};

	if (getenv("GROTTO_TEST_FILTER"))
		cmocka_set_test_filter(getenv("GROTTO_TEST_FILTER"));
	return cmocka_run_group_tests(tests, NULL, NULL);
}
