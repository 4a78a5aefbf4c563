/* Session records: what is written is read, and damage costs what it hits. */
#include "tests/unit/record_make.h"

#include "base/clock.h"
#include "base/result.h"
#include "protocol/state.h"
#include "record/csv.h"
#include "record/player.h"
#include "record/ring.h"
#include "record/survey.h"

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static char dir[64];

static int make_dir(void **state)
{
	(void)state;
	strcpy(dir, "/tmp/grotto-record-XXXXXX");
	return mkdtemp(dir) ? 0 : -1;
}

static int remove_dir(void **state)
{
	(void)state;
	return rmdir(dir);
}

static const char *path_of(const char *name, char out[96])
{
	snprintf(out, 96, "%s/%s", dir, name);
	return out;
}

static void pause_ms(long ms)
{
	const struct timespec t = { ms / 1000, ms % 1000 * 1000000 };

	nanosleep(&t, NULL);
}

static struct record_writer_params quick(void)
{
	struct record_writer_params params = RECORD_WRITER_DEFAULTS;

	params.flush_ns = GR_NS_PER_MS;
	return params;
}

static void await_state(struct record_writer *w, enum record_writer_state state,
			struct record_writer_status *out)
{
	for (int i = 0; i < 10000; i++) {
		record_writer_status(w, out);
		if (out->state == state)
			return;
		pause_ms(1);
	}
	fail_msg("the writer is %s, not %s", record_writer_state_name(out->state),
		 record_writer_state_name(state));
}

/* A recording of so many frames; the blocks are as the writer's thread happens to wake. */
static void make_recording(struct record_maker *m, const char *path, unsigned frames, bool end)
{
	struct record_writer_params params = quick();
	struct record_writer_status status;
	struct record_writer *w;

	assert_int_equal(record_writer_create(&w, &params), GR_OK);
	assert_int_equal(record_writer_start(w, path, &m->session), GR_OK);
	await_state(w, RECORD_WRITER_RUNNING, &status);
	for (unsigned i = 0; i < frames; i++) {
		record_maker_frame(m, record_maker_to_writer, w);
		if (i % 10 == 9)
			pause_ms(1);
	}
	if (end)
		assert_int_equal(record_writer_stop(w, RECORD_END_ASKED), GR_OK);
	if (end)
		await_state(w, RECORD_WRITER_IDLE, &status);
	assert_string_equal(status.error, "");
	assert_int_equal(status.lost, 0);
	record_writer_destroy(&w);
}

struct bytes {
	uint8_t *bytes;
	size_t len;
};

static struct bytes load(const char *path)
{
	struct bytes b = { NULL, 0 };
	struct stat status;
	int fd = open(path, O_RDONLY);

	assert_true(fd >= 0 && fstat(fd, &status) == 0);
	b.len = (size_t)status.st_size;
	b.bytes = malloc(b.len);
	assert_true(read(fd, b.bytes, b.len) == status.st_size);
	close(fd);
	return b;
}

static void save(const char *path, const void *bytes, size_t len)
{
	int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);

	assert_true(fd >= 0 && write(fd, bytes, len) == (ssize_t)len);
	close(fd);
}

/* Plays a file: how many frames it gives; each must be as made. */
static unsigned play(const struct record_maker *m, const char *path,
		     struct record_player_counts *out, struct record_damage *out_damage)
{
	const struct record_player_params params = { .recording = 1 };
	struct gr_diag diag = { 0 };
	struct record_player *player;
	struct param_state *state;
	struct record_play play;
	unsigned frames = 0;
	uint64_t last = 0;

	memset(out, 0, sizeof *out);
	memset(out_damage, 0, sizeof *out_damage);
	assert_int_equal(param_state_create(&state), GR_OK);
	if (record_player_open(&player, path, &params, &diag) == GR_OK) {
		while (record_player_next(player, state, &play) == GR_OK) {
			assert_true(play.frame > last && play.frame <= m->frame);
			assert_int_equal(play.hash, m->hashes[play.frame]);
			assert_int_equal(param_state_hash(state, play.previous_hash), play.hash);
			assert_int_equal(play.jumps, play.frame != last + 1 || last == 0);
			last = play.frame;
			frames++;
		}
		record_player_counts(player, out);
		record_player_damage(player, out_damage);
		record_player_destroy(&player);
	} else {
		assert_true(diag.errors > 0);
	}
	gr_diag_finish(&diag);
	param_state_destroy(&state);
	return frames;
}

static struct record_entry random_entry(struct unit_random *r, uint8_t *delta, size_t delta_len)
{
	struct record_entry e = { .kind = RECORD_SAMPLE + (enum record_entry_kind)(unit_random_u32(r) % 8),
				  .time_ns = unit_random_u32(r) };

	switch (e.kind) {
	case RECORD_SAMPLE:
		e.sample = (struct record_sample){ .body = unit_random_u32(r) % 2, .flags = unit_random_u32(r) % 4,
						   .axis_count = (uint8_t)(unit_random_u32(r) % 9), .time_ns = -5,
						   .T_room_body = GR_POSE_IDENTITY, .buttons = unit_random_u32(r) };
		for (int i = 0; i < e.sample.axis_count; i++)
			e.sample.axes[i] = (float)unit_random_range(r, -1, 1);
		break;
	case RECORD_STATE:
	case RECORD_DELTA:
		e.frame = (struct record_frame){ 9, 4, unit_random_u32(r), unit_random_u32(r), 3, delta, delta_len };
		delta[0] = e.kind == RECORD_STATE ? 0 : 4;
		break;
	case RECORD_REPORT:
		e.report = (struct record_report){ 1, 6, 3, unit_random_u32(r), 2, 8, -7, 1, unit_random_u32(r) };
		break;
	case RECORD_SWAP: e.swap = (struct record_swap){ 4, unit_random_u32(r) }; break;
	case RECORD_EVENT:
		e.event = (struct record_event){ RECORD_MISMATCH, RECORD_ALL_NODES, 3, 4, 5, "why" };
		break;
	case RECORD_LOST: e.lost = (struct record_lost){ 5, 2, 4 }; break;
	case RECORD_SHOWN: e.shown = (struct record_shown){ 1, 7, -5, unit_random_u32(r) }; break;
	}
	return e;
}

static void entries_come_back(void **state)
{
	struct unit_random r = unit_random_start("entries");
	struct record_maker m;
	uint8_t delta[64] = { 0 };
	uint8_t bytes[RECORD_ENTRY_MAX], again[RECORD_ENTRY_MAX];

	(void)state;
	record_maker_init(&m, 10, r);
	for (int i = 0; i < 2000; i++) {
		struct record_entry e = random_entry(&r, delta, 10 + unit_random_u32(&r) % 50), back;
		size_t len = record_entry_encode(&e, bytes, sizeof bytes);
		struct gr_reader reader = gr_reader(bytes, len);

		assert_true(len > RECORD_ENTRY_HEAD);
		assert_true(record_entry_decode(&reader, &m.session, &back) && gr_reader_done(&reader));
		assert_int_equal(record_entry_encode(&back, again, sizeof again), len);
		assert_memory_equal(bytes, again, len);
		for (size_t cut = 0; cut < len; cut++) {
			uint8_t *copy = unit_copy(bytes, cut);
			reader = gr_reader(copy, cut);
			assert_false(record_entry_decode(&reader, &m.session, &back));
			assert_int_equal(record_entry_encode(&e, copy, cut), 0);
			free(copy);
		}
	}
	record_maker_finish(&m);
}

static void fields_are_checked(void **state)
{
	static const struct { struct record_entry e; const char *what; } bad[] = {
		{ { RECORD_SAMPLE, 1, { .sample = { .tracker = 1 } } }, "tracker" },
		{ { RECORD_SAMPLE, 1, { .sample = { .body = 2 } } }, "body" },
		{ { RECORD_SAMPLE, 1, { .sample = { .flags = 4 } } }, "flags" },
		{ { RECORD_SAMPLE, 1, { .sample = { .flags = 3 } } }, "pose" },
		{ { RECORD_SWAP, -1, { .swap = { 1, 0 } } }, "time" },
		{ { RECORD_SWAP, 1, { .swap = { 0, 0 } } }, "frame 0" },
		{ { RECORD_REPORT, 1, { .report = { .node = 2, .kind = 6 } } }, "node" },
		{ { RECORD_REPORT, 1, { .report = { .node = 1, .kind = 7 } } }, "kind" },
		{ { RECORD_EVENT, 1, { .event = { .kind = 8 } } }, "event" },
		{ { RECORD_EVENT, 1, { .event = { .kind = 1, .text = "\033[2J" } } }, "text" },
		{ { RECORD_LOST, 1, { .lost = { 1, 2, 0 } } }, "frames" },
		{ { RECORD_SHOWN, 1, { .shown = { 2, 1, 0, 0 } } }, "node" },
	};
	struct record_maker m;
	uint8_t bytes[RECORD_ENTRY_MAX];

	(void)state;
	record_maker_init(&m, 10, (struct unit_random){ 1 });
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct gr_reader reader;
		struct record_entry back;
		size_t len = record_entry_encode(&bad[i].e, bytes, sizeof bytes);

		reader = gr_reader(bytes, len);
		if (!len || record_entry_decode(&reader, &m.session, &back))
			fail_msg("took a wrong %s", bad[i].what);
	}
	record_maker_finish(&m);
}

static void session_comes_back(void **state)
{
	struct record_session back;
	struct record_maker m;
	uint8_t bytes[RECORD_SESSION_MAX], again[RECORD_SESSION_MAX];
	size_t len;

	(void)state;
	record_maker_init(&m, 10, (struct unit_random){ 1 });
	len = record_session_encode(&m.session, bytes, sizeof bytes);
	assert_int_equal(record_session_decode(bytes, len, &back), GR_OK);
	assert_int_equal(record_session_encode(&back, again, sizeof again), len);
	assert_memory_equal(bytes, again, len);
	for (size_t cut = 0; cut < len; cut++) {
		uint8_t *copy = unit_copy(bytes, cut);
		assert_int_equal(record_session_decode(copy, cut, &back), GR_ERR_FORMAT);
		free(copy);
	}
	record_maker_finish(&m);
}

/* Every bit of a block counts. */
static void a_flipped_bit_is_seen(void **state)
{
	struct record_head head = { .kind = RECORD_END, .len = RECORD_END_BYTES, .recording = 5, .sequence = 3 };
	const struct record_end end = { RECORD_END_ASKED, 10, 0 };
	uint8_t bytes[RECORD_HEAD_BYTES + RECORD_END_BYTES], again[RECORD_HEAD_BYTES];
	struct record_head back;

	(void)state;
	record_end_encode(&end, bytes + RECORD_HEAD_BYTES);
	record_head_sum(&head, bytes + RECORD_HEAD_BYTES);
	record_head_encode(&head, bytes);
	assert_int_equal(record_head_decode(bytes, &back), GR_OK);
	record_head_encode(&back, again);
	assert_memory_equal(again, bytes, sizeof again);
	for (size_t bit = 0; bit < 8 * sizeof bytes; bit++) {
		bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
		assert_false(record_head_decode(bytes, &back) == GR_OK &&
			     record_payload_sound(&back, bytes + RECORD_HEAD_BYTES));
		bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
	}
}

struct pair {
	struct record_ring ring;
	uint32_t count;
};

static void *put_all(void *arg)
{
	struct pair *p = arg;
	uint32_t words[32];

	for (uint32_t i = 0; i < p->count;) {
		const uint32_t n = 1 + i % 31;
		for (uint32_t k = 0; k < n; k++)
			words[k] = i;
		if (record_ring_put(&p->ring, words, 4 * n - i % 3))
			i++;
		else
			sched_yield();
	}
	return NULL;
}

static void ring_keeps_order_between_threads(void **state)
{
	struct pair p = { .count = 100000 };
	pthread_t thread;
	uint32_t len;

	(void)state;
	assert_int_equal(record_ring_init(&p.ring, 100), GR_ERR_RANGE);
	assert_int_equal(record_ring_init(&p.ring, 1024), GR_OK);
	assert_int_equal(pthread_create(&thread, NULL, put_all, &p), 0);
	for (uint32_t i = 0; i < p.count;) {
		const uint8_t *got = record_ring_peek(&p.ring, &len);
		uint32_t word;
		if (!got) {
			sched_yield();
			continue;
		}
		assert_int_equal(len, 4 * (1 + i % 31) - i % 3);
		memcpy(&word, got, 4);
		if (len >= 4)
			assert_int_equal(word, i);
		record_ring_drop(&p.ring);
		i++;
	}
	pthread_join(thread, NULL);
	assert_null(record_ring_peek(&p.ring, &len));
	record_ring_finish(&p.ring);
}

static void on_survey(void *ctx, const struct record_survey *s)
{
	struct record_survey *all = ctx; /* room for three */

	for (int i = 0; i < 3; i++)
		if (all[i].blocks == 0) {
			all[i] = *s;
			return;
		}
}

static int survey(const char *path, struct record_survey out[3], struct record_damage *damage)
{
	struct gr_diag diag = { 0 };
	struct record_reader *reader;
	int r = record_reader_open(&reader, path, &diag);

	memset(out, 0, 3 * sizeof *out);
	gr_diag_finish(&diag);
	assert_int_equal(r, GR_OK);
	r = record_survey(reader, on_survey, out);
	record_reader_damage(reader, damage);
	record_reader_destroy(&reader);
	return r;
}

static void what_is_recorded_is_read(void **state)
{
	struct record_maker m;
	struct record_player_counts counts;
	struct record_damage damage;
	struct record_survey s[3];
	char path[96];

	(void)state;
	record_maker_init(&m, 60, unit_random_start("recording"));
	make_recording(&m, path_of("a.rec", path), 300, true);
	assert_int_equal(play(&m, path, &counts, &damage), 300);
	assert_int_equal(counts.missing + counts.wrong + damage.bytes + damage.tail, 0);
	assert_int_equal(survey(path, s, &damage), GR_OK);
	assert_true(s[0].ended && s[0].end.reason == RECORD_END_ASKED && s[0].states_known);
	assert_int_equal(s[0].frames, 300);
	assert_int_equal(s[0].wholes, 5);
	assert_int_equal(s[0].frames_missing + s[0].frames_wrong + s[0].frames_unusable, 0);
	assert_int_equal(s[0].samples[0], 600);
	assert_int_equal(s[0].reports[0], 300);
	assert_int_equal(s[0].swaps, 300);
	assert_int_equal(s[0].events[RECORD_JOINED], 1);
	assert_int_equal(s[0].end.entries, 300 * 8 - 2 + 1);
	assert_int_equal(s[0].shown[1], 299);
	assert_string_equal(s[0].session.nodes[1], "floor");
	assert_int_equal(s[0].rules.equal, 600);
	assert_int_equal(s[0].rules.different + s[0].rules.early + s[0].rules.back, 0);
	assert_int_equal(s[1].blocks, 0);
	record_maker_finish(&m);
	unlink(path);
}

/* Replay from the middle: the first whole state after the time. */
static void note_frame(struct record_rules *rules, uint64_t frame, uint64_t live)
{
	const struct record_entry e = { .kind = RECORD_STATE, .frame = { .frame = frame, .hash = frame + 7, .live = live } };

	record_rules_note(rules, &e);
}

static void note_ready(struct record_rules *rules, uint8_t node, uint64_t frame, uint64_t hash)
{
	const struct record_entry e = { .kind = RECORD_REPORT,
					.report = { .node = node, .kind = 9, .frame = frame, .hash = hash } };

	record_rules_note(rules, &e);
}

static void note_event(struct record_rules *rules, uint8_t kind, uint8_t node, uint64_t frame)
{
	const struct record_entry e = { .kind = RECORD_EVENT, .event = { .kind = kind, .node = node, .frame = frame } };

	record_rules_note(rules, &e);
}

static void note_swap(struct record_rules *rules, uint64_t frame)
{
	const struct record_entry e = { .kind = RECORD_SWAP, .swap = { frame, 0 } };

	record_rules_note(rules, &e);
}

/* Each rule is seen broken, and what excuses it. */
static void rules_are_judged(void **state)
{
	struct record_rules r = { 0 };

	(void)state;
	note_frame(&r, 1, 7);
	note_ready(&r, 0, 1, 8);
	note_ready(&r, 0, 1, 8);
	note_event(&r, RECORD_LATE, 1, 1);
	note_event(&r, RECORD_LEFT, 2, 0);
	note_swap(&r, 1);
	assert_int_equal(r.equal, 1);
	assert_int_equal(r.different + r.early + r.back, 0);
	note_frame(&r, 2, 3);
	note_ready(&r, 0, 2, 9);
	note_event(&r, RECORD_LATE, 1, 1); /* of another frame */
	note_swap(&r, 2);
	assert_int_equal(r.early, 1);
	note_ready(&r, 1, 2, 1);
	assert_int_equal(r.different, 1);
	note_swap(&r, 2);
	assert_int_equal(r.back, 1);
	note_frame(&r, 3, 3);
	record_rules_gap(&r);
	note_swap(&r, 3); /* nobody knows who was ready */
	assert_int_equal(r.back, 1);
	assert_int_equal(r.early, 2); /* the second SWAP of frame 2 as well */
}

static void reading_can_begin_in_the_middle(void **state)
{
	const struct record_player_params params = { 1, 2 * GR_NS_PER_S };
	struct gr_diag diag = { 0 };
	struct record_player *player;
	struct record_play play;
	struct record_maker m;
	char path[96];

	(void)state;
	record_maker_init(&m, 60, unit_random_start("middle"));
	make_recording(&m, path_of("m.rec", path), 300, true);
	assert_int_equal(record_player_open(&player, path, &params, &diag), GR_OK);
	assert_int_equal(record_player_next(player, m.state, &play), GR_OK);
	assert_int_equal(play.frame, 121);
	assert_true(play.jumps);
	record_player_destroy(&player);
	record_maker_finish(&m);
	unlink(path);
}

static bool forget(void *ctx, const struct record_entry *entry)
{
	(void)ctx;
	(void)entry;
	return true;
}

/* The writer's process dies in mid-sentence: all but the last moment is there. */
static void a_killed_writer_costs_the_last_moment(void **state)
{
	struct record_player_counts counts;
	struct record_damage damage;
	struct record_maker m, again;
	char path[96];
	int put[2];
	uint32_t flushed = 0;
	unsigned frames;
	pid_t child;

	(void)state;
	record_maker_init(&m, 60, (struct unit_random){ 12345 });
	path_of("killed.rec", path);
	assert_int_equal(pipe(put), 0);
	child = fork();
	if (child == 0) {
		struct record_writer_params params = quick();
		struct record_writer_status status = { 0 };
		struct record_writer *w;

		if (record_writer_create(&w, &params) || record_writer_start(w, path, &m.session))
			_exit(1);
		while (status.state != RECORD_WRITER_RUNNING)
			record_writer_status(w, &status);
		for (;;) {
			record_maker_frame(&m, record_maker_to_writer, w);
			pause_ms(1);
			record_writer_status(w, &status);
			flushed = (uint32_t)(status.entries / 8); /* frames wholly in the file */
			if (write(put[1], &flushed, sizeof flushed) < 0)
				_exit(1);
		}
	}
	close(put[1]);
	for (int i = 0; i < 200; i++)
		assert_int_equal(read(put[0], &flushed, sizeof flushed), sizeof flushed);
	kill(child, SIGKILL);
	waitpid(child, NULL, 0);
	while (read(put[0], &flushed, sizeof flushed) == sizeof flushed)
		;
	close(put[0]);
	/* The same session made here, for its hashes. */
	record_maker_init(&again, 60, (struct unit_random){ 12345 });
	for (int i = 0; i < 1000; i++)
		record_maker_frame(&again, forget, NULL);
	frames = play(&again, path, &counts, &damage);
	printf("# killed: %u frames were said to be written, %u are read, tail of %llu bytes\n", flushed,
	       frames, (unsigned long long)damage.tail);
	assert_true(flushed > 100 && frames >= flushed);
	assert_int_equal(counts.missing + counts.wrong + damage.bad + damage.bytes, 0);
	record_maker_finish(&again);
	record_maker_finish(&m);
	unlink(path);
}

/* One byte anywhere: nothing wrong is played, and about a second is lost at most. */
static void damage_costs_little(void **state)
{
	struct unit_random r = unit_random_start("damage");
	struct record_player_counts counts;
	struct record_damage damage;
	struct record_maker m;
	unsigned worst = 0, hits = 0;
	char path[96], other[96];
	struct bytes b;

	(void)state;
	record_maker_init(&m, 60, r);
	make_recording(&m, path_of("d.rec", path), 600, true);
	b = load(path);
	path_of("e.rec", other);
	for (int i = 0; i < 150; i++) {
		const size_t at = (size_t)unit_random_range(&r, 0, (double)b.len);
		const uint8_t was = b.bytes[at];
		unsigned frames;

		b.bytes[at] ^= (uint8_t)(1 + unit_random_u32(&r) % 255);
		save(other, b.bytes, b.len);
		frames = play(&m, other, &counts, &damage);
		if (at >= 2000) {
			worst = 600 - frames > worst ? 600 - frames : worst;
			hits += frames < 600;
		}
		assert_int_equal(counts.wrong, 0);
		b.bytes[at] = was;
	}
	printf("# one byte of %zu damaged, 150 times: %u cost frames, at most %u of 600\n", b.len, hits, worst);
	assert_true(hits > 0 && worst <= 60 + 30);
	free(b.bytes);
	record_maker_finish(&m);
	unlink(path);
	unlink(other);
}

static void every_cut_is_read_up_to_the_last_block(void **state)
{
	struct unit_random r = unit_random_start("cuts");
	struct record_player_counts counts;
	struct record_damage damage;
	struct record_maker m;
	char path[96], other[96];
	unsigned last = 0;
	struct bytes b;

	(void)state;
	record_maker_init(&m, 20, r);
	make_recording(&m, path_of("c.rec", path), 60, true);
	b = load(path);
	path_of("cut.rec", other);
	for (size_t len = 1; len <= b.len; len += 1 + unit_random_u32(&r) % 97) {
		unsigned frames;
		save(other, b.bytes, len);
		frames = play(&m, other, &counts, &damage);
		assert_true(frames >= last && frames <= 60);
		assert_int_equal(counts.missing + counts.wrong, 0);
		last = frames;
	}
	assert_true(last >= 50);
	free(b.bytes);
	record_maker_finish(&m);
	unlink(path);
	unlink(other);
}

/* A second recording in a file whose first was torn. */
static void recordings_follow_each_other(void **state)
{
	struct record_maker m, n;
	struct record_damage damage;
	struct record_survey s[3];
	char path[96];
	struct bytes b;

	(void)state;
	record_maker_init(&m, 20, unit_random_start("append"));
	record_maker_init(&n, 20, m.random);
	make_recording(&m, path_of("two.rec", path), 100, false);
	b = load(path);
	save(path, b.bytes, b.len - RECORD_END_BYTES - RECORD_HEAD_BYTES - 17);
	free(b.bytes);
	make_recording(&n, path, 50, true);
	assert_int_equal(survey(path, s, &damage), GR_OK);
	assert_false(s[0].ended);
	assert_true(s[1].ended);
	assert_int_equal(s[1].frames, 50);
	assert_true(s[0].frames < 100 && s[0].frames > 50);
	assert_true(damage.bytes > 0);
	assert_int_equal(s[1].gaps, 0);
	record_maker_finish(&m);
	record_maker_finish(&n);
	unlink(path);
}

/* More than the ring holds while the writer sleeps: counted, said, and whole again after. */
static void a_full_ring_loses_and_says_so(void **state)
{
	struct record_writer_params params = RECORD_WRITER_DEFAULTS;
	struct record_writer_status status;
	struct record_player_counts counts;
	struct record_damage damage;
	struct record_survey s[3];
	struct record_writer *w;
	struct record_maker m;
	char path[96];
	uint64_t lost;

	(void)state;
	params.ring_bytes = 1 << 15;
	params.flush_ns = 300 * GR_NS_PER_MS;
	record_maker_init(&m, 1000, unit_random_start("full"));
	assert_int_equal(record_writer_create(&w, &params), GR_OK);
	assert_int_equal(record_writer_start(w, path_of("full.rec", path), &m.session), GR_OK);
	await_state(w, RECORD_WRITER_RUNNING, &status);
	for (int i = 0; i < 200; i++)
		record_maker_frame(&m, record_maker_to_writer, w);
	pause_ms(450);
	for (int i = 0; i < 20; i++)
		record_maker_frame(&m, record_maker_to_writer, w);
	record_writer_status(w, &status);
	lost = status.lost;
	record_writer_destroy(&w);
	assert_true(lost > 0);
	assert_int_equal(survey(path, s, &damage), GR_OK);
	assert_int_equal(s[0].lost, lost);
	assert_int_equal(s[0].end.lost, lost);
	assert_int_equal(s[0].end.reason, RECORD_END_MASTER);
	assert_int_equal(s[0].frames + s[0].lost_frames, 220);
	assert_int_equal(play(&m, path, &counts, &damage), s[0].frames - s[0].frames_unusable);
	assert_int_equal(counts.wrong, 0);
	assert_true(counts.missing > 0);
	printf("# ring of 32 KiB: %llu entries lost, %llu of them frames; %llu frames played\n",
	       (unsigned long long)lost, (unsigned long long)s[0].lost_frames,
	       (unsigned long long)counts.frames);
	record_maker_finish(&m);
	unlink(path);
}

static void what_is_no_recording_is_left_alone(void **state)
{
	struct record_writer_params params = quick();
	struct record_writer_status status;
	struct record_writer *w;
	struct record_maker m;
	char path[96], text[16] = { 0 };
	FILE *file;

	(void)state;
	params.hint = "write below /right";
	record_maker_init(&m, 10, (struct unit_random){ 1 });
	save(path_of("notes.txt", path), "dear diary", 10);
	assert_int_equal(record_writer_create(&w, &params), GR_OK);
	assert_int_equal(record_writer_stop(w, RECORD_END_ASKED), GR_ERR_STATE);
	assert_int_equal(record_writer_start(w, path, &m.session), GR_OK);
	await_state(w, RECORD_WRITER_IDLE, &status);
	assert_non_null(strstr(status.error, "holds no recording"));
	file = fopen(path, "r");
	assert_true(file && fread(text, 1, sizeof text, file) == 10);
	fclose(file);
	assert_int_equal(record_writer_start(w, dir, &m.session), GR_OK);
	await_state(w, RECORD_WRITER_IDLE, &status);
	assert_string_not_equal(status.error, "");
	assert_int_equal(record_writer_start(w, "/nowhere/at/all.rec", &m.session), GR_OK);
	await_state(w, RECORD_WRITER_IDLE, &status);
	assert_non_null(strstr(status.error, "write below /right"));
	assert_false(record_writer_runs(w));
	record_writer_destroy(&w);
	record_maker_finish(&m);
	unlink(path);
}

/* Two at once into one file, and a file that is full. */
static void files_are_locked_and_bounded(void **state)
{
	struct record_writer_params params = quick();
	struct record_writer_status status;
	struct record_writer *w, *other;
	struct record_damage damage;
	struct record_survey s[3];
	struct record_maker m;
	struct stat file;
	char path[96];

	(void)state;
	params.limit_bytes = 50000;
	record_maker_init(&m, 10, unit_random_start("bounds"));
	assert_int_equal(record_writer_create(&w, &params), GR_OK);
	assert_int_equal(record_writer_create(&other, &params), GR_OK);
	assert_int_equal(record_writer_start(w, path_of("b.rec", path), &m.session), GR_OK);
	await_state(w, RECORD_WRITER_RUNNING, &status);
	assert_int_equal(record_writer_start(w, path, &m.session), GR_ERR_STATE);
	assert_int_equal(record_writer_start(other, path, &m.session), GR_OK);
	await_state(other, RECORD_WRITER_IDLE, &status);
	assert_non_null(strstr(status.error, "another recording"));
	while (record_writer_runs(w)) {
		record_maker_frame(&m, record_maker_to_writer, w);
		pause_ms(1);
	}
	await_state(w, RECORD_WRITER_IDLE, &status);
	assert_int_equal(stat(path, &file), 0);
	assert_true(file.st_size <= 50000 && file.st_size > 40000);
	assert_int_equal(survey(path, s, &damage), GR_OK);
	assert_int_equal(s[0].end.reason, RECORD_END_SIZE);
	record_writer_destroy(&w);
	record_writer_destroy(&other);
	record_maker_finish(&m);
	unlink(path);
}

static size_t columns(const char *line)
{
	bool quoted = false;
	size_t n = 1;

	for (; *line; line++) {
		quoted = quoted != (*line == '"');
		n += *line == ',' && !quoted;
	}
	return n;
}

static void check_tables(uint64_t table_hash)
{
	static const size_t lines_right[RECORD_TABLES] = { 201, 201, 201, 401, 2 };
	FILE *files[RECORD_TABLES];
	char *texts[RECORD_TABLES];
	size_t sizes[RECORD_TABLES];
	struct gr_diag diag = { 0 };
	struct record_reader *reader;
	struct record_maker m;
	char path[96];

	record_maker_init(&m, 60, unit_random_start("tables"));
	m.session.table_hash = table_hash;
	make_recording(&m, path_of("t.rec", path), 200, true);
	for (int i = 0; i < RECORD_TABLES; i++)
		files[i] = open_memstream(&texts[i], &sizes[i]);
	assert_int_equal(record_reader_open(&reader, path, &diag), GR_OK);
	assert_int_equal(record_csv_write(reader, 1, files), GR_OK);
	record_reader_destroy(&reader);
	assert_int_equal(record_reader_open(&reader, path, &diag), GR_OK);
	assert_int_equal(record_csv_write(reader, 2, (FILE *const[RECORD_TABLES]){ NULL }), GR_NOTHING);
	record_reader_destroy(&reader);
	for (int i = 0; i < RECORD_TABLES; i++) {
		size_t lines = 0, right = 0;
		fclose(files[i]);
		for (char *line = strtok(texts[i], "\n"); line; line = strtok(NULL, "\n"), lines++) {
			right = lines ? right : columns(line);
			assert_int_equal(columns(line), right);
		}
		assert_int_equal(lines, lines_right[i]);
		free(texts[i]);
	}
	record_maker_finish(&m);
	unlink(path);
}

static void tables_have_their_columns(void **state)
{
	(void)state;
	check_tables(param_table_hash());
	check_tables(1); /* of another grotto: the states cannot be known */
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(entries_come_back),
		cmocka_unit_test(fields_are_checked),
		cmocka_unit_test(session_comes_back),
		cmocka_unit_test(a_flipped_bit_is_seen),
		cmocka_unit_test(ring_keeps_order_between_threads),
		cmocka_unit_test(what_is_recorded_is_read),
		cmocka_unit_test(rules_are_judged),
		cmocka_unit_test(reading_can_begin_in_the_middle),
		cmocka_unit_test(a_killed_writer_costs_the_last_moment),
		cmocka_unit_test(damage_costs_little),
		cmocka_unit_test(every_cut_is_read_up_to_the_last_block),
		cmocka_unit_test(recordings_follow_each_other),
		cmocka_unit_test(a_full_ring_loses_and_says_so),
		cmocka_unit_test(what_is_no_recording_is_left_alone),
		cmocka_unit_test(files_are_locked_and_bounded),
		cmocka_unit_test(tables_have_their_columns),
	};

	return cmocka_run_group_tests(tests, make_dir, remove_dir);
}
