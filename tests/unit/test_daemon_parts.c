/* The daemons' small parts: JSON, histograms, frame statistics, command lines, sd_notify. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "daemon/frame_stats.h"
#include "daemon/histogram.h"
#include "daemon/json.h"
#include "daemon/notify.h"
#include "daemon/options.h"

#include <math.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

static void json_is_escaped_and_bounded(void **state)
{
	char text[256];
	struct json json = json_start(text, sizeof text);

	(void)state;
	json_open(&json, NULL, '{');
	json_string(&json, "a", "q\"b\\n\n\x01\xff");
	json_f64(&json, "nan", NAN);
	json_f64(&json, "inf", -INFINITY);
	json_f64(&json, "x", 0.1);
	json_open(&json, "list", '[');
	json_u64(&json, NULL, UINT64_MAX);
	json_i64(&json, NULL, INT64_MIN);
	json_close(&json, ']');
	json_hash(&json, "h", 0xabc);
	json_string(&json, "none", NULL);
	json_bool(&json, "yes", true);
	json_close(&json, '}');
	assert_true(json.ok);
	assert_string_equal(text,
			    "{\"a\":\"q\\\"b\\\\n\\u000a\\u0001\\u00ff\",\"nan\":null,\"inf\":null,"
			    "\"x\":0.1,\"list\":[18446744073709551615,-9223372036854775808],"
			    "\"h\":\"0000000000000abc\",\"none\":null,\"yes\":true}");
}

/* Whatever the size, nothing is written past it, and what is too small is said. */
static void json_never_writes_past_its_size(void **state)
{
	(void)state;
	for (size_t size = 0; size < 40; size++) {
		char *text = malloc(size ? size : 1);
		struct json json = json_start(text, size);

		json_open(&json, NULL, '{');
		json_string(&json, "name", "front wall");
		json_u64(&json, "n", 12345);
		json_close(&json, '}');
		assert_int_equal(json.ok, size > strlen("{\"name\":\"front wall\",\"n\":12345}"));
		free(text);
	}
}

static void json_is_saved_whole(void **state)
{
	char dir[] = "/tmp/grotto-json-XXXXXX", path[64], back[32];
	FILE *file;
	size_t n;

	(void)state;
	assert_non_null(mkdtemp(dir));
	snprintf(path, sizeof path, "%s/report.json", dir);
	assert_int_equal(json_save(path, "{}", 2), GR_OK);
	assert_int_equal(json_save(path, "{\"a\":1}", 7), GR_OK);
	file = fopen(path, "r");
	n = fread(back, 1, sizeof back, file);
	fclose(file);
	assert_int_equal(n, 8);
	assert_memory_equal(back, "{\"a\":1}\n", 8);
	assert_int_equal(json_try(path), GR_OK);
	unlink(path);
	assert_int_equal(json_try(path), GR_OK);
	gr_log_set_level((enum gr_log_level)0);
	assert_int_equal(json_try(dir), GR_ERR_IO); /* a folder */
	assert_int_equal(rmdir(dir), 0); /* nothing is left beside it */
	assert_int_equal(json_try(path), GR_ERR_IO);
	assert_int_equal(json_save(path, "{}", 2), GR_ERR_IO);
	gr_log_set_level(GR_LOG_ERROR);
}

static int compare(const void *a, const void *b)
{
	int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;

	return (x > y) - (x < y);
}

static void histogram_percentiles_are_near(void **state)
{
	struct unit_random random = unit_random_start("histogram");
	double worst = 0;

	(void)state;
	for (int round = 0; round < 50; round++) {
		static struct histogram h;
		static int64_t values[1000];

		memset(&h, 0, sizeof h);
		for (int i = 0; i < 1000; i++) {
			values[i] = (int64_t)exp2(unit_random_range(&random, 0, 30));
			histogram_add(&h, values[i]);
		}
		qsort(values, 1000, sizeof *values, compare);
		for (int k = 1; k <= 100; k++) {
			double truth = (double)values[k * 10 - 1];
			double error = fabs(histogram_percentile(&h, k / 100.0) - truth) / truth;
			worst = error > worst ? error : worst;
		}
		assert_int_equal(h.max_us, values[999]);
	}
	printf("# largest relative error of a percentile: %.4f\n", worst);
	assert_true(worst < 1.0 / 64);
}

static void histogram_takes_anything(void **state)
{
	static struct histogram h;

	(void)state;
	assert_true(histogram_percentile(&h, 0.5) == 0);
	histogram_add(&h, -5);
	histogram_add(&h, INT64_MAX);
	assert_true(histogram_percentile(&h, 0.5) == 0);
	assert_true(histogram_percentile(&h, 1.0) <= INT32_MAX);
	assert_int_equal(h.count, 2);
}

#define MS GR_NS_PER_MS

static void frame_stats_measure_swap_and_skew(void **state)
{
	static struct frame_stats s;

	(void)state;
	frame_stats_begin(&s, 1, 7, 100 * MS);
	frame_stats_applied(&s, 2, 1, 101 * MS);
	frame_stats_applied(&s, 0, 1, 102 * MS);
	frame_stats_applied(&s, 1, 1, 103 * MS);
	frame_stats_applied(&s, 1, 1, 109 * MS);
	frame_stats_applied(&s, 64, 1, 109 * MS);
	assert_int_equal(s.applied.count, 1);
	assert_int_equal(s.applied.max_us, 3000);
	frame_stats_swap_sent(&s, 1, false, 110 * MS);
	assert_int_equal(s.smoothed_swap_ns, 10 * MS);
	frame_stats_swapped(&s, 1, 1, 5000 * MS, 111 * MS);
	frame_stats_swapped(&s, 1, 1, 9000 * MS, 111 * MS); /* said twice: counts once */
	frame_stats_swapped(&s, 0, 1, 5002 * MS, 112 * MS);
	assert_false(frame_stats_settled(&s, 1));
	/* The next frame may begin before the last report of this one. */
	frame_stats_begin(&s, 2, 7, 113 * MS);
	frame_stats_swapped(&s, 2, 1, 5001 * MS, 114 * MS);
	assert_true(frame_stats_settled(&s, 1));
	assert_int_equal(s.complete, 1);
	assert_int_equal(s.skew.max_us, 2000);
	assert_int_equal(s.skew_told.count, 1);
	assert_int_equal(s.skew_scheduled.count, 0);
	assert_int_equal(s.last_swapped.max_us, 14000);
	assert_int_equal(s.swap_sent.max_us, 10000);
	assert_int_equal(s.swap_to_last.max_us, 4000);
	/* A node dies: the frame is whole without it. */
	frame_stats_swapped(&s, 0, 2, 5010 * MS, 120 * MS);
	frame_stats_swapped(&s, 1, 2, 5010 * MS, 120 * MS);
	frame_stats_gone(&s, 2);
	assert_true(frame_stats_settled(&s, 2));
	/* At a set time, and with a node whose clock is not known. */
	frame_stats_begin(&s, 3, 3, 130 * MS);
	frame_stats_swap_sent(&s, 3, true, 131 * MS);
	frame_stats_swapped(&s, 0, 3, 5020 * MS, 132 * MS);
	frame_stats_swapped(&s, 1, 3, 5021 * MS, 132 * MS);
	assert_int_equal(s.skew_scheduled.max_us, 1000);
	frame_stats_begin(&s, 4, 3, 140 * MS);
	frame_stats_swapped(&s, 0, 4, 5030 * MS, 142 * MS);
	frame_stats_swapped(&s, 1, 4, 0, 142 * MS);
	assert_true(frame_stats_settled(&s, 4));
	assert_int_equal(s.skew.count, s.skew_told.count + s.skew_scheduled.count);
	assert_int_equal(s.skew_scheduled.count, 1);
	assert_int_equal(s.skew_told.count, 2);
	assert_int_equal(s.complete, 4);
	/* Reports that never come do not stop the count. */
	for (uint64_t frame = 5; frame < 5 + FRAME_STATS_OPEN + 1; frame++)
		frame_stats_begin(&s, frame, 3, 200 * MS);
	assert_int_equal(s.incomplete, 1);
	/* Hostile numbers. */
	frame_stats_swapped(&s, 64, 5, 0, 0);
	frame_stats_swapped(&s, 0, 0, 0, 0);
	frame_stats_swapped(&s, 0, UINT64_MAX, 0, 0);
	frame_stats_gone(&s, 200);
}

static void command_lines(void **state)
{
	struct master_options m;
	struct node_options n;
	char *good[] = { "grotto-master", "--layout", "a.cave", "--frames=600", "--frame-clock",
			 "--wait-all", "--deadline-ms", "60000", "--log-level", "debug", NULL };
	char *node[] = { "grotto-node", "--node", "front", "--target", "headless", "--once",
			 "--pictures", "out", "--every", "50", "--exr", NULL };
	static char *const wrong[][4] = {
		{ "x", "--frames", "0", NULL },	      { "x", "--frames", "12x", NULL },
		{ "x", "--frames", NULL, NULL },      { "x", "--frmes", "12", NULL },
		{ "x", "--expect", "65", NULL },      { "x", "file", NULL, NULL },
		{ "x", "--log-level", "loud", NULL }, { "x", "--layout", "", NULL },
		{ "x", "-z", NULL, NULL },
	};

	(void)state;
	assert_int_equal(master_options_parse(&m, 10, good), OPTIONS_RUN);
	assert_string_equal(m.common.layout, "a.cave");
	assert_int_equal(m.frames, 600);
	assert_true(m.frame_clock && m.wait_all);
	assert_int_equal(m.expect, 1);
	assert_int_equal(m.common.deadline_ms, 60000);
	assert_int_equal(m.common.log_level, GR_LOG_DEBUG);
	assert_int_equal(node_options_parse(&n, 11, node), OPTIONS_RUN);
	assert_string_equal(n.node, "front");
	assert_int_equal(n.target, NODE_TARGET_HEADLESS);
	assert_int_equal(n.every, 50);
	assert_int_equal(n.gpu, -2);
	assert_true(n.once && n.exr);
	gr_log_set_level((enum gr_log_level)0);
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		char *argv[4];
		int argc = 0;

		for (; wrong[i][argc]; argc++)
			argv[argc] = wrong[i][argc];
		argv[argc] = NULL;
		assert_int_equal(master_options_parse(&m, argc, argv), OPTIONS_WRONG);
	}
	assert_int_equal(node_options_parse(&n, 1, node), OPTIONS_WRONG); /* no --node */
	char *lone[] = { "x", "--node", "a", "--exr", NULL };
	assert_int_equal(node_options_parse(&n, 4, lone), OPTIONS_WRONG);
	gr_log_set_level(GR_LOG_ERROR);
}

static void notify_speaks_to_the_manager(void **state)
{
	char dir[] = "/tmp/grotto-notify-XXXXXX", text[600];
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
	struct notify notify;
	ssize_t n;

	(void)state;
	assert_non_null(mkdtemp(dir));
	snprintf(address.sun_path, sizeof address.sun_path, "%s/notify", dir);
	assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
	setenv("NOTIFY_SOCKET", address.sun_path, 1);
	setenv("WATCHDOG_USEC", "4000000", 1);
	notify_init(&notify);
	assert_int_equal(notify.interval_ns, GR_NS_PER_S);
	notify_ready("waiting for %d nodes", 4);
	n = recv(fd, text, sizeof text - 1, 0);
	assert_true(n > 0);
	text[n] = '\0';
	assert_string_equal(text, "READY=1\nSTATUS=waiting for 4 nodes");
	/* Fed at most once an interval. */
	notify_feed(&notify, 10 * GR_NS_PER_S);
	notify_feed(&notify, 10 * GR_NS_PER_S + GR_NS_PER_MS);
	n = recv(fd, text, sizeof text - 1, 0);
	assert_int_equal(n, 10);
	assert_memory_equal(text, "WATCHDOG=1", 10);
	assert_true(recv(fd, text, sizeof text, 0) < 0);
	notify_feed(&notify, 11 * GR_NS_PER_S);
	assert_int_equal(recv(fd, text, sizeof text, 0), 10);
	notify_stopping();
	assert_int_equal(recv(fd, text, sizeof text, 0), 10);
	unsetenv("NOTIFY_SOCKET");
	unsetenv("WATCHDOG_USEC");
	notify_init(&notify);
	assert_int_equal(notify.interval_ns, 0);
	notify_feed(&notify, 1);
	close(fd);
	unlink(address.sun_path);
	rmdir(dir);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(json_is_escaped_and_bounded),
		cmocka_unit_test(json_never_writes_past_its_size),
		cmocka_unit_test(json_is_saved_whole),
		cmocka_unit_test(histogram_percentiles_are_near),
		cmocka_unit_test(histogram_takes_anything),
		cmocka_unit_test(frame_stats_measure_swap_and_skew),
		cmocka_unit_test(command_lines),
		cmocka_unit_test(notify_speaks_to_the_manager),
	};

	gr_log_init("test", GR_LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
