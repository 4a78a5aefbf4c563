/* The log of samples: round trip, playing, and what it refuses. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "tracking/replay.h"
#include "tracking/sim.h"

#include <errno.h>
#include <math.h>
#include <unistd.h>

#define MS GR_NS_PER_MS
#define S GR_NS_PER_S

static const char good[] = "# a visitor\n"
			   "0.000000000 head 1 0 1.7 0 0 0 0 1 0\n"
			   "0.000000000 wand 1 0.2 1.2 -0.3 0 0 0 1 3 # pressed\n"
			   "\n"
			   "\t0.01 head 1 1e-2 +1.7 -.0 0 0.6 0 0.8 0\r\n"
			   "0.02 wand 0 0 0 0 0 0 0 1 4294967295\n"
			   "0.02 head 1 0.02 1.7 0 0 0 0 1 0";

static void test_parse(void **state)
{
	struct track_sample *s = NULL;
	struct gr_diag diag = { 0 };
	size_t n = 0;

	(void)state;
	assert_int_equal(track_replay_parse(good, strlen(good), "good", &s, &n, &diag), GR_OK);
	assert_int_equal(n, 5);
	assert_int_equal(diag.count, 0);
	assert_int_equal(s[1].body, TRACK_WAND);
	assert_int_equal(s[1].buttons, 3);
	assert_true(s[2].time_ns == 10 * MS && s[2].T_room_body.p[0] == 0.01f);
	assert_true(s[2].T_room_body.q[1] == 0.6f && s[2].T_room_body.q[3] == 0.8f);
	/* Sorted by time, head first, though the file has the wand's line first. */
	assert_int_equal(s[3].body, TRACK_HEAD);
	assert_int_equal(s[4].body, TRACK_WAND);
	assert_int_equal(s[4].buttons, UINT32_MAX);
	assert_false(s[4].valid);
	free(s);
}

static void test_round_trip(void **state)
{
	struct track_sim_params params = {
		.start_head = { { 0, 1.7f, 0 }, { 0, 0, 0, 1 } },
		.start_wand = { { 0.3f, 1.2f, -0.2f }, { 0, 0, 0, 1 } },
		.room_min = { -1.5f, 0, -1.5f },
		.room_max = { 1.5f, 3, 1.5f },
		.rate_hz = 59.94f,
		.noise_position_m = 0.001f,
		.noise_angle_rad = 0.01f,
		.dropout_per_s = 1,
		.dropout_ns = 200 * MS,
		.seed = 7,
		.walk_radius_m = 1,
		.walk_speed_m_s = 1,
		.head = true,
		.wand = true,
	};
	struct track_source *source = NULL;
	struct track_sample written[2048], *read = NULL;
	struct gr_diag diag = { 0 };
	char *text = NULL;
	size_t len = 0, n = 0;
	int count = 0;
	FILE *file = open_memstream(&text, &len);

	(void)state;
	assert_non_null(file);
	assert_int_equal(track_sim_create(&source, &params, &diag), GR_OK);
	for (int64_t now = 0; now < 10 * S; now += 100 * MS)
		count += track_poll(source, now, written + count, 2048 - count);
	for (int i = 0; i < count; i++)
		track_replay_write(file, &written[i]);
	assert_int_equal(fclose(file), 0);
	assert_int_equal(track_replay_parse(text, len, "log", &read, &n, &diag), GR_OK);
	assert_int_equal(n, count);
	for (int i = 0; i < count; i++) {
		assert_true(read[i].time_ns == written[i].time_ns);
		assert_int_equal(read[i].body, written[i].body);
		assert_int_equal(read[i].valid, written[i].valid);
		assert_int_equal(read[i].buttons, written[i].buttons);
		if (read[i].valid)
			assert_memory_equal(&read[i].T_room_body, &written[i].T_room_body,
					    sizeof read[i].T_room_body);
	}
	free(read);
	free(text);
	track_source_destroy(&source);
}

static void refused(const char *text, size_t len, const char *where, const char *what)
{
	struct track_sample *s = NULL;
	struct gr_diag diag = { 0 };
	size_t n = 0;
	char *copy = (char *)unit_copy(text, len);

	assert_int_equal(track_replay_parse(copy, len, "f.log", &s, &n, &diag), GR_ERR_FORMAT);
	assert_null(s);
	assert_true(diag.errors > 0);
	if (!strstr(diag.items[0].text, where) || !strstr(diag.items[0].text, what))
		fail_msg("\"%s\" has not \"%s\" and \"%s\"", diag.items[0].text, where, what);
	gr_diag_finish(&diag);
	free(copy);
}

static void test_refuses(void **state)
{
	static const struct {
		const char *text, *where, *what;
	} bad[] = {
		{ "", "f.log: ", "at least one line" },
		{ "# nothing\n\n", "f.log: ", "at least one line" },
		{ "0 head 1 0 0 0 0 0 0 1\n", "f.log:1: ", "has 10 fields, must have 11" },
		{ "\n0 head 1 0 0 0 0 0 0 1 0 0\n", "f.log:2: ", "more than 11 fields" },
		{ "0 foot 1 0 0 0 0 0 0 1 0\n", "f.log:1: body: ", "\"foot\", must be head or wand" },
		{ "-1 head 1 0 0 0 0 0 0 1 0\n", "time_s", "must be seconds" },
		{ "1e3 head 1 0 0 0 0 0 0 1 0\n", "time_s", "\"1e3\"" },
		{ ". head 1 0 0 0 0 0 0 1 0\n", "time_s", "must be" },
		{ "nan head 1 0 0 0 0 0 0 1 0\n", "time_s", "must be" },
		{ "10000001 head 1 0 0 0 0 0 0 1 0\n", "time_s", "must be" },
		{ "99999999999999999999999999 head 1 0 0 0 0 0 0 1 0\n", "time_s", "must be" },
		{ "0 head 2 0 0 0 0 0 0 1 0\n", "valid", "0 (lost) or 1" },
		{ "0 head 1 nan 0 0 0 0 0 1 0\n", "px", "\"nan\", must be a finite" },
		{ "0 head 1 0 inf 0 0 0 0 1 0\n", "py", "finite" },
		{ "0 head 1 0 0 1e999 0 0 0 1 0\n", "pz", "finite" },
		{ "0 head 1 0 0 0x10 0 0 0 1 0\n", "pz", "finite" },
		{ "0 head 1 0 0 1.2.3 0 0 0 1 0\n", "pz", "finite" },
		{ "0 head 1 0 0 1000.5 0 0 0 1 0\n", "pz", "within 1000 m" },
		{ "0 head 1 0 0 0 0 0 0 2 0\n", "qx qy qz qw", "length 2, must be 1" },
		{ "0 head 1 0 0 0 0 0 0 0 0\n", "qx qy qz qw", "length 0, must be 1" },
		{ "0 head 1 0 0 0 0 0 NaN 1 0\n", "qz", "finite" },
		{ "0 head 1 0 0 0 0 0 0 1 4294967296\n", "buttons", "4294967295" },
		{ "0 head 1 0 0 0 0 0 0 1 -1\n", "buttons", "decimal" },
		{ "0 head 1 0 0 0 0 0 0 1 0\n0.5 wand 1 0 0 0 0 0 0 1 0\n0 head 1 0 0 0 0 0 0 1 0\n",
		  "f.log:3: time_s", "the head's sample before it, in line 1" },
		{ "0 he\033[2Jad 1 0 0 0 0 0 0 1 0\n", "body", "he?[2Jad" },
		{ "0 "
		  "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"
		  " 1 0 0 0 0 0 0 1 0\n",
		  "body", "aaaa..." },
	};

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		refused(bad[i].text, strlen(bad[i].text), bad[i].where, bad[i].what);
	refused("0 head 1 0 0 0 0 0 0 \0 0\n", 25, "qw", "finite");
}

/* All faults of a file at once, but not without end. */
static void test_counts_faults(void **state)
{
	struct track_sample *s = NULL;
	struct gr_diag diag = { 0 };
	char text[4000] = "";
	size_t n = 0;

	(void)state;
	for (int i = 0; i < 100; i++)
		strcat(text, i % 2 ? "x\n" : "0 head 1 0 0 0 0 0 0 9 0\n");
	assert_int_equal(track_replay_parse(text, strlen(text), "f", &s, &n, &diag), GR_ERR_FORMAT);
	assert_int_equal(diag.count, 21);
	assert_non_null(strstr(diag.items[20].text, "f:20: 20 faults so far"));
	gr_diag_finish(&diag);
}

/* Every prefix of a good file is read or refused, never more than it has. */
static void test_every_length(void **state)
{
	(void)state;
	for (size_t len = 0; len < sizeof good; len++) {
		struct track_sample *s = NULL;
		struct gr_diag diag = { 0 };
		size_t n = 0;
		char *copy = (char *)unit_copy(good, len);
		int result = track_replay_parse(copy, len, "cut", &s, &n, &diag);

		assert_true(result == GR_OK ? n > 0 && diag.errors == 0 : diag.errors > 0);
		free(s);
		free(copy);
		gr_diag_finish(&diag);
	}
}

static void write_temporary(char path[32], const char *text)
{
	int fd;

	strcpy(path, "replay-test-XXXXXX");
	fd = mkstemp(path);
	assert_true(fd >= 0);
	assert_int_equal(write(fd, text, strlen(text)), (ssize_t)strlen(text));
	close(fd);
}

static void test_plays(void **state)
{
	struct track_source *source = NULL;
	struct track_sample got[16];
	struct gr_diag diag = { 0 };
	const int64_t base = 1000 * S;
	char path[32];

	(void)state;
	write_temporary(path, good);
	assert_int_equal(track_replay_create(&source, path, false, &diag), GR_OK);
	assert_int_equal(track_fd(source), -1);
	assert_true(track_next(source, base) == base);
	assert_int_equal(track_poll(source, base, got, 16), 2);
	assert_true(got[0].time_ns == base);
	assert_true(track_next(source, base) == base + 10 * MS);
	assert_int_equal(track_poll(source, base + 10 * MS - 1, got, 16), 0);
	assert_int_equal(track_poll(source, base + 90 * MS, got, 1), 1);
	assert_int_equal(track_poll(source, base + 90 * MS, got, 16), 2);
	assert_true(got[1].time_ns == base + 20 * MS);
	assert_true(track_next(source, base + S) == INT64_MAX);
	assert_int_equal(track_poll(source, base + 10 * S, got, 16), 0);
	track_source_destroy(&source);
	unlink(path);
}

static void test_loops(void **state)
{
	struct track_source *source = NULL;
	struct track_sample got[4];
	struct gr_diag diag = { 0 };
	int64_t last[TRACK_BODIES] = { -1, -1 }, now = 5 * S;
	int count = 0;
	char path[32];

	(void)state;
	write_temporary(path, good);
	assert_int_equal(track_replay_create(&source, path, true, &diag), GR_OK);
	/* 20 ms long in two steps, so a round is 30 ms of 5 samples. */
	while (now < 8 * S) {
		int n;

		while ((n = track_poll(source, now, got, 4)) > 0)
			for (int i = 0; i < n; i++, count++) {
				assert_true(got[i].time_ns > last[got[i].body] && got[i].time_ns <= now);
				last[got[i].body] = got[i].time_ns;
			}
		assert_true(track_next(source, now) > now);
		now = track_next(source, now);
	}
	assert_int_equal(count, 100 * 5);
	/* Away for an hour: one whole old round at most, then the present. */
	count = 0;
	now += 3600 * S;
	for (int n; (n = track_poll(source, now, got, 4)) > 0;)
		count += n;
	assert_true(count <= 15);
	assert_true(track_next(source, now) > now && track_next(source, now) <= now + 30 * MS);
	track_source_destroy(&source);
	unlink(path);
}

static void test_file_faults(void **state)
{
	struct track_source *source = NULL;
	struct gr_diag diag = { 0 };
	char path[32];

	(void)state;
	assert_int_equal(track_replay_create(&source, "not/there.log", false, &diag), GR_ERR_IO);
	assert_non_null(strstr(diag.items[0].text, "not/there.log: cannot open the log"));
	gr_diag_finish(&diag);
	assert_int_equal(track_replay_create(&source, ".", false, &diag), GR_ERR_FORMAT);
	assert_non_null(strstr(diag.items[0].text, "must be a regular file"));
	gr_diag_finish(&diag);
	write_temporary(path, "0 head 1 0 0 0 0 0 0 1\n");
	assert_int_equal(track_replay_create(&source, path, false, &diag), GR_ERR_FORMAT);
	assert_non_null(strstr(diag.items[0].text, path));
	gr_diag_finish(&diag);
	unlink(path);
	write_temporary(path, "100 head 1 0 0 0 0 0 0 1 0\n");
	assert_int_equal(track_replay_create(&source, path, false, &diag), GR_OK);
	assert_int_equal(diag.warnings, 1);
	gr_diag_finish(&diag);
	track_source_destroy(&source);
	unlink(path);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_parse),
		cmocka_unit_test(test_round_trip),
		cmocka_unit_test(test_refuses),
		cmocka_unit_test(test_counts_faults),
		cmocka_unit_test(test_every_length),
		cmocka_unit_test(test_plays),
		cmocka_unit_test(test_loops),
		cmocka_unit_test(test_file_faults),
	};
	return cmocka_run_group_tests_name("replay", tests, NULL, NULL);
}
