#include <config.h> /* pipe2 */

/*
 * The command at a device, end to end: a DTrack controller sends over UDP what
 * a wand does, `grotto trackers calibrate` asks for its points and is answered,
 * the layout gets the result, and with it a room's trackers put the wand where it is.
 */
#include "tests/unit/unit_config.h"

#include "base/log.h"
#include "daemon/trackers.h"
#include "tests/unit/mock_dtrack.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>

#define POINTS 6

static const char room_head[] =
	"name = \"room\"; # a room, as it was made\n"
	"walls = ( { name = \"front\"; lower_left = [-1.5, 0.0, -1.5]; lower_right = [1.5, 0.0, -1.5];\n"
	"  upper_left = [-1.5, 2.0, -1.5]; pixels = [600, 400];\n"
	"  nodes = ( { address = \"127.0.0.1\"; port = 5001; } ); } );\n"
	"room = { min = [-2.0, 0.0, -2.5]; max = [2.0, 2.5, 2.5]; };\n"
	"network = { master_address = \"127.0.0.1\"; };\n"
	"trackers = (\n";
static const char room_tail[] = "\t// the one on the ceiling\n"
				"\t{ name = \"art\"; kind = \"dtrack\"; dtrack = { port = %u; };\n"
				"\t  bind = ( { body = \"wand\"; sensor = \"flystick0\"; /* mounted askew */ } ); } );\n"
				"control_socket = \"%s\";\n";

static const double known[POINTS][3] = { { -1.5, 0, -1.5 }, { 1.5, 0, -1.5 }, { -1.5, 2, -1.5 },
					 { 0.3, 0.8, 0.2 }, { 1, 0, 1 },      { -0.7, 1.2, 0.9 } };
static const char points_text[] = "a -1.5 0 -1.5\nb 1.5 0 -1.5\nc -1.5 2 -1.5\nd 0.3 0.8 0.2\n"
				  "e 1 0 1\nf -0.7 1.2 0.9\n";
static const double arm[3] = { 0.02, -0.05, -0.2 };

struct fixture {
	struct controller controller;
	char dir[64], layout[100], points[100], kept[100], socket[100];
	struct unit_random random;
	/* The command. */
	pid_t pid;
	int in, out;
	char said[16384];
	size_t said_len, looked;
};

/* ---- the command ---- */

/* Its words, after "grotto trackers calibrate --layout FILE"; ended by NULL. */
static void start(struct fixture *f, const char *const *words)
{
	const char *argv[24] = { NULL, "trackers", "calibrate", "--layout", f->layout };
	const char *folder = getenv("builddir");
	char path[1024];
	int in[2], out[2], n = 5;

	snprintf(path, sizeof path, "%s/tools/grotto", folder ? folder : ".");
	argv[0] = path;
	while (*words && n < 23)
		argv[n++] = *words++;
	assert_true(pipe2(in, O_CLOEXEC) == 0 && pipe2(out, O_CLOEXEC) == 0);
	f->pid = fork();
	if (f->pid == 0) {
		dup2(in[0], STDIN_FILENO);
		dup2(out[1], STDOUT_FILENO);
		dup2(out[1], STDERR_FILENO);
		execv(path, (char *const *)argv);
		_exit(127);
	}
	close(in[0]);
	close(out[1]);
	f->in = in[1];
	f->out = out[0];
	f->said_len = f->looked = 0;
	f->said[0] = '\0';
}

/* More of what it says. False: it ended. */
static bool hear(struct fixture *f)
{
	struct pollfd p = { .fd = f->out, .events = POLLIN };
	ssize_t n;

	if (poll(&p, 1, 60000) <= 0)
		fail_msg("says nothing more after\n%s", f->said);
	n = read(f->out, f->said + f->said_len, sizeof f->said - 1 - f->said_len);
	if (n <= 0)
		return false;
	f->said_len += (size_t)n;
	f->said[f->said_len] = '\0';
	return true;
}

/* Until it has said that, after what was waited for before. */
static void wait_for(struct fixture *f, const char *words)
{
	const char *at;

	while (!(at = strstr(f->said + f->looked, words)))
		if (!hear(f))
			fail_msg("wanted \"%s\" of\n%s", words, f->said);
	f->looked = (size_t)(at - f->said) + strlen(words);
}

static void type(struct fixture *f, const char *line)
{
	if (write(f->in, line, strlen(line)) != (ssize_t)strlen(line))
		fail_msg("it ended:\n%s", f->said);
}

/* Enter, until it is content: of a machine that is slow, what was sent before may still be on its way. */
static void measure(struct fixture *f, const char *line)
{
	type(f, line);
	for (;;) {
		const char *good = strstr(f->said + f->looked, "samples, spread");
		const char *bad = strstr(f->said + f->looked, "; again\n");

		if (bad && (!good || bad < good)) {
			f->looked = (size_t)(bad - f->said) + 1;
			type(f, "\n");
		} else if (good) {
			f->looked = (size_t)(good - f->said) + 1;
			return;
		} else if (!hear(f)) {
			fail_msg("nothing was measured:\n%s", f->said);
		}
	}
}

static void ends_with(struct fixture *f, int status)
{
	int how;

	while (hear(f))
		;
	assert_int_equal(waitpid(f->pid, &how, 0), f->pid);
	close(f->in);
	close(f->out);
	f->pid = 0;
	if (!WIFEXITED(how) || WEXITSTATUS(how) != status)
		fail_msg("ended with %d, not %d:\n%s", how, status, f->said);
}

static void says(const struct fixture *f, const char *words)
{
	if (!strstr(f->said, words))
		fail_msg("wanted \"%s\" of\n%s", words, f->said);
}

static void write_file(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");

	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

static void write_layout(struct fixture *f)
{
	char text[3000];
	const int len = snprintf(text, sizeof text, "%s", room_head);

	snprintf(text + len, sizeof text - (size_t)len, room_tail, (unsigned)f->controller.port, f->socket);
	write_file(f->layout, text);
}

static char *read_file(const char *path)
{
	char *text = calloc(1, 10000);
	FILE *file = fopen(path, "r");

	assert_non_null(file);
	assert_true(fread(text, 1, 9999, file) > 0);
	fclose(file);
	return text;
}

static int setup(void **state)
{
	struct fixture *f = calloc(1, sizeof *f);

	f->random = unit_random_start("device");
	strcpy(f->dir, "/tmp/grotto-calibrate-XXXXXX");
	if (!mkdtemp(f->dir))
		return -1;
	snprintf(f->layout, sizeof f->layout, "%s/room.cave", f->dir);
	snprintf(f->points, sizeof f->points, "%s/points", f->dir);
	snprintf(f->kept, sizeof f->kept, "%s/kept", f->dir);
	snprintf(f->socket, sizeof f->socket, "%s/control", f->dir);
	controller_init(&f->controller, &f->random, arm);
	write_layout(f);
	write_file(f->points, points_text);
	*state = f;
	return pthread_create(&f->controller.thread, NULL, run_controller, &f->controller);
}

static int teardown(void **state)
{
	struct fixture *f = *state;

	pthread_mutex_lock(&f->controller.lock);
	f->controller.stop = true;
	pthread_mutex_unlock(&f->controller.lock);
	pthread_join(f->controller.thread, NULL);
	if (f->pid > 0) {
		kill(f->pid, SIGKILL);
		waitpid(f->pid, NULL, 0);
	}
	close(f->controller.fd);
	unlink(f->layout);
	unlink(f->points);
	unlink(f->kept);
	unlink(f->socket);
	/* No temporary file is left. */
	if (rmdir(f->dir) < 0)
		return -1;
	free(f);
	return 0;
}

/* ---- what came of it ---- */

static struct layout *load(const struct fixture *f)
{
	struct layout *layout = NULL;
	struct gr_diag diag = { 0 };

	if (layout_load(f->layout, &layout, &diag) != GR_OK) {
		unit_diag_print(&diag);
		fail_msg("the layout does not load");
	}
	gr_diag_finish(&diag);
	return layout;
}

static double base_error_m(const struct fixture *f, const struct layout_tracker *tracker, double *turn_rad)
{
	const struct rotation turn = rotation_from(tracker->room_base.pose.q);
	const struct align_fit found = { .R = dmat3_from_rotation(&turn) };
	const struct align_room truth = { .R = f->controller.R };
	double square = 0;

	*turn_rad = align_turn_error(&truth, &found);
	for (int i = 0; i < 3; i++)
		square += pow((double)tracker->room_base.position[i] - f->controller.t[i], 2);
	return sqrt(square);
}

/* A master's trackers with that layout put the wand where it is. */
static void wand_is_where_it_is(struct fixture *f, const struct layout *layout)
{
	const double at[3] = { -0.2, 1.4, 0.6 };
	struct master_input input = { 0 };
	struct trackers trackers;
	struct gr_diag diag = { 0 };
	double off = 1;

	put_wand(&f->controller, at, MOTION_STILL, &f->random);
	assert_int_equal(trackers_open(&trackers, layout, &diag), GR_OK);
	assert_int_equal(trackers_start(&trackers), GR_OK);
	for (const int64_t since = gr_clock_now(&gr_clock_monotonic); off > 0.003;
	     net_again(since, trackers.all[0].device)) {
		const int64_t now_ns = gr_clock_now(&gr_clock_monotonic);

		trackers_poll(&trackers, now_ns, now_ns);
		trackers_sample(&trackers, now_ns, &input);
		off = input.wand.tracked ? 0 : 1;
		for (int i = 0; i < 3; i++)
			off += fabs((double)input.wand.T_room_body.p[i] - at[i]);
	}
	trackers_close(&trackers);
	gr_diag_finish(&diag);
}

/* Goes to all points: the first is held badly, one is another than it should be, one is said by a button. */
static void answer_points(struct fixture *f)
{
	for (int k = 0; k < POINTS; k++) {
		double at[3];
		char wanted[40];

		snprintf(wanted, sizeof wanted, "%d of %d: %c (", k + 1, POINTS, 'a' + k);
		wait_for(f, wanted);
		memcpy(at, known[k], sizeof at);
		at[2] += k == 4 ? 0.2 : 0;
		if (k == 0) {
			put_wand(&f->controller, at, MOTION_SHAKE, &f->random);
			type(f, "what\n");
			wait_for(f, "Enter measures");
			type(f, "\n");
			wait_for(f, "hold it still; again");
			wait_for(f, wanted);
		}
		put_wand(&f->controller, at, MOTION_STILL, &f->random);
		if (k == 2) {
			pthread_mutex_lock(&f->controller.lock);
			f->controller.button = true;
			pthread_mutex_unlock(&f->controller.lock);
			measure(f, "");
			pthread_mutex_lock(&f->controller.lock);
			f->controller.button = false;
			pthread_mutex_unlock(&f->controller.lock);
		} else {
			measure(f, "\n");
		}
	}
}

static void arm_base_and_where_the_wand_is(void **state)
{
	struct fixture *f = *state;
	static const char *const pivot[] = { "--pivot", "--open", "--seconds", "1", NULL };
	const char *const points[] = { "--open", "--points", f->points, "--seconds", "0.2", "--keep", f->kept, NULL };
	const char *const recorded[] = { "--points", f->kept, NULL };
	const char *const dry[] = { "--points", f->kept, "--dry-run", NULL };
	struct layout *layout;
	char *first, *text;
	double turn_rad, place_m;

	start(f, pivot);
	wait_for(f, "put the wand's tip on a point");
	put_wand(&f->controller, known[3], MOTION_TURN, &f->random);
	type(f, "\n");
	ends_with(f, 0);
	layout = load(f);
	for (int i = 0; i < 3; i++)
		assert_float_equal(layout->trackers[0].bindings[0].sensor_body.position[i], arm[i], 0.002);
	layout_destroy(&layout);

	start(f, points);
	answer_points(f);
	ends_with(f, 0);
	says(f, "wrong, left out");
	says(f, "5 of 6 points agree");
	layout = load(f);
	place_m = base_error_m(f, &layout->trackers[0], &turn_rad);
	printf("# base: %.2f mm and %.3f degrees off\n", place_m * 1e3, turn_rad * 180 / M_PI);
	assert_true(place_m < 0.005 && turn_rad < 0.002);
	wand_is_where_it_is(f, layout);
	layout_destroy(&layout);

	/* All else stands as it did, and the notes say which point was left out. */
	first = read_file(f->layout);
	assert_memory_equal(first, room_head, strlen(room_head));
	assert_non_null(strstr(first, "\t// the one on the ceiling\n"));
	assert_non_null(strstr(first, "/* mounted askew */"));
	assert_non_null(strstr(first, "base = { /* calibrated 2"));
	assert_non_null(strstr(first, "; without e */"));
	assert_non_null(strstr(first, "bind = ( { /* calibrated 2"));

	/* From what was kept the same comes again, without a device. */
	start(f, dry);
	ends_with(f, 0);
	says(f, "left as it is");
	text = read_file(f->layout);
	assert_string_equal(text, first);
	free(text);
	start(f, recorded);
	ends_with(f, 0);
	says(f, "written");
	layout = load(f);
	assert_true(fabs(base_error_m(f, &layout->trackers[0], &turn_rad) - place_m) < 1e-6);
	layout_destroy(&layout);
	free(first);
}

/* ---- by a master ---- */

/* Answers "trackers" as a master does, on its control socket, until it is told to stop. */
struct master {
	struct trackers trackers;
	int listener;
	_Atomic bool stop;
	pthread_t thread;
};

static void answer(struct master *m, int fd)
{
	static char text[65536];
	const int64_t now_ns = gr_clock_now(&gr_clock_monotonic);
	size_t len;
	char c = 0;

	while (c != '\n')
		if (read(fd, &c, 1) != 1)
			return;
	trackers_poll(&m->trackers, now_ns, now_ns);
	if (trackers_answer(&m->trackers, now_ns, text, sizeof text - 1, &len) == GR_OK) {
		text[len] = '\n';
		(void)!write(fd, text, len + 1);
	}
}

static void *run_master(void *ctx)
{
	struct master *m = ctx;

	while (!m->stop) {
		struct pollfd p = { .fd = m->listener, .events = POLLIN };
		int fd;

		if (poll(&p, 1, 20) <= 0)
			continue;
		fd = accept(m->listener, NULL, NULL);
		answer(m, fd);
		close(fd);
	}
	return NULL;
}

/* The sensor, not the tip, is there. */
static void put_wand_sensor(struct fixture *f, const double at[3])
{
	struct controller *c = &f->controller;
	struct dmat3 R;
	double to[3];

	put_wand(c, at, MOTION_STILL, &f->random);
	pthread_mutex_lock(&c->lock);
	R = dmat3_from_rotation(&c->turn);
	dmat3_apply(&R, arm, to);
	dmat3_apply(&c->R, to, to);
	for (int i = 0; i < 3; i++)
		c->at[i] += to[i];
	pthread_mutex_unlock(&c->lock);
	nanosleep(&(struct timespec){ 0, 10 * PERIOD_NS }, NULL);
}

static void by_a_running_master(void **state)
{
	struct fixture *f = *state;
	const char *const points[] = { "--points", f->points, "--keep", f->kept, "--seconds", "0.6", NULL };
	const char *const rest[] = { "--points", f->kept, "--seconds", "0.6", NULL };
	struct sockaddr_un at = { .sun_family = AF_UNIX };
	struct layout *layout = load(f), *after;
	struct gr_diag diag = { 0 };
	struct master m = { 0 };
	double turn_rad, place_m;
	char *text, *other;

	snprintf(at.sun_path, sizeof at.sun_path, "%s", f->socket);
	m.listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	assert_int_equal(bind(m.listener, (const struct sockaddr *)&at, sizeof at), 0);
	assert_int_equal(listen(m.listener, 4), 0);
	assert_int_equal(trackers_open(&m.trackers, layout, &diag), GR_OK);
	assert_int_equal(trackers_start(&m.trackers), GR_OK);
	assert_int_equal(pthread_create(&m.thread, NULL, run_master, &m), 0);

	/* The arm is not in the layout: the sensor itself is held at the points. */
	start(f, points);
	for (int k = 0; k < POINTS; k++) {
		char wanted[40];

		snprintf(wanted, sizeof wanted, "%d of %d:", k + 1, POINTS);
		wait_for(f, wanted);
		put_wand_sensor(f, known[k]);
		if (k == 2)
			type(f, "s\n");
		else
			measure(f, "\n");
	}
	ends_with(f, 0);
	says(f, "5 of 5 points agree");
	after = load(f);
	place_m = base_error_m(f, &after->trackers[0], &turn_rad);
	printf("# by a master: base %.2f mm and %.3f degrees off\n", place_m * 1e3, turn_rad * 180 / M_PI);
	assert_true(place_m < 0.005 && turn_rad < 0.002);

	/* Of a layout that the master does not run with nothing is taken. */
	text = read_file(f->layout);
	other = unit_replace(text, "flystick0", "flystick1");
	write_file(f->layout, other);
	start(f, points);
	ends_with(f, 1);
	says(f, "has no tracker \"art\" whose wand is on that sensor");
	free(other);
	free(text);

	/* The one that was skipped is asked for; whoever changes the layout meanwhile keeps what he wrote. */
	write_layout(f);
	start(f, rest);
	wait_for(f, "3 of 6: c");
	write_file(f->layout, "# mine\n");
	put_wand_sensor(f, known[2]);
	measure(f, "\n");
	ends_with(f, 1);
	text = read_file(f->layout);
	assert_string_equal(text, "# mine\n");
	free(text);

	m.stop = true;
	pthread_join(m.thread, NULL);
	close(m.listener);
	trackers_close(&m.trackers);
	layout_destroy(&layout);
	layout_destroy(&after);
	gr_diag_finish(&diag);
}

/* ---- of what was kept ---- */

static void recorded(struct fixture *f, const char *points, const char *option, const char *wanted)
{
	const char *const options[] = { "--points", f->kept, option, NULL };
	char *text;

	write_layout(f);
	write_file(f->kept, points);
	start(f, options);
	ends_with(f, 0);
	text = read_file(f->layout);
	if (!strstr(text, wanted))
		fail_msg("wanted \"%s\" of\n%s", wanted, text);
	layout_destroy(&(struct layout *){ load(f) });
	free(text);
}

static void arms_and_scales(void **state)
{
	struct fixture *f = *state;

	/* The base is where it is without one: in the room's middle; of three arms one is another. */
	recorded(f, "a 0 0 0  0 0.1 0  0 0 0 1\nb 1 1 1  1 0.9 1  0 0 1 0\nc 2 0 0  2 0.1 0.2  0 0 0 1\n", "--arm",
		 "; without c */ offset = [0.00000, -0.10000, 0.00000];");
	/* In a device's metres that are half as long, turned to the left. */
	recorded(f, "a 0 0 0  0 0 0  0 0 0 1\nb 1 0 0  0 0 2  0 0 0 1\nc 0 1 0  0 2 0  0 0 0 1\n"
		    "d 0 0 -1  2 0 0  0 0 0 1\ne 1 1 1  -2 2 2  0 0 0 1\n",
		 "--scale",
		 "position = [0.00000, 0.00000, 0.00000]; heading_deg = 90.0000; pitch_deg = 0.0000; roll_deg = 0.0000; "
		 "scale = 0.5; };");
}

/* ---- what is refused ---- */

static void refused(struct fixture *f, int status, const char *words, const char *const *options)
{
	start(f, options);
	close(f->in);
	f->in = open("/dev/null", O_WRONLY | O_CLOEXEC);
	ends_with(f, status);
	says(f, words);
}

static void what_is_refused(void **state)
{
	struct fixture *f = *state;
	char *before = read_file(f->layout), *after;
	const char *const none[] = { NULL };
	const char *const both[] = { "--pivot", "--arm", "--points", f->points, NULL };
	const char *const nobody[] = { "--points", f->points, "--body", "head", NULL };
	const char *const unknown[] = { "--points", f->points, "--tracker", "arts", NULL };
	const char *const no_master[] = { "--points", f->points, NULL };
	const char *const ended[] = { "--points", f->points, "--open", NULL };
	const char *const line[] = { "--points", f->kept, NULL };
	const char *const missing[] = { "--points", "/nowhere/at/all", NULL };

	refused(f, 2, "needs --points FILE", none);
	refused(f, 2, "two ways to the same", both);
	refused(f, 2, "no binding of \"art\" gives the position of the head", nobody);
	refused(f, 2, "has no tracker \"arts\"", unknown);
	refused(f, 1, "--open opens the device itself", no_master);
	refused(f, 1, "the input ended before all was measured", ended);
	refused(f, 1, "cannot be opened", missing);
	write_file(f->kept, "a 0 0 0 0 0 0 0 0 0 1\nb 1 0 0 1 0 0 0 0 0 1\nc 2 0 0 2 0 0 0 0 0 1\n");
	refused(f, 1, "on a line (spread 816 mm along it, 0 mm across)", line);
	write_file(f->kept, "a 0 0 0 0 0 0 0 0 0 1\nb 1 0 0 1 0 0 0 0 0 1\n");
	refused(f, 1, "2 points: at least 3 are needed", line);
	after = read_file(f->layout);
	assert_string_equal(before, after);
	free(before);
	free(after);
}

int main(void)
{
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
	const struct CMUnitTest tests[] = {
		WITH(arm_base_and_where_the_wand_is),
		WITH(by_a_running_master),
		WITH(arms_and_scales),
		WITH(what_is_refused),
	};

	signal(SIGPIPE, SIG_IGN);
	gr_log_init("test", GR_LOG_ERROR);
	return cmocka_run_group_tests_name("calibrate_device", tests, NULL, NULL);
}
