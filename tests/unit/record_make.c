#include "tests/unit/record_make.h"

#include "base/result.h"
#include "protocol/state.h"

void record_maker_init(struct record_maker *m, unsigned whole_every, struct unit_random random)
{
	memset(m, 0, sizeof *m);
	m->session = (struct record_session){
		.protocol = 2, .session = 77, .table_hash = param_table_hash(),
		.wall_ns = INT64_C(1700000000000000000), .start_ns = MAKE_START_NS,
		.zero_ns = MAKE_START_NS, .frame_hz = 60,
		.grotto = "test", .layout = "room", .scene = "cell",
		.layout_path = "/a/room.cave", .scene_path = "/a/cell.scene",
		.node_count = 2, .tracker_count = 1,
		.nodes = { "front", "floor" }, .trackers = { "visitor" },
	};
	m->whole_every = whole_every;
	m->random = random;
	assert_int_equal(param_state_create(&m->state), GR_OK);
	m->hash = param_state_hash(m->state, 0);
}

void record_maker_finish(struct record_maker *m)
{
	param_state_destroy(&m->state);
}

static void change_state(struct record_maker *m)
{
	float place[3];
	uint64_t time_ns = m->frame * (uint64_t)MAKE_FRAME_NS;

	for (int i = 0; i < 3; i++)
		place[i] = (float)unit_random_range(&m->random, -2, 2);
	assert_int_equal(param_set(m->state, PARAM_FRAME_TIME, &time_ns, m->frame), GR_OK);
	param_set(m->state, PARAM_HEAD_POSITION, place, m->frame);
	if (m->frame % 3 == 0)
		param_set(m->state, PARAM_WAND_POSITION, place, m->frame);
	if (m->frame % 50 == 0)
		param_set(m->state, PARAM_EXPOSURE, &(float){ 0.5f + (float)(m->frame % 7) }, m->frame);
}

static void put_frame(struct record_maker *m, int64_t now_ns, record_maker_put put, void *ctx)
{
	uint8_t delta[PARAM_DELTA_MAX];
	const bool whole = m->need_whole || (m->frame - 1) % m->whole_every == 0;
	struct record_entry e = { .kind = whole ? RECORD_STATE : RECORD_DELTA, .time_ns = now_ns };
	const uint64_t before = m->hash;
	long len = param_delta_encode(m->state, whole ? 0 : m->frame - 1, delta, sizeof delta);

	assert_true(len > 0);
	m->hash = param_state_hash(m->state, before);
	if (m->frame < MAKE_FRAMES_MAX)
		m->hashes[m->frame] = m->hash;
	e.frame = (struct record_frame){ m->frame, m->frame - 1, m->hash, before, 3, delta, (size_t)len };
	m->need_whole = !put(ctx, &e);
}

void record_maker_frame(struct record_maker *m, record_maker_put put, void *ctx)
{
	const int64_t now_ns = MAKE_START_NS + (int64_t)++m->frame * MAKE_FRAME_NS;
	struct record_entry e = { .kind = RECORD_SAMPLE, .time_ns = now_ns };
	const float *head;

	change_state(m);
	head = param_f32(m->state, PARAM_HEAD_POSITION);
	for (uint8_t body = 0; body < 2; body++) {
		e.sample = (struct record_sample){
			.body = body, .flags = RECORD_VALID | RECORD_TAKEN, .axis_count = body,
			.time_ns = (int64_t)m->frame * MAKE_FRAME_NS,
			.T_room_body = { { head[0], head[1], head[2] }, { 0, 0, 0, 1 } },
			.buttons = body, .axes = { 0.25f },
		};
		put(ctx, &e);
	}
	put_frame(m, now_ns, put, ctx);
	for (uint8_t node = 0; node < 2; node++) {
		e = (struct record_entry){ .kind = RECORD_REPORT, .time_ns = now_ns + 1000 * (node + 1) };
		e.report = (struct record_report){ .node = node, .kind = 9, .frame = m->frame, .hash = m->hash,
						   .swapped_frame = m->frame - 1, .swapped_count = m->frame - 1,
						   .swap_ns = now_ns - 500 * node, .render_us = 100 };
		put(ctx, &e);
	}
	for (uint8_t node = 0; node < 2 && m->frame > 1; node++) {
		e = (struct record_entry){ .kind = RECORD_SHOWN, .time_ns = now_ns };
		e.shown = (struct record_shown){ node, m->frame - 1, now_ns - 500 * node, now_ns - 250 * node };
		put(ctx, &e);
	}
	e = (struct record_entry){ .kind = RECORD_SWAP, .time_ns = now_ns + 5000, .swap = { m->frame, 0 } };
	put(ctx, &e);
	if (m->frame == 1) {
		e = (struct record_entry){ .kind = RECORD_EVENT, .time_ns = now_ns };
		e.event = (struct record_event){ .kind = RECORD_JOINED, .node = 1, .text = "said \"so\", once" };
		put(ctx, &e);
	}
}

bool record_maker_to_writer(void *writer, const struct record_entry *entry)
{
	return record_writer_put(writer, entry);
}
