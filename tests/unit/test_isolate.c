/* Work in a process of its own: what comes back of each way to end, and that blocks are checked. */
#include "config.h" /* memfd_create */

#include "tests/unit/unit.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/scene/isolate.h"
#include "renderer/scene/scene_block.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
#define SANITIZED true
#else
#define SANITIZED false
#endif

static const struct isolate_limits usual = {
	.memory = (size_t)64 << 20,
	.block = 1 << 20,
	.cpu_s = 20,
	.wall_ms = 30000,
};

static int hand_back(void *context, int fd)
{
	return isolate_write(fd, context, strlen(context));
}

static int die(void *context, int fd)
{
	(void)fd;
	raise(*(int *)context);
	return 0;
}

static int null_read(void *context, int fd)
{
	volatile const char *volatile *at = context;

	(void)fd;
	return **at;
}

static int leave(void *context, int fd)
{
	(void)fd;
	return *(int *)context;
}

static int spin(void *context, int fd)
{
	volatile unsigned count = 1;

	(void)context;
	(void)fd;
	while (count)
		count = count | 1;
	return 0;
}

static int rest(void *context, int fd)
{
	(void)context;
	(void)fd;
	while (pause() != 0)
		;
	return 0;
}

static int take_memory(void *context, int fd)
{
	void *volatile got = malloc((size_t)1 << 30);

	(void)context;
	return got ? 3 : hand_back("none", fd);
}

static int write_much(void *context, int fd)
{
	static const char some[4096];

	(void)context;
	for (int i = 0; i < 1024; i++) {
		if (isolate_write(fd, some, sizeof some) != GR_OK)
			return 4;
	}
	return 0;
}

/* A block that somebody keeps a hand on is not taken. */
static int keep_mapped(void *context, int fd)
{
	int sync = *(int *)context;

	hand_back("x", fd);
	if (mmap(NULL, 1, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0) == MAP_FAILED)
		return 5;
	if (fork() == 0) {
		char byte;

		_exit(read(sync, &byte, 1) < 0);
	}
	return 0;
}

static void expect(isolate_work work, void *context, const struct isolate_limits *limits,
		   enum isolate_how how, int number)
{
	struct isolate_end end;

	assert_int_equal(isolate_run(limits, work, context, &end), GR_OK);
	assert_int_equal(end.how, how);
	assert_int_equal(end.number, number);
	isolate_finish(&end);
}

static void test_ends(void **state)
{
	struct isolate_limits little = usual;
	struct isolate_end end;
	const char *nowhere = NULL;
	int number = SIGABRT;

	(void)state;
	assert_int_equal(isolate_run(&usual, hand_back, "some bytes", &end), GR_OK);
	assert_int_equal(end.how, ISOLATE_DONE);
	assert_int_equal(end.len, 10);
	assert_memory_equal(end.block, "some bytes", 10);
	isolate_finish(&end);
	expect(die, &number, &usual, ISOLATE_SIGNAL, SIGABRT);
	number = SIGKILL;
	expect(die, &number, &usual, ISOLATE_SIGNAL, SIGKILL);
	if (!SANITIZED) /* they would report it, as they should */
		expect(null_read, &nowhere, &usual, ISOLATE_SIGNAL, SIGSEGV);
	number = 7;
	expect(leave, &number, &usual, ISOLATE_STATUS, 7);
	little.cpu_s = 1;
	expect(spin, NULL, &little, ISOLATE_SIGNAL, SIGXCPU);
	little.wall_ms = 50;
	expect(rest, NULL, &little, ISOLATE_LATE, 0);
	expect(write_much, NULL, &usual, ISOLATE_SIGNAL, SIGXFSZ);
	if (!SANITIZED) {
		assert_int_equal(isolate_run(&usual, take_memory, NULL, &end), GR_OK);
		assert_int_equal(end.how, ISOLATE_DONE);
		isolate_finish(&end);
	}
}

static void test_sealed(void **state)
{
	struct isolate_end end;
	int ends[2];

	(void)state;
	assert_int_equal(pipe(ends), 0);
	assert_int_equal(isolate_run(&usual, keep_mapped, &ends[0], &end), GR_ERR_IO);
	assert_null(end.block);
	assert_int_equal(write(ends[1], "x", 1), 1);
	close(ends[0]);
	close(ends[1]);
	assert_int_equal(isolate_run(&usual, leave, &(int){ 0 }, &end), GR_ERR_IO); /* empty */
}

static struct scene *small_scene(void)
{
	struct scene *s = calloc(1, sizeof *s);

	assert_non_null(s);
	s->vertices = calloc(3, sizeof s->vertices[0]);
	s->indices = calloc(3, sizeof s->indices[0]);
	s->draws = calloc(1, sizeof s->draws[0]);
	s->materials = calloc(1, sizeof s->materials[0]);
	s->images = calloc(1, sizeof s->images[0]);
	assert_true(s->vertices && s->indices && s->draws && s->materials && s->images);
	s->vertex_count = s->index_count = 3;
	s->draw_count = s->material_count = s->image_count = 1;
	for (unsigned i = 0; i < 3; i++) {
		s->vertices[i].position[i] = 1.0f;
		s->indices[i] = i;
	}
	s->draws[0].index_count = 3;
	strcpy(s->materials[0].name, "paint");
	s->materials[0].emission_image = -1;
	s->materials[0].two_sided = true;
	s->images[0] = (struct scene_image){ strdup("a.png"), 2, 1, true, calloc(2, 4) };
	s->images[0].rgba[5] = 77;
	s->dropped_index = 4;
	return s;
}

/* The block of a scene and two lines, as bytes; the caller frees. */
static uint8_t *block_of(const struct scene *scene, int result, size_t *len)
{
	struct gr_diag diag = { 0 };
	int fd = memfd_create("block", 0);
	uint8_t *bytes;

	gr_diag_add(&diag, GR_DIAG_WARNING, "a.glb", 0, NULL, "odd");
	gr_diag_add(&diag, GR_DIAG_ERROR, "a.glb", 0, NULL, "wrong");
	assert_int_equal(scene_block_write(fd, result, scene, &diag), GR_OK);
	gr_diag_finish(&diag);
	*len = (size_t)lseek(fd, 0, SEEK_END);
	bytes = malloc(*len);
	assert_int_equal(pread(fd, bytes, *len, 0), *len);
	close(fd);
	return bytes;
}

static int read_copy(const uint8_t *bytes, size_t len, struct scene **out, struct gr_diag *diag)
{
	uint8_t *copy = unit_copy(bytes, len);
	int result = scene_block_read(copy, len, out, diag);

	free(copy);
	return result;
}

static void test_block(void **state)
{
	struct scene *scene = small_scene(), *back;
	struct gr_diag diag = { 0 };
	size_t len;
	uint8_t *bytes = block_of(scene, GR_OK, &len);

	(void)state;
	assert_int_equal(read_copy(bytes, len, &back, &diag), GR_OK);
	assert_int_equal(diag.count, 2);
	assert_int_equal(diag.errors, 1);
	assert_string_equal(diag.items[1].text, "a.glb: wrong");
	assert_memory_equal(back->vertices, scene->vertices, 3 * sizeof scene->vertices[0]);
	assert_string_equal(back->materials[0].name, "paint");
	assert_true(back->materials[0].two_sided);
	assert_false(back->materials[0].tinted_specular);
	assert_int_equal(back->materials[0].emission_image, -1);
	assert_string_equal(back->images[0].name, "a.png");
	assert_int_equal(back->images[0].rgba[5], 77);
	assert_int_equal(back->dropped_index, 4);
	scene_destroy(&back);
	for (size_t cut = 0; cut < len; cut++) {
		assert_int_equal(read_copy(bytes, cut, &back, &diag), GR_ERR_FORMAT);
		assert_null(back);
	}
	free(bytes);
	gr_diag_finish(&diag);
	bytes = block_of(NULL, GR_ERR_CONFIG, &len);
	assert_int_equal(read_copy(bytes, len, &back, &diag), GR_ERR_CONFIG);
	assert_null(back);
	gr_diag_finish(&diag);
	free(bytes);
	scene_destroy(&scene);
}

/* Scenes whose parts do not fit are none. */
static void test_misfits(void **state)
{
	(void)state;
	for (int fault = 0; fault < 8; fault++) {
		struct scene *scene = small_scene(), *back;
		struct gr_diag diag = { 0 };
		uint8_t *bytes;
		size_t len;

		switch (fault) {
		case 0: scene->indices[2] = 3; break;
		case 1: scene->vertices[1].normal[0] = NAN; break;
		case 2: scene->draws[0].first_index = 3; break;
		case 3: scene->draws[0].material = 1; break;
		case 4: scene->draws[0].index_count = 2; break;
		case 5: scene->materials[0].diffuse_image = 1; break;
		case 6: memset(scene->materials[0].name, 'a', 64); break;
		default: scene->materials[0].emission[2] = INFINITY; break;
		}
		bytes = block_of(scene, GR_OK, &len);
		assert_int_equal(read_copy(bytes, len, &back, &diag), GR_ERR_FORMAT);
		assert_null(back);
		gr_diag_finish(&diag);
		free(bytes);
		scene_destroy(&scene);
	}
}

static void test_changed_blocks(void **state)
{
	struct unit_random random = unit_random_start("changed blocks");
	struct scene *scene = small_scene(), *back;
	int rounds = getenv("GROTTO_LONG") ? 1000000 : 20000, taken = 0;
	size_t len;
	uint8_t *bytes = block_of(scene, GR_OK, &len);

	(void)state;
	for (int i = 0; i < rounds; i++) {
		struct gr_diag diag = { 0 };
		uint8_t *copy = unit_copy(bytes, len);

		for (uint32_t k = 1 + unit_random_u32(&random) % 4; k > 0; k--)
			copy[unit_random_u32(&random) % len] = (uint8_t)unit_random_u32(&random);
		if (scene_block_read(copy, len, &back, &diag) == GR_OK) {
			taken++;
			scene_destroy(&back);
		}
		gr_diag_finish(&diag);
		free(copy);
	}
	printf("# %d changed blocks: %d still fit\n", rounds, taken);
	free(bytes);
	scene_destroy(&scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_ends),	cmocka_unit_test(test_sealed),
		cmocka_unit_test(test_block),	cmocka_unit_test(test_misfits),
		cmocka_unit_test(test_changed_blocks),
	};

	gr_log_init("test_isolate", GR_LOG_INFO);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
