/* GPU times: counted per frame in which a stage ran, kept for medians, forgotten on demand. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/timer.h"
#include "tests/unit/gl.h"

#include <epoxy/gl.h>
#include <math.h>

#define STAGE 3

static void frame(struct timers *timers, bool run)
{
	if (run) {
		timers_begin(timers, STAGE, "clear");
		glClear(GL_COLOR_BUFFER_BIT);
		timers_end(timers, STAGE);
	}
	timers_frame(timers);
	glFinish();
}

/* Until all that was submitted is read. */
static void settle(struct timers *timers)
{
	for (int i = 0; i < 8; i++) {
		glFinish();
		timers_frame(timers);
	}
}

static void window_holds_the_last(void **state)
{
	static double ms[TIMER_WINDOW];
	struct timers *timers;
	struct timer_stats stats;
	double sum = 0;

	(void)state;
	assert_int_equal(timers_create(&timers), GR_OK);
	assert_int_equal(timers_window(timers, STAGE, ms), 0);
	for (int i = 0; i < 40; i++)
		frame(timers, i % 2 == 0);
	settle(timers);
	timers_stats(timers, STAGE, &stats);
	assert_string_equal(stats.name, "clear");
	assert_int_equal(stats.count, 20);
	assert_int_equal(timers_window(timers, STAGE, ms), 20);
	for (int i = 0; i < 20; i++) {
		assert_true(ms[i] >= 0 && isfinite(ms[i]));
		sum += ms[i];
	}
	assert_true(fabs(sum / 20 - stats.mean_ms) < 1e-4 * (1 + stats.mean_ms));
	for (int i = 0; i < TIMER_WINDOW + 10; i++)
		frame(timers, true);
	settle(timers);
	assert_int_equal(timers_window(timers, STAGE, ms), TIMER_WINDOW);
	timers_stats(timers, STAGE, &stats);
	assert_true(fabs(ms[TIMER_WINDOW - 1] - stats.last_ms) < 1e-4 * (1 + stats.last_ms));
	assert_int_equal(timers_window(timers, -1, ms), 0);
	assert_int_equal(timers_window(timers, TIMER_STAGES, ms), 0);
	timers_destroy(&timers);
}

static void reset_forgets_what_is_on_its_way(void **state)
{
	struct timers *timers;
	struct timer_stats stats;

	(void)state;
	assert_int_equal(timers_create(&timers), GR_OK);
	timers_begin(timers, STAGE, "clear");
	glClear(GL_COLOR_BUFFER_BIT);
	timers_end(timers, STAGE);
	timers_frame(timers); /* on its way, or read already */
	timers_reset(timers);
	settle(timers);
	timers_stats(timers, STAGE, &stats);
	assert_int_equal(stats.count, 0);
	frame(timers, true);
	settle(timers);
	timers_stats(timers, STAGE, &stats);
	assert_int_equal(stats.count, 1);
	assert_true(stats.min_ms <= stats.max_ms);
	timers_destroy(&timers);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(window_holds_the_last),
		cmocka_unit_test(reset_forgets_what_is_on_its_way),
	};
	struct target *target;
	int failed;

	gr_log_init("test_timer", GR_LOG_WARNING);
	target = gl_target_or_skip(64, 64);
	glBindFramebuffer(GL_FRAMEBUFFER, target_framebuffer(target, 0));
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	target_destroy(&target);
	return failed;
}
