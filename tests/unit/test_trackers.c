/* A layout's trackers: simulated and replayed bodies at the photon time; giving up root. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "daemon/privileges.h"
#include "daemon/trackers.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#define PERIOD_NS (GR_NS_PER_S / 60)

struct fixture {
	struct layout layout;
	struct layout_tracker trackers[TRACKERS_MAX + 1];
	struct trackers open;
	struct master_input input;
	struct gr_diag diag;
	char dir[64], path[96];
};

static int setup(void **state)
{
	struct fixture *f = calloc(1, sizeof *f);
	const vec3 head = { 0, 1.7f, 0 }, wand = { 0.3f, 1.2f, -0.3f };

	strcpy(f->dir, "/tmp/grotto-trackers-XXXXXX");
	if (!mkdtemp(f->dir))
		return -1;
	snprintf(f->path, sizeof f->path, "%s/room.cave", f->dir);
	f->layout.path = f->path;
	f->layout.trackers = f->trackers;
	gr_pose_heading(head, 0, &f->layout.start_head);
	gr_pose_heading(wand, 0, &f->layout.start_wand);
	for (int i = 0; i < 3; i++) {
		f->layout.room_min[i] = i == 1 ? 0.0f : -1.5f;
		f->layout.room_max[i] = 2.2f;
	}
	f->input.head.T_room_body = f->layout.start_head;
	f->input.wand.T_room_body = f->layout.start_wand;
	*state = f;
	return 0;
}

static int teardown(void **state)
{
	struct fixture *f = *state;

	trackers_close(&f->open);
	gr_diag_finish(&f->diag);
	rmdir(f->dir);
	free(f);
	return 0;
}

static void add_sim(struct fixture *f)
{
	struct layout_tracker *t = &f->trackers[f->layout.tracker_count++];

	strcpy(t->name, "visitor");
	t->kind = LAYOUT_TRACKER_SIM;
	t->head = t->wand = true;
	t->sim = (struct layout_sim){ .rate_hz = 120, .latency_ns = 5 * GR_NS_PER_MS, .seed = 1,
				      .walk_radius_m = 0.5f, .walk_speed_m_s = 0.5f };
}

static void nobody_is_at_the_start_pose(void **state)
{
	struct fixture *f = *state;

	assert_int_equal(trackers_open(&f->open, &f->layout, &f->diag), GR_OK);
	trackers_poll(&f->open, 0, 0);
	trackers_sample(&f->open, PERIOD_NS, &f->input);
	assert_false(f->input.head.tracked);
	assert_memory_equal(&f->input.head.T_room_body, &f->layout.start_head, sizeof(struct gr_pose));
}

/* Same frames, same poses, whenever they are computed: what a frame clock relies on. */
static void simulated_visitor_is_a_function_of_time(void **state)
{
	struct fixture *f = *state;
	struct trackers second;
	float farthest = 0;

	add_sim(f);
	assert_int_equal(trackers_open(&f->open, &f->layout, &f->diag), GR_OK);
	assert_int_equal(trackers_open(&second, &f->layout, &f->diag), GR_OK);
	for (int frame = 1; frame <= 600; frame++) {
		struct master_input other = f->input;
		int64_t now_ns = frame * PERIOD_NS;

		trackers_poll(&f->open, now_ns, now_ns);
		trackers_sample(&f->open, now_ns + PERIOD_NS, &f->input);
		trackers_poll(&second, now_ns, now_ns);
		trackers_sample(&second, now_ns + PERIOD_NS, &other);
		assert_memory_equal(&f->input, &other, sizeof other);
		assert_true(gr_pose_valid(&f->input.head.T_room_body));
		assert_true(f->input.head.tracked && f->input.wand.tracked);
		farthest = fmaxf(farthest, fabsf(f->input.head.T_room_body.p[0]));
	}
	printf("# the visitor walked %.2f m to the side\n", (double)farthest);
	assert_true(farthest > 0.1f);
	trackers_close(&second);
}

static void replay_is_beside_the_layout(void **state)
{
	struct fixture *f = *state;
	struct layout_tracker *t = &f->trackers[f->layout.tracker_count++];
	char path[112];
	FILE *file;

	snprintf(path, sizeof path, "%s/walk.log", f->dir);
	file = fopen(path, "w");
	fprintf(file, "0.0 head 1 0 1.5 0 0 0 0 1 0\n0.0 wand 1 0 1 0 0 0 0 1 2\n"
		      "0.1 head 1 0.2 1.5 0 0 0 0 1 0\n0.1 wand 0 0 1 0 0 0 0 1 2\n");
	fclose(file);
	strcpy(t->name, "walk");
	t->kind = LAYOUT_TRACKER_REPLAY;
	t->head = t->wand = true;
	t->file = (char *)"walk.log";
	assert_int_equal(trackers_open(&f->open, &f->layout, &f->diag), GR_OK);
	trackers_poll(&f->open, 0, 0);
	trackers_poll(&f->open, 20 * GR_NS_PER_MS, 20 * GR_NS_PER_MS);
	trackers_sample(&f->open, 20 * GR_NS_PER_MS, &f->input);
	assert_true(f->input.wand.tracked);
	assert_int_equal(f->input.buttons, 2);
	trackers_poll(&f->open, 110 * GR_NS_PER_MS, 110 * GR_NS_PER_MS);
	trackers_sample(&f->open, 50 * GR_NS_PER_MS, &f->input);
	assert_float_equal(f->input.head.T_room_body.p[0], 0.1f, 1e-5f);
	/* The wand is lost: it holds no button down, whatever it held last. */
	trackers_sample(&f->open, 120 * GR_NS_PER_MS, &f->input);
	assert_false(f->input.wand.tracked);
	assert_int_equal(f->input.buttons, 0);
	unlink(path);
}

static void missing_log_and_too_many_are_refused(void **state)
{
	struct fixture *f = *state;
	struct layout_tracker *t = &f->trackers[0];

	f->layout.tracker_count = 1;
	strcpy(t->name, "walk");
	t->kind = LAYOUT_TRACKER_REPLAY;
	t->file = (char *)"none.log";
	assert_true(trackers_open(&f->open, &f->layout, &f->diag) < 0);
	assert_true(f->diag.errors > 0);
	assert_non_null(strstr(f->diag.items[0].text, "none.log"));
	f->layout.tracker_count = 0;
	for (int i = 0; i <= TRACKERS_MAX; i++)
		add_sim(f);
	assert_int_equal(trackers_open(&f->open, &f->layout, &f->diag), GR_ERR_CONFIG);
}

/* In a child of its own: what is given up does not come back. */
static int in_child(int (*act)(void))
{
	pid_t pid = fork();
	int status;

	if (pid == 0)
		_exit(act());
	waitpid(pid, &status, 0);
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static int become_nobody(void)
{
	if (privileges_drop("nobody", NULL) != GR_OK)
		return 1;
	if (geteuid() == 0 || getuid() == 0 || getegid() == 0 || setuid(0) == 0 || setgid(0) == 0)
		return 2;
	return prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) == 1 ? 0 : 3;
}

static int become_unknown(void)
{
	return privileges_drop("no-such-user-here", NULL) == GR_ERR_CONFIG ? 0 : 1;
}

static int become_root(void)
{
	return privileges_drop("root", NULL) == GR_ERR_CONFIG ? 0 : 1;
}

static int stay(void)
{
	uid_t before = geteuid();

	return privileges_drop(NULL, NULL) == GR_OK && geteuid() == before &&
			       prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) == 1 ? 0 : 1;
}

static void root_is_given_up_for_good(void **state)
{
	(void)state;
	assert_int_equal(in_child(stay), 0);
	if (geteuid() != 0) {
		printf("# not root: nothing to give up here\n");
		skip();
	}
	assert_int_equal(in_child(become_nobody), 0);
	gr_log_set_level((enum gr_log_level)0);
	assert_int_equal(in_child(become_unknown), 0);
	assert_int_equal(in_child(become_root), 0);
	gr_log_set_level(GR_LOG_ERROR);
}

int main(void)
{
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
	const struct CMUnitTest tests[] = {
		WITH(nobody_is_at_the_start_pose),
		WITH(simulated_visitor_is_a_function_of_time),
		WITH(replay_is_beside_the_layout),
		WITH(missing_log_and_too_many_are_refused),
		cmocka_unit_test(root_is_given_up_for_good),
	};

	gr_log_init("test", GR_LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
