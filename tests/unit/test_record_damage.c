/* Session records that a death, a flipped byte or a cut has damaged: it costs what it hits. */
#include "tests/unit/record_files.h"

#include "base/result.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

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
	char path[RECORDING_PATH_BYTES];
	int put[2];
	uint32_t flushed = 0;
	unsigned frames;
	pid_t child;

	(void)state;
	record_maker_init(&m, 60, (struct unit_random){ 12345 });
	recording_path("killed.rec", path);
	assert_int_equal(pipe(put), 0);
	child = fork();
	if (child == 0) {
		struct record_writer_params params = quick_writer();
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
	frames = recording_play(&again, path, &counts, &damage);
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
	char path[RECORDING_PATH_BYTES], other[RECORDING_PATH_BYTES];
	struct recording_bytes b;

	(void)state;
	record_maker_init(&m, 60, r);
	recording_make(&m, recording_path("d.rec", path), 600, true);
	b = recording_load(path);
	recording_path("e.rec", other);
	for (int i = 0; i < 150; i++) {
		const size_t at = (size_t)unit_random_range(&r, 0, (double)b.len);
		const uint8_t was = b.bytes[at];
		unsigned frames;

		b.bytes[at] ^= (uint8_t)(1 + unit_random_u32(&r) % 255);
		recording_save(other, b.bytes, b.len);
		frames = recording_play(&m, other, &counts, &damage);
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
	char path[RECORDING_PATH_BYTES], other[RECORDING_PATH_BYTES];
	unsigned last = 0;
	struct recording_bytes b;

	(void)state;
	record_maker_init(&m, 20, r);
	recording_make(&m, recording_path("c.rec", path), 60, true);
	b = recording_load(path);
	recording_path("cut.rec", other);
	for (size_t len = 1; len <= b.len; len += 1 + unit_random_u32(&r) % 97) {
		unsigned frames;
		recording_save(other, b.bytes, len);
		frames = recording_play(&m, other, &counts, &damage);
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_killed_writer_costs_the_last_moment),
		cmocka_unit_test(damage_costs_little),
		cmocka_unit_test(every_cut_is_read_up_to_the_last_block),
	};

	return cmocka_run_group_tests(tests, recording_folder_make, recording_folder_remove);
}
