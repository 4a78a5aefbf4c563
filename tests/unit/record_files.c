#include "tests/unit/record_files.h"

#include "base/clock.h"
#include "base/result.h"
#include "protocol/state.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static char dir[64];

int recording_folder_make(void **state)
{
	(void)state;
	strcpy(dir, "/tmp/grotto-record-XXXXXX");
	return mkdtemp(dir) ? 0 : -1;
}

int recording_folder_remove(void **state)
{
	(void)state;
	return rmdir(dir);
}

const char *recording_folder(void)
{
	return dir;
}

const char *recording_path(const char *name, char out[RECORDING_PATH_BYTES])
{
	snprintf(out, RECORDING_PATH_BYTES, "%s/%s", dir, name);
	return out;
}

void pause_ms(long ms)
{
	const struct timespec t = { ms / 1000, ms % 1000 * 1000000 };

	nanosleep(&t, NULL);
}

struct record_writer_params quick_writer(void)
{
	struct record_writer_params params = RECORD_WRITER_DEFAULTS;

	params.flush_ns = GR_NS_PER_MS;
	return params;
}

void writer_await(struct record_writer *w, enum record_writer_state state,
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

void recording_make(struct record_maker *m, const char *path, unsigned frames, bool end)
{
	struct record_writer_params params = quick_writer();
	struct record_writer_status status;
	struct record_writer *w;

	assert_int_equal(record_writer_create(&w, &params), GR_OK);
	assert_int_equal(record_writer_start(w, path, &m->session), GR_OK);
	writer_await(w, RECORD_WRITER_RUNNING, &status);
	for (unsigned i = 0; i < frames; i++) {
		record_maker_frame(m, record_maker_to_writer, w);
		if (i % 10 == 9)
			pause_ms(1);
	}
	if (end)
		assert_int_equal(record_writer_stop(w, RECORD_END_ASKED), GR_OK);
	if (end)
		writer_await(w, RECORD_WRITER_IDLE, &status);
	assert_string_equal(status.error, "");
	assert_int_equal(status.lost, 0);
	record_writer_destroy(&w);
}

struct recording_bytes recording_load(const char *path)
{
	struct recording_bytes b = { NULL, 0 };
	struct stat status;
	int fd = open(path, O_RDONLY);

	assert_true(fd >= 0 && fstat(fd, &status) == 0);
	b.len = (size_t)status.st_size;
	b.bytes = malloc(b.len);
	assert_true(read(fd, b.bytes, b.len) == status.st_size);
	close(fd);
	return b;
}

void recording_save(const char *path, const void *bytes, size_t len)
{
	int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);

	assert_true(fd >= 0 && write(fd, bytes, len) == (ssize_t)len);
	close(fd);
}

unsigned recording_play(const struct record_maker *m, const char *path,
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

static void on_survey(void *ctx, const struct record_survey *s)
{
	struct record_survey *all = ctx; /* room for three */

	for (int i = 0; i < 3; i++)
		if (all[i].blocks == 0) {
			all[i] = *s;
			return;
		}
}

int recording_survey(const char *path, struct record_survey out[3], struct record_damage *damage)
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
