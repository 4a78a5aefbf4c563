/* A node's renderer is made anew for the room's plan: fed, stopped, refused, impossible. */
#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "config/layout.h"
#include "daemon/loop.h"
#include "daemon/node_light.h"
#include "tests/unit/gl.h"

#include <pthread.h>
#include <signal.h>
#include <sodium.h>
#include <stdatomic.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

static struct target *target;
static struct loop *loop;
static struct layout layout; /* of it only where the head begins is asked */
static struct scene_file *file;
static struct scene *scene;
static int manager = -1; /* hears what systemd would */
static struct sockaddr_un address = { .sun_family = AF_UNIX };
static pthread_t manager_thread;
static atomic_uint fed; /* WATCHDOG=1 */

static struct node_light light(void)
{
	return (struct node_light){
		.target = target, .layout = &layout, .file = file, .scene = scene,
		.params = {
			.width = 32, .height = 32, .eyes = RENDERER_MONO, .wall_given = true, .quiet = true,
			.wall = { { -1.5f, 0, -1.5f }, { 1.5f, 0, -1.5f }, { -1.5f, 2.25f, -1.5f } },
		},
	};
}

/* Takes what comes, as the manager does: who speaks would wait for it when its queue is full. */
static void *hear(void *unused)
{
	char text[600];
	ssize_t n;

	while ((n = recv(manager, text, sizeof text, 0)) > 0 && memcmp(text, "END", 3) != 0)
		atomic_fetch_add(&fed, n == 10 && !memcmp(text, "WATCHDOG=1", 10));
	return unused;
}

/* What a node whose GPU is faster by a factor would have chosen. */
static uint64_t plan_of(const struct node_light *node, double factor)
{
	struct gi_costs costs = node->own.costs;
	struct gi_plan plan;

	costs.surfel_frame /= factor;
	costs.surfel_tap /= factor;
	costs.surfel_link /= factor;
	costs.lattice_frame /= factor;
	costs.lattice_cell_step /= factor;
	gi_plan_make(&plan, &node->own.facts, &file->gi, &costs);
	return plan.code;
}

static void takes_the_rooms_plan(void **state)
{
	struct node_light node = light();
	uint64_t own, theirs = 0;
	unsigned before;

	(void)state;
	assert_int_equal(node_light_open(&node), GR_OK);
	assert_true(node.planned);
	own = renderer_plan(node.renderer)->code;
	assert_int_equal(own, node.own.plan.code);
	for (double factor = 1.5; factor < 1e4 && (theirs == 0 || theirs == own); factor *= 1.5)
		theirs = plan_of(&node, factor);
	assert_int_not_equal(theirs, own);
	before = atomic_load(&fed);
	assert_int_equal(node_light_adopt(&node, theirs), GR_OK);
	printf("# the watchdog was fed %u times while the room's plan was baked\n",
	       atomic_load(&fed) - before);
	assert_true(atomic_load(&fed) >= before + 4);
	assert_int_equal(renderer_plan(node.renderer)->code, theirs);
	assert_int_equal(node.own.plan.code, own);
	/* and back */
	assert_int_equal(node_light_adopt(&node, own), GR_OK);
	assert_int_equal(renderer_plan(node.renderer)->code, own);
	node_light_close(&node);
}

static void refuses_what_is_none(void **state)
{
	struct node_light node = light();
	struct renderer *before;

	(void)state;
	assert_int_equal(node_light_open(&node), GR_OK);
	before = node.renderer;
	assert_int_equal(node_light_adopt(&node, 0), GR_ERR_MISMATCH);
	assert_int_equal(node_light_adopt(&node, UINT64_MAX), GR_ERR_MISMATCH);
	assert_ptr_equal(node.renderer, before);
	assert_int_equal(renderer_plan(node.renderer)->code, node.own.plan.code);
	node_light_close(&node);
}

/* One that passes for a plan, and has more surfels than a set may hold. */
static void goes_back_where_it_cannot(void **state)
{
	struct node_light node = light();
	struct scene_gi gi = file->gi;
	uint64_t own;

	(void)state;
	assert_int_equal(node_light_open(&node), GR_OK);
	own = node.own.plan.code;
	gi = node.own.plan.gi;
	gi.method = SCENE_GI_SURFELS;
	gi.links = 16;
	for (gi.spacing_m = 1; gi_plan_surfels(&node.own.facts, &gi) < 1.6e5;)
		gi.spacing_m *= 0.95f;
	assert_int_equal(node_light_adopt(&node, gi_plan_code(&gi)), GR_ERR_UNSUPPORTED);
	assert_non_null(node.renderer);
	assert_int_equal(renderer_plan(node.renderer)->code, own);
	node_light_close(&node);
}

/* The manager must not wait until all is baked. */
static void ends_when_told(void **state)
{
	struct node_light node = light();

	(void)state;
	assert_false(loop_signal_waits());
	assert_int_equal(node_light_open(&node), GR_OK);
	assert_int_equal(kill(getpid(), SIGTERM), 0);
	assert_true(loop_signal_waits());
	assert_int_equal(node_light_adopt(&node, plan_of(&node, 16)), GR_NOTHING);
	assert_null(node.renderer);
	assert_int_equal(node_light_open(&node), GR_NOTHING);
	/* it still stops the loop */
	assert_int_equal(loop_once(loop, 0), GR_OK);
	assert_int_equal(loop_signal(loop), SIGTERM);
	assert_false(loop_signal_waits());
	node_light_close(&node);
}

static void listen_as_manager(const char *folder)
{
	snprintf(address.sun_path, sizeof address.sun_path, "%s/notify", folder);
	manager = socket(AF_UNIX, SOCK_DGRAM, 0);
	assert_int_equal(bind(manager, (const struct sockaddr *)&address, sizeof address), 0);
	setenv("NOTIFY_SOCKET", address.sun_path, 1);
	setenv("WATCHDOG_USEC", "40", 1); /* fed as often as there is a reason */
	unsetenv("WATCHDOG_PID");
	assert_int_equal(pthread_create(&manager_thread, NULL, hear, NULL), 0);
}

static void stop_listening(void)
{
	int fd = socket(AF_UNIX, SOCK_DGRAM, 0);

	sendto(fd, "END", 3, 0, (const struct sockaddr *)&address, sizeof address);
	pthread_join(manager_thread, NULL);
	close(fd);
	close(manager);
}

static void load(void)
{
	const char *source = getenv("srcdir");
	struct gr_diag diag = { 0 };
	char path[1024];

	snprintf(path, sizeof path, "%s/scenes/box.scene", source ? source : ".");
	assert_int_equal(scene_file_load(path, &file, &diag), GR_OK);
	assert_int_equal(scene_import(file, &scene, &diag), GR_OK);
	gr_diag_finish(&diag);
	free(file->path);
	file->path = NULL; /* nothing baked is kept */
	file->gi.method = SCENE_GI_AUTO;
	file->gi.budget_ms = 0.1f;
	layout.start_head = (struct gr_pose){ { 0, 1.7f, 0 }, { 0, 0, 0, 1 } };
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(takes_the_rooms_plan),
		cmocka_unit_test(refuses_what_is_none),
		cmocka_unit_test(goes_back_where_it_cannot),
		cmocka_unit_test(ends_when_told),
	};
	char folder[] = "/tmp/grotto-node-light-XXXXXX", command[64];
	int failed;

	gr_log_init("test_node_light", GR_LOG_NOTICE);
	/* signals first: no thread that is made later may take them */
	if (sodium_init() < 0 || !mkdtemp(folder) || loop_create(&loop) < 0 || loop_catch_signals(loop) < 0)
		return 1;
	setenv("CACHE_DIRECTORY", folder, 1);
	target = gl_target_or_skip(32, 32);
	listen_as_manager(folder);
	load();
	failed = cmocka_run_group_tests(tests, NULL, NULL);
	scene_destroy(&scene);
	scene_file_destroy(&file);
	target_destroy(&target);
	loop_destroy(&loop);
	stop_listening();
	snprintf(command, sizeof command, "rm -r %s", folder);
	return system(command) == 0 ? failed : 1;
}
