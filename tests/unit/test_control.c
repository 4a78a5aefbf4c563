/* The control socket against clients that are well behaved, hostile, many and slow. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "daemon/control.h"
#include "daemon/json.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

struct fixture {
	char dir[64], path[96];
	struct loop *loop;
	struct control *control;
	int answered;
};

/* Answers with the words it got; "big" with the longest answer there may be. */
static void answer(void *ctx, char *const *words, int count, char *out, size_t size)
{
	struct fixture *f = ctx;
	struct json json = json_start(out, size);

	f->answered++;
	if (!strcmp(words[0], "big")) {
		memset(out, 'x', size - 1);
		out[size - 1] = '\0';
		return;
	}
	json_open(&json, NULL, '[');
	for (int i = 0; i < count; i++)
		json_string(&json, NULL, words[i]);
	json_close(&json, ']');
}

static int setup(void **state)
{
	struct fixture *f = calloc(1, sizeof *f);

	gr_log_init("test", GR_LOG_ERROR);
	strcpy(f->dir, "/tmp/grotto-control-XXXXXX");
	if (!mkdtemp(f->dir))
		return -1;
	snprintf(f->path, sizeof f->path, "%s/socket", f->dir);
	if (loop_create(&f->loop) < 0 ||
	    control_create(&f->control, f->loop, f->path, answer, f) < 0)
		return -1;
	*state = f;
	return 0;
}

static int teardown(void **state)
{
	struct fixture *f = *state;

	control_destroy(&f->control);
	loop_destroy(&f->loop);
	unlink(f->path);
	rmdir(f->dir);
	free(f);
	return 0;
}

static int dial(const struct fixture *f)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0);

	strcpy(address.sun_path, f->path);
	assert_int_equal(connect(fd, (const struct sockaddr *)&address, sizeof address), 0);
	return fd;
}

static void turn(struct fixture *f)
{
	while (loop_once(f->loop, 0) == GR_OK)
		;
}

static void put(int fd, const void *bytes, size_t n)
{
	assert_int_equal(send(fd, bytes, n, MSG_NOSIGNAL), (int)n);
}

/* What came back, as a string; "" when the connection is closed. NULL: nothing yet. */
static const char *get(int fd)
{
	static char text[CONTROL_ANSWER_MAX + 16];
	ssize_t n = recv(fd, text, sizeof text - 1, 0);

	if (n < 0)
		return NULL;
	text[n] = '\0';
	return text;
}

static void one_line_one_answer(void **state)
{
	struct fixture *f = *state;
	int fd = dial(f);

	put(fd, "status\n", 7);
	turn(f);
	assert_string_equal(get(fd), "[\"status\"]\n");
	/* Pieces of a line, and two lines at once. */
	put(fd, "set gi", 6);
	turn(f);
	assert_null(get(fd));
	put(fd, "_steps 8\r\nquit\n", 15);
	turn(f);
	assert_string_equal(get(fd), "[\"set\",\"gi_steps\",\"8\"]\n[\"quit\"]\n");
	close(fd);
	turn(f);
	assert_int_equal(control_clients(f->control), 0);
}

/* A client that shuts down its sending side (as `nc -N`) still gets the answer. */
static void half_closed_client_is_answered(void **state)
{
	struct fixture *f = *state;
	int fd = dial(f);

	put(fd, "status\n", 7);
	shutdown(fd, SHUT_WR);
	turn(f);
	assert_string_equal(get(fd), "[\"status\"]\n");
	turn(f);
	assert_int_equal(control_clients(f->control), 0);
	close(fd);
}

static void hostile_lines_are_refused(void **state)
{
	struct fixture *f = *state;
	static const struct {
		const char *bytes;
		size_t n;
	} lines[] = { { "\n", 1 }, { "   \t \n", 6 }, { "a\0b\n", 4 }, { "\x1b[2J\n", 5 },
		      { "caf\xc3\xa9\n", 6 }, { "\x7f\n", 2 } };
	int fd = dial(f);

	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
		put(fd, lines[i].bytes, lines[i].n);
		turn(f);
		assert_non_null(strstr(get(fd), "{\"ok\":false,\"error\":\""));
	}
	assert_int_equal(f->answered, 0);
	close(fd);
	turn(f);
}

static void too_many_words_are_refused(void **state)
{
	struct fixture *f = *state;
	char line[2 * (CONTROL_WORDS + 1) + 1];
	int fd = dial(f);

	for (int i = 0; i <= CONTROL_WORDS; i++)
		memcpy(line + 2 * i, "a ", 2);
	line[sizeof line - 1] = '\n';
	put(fd, line, sizeof line);
	turn(f);
	assert_non_null(strstr(get(fd), "\"ok\":false"));
	close(fd);
	turn(f);
}

static void line_without_end_is_dropped(void **state)
{
	struct fixture *f = *state;
	char bytes[CONTROL_LINE_MAX];
	int fd = dial(f);

	memset(bytes, 'a', sizeof bytes);
	put(fd, bytes, sizeof bytes);
	turn(f);
	assert_int_equal(control_clients(f->control), 0);
	assert_string_equal(get(fd), "");
	close(fd);
}

static void ninth_client_is_told(void **state)
{
	struct fixture *f = *state;
	int fds[CONTROL_CLIENTS + 1];

	for (int i = 0; i <= CONTROL_CLIENTS; i++) {
		fds[i] = dial(f);
		turn(f);
	}
	assert_int_equal(control_clients(f->control), CONTROL_CLIENTS);
	assert_string_equal(get(fds[CONTROL_CLIENTS]),
			    "{\"ok\":false,\"error\":\"too many clients\"}\n");
	put(fds[3], "status\n", 7);
	turn(f);
	assert_string_equal(get(fds[3]), "[\"status\"]\n");
	for (int i = 0; i <= CONTROL_CLIENTS; i++)
		close(fds[i]);
	turn(f);
	assert_int_equal(control_clients(f->control), 0);
}

/* A client that asks and does not read: its answers stop, the others' go on. */
static void slow_client_does_not_hold_others(void **state)
{
	struct fixture *f = *state;
	int slow = dial(f), other = dial(f);

	for (int i = 0; i < 200; i++) {
		send(slow, "big\n", 4, MSG_NOSIGNAL);
		turn(f);
	}
	/* Requests are not taken while an answer waits: bounded by the socket's buffers. */
	assert_true(f->answered < 50);
	put(other, "status\n", 7);
	turn(f);
	assert_string_equal(get(other), "[\"status\"]\n");
	/* One that takes its answers gets all of them. */
	size_t bytes = 0;
	for (int i = 0; i < 100000 && bytes < (size_t)200 * CONTROL_ANSWER_MAX; i++) {
		const char *text = get(slow);
		if (text && *text)
			bytes += strlen(text);
		else if (text)
			break;
		turn(f);
	}
	assert_int_equal(bytes, (size_t)200 * CONTROL_ANSWER_MAX);
	close(slow);
	close(other);
	turn(f);
}

static void random_bytes_do_no_harm(void **state)
{
	struct fixture *f = *state;
	struct unit_random random = unit_random_start("control");

	for (int round = 0; round < 200; round++) {
		char bytes[300];
		size_t n = 1 + unit_random_u32(&random) % sizeof bytes;
		int fd = dial(f);

		for (size_t i = 0; i < n; i++)
			bytes[i] = (char)(unit_random_u32(&random) % 100 < 10 ? '\n' :
									       unit_random_u32(&random));
		put(fd, bytes, n);
		turn(f);
		close(fd);
		turn(f);
	}
	assert_int_equal(control_clients(f->control), 0);
}

static void path_is_private_and_taken_over_only_when_dead(void **state)
{
	struct fixture *f = *state;
	struct control *second;
	char other[112];
	struct stat st;
	int fd;

	assert_int_equal(stat(f->path, &st), 0);
	assert_int_equal(st.st_mode & 0777, 0660);
	gr_log_set_level((enum gr_log_level)0);
	assert_int_equal(control_create(&second, f->loop, f->path, answer, f), GR_ERR_STATE);
	snprintf(other, sizeof other, "%s/file", f->dir);
	fd = open(other, O_CREAT | O_WRONLY, 0600);
	close(fd);
	assert_int_equal(control_create(&second, f->loop, other, answer, f), GR_ERR_CONFIG);
	unlink(other);
	gr_log_set_level(GR_LOG_ERROR);
	turn(f);
	/* A master that was killed leaves its socket behind. */
	snprintf(other, sizeof other, "%s/dead", f->dir);
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	strcpy(address.sun_path, other);
	fd = socket(AF_UNIX, SOCK_STREAM, 0);
	assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
	close(fd);
	assert_int_equal(control_create(&second, f->loop, other, answer, f), GR_OK);
	control_destroy(&second);
	assert_int_equal(access(other, F_OK), -1);
}

int main(void)
{
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
	const struct CMUnitTest tests[] = {
		WITH(one_line_one_answer),
		WITH(half_closed_client_is_answered),
		WITH(hostile_lines_are_refused),
		WITH(too_many_words_are_refused),
		WITH(line_without_end_is_dropped),
		WITH(ninth_client_is_told),
		WITH(slow_client_does_not_hold_others),
		WITH(random_bytes_do_no_harm),
		WITH(path_is_private_and_taken_over_only_when_dead),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
