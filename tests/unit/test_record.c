/* Session records: what is written is read; full rings, locks, limits and foreign files. */
#include "tests/unit/record_files.h"

#include "base/clock.h"
#include "base/result.h"
#include "record/ring.h"

#include <pthread.h>
#include <sched.h>
#include <sys/stat.h>
#include <unistd.h>

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

static void what_is_recorded_is_read(void **state)
{
	struct record_maker m;
	struct record_player_counts counts;
	struct record_damage damage;
	struct record_survey s[3];
	char path[RECORDING_PATH_BYTES];

	(void)state;
	record_maker_init(&m, 60, unit_random_start("recording"));
	recording_make(&m, recording_path("a.rec", path), 300, true);
	assert_int_equal(recording_play(&m, path, &counts, &damage), 300);
	assert_int_equal(counts.missing + counts.wrong + damage.bytes + damage.tail, 0);
	assert_int_equal(recording_survey(path, s, &damage), GR_OK);
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
static void reading_can_begin_in_the_middle(void **state)
{
	const struct record_player_params params = { 1, 2 * GR_NS_PER_S };
	struct gr_diag diag = { 0 };
	struct record_player *player;
	struct record_play play;
	struct record_maker m;
	char path[RECORDING_PATH_BYTES];

	(void)state;
	record_maker_init(&m, 60, unit_random_start("middle"));
	recording_make(&m, recording_path("m.rec", path), 300, true);
	assert_int_equal(record_player_open(&player, path, &params, &diag), GR_OK);
	assert_int_equal(record_player_next(player, m.state, &play), GR_OK);
	assert_int_equal(play.frame, 121);
	assert_true(play.jumps);
	record_player_destroy(&player);
	record_maker_finish(&m);
	unlink(path);
}

/* A second recording in a file whose first was torn. */
static void recordings_follow_each_other(void **state)
{
	struct record_maker m, n;
	struct record_damage damage;
	struct record_survey s[3];
	char path[RECORDING_PATH_BYTES];
	struct recording_bytes b;

	(void)state;
	record_maker_init(&m, 20, unit_random_start("append"));
	record_maker_init(&n, 20, m.random);
	recording_make(&m, recording_path("two.rec", path), 100, false);
	b = recording_load(path);
	recording_save(path, b.bytes, b.len - RECORD_END_BYTES - RECORD_HEAD_BYTES - 17);
	free(b.bytes);
	recording_make(&n, path, 50, true);
	assert_int_equal(recording_survey(path, s, &damage), GR_OK);
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
	char path[RECORDING_PATH_BYTES];
	uint64_t lost;

	(void)state;
	params.ring_bytes = 1 << 15;
	params.flush_ns = 300 * GR_NS_PER_MS;
	record_maker_init(&m, 1000, unit_random_start("full"));
	assert_int_equal(record_writer_create(&w, &params), GR_OK);
	assert_int_equal(record_writer_start(w, recording_path("full.rec", path), &m.session), GR_OK);
	writer_await(w, RECORD_WRITER_RUNNING, &status);
	for (int i = 0; i < 200; i++)
		record_maker_frame(&m, record_maker_to_writer, w);
	pause_ms(450);
	for (int i = 0; i < 20; i++)
		record_maker_frame(&m, record_maker_to_writer, w);
	record_writer_status(w, &status);
	lost = status.lost;
	record_writer_destroy(&w);
	assert_true(lost > 0);
	assert_int_equal(recording_survey(path, s, &damage), GR_OK);
	assert_int_equal(s[0].lost, lost);
	assert_int_equal(s[0].end.lost, lost);
	assert_int_equal(s[0].end.reason, RECORD_END_MASTER);
	assert_int_equal(s[0].frames + s[0].lost_frames, 220);
	assert_int_equal(recording_play(&m, path, &counts, &damage), s[0].frames - s[0].frames_unusable);
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
	struct record_writer_params params = quick_writer();
	struct record_writer_status status;
	struct record_writer *w;
	struct record_maker m;
	char path[RECORDING_PATH_BYTES], text[16] = { 0 };
	FILE *file;

	(void)state;
	params.hint = "write below /right";
	record_maker_init(&m, 10, (struct unit_random){ 1 });
	recording_save(recording_path("notes.txt", path), "dear diary", 10);
	assert_int_equal(record_writer_create(&w, &params), GR_OK);
	assert_int_equal(record_writer_stop(w, RECORD_END_ASKED), GR_ERR_STATE);
	assert_int_equal(record_writer_start(w, path, &m.session), GR_OK);
	writer_await(w, RECORD_WRITER_IDLE, &status);
	assert_non_null(strstr(status.error, "holds no recording"));
	file = fopen(path, "r");
	assert_true(file && fread(text, 1, sizeof text, file) == 10);
	fclose(file);
	assert_int_equal(record_writer_start(w, recording_folder(), &m.session), GR_OK);
	writer_await(w, RECORD_WRITER_IDLE, &status);
	assert_string_not_equal(status.error, "");
	assert_int_equal(record_writer_start(w, "/nowhere/at/all.rec", &m.session), GR_OK);
	writer_await(w, RECORD_WRITER_IDLE, &status);
	assert_non_null(strstr(status.error, "write below /right"));
	assert_false(record_writer_runs(w));
	record_writer_destroy(&w);
	record_maker_finish(&m);
	unlink(path);
}

/* Two at once into one file, and a file that is full. */
static void files_are_locked_and_bounded(void **state)
{
	struct record_writer_params params = quick_writer();
	struct record_writer_status status;
	struct record_writer *w, *other;
	struct record_damage damage;
	struct record_survey s[3];
	struct record_maker m;
	struct stat file;
	char path[RECORDING_PATH_BYTES];

	(void)state;
	params.limit_bytes = 50000;
	record_maker_init(&m, 10, unit_random_start("bounds"));
	assert_int_equal(record_writer_create(&w, &params), GR_OK);
	assert_int_equal(record_writer_create(&other, &params), GR_OK);
	assert_int_equal(record_writer_start(w, recording_path("b.rec", path), &m.session), GR_OK);
	writer_await(w, RECORD_WRITER_RUNNING, &status);
	assert_int_equal(record_writer_start(w, path, &m.session), GR_ERR_STATE);
	assert_int_equal(record_writer_start(other, path, &m.session), GR_OK);
	writer_await(other, RECORD_WRITER_IDLE, &status);
	assert_non_null(strstr(status.error, "another recording"));
	while (record_writer_runs(w)) {
		record_maker_frame(&m, record_maker_to_writer, w);
		pause_ms(1);
	}
	writer_await(w, RECORD_WRITER_IDLE, &status);
	assert_int_equal(stat(path, &file), 0);
	assert_true(file.st_size <= 50000 && file.st_size > 40000);
	assert_int_equal(recording_survey(path, s, &damage), GR_OK);
	assert_int_equal(s[0].end.reason, RECORD_END_SIZE);
	record_writer_destroy(&w);
	record_writer_destroy(&other);
	record_maker_finish(&m);
	unlink(path);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(ring_keeps_order_between_threads),
		cmocka_unit_test(what_is_recorded_is_read),
		cmocka_unit_test(reading_can_begin_in_the_middle),
		cmocka_unit_test(recordings_follow_each_other),
		cmocka_unit_test(a_full_ring_loses_and_says_so),
		cmocka_unit_test(what_is_no_recording_is_left_alone),
		cmocka_unit_test(files_are_locked_and_bounded),
	};

	return cmocka_run_group_tests(tests, recording_folder_make, recording_folder_remove);
}
