/* Targets: headless always, a window when DISPLAY is set (tests/unit/window.sh). */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/pattern.h"
#include "tests/unit/gl.h"

#include <epoxy/gl.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

static void clear_and_read(struct target *target, int eye, float red, uint8_t expect)
{
	uint8_t pixel[4] = { 0 };

	target_bind(target, eye, false);
	glClearColor(red, 0.5f, 0.25f, 1.0f);
	glClear(GL_COLOR_BUFFER_BIT);
	target_bind(target, eye, true);
	glPixelStorei(GL_PACK_ALIGNMENT, 1);
	glReadPixels(3, 2, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
	assert_int_equal(pixel[0], expect);
	assert_int_equal(glGetError(), GL_NO_ERROR);
}

/* No board, no barrier: said why, and nothing happens. */
static void assert_no_barrier(struct target *target)
{
	char why[160] = "";

	assert_int_equal(target_barrier_join(target, why, sizeof why), GR_ERR_UNSUPPORTED);
	printf("# no barrier of the driver's: %s\n", why);
	assert_true(why[0]);
	target_barrier_leave(target);
	assert_true(target_swap(target));
}

static void test_headless(void **state)
{
	struct target *target = gl_target_or_skip(37, 23);
	int width, height;

	(void)state;
	printf("# %s: %s\n", target_platform_name(target), target_renderer_name(target));
	target_size(target, &width, &height);
	assert_int_equal(width, 37);
	assert_int_equal(height, 23);
	assert_int_not_equal(target_framebuffer(target, 0), 0);
	assert_int_equal(target_framebuffer(target, 0), target_framebuffer(target, 1));
	clear_and_read(target, 0, 1.0f, 255);
	assert_true(target_swap(target));
	assert_true(target_poll(target));
	assert_no_barrier(target);
	target_destroy(&target);
	assert_null(target);
	target_destroy(&target);
}

static const uint8_t *pixel_at(const struct target *target, int eye, int x, int y)
{
	static uint8_t pixel[4];

	target_bind(target, eye, true);
	glReadPixels(x, y, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
	return pixel;
}

static void assert_color(const uint8_t *pixel, int red, int green, int blue)
{
	assert_int_equal(pixel[0], red);
	assert_int_equal(pixel[1], green);
	assert_int_equal(pixel[2], blue);
}

/* What a wall shows without a master: in both eyes, to the last pixel, and nothing stays set. */
static void test_patterns(void **state)
{
	const struct target_params params = {
		.kind = TARGET_HEADLESS, .width = 64, .height = 48, .gpu = -1, .quad_buffer = true,
	};
	struct target *target = gl_target_or_skip(3, 3);

	(void)state;
	target_destroy(&target);
	assert_int_equal(target_create(&target, &params), GR_OK);
	pattern_draw(target, PATTERN_TEST);
	for (int eye = 0; eye < target_eyes(target); eye++) {
		assert_color(pixel_at(target, eye, 0, 0), 255, 255, 255);
		assert_color(pixel_at(target, eye, 63, 47), 255, 255, 255);
		assert_color(pixel_at(target, eye, 2, 2), 0, 0, 0);
		assert_color(pixel_at(target, eye, 17, 20), 255, 255, 255); /* bars */
		assert_color(pixel_at(target, eye, 42, 20), 0, 0, 255);
		assert_color(pixel_at(target, eye, 5, 5), eye ? 0 : 255, eye ? 255 : 0, eye ? 255 : 0);
		assert_color(pixel_at(target, eye, 32, 2), 64, 64, 64);
	}
	assert_false(glIsEnabled(GL_SCISSOR_TEST));
	pattern_draw(target, PATTERN_BLACK);
	for (int eye = 0; eye < 2; eye++)
		for (int x = 0; x < 64; x += 3)
			assert_color(pixel_at(target, eye, x, x % 48), 0, 0, 0);
	assert_int_equal(glGetError(), GL_NO_ERROR);
	target_destroy(&target);
}

static void test_headless_eyes(void **state)
{
	const struct target_params params = {
		.kind = TARGET_HEADLESS, .width = 16, .height = 8, .gpu = -1, .quad_buffer = true,
	};
	struct target *target;

	(void)state;
	assert_int_equal(target_create(&target, &params), GR_OK);
	assert_int_not_equal(target_framebuffer(target, 0), target_framebuffer(target, 1));
	clear_and_read(target, 0, 1.0f, 255);
	clear_and_read(target, 1, 0.0f, 0);
	target_bind(target, 0, true);
	target_destroy(&target);
}

/* One process may open and close targets many times over (a node restarted by hand). */
static void test_again(void **state)
{
	(void)state;
	for (int i = 0; i < 5; i++) {
		struct target *target = gl_target_or_skip(8, 8);

		clear_and_read(target, 0, 0.0f, 0);
		target_destroy(&target);
	}
}

static void test_refused(void **state)
{
	struct target_params params = {
		.kind = TARGET_HEADLESS, .width = 8, .height = 8, .gpu = 1000,
	};
	struct target *target = (struct target *)state;
	int result = target_create(&target, &params);

	assert_true(result == GR_ERR_RANGE || result == GR_ERR_UNSUPPORTED);
	assert_null(target);
	params.gpu = -1;
	params.width = 0;
	assert_int_equal(target_create(&target, &params), GR_ERR_RANGE);
	params.width = 1 << 24;
	assert_int_equal(target_create(&target, &params), GR_ERR_UNSUPPORTED);
	assert_null(target);
}

static void test_no_display(void **state)
{
	const struct target_params params = {
		.kind = TARGET_WINDOW, .width = 8, .height = 8, .display = ":9999",
	};
	char *display = getenv("DISPLAY") ? strdup(getenv("DISPLAY")) : NULL;
	struct target *target;

	(void)state;
	assert_int_equal(target_create(&target, &params), GR_ERR_UNSUPPORTED);
	assert_null(target);
	if (display)
		setenv("DISPLAY", display, 1);
	else
		unsetenv("DISPLAY");
	free(display);
}

static void test_window(void **state)
{
	struct target_params params = {
		.kind = TARGET_WINDOW, .title = "grotto test", .width = 64, .height = 48,
	};
	struct target *target;
	char why[160];
	int width, height;

	(void)state;
	if (!getenv("DISPLAY")) {
		printf("# no DISPLAY: window not tested here, see window.sh\n");
		skip();
	}
	assert_int_equal(target_create(&target, &params), GR_OK);
	printf("# %s: %s\n", target_platform_name(target), target_renderer_name(target));
	target_size(target, &width, &height);
	assert_int_equal(width, 64);
	assert_int_equal(height, 48);
	assert_int_equal(target_framebuffer(target, 0), 0);
	clear_and_read(target, 0, 1.0f, 255);
	assert_true(target_swap(target));
	if (target_barrier_join(target, why, sizeof why) < 0)
		printf("# no barrier of the driver's: %s\n", why);
	target_barrier_leave(target);
	assert_true(target_swap(target));
	assert_true(target_poll(target));
	/* What the window manager's close button does. */
	glfwSetWindowShouldClose(glfwGetCurrentContext(), GLFW_TRUE);
	assert_false(target_poll(target));
	assert_false(target_swap(target));
	target_destroy(&target);

	params.kind = TARGET_FULLSCREEN;
	params.monitor = 77;
	assert_int_equal(target_create(&target, &params), GR_ERR_RANGE);
	params.kind = TARGET_WINDOW;
	params.quad_buffer = true;
	/* Works where the display has a stereo visual, is refused elsewhere. */
	if (target_create(&target, &params) == GR_OK) {
		clear_and_read(target, 0, 1.0f, 255);
		clear_and_read(target, 1, 0.0f, 0);
		target_destroy(&target);
	}
	assert_null(target);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_headless),
		cmocka_unit_test(test_headless_eyes),
		cmocka_unit_test(test_patterns),
		cmocka_unit_test(test_again),
		cmocka_unit_test(test_refused),
		cmocka_unit_test(test_no_display),
		cmocka_unit_test(test_window),
	};

	gr_log_init("test_target", GR_LOG_INFO);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
