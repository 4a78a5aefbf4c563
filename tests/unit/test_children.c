/*
 * Process supervision, with this program as its own test double: called with
 * a role it plays a child that ends, crashes, hangs or ignores SIGTERM.
 */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "tools/children.h"

#include <errno.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#define SECOND INT64_C(1000000000)

static char self[4096];
static char log_path[64];

static int play(const char *role)
{
	struct sigaction ignore = { .sa_handler = SIG_IGN };

	if (strcmp(role, "well") == 0) {
		printf("out\n");
		fprintf(stderr, "err\n");
		return 0;
	}
	if (strcmp(role, "badly") == 0)
		return 3;
	if (strcmp(role, "crash") == 0) {
		signal(SIGABRT, SIG_DFL);
		abort();
	}
	if (strcmp(role, "stubborn") == 0)
		sigaction(SIGTERM, &ignore, NULL);
	/* "hang" and "stubborn": tell that we are ready, then wait. */
	if (write(STDOUT_FILENO, "ready\n", 6) != 6)
		return 4;
	for (;;)
		pause();
}

static void spawn(struct children *children, const char *role)
{
	char *argv[] = { self, (char *)role, NULL };

	assert_int_equal(children_spawn(children, role, argv, log_path), GR_OK);
}

static size_t read_log(char *text, size_t size)
{
	FILE *file = fopen(log_path, "re");
	size_t n;

	if (!file)
		return 0;
	n = fread(text, 1, size - 1, file);
	fclose(file);
	text[n] = '\0';
	return n;
}

/* Until the child has said that it is ready: its handlers stand. */
static void await_ready(struct children *children)
{
	char text[256] = "";
	size_t which;

	children_tick(children, 5000000);
	while (read_log(text, sizeof text) == 0)
		assert_int_equal(children_wait(children, 10 * SECOND, &which), CHILDREN_TICK);
	children_tick(children, 0);
}

static void test_ends(void **state)
{
	struct children children;
	size_t which;
	char text[256];

	(void)state;
	assert_int_equal(children_start(&children), GR_OK);
	spawn(&children, "well");
	assert_int_equal(children_wait(&children, 10 * SECOND, &which), CHILDREN_ENDED);
	assert_int_equal(which, 0);
	assert_true(child_ended_well(&children.items[0]));
	assert_int_equal(children.running, 0);
	read_log(text, sizeof text);
	assert_non_null(strstr(text, "out\n"));
	assert_non_null(strstr(text, "err\n"));

	spawn(&children, "badly");
	assert_int_equal(children_wait(&children, 10 * SECOND, &which), CHILDREN_ENDED);
	assert_int_equal(which, 1);
	assert_false(child_ended_well(&children.items[1]));
	child_describe(&children.items[1], text, sizeof text);
	assert_string_equal(text, "ended with status 3");

	spawn(&children, "crash");
	assert_int_equal(children_wait(&children, 10 * SECOND, &which), CHILDREN_ENDED);
	child_describe(&children.items[2], text, sizeof text);
	assert_non_null(strstr(text, "killed by signal 6"));
	children_finish(&children);
}

static void test_no_such_program(void **state)
{
	struct children children;
	char *argv[] = { (char *)"/nowhere/at/all", NULL };

	(void)state;
	assert_int_equal(children_start(&children), GR_OK);
	errno = 0;
	assert_int_equal(children_spawn(&children, "none", argv, log_path), GR_ERR_IO);
	assert_int_equal(errno, ENOENT);
	assert_int_equal(children.count, 0);
	errno = 0;
	argv[0] = self;
	assert_int_equal(children_spawn(&children, "none", argv, "/nowhere/log"), GR_ERR_IO);
	assert_int_equal(errno, ENOENT);
	children_finish(&children);
}

static void test_end_is_bounded(void **state)
{
	struct children children;
	char text[64];
	int64_t start;

	(void)state;
	assert_int_equal(children_start(&children), GR_OK);
	spawn(&children, "hang");
	await_ready(&children);
	children_end(&children, 10 * SECOND);
	assert_int_equal(children.running, 0);
	assert_true(WIFSIGNALED(children.items[0].status));
	assert_int_equal(WTERMSIG(children.items[0].status), SIGTERM);

	spawn(&children, "stubborn");
	await_ready(&children);
	start = gr_clock_now(&gr_clock_monotonic);
	children_end(&children, SECOND / 20);
	assert_int_equal(WTERMSIG(children.items[1].status), SIGKILL);
	printf("# a stubborn child ended after %.3f s (patience 0.05 s)\n",
	       (double)(gr_clock_now(&gr_clock_monotonic) - start) / 1e9);
	child_describe(&children.items[1], text, sizeof text);
	assert_non_null(strstr(text, "signal 9"));
	children_finish(&children);
}

static void test_signal_and_timeout(void **state)
{
	struct children children;
	size_t which;

	(void)state;
	assert_int_equal(children_start(&children), GR_OK);
	spawn(&children, "hang");
	assert_int_equal(children_wait(&children, 1000000, &which), CHILDREN_TIMEOUT);
	kill(getpid(), SIGINT);
	assert_int_equal(children_wait(&children, 10 * SECOND, &which), CHILDREN_SIGNAL);
	children_finish(&children); /* ends the child */
	assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
	assert_int_equal(errno, ECHILD);
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_ends),
		cmocka_unit_test(test_no_such_program),
		cmocka_unit_test(test_end_is_bounded),
		cmocka_unit_test(test_signal_and_timeout),
	};
	ssize_t n;
	int failed;

	if (argc > 1)
		return play(argv[1]);
	n = readlink("/proc/self/exe", self, sizeof self - 1);
	if (n <= 0)
		return 77;
	self[n] = '\0';
	snprintf(log_path, sizeof log_path, "test_children.%d.log", (int)getpid());
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	unlink(log_path);
	return failed;
}
