/* Where bakes are kept: beside the scene, in the cache, or nowhere; and one bakes for all. */
#include <config.h>

#include "base/result.h"
#include "renderer/gi/surfel_file.h"
#include "renderer/gi/surfel_store.h"
#include "tests/unit/baked_room.h"

#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static struct baked_room room;

static char *in_folder(const char *name)
{
	static char path[BAKED_ROOM_PATH_BYTES];

	return baked_room_path(&room, name, path);
}

static int set_up(void **state)
{
	(void)state;
	return baked_room_make(&room);
}

static int tear_down(void **state)
{
	(void)state;
	return baked_room_remove(&room);
}

static bool is_said(const struct gr_diag *diag, const char *words)
{
	for (size_t i = 0; i < diag->count; i++)
		if (strstr(diag->items[i].text, words))
			return true;
	return false;
}

/* The usual places for the scene of that name in the folder. */
static void keep_for(struct surfel_store *store, const char *name)
{
	const struct scene_file file = { .path = in_folder(name) };

	assert_int_equal(surfel_store_init(store, &file), GR_OK);
}

/* The store gives the room's set; how, is in *done. */
static void get(const struct surfel_store *store, struct gr_diag *diag, struct surfel_store_done *done)
{
	struct surfel_set *found;

	assert_int_equal(surfel_store_get(store, &found, room.scene, NULL, &baked_room_coarse, diag, done),
			 GR_OK);
	assert_int_equal(surfel_set_hash(found), surfel_set_hash(room.set));
	surfel_set_destroy(&found);
}

static void bakes_once(void **state)
{
	char kept[128];
	struct surfel_store store;
	struct surfel_store_done done;
	struct gr_diag diag = { 0 };

	(void)state;
	snprintf(kept, sizeof kept, "%s/my.surfels", room.folder);
	keep_for(&store, "my.scene");
	assert_string_equal(store.beside, kept);
	for (int round = 0; round < 4; round++) {
		bool damaged = round == 2;

		if (damaged) {
			int fd = open(kept, O_WRONLY);

			assert_int_equal(pwrite(fd, "x", 1, 1000), 1);
			close(fd);
		}
		get(&store, &diag, &done);
		assert_int_equal(done.baked, round == 0 || damaged);
		assert_string_equal(done.path, kept);
		assert_int_equal(diag.count, round >= 2);
	}
	gr_diag_finish(&diag);
	/* nothing else is left lying about */
	assert_int_equal(unlink(kept), 0);
	snprintf(kept, sizeof kept, "%s/my.surfels.lock", room.folder);
	assert_int_not_equal(access(kept, F_OK), 0);
	surfel_store_finish(&store);
}

/* What is done to a file that fits, and what is said of it. */
static void other_version(FILE *file)
{
	fseek(file, 12, SEEK_SET);
	fputc(99, file);
}

static void other_scene(FILE *file)
{
	int byte;

	fseek(file, 16, SEEK_SET);
	byte = fgetc(file);
	fseek(file, 16, SEEK_SET);
	fputc(byte ^ 0xff, file);
}

static void flipped_bit(FILE *file)
{
	int byte;

	fseek(file, 1000, SEEK_SET);
	byte = fgetc(file);
	fseek(file, 1000, SEEK_SET);
	fputc(byte ^ 0x10, file);
}

static void cut_short(FILE *file)
{
	fflush(file);
	assert_int_equal(ftruncate(fileno(file), 1000), 0);
}

static void emptied(FILE *file)
{
	fflush(file);
	assert_int_equal(ftruncate(fileno(file), 0), 0);
}

/* Refused with the reason, baked anew, and put in place: the next finds a file that fits. */
static void rebuilt(void **state)
{
	static const struct {
		void (*spoil)(FILE *file);
		const char *said;
	} faults[] = {
		{ other_version, "another version" }, { other_scene, "another scene" },
		{ flipped_bit, "checksum" },          { cut_short, "cut short" },
		{ emptied, "not a file" },
	};
	struct surfel_store_done done;
	struct surfel_store store;

	(void)state;
	assert_int_equal(surfel_store_at(&store, in_folder("my.surfels")), GR_OK);
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
		for (int round = 0; round < 3; round++) {
			struct gr_diag diag = { 0 };
			bool spoilt = round == 1;

			if (spoilt) {
				FILE *file = fopen(store.beside, "r+b");

				assert_non_null(file);
				faults[i].spoil(file);
				fclose(file);
			}
			get(&store, &diag, &done);
			assert_int_equal(done.baked, spoilt || (i == 0 && round == 0));
			assert_int_equal(diag.warnings, spoilt);
			if (spoilt && !is_said(&diag, faults[i].said))
				fail_msg("'%s' does not say '%s'", diag.items[0].text, faults[i].said);
			gr_diag_finish(&diag);
		}
	}
	unlink(store.beside);
	surfel_store_finish(&store);
}

static void goes_to_the_cache(void **state)
{
	char cache[160];
	struct surfel_store store;
	struct surfel_store_done done;
	struct gr_diag diag = { 0 };

	(void)state;
	/* a folder that is none cannot be written, by root neither */
	assert_int_equal(close(open(in_folder("file"), O_WRONLY | O_CREAT, 0600)), 0);
	snprintf(cache, sizeof cache, "%s/cache/grotto", room.folder);
	setenv("CACHE_DIRECTORY", cache, 1);
	keep_for(&store, "file/my.scene");
	assert_int_equal(strncmp(store.cache, cache, strlen(cache)), 0);
	for (int round = 0; round < 2; round++) {
		get(&store, &diag, &done);
		assert_int_equal(done.baked, round == 0);
		assert_string_equal(done.path, store.cache);
	}
	unlink(store.cache);
	rmdir(cache);
	*strrchr(cache, '/') = 0;
	rmdir(cache);
	/* and without one: still a set, and a warning */
	unsetenv("CACHE_DIRECTORY");
	free(store.cache);
	store.cache = NULL;
	gr_diag_finish(&diag);
	diag = (struct gr_diag){ 0 };
	get(&store, &diag, &done);
	assert_null(done.path);
	assert_int_equal(diag.warnings, 1);
	assert_true(is_said(&diag, "there is no cache") && is_said(&diag, strerror(ENOTDIR)));
	gr_diag_finish(&diag);
	surfel_store_finish(&store);
	unlink(in_folder("file"));
}

/* A place that lends its lock and then cannot take the file: the next one has it. */
static void full_after_the_lock(void **state)
{
	struct surfel_store_done done;
	struct gr_diag diag = { 0 };
	struct surfel_store store;
	char beside[128];

	(void)state;
	/* what stands where the file would be written, and is no file: root cannot write it either */
	snprintf(beside, sizeof beside, "%s/my.surfels", room.folder);
	snprintf(beside + strlen(beside), 32, ".%ld.new", (long)getpid());
	assert_int_equal(mkdir(beside, 0700), 0);
	*strstr(beside, ".surfels.") = 0;
	strcat(beside, ".surfels");
	assert_int_equal(surfel_store_at(&store, beside), GR_OK);
	store.one_place = false;
	store.cache = strdup(in_folder("cache.surfels"));
	for (int round = 0; round < 2; round++) {
		get(&store, &diag, &done);
		assert_int_equal(done.baked, round == 0);
		assert_string_equal(done.path, store.cache);
	}
	assert_true(is_said(&diag, "my.surfels: cannot be written: "));
	assert_int_equal(diag.warnings, 0);
	gr_diag_finish(&diag);
	assert_int_equal(unlink(store.cache), 0);
	surfel_store_finish(&store);
	snprintf(beside + strlen(beside), 32, ".%ld.new", (long)getpid());
	assert_int_equal(rmdir(beside), 0);
}

/* Of a name space of its own, where a file system may be mounted. */
static bool become_root(void)
{
	const unsigned user = geteuid();
	FILE *map;

	if (unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0)
		return false;
	map = fopen("/proc/self/uid_map", "w");
	return map && fprintf(map, "0 %u 1\n", user) > 0 && fclose(map) == 0;
}

/* 0: a set, kept in the cache; else the line that failed. */
static int on_a_full_disk(const char *mounted, const char *beside, const char *cache)
{
	struct surfel_store_done done;
	struct gr_diag diag = { 0 };
	struct surfel_store store;
	struct surfel_set *found;

	if (unshare(CLONE_NEWNS) != 0 && !become_root())
		return 77;
	if (mount(NULL, "/", NULL, MS_REC | MS_PRIVATE, NULL) != 0 ||
	    mount("tmpfs", mounted, "tmpfs", 0, "size=16k") != 0)
		return 77;
	if (surfel_store_at(&store, beside) != GR_OK)
		return __LINE__ & 63;
	store.one_place = false;
	store.cache = strdup(cache);
	if (surfel_store_get(&store, &found, room.scene, NULL, &baked_room_coarse, &diag, &done) != GR_OK)
		return __LINE__ & 63;
	if (!done.path || strcmp(done.path, cache) != 0 || !done.baked ||
	    surfel_set_hash(found) != surfel_set_hash(room.set))
		return __LINE__ & 63;
	if (!is_said(&diag, strerror(ENOSPC)) || access(cache, F_OK) != 0 || access(beside, F_OK) == 0)
		return __LINE__ & 63;
	return 0;
}

static void disk_full(void **state)
{
	char mounted[96], beside[128], cache[128];
	int status;
	pid_t child;

	(void)state;
	snprintf(mounted, sizeof mounted, "%s/full", room.folder);
	snprintf(beside, sizeof beside, "%s/my.surfels", mounted);
	snprintf(cache, sizeof cache, "%s/cache.surfels", room.folder);
	assert_int_equal(mkdir(mounted, 0700), 0);
	fflush(stdout);
	child = fork();
	if (child == 0)
		_exit(on_a_full_disk(mounted, beside, cache));
	assert_int_equal(waitpid(child, &status, 0), child);
	rmdir(mounted);
	unlink(cache);
	assert_true(WIFEXITED(status));
	if (WEXITSTATUS(status) == 77) {
		printf("# no file system may be mounted here: skipped\n");
		skip();
	}
	assert_int_equal(WEXITSTATUS(status), 0);
}

/* No file may grow: nothing is kept, everything is there. */
static void nothing_can_be_written(void **state)
{
	struct rlimit before, none;
	struct surfel_store_done done;
	struct gr_diag diag = { 0 };
	struct surfel_store store;
	struct surfel_set *found;
	int result;

	(void)state;
	signal(SIGXFSZ, SIG_IGN);
	getrlimit(RLIMIT_FSIZE, &before);
	none = (struct rlimit){ 0, before.rlim_max };
	for (int one_place = 0; one_place < 2; one_place++) {
		assert_int_equal(surfel_store_at(&store, in_folder("my.surfels")), GR_OK);
		if (!one_place)
			store.cache = strdup(in_folder("cache.surfels"));
		store.one_place = one_place;
		fflush(stdout);
		setrlimit(RLIMIT_FSIZE, &none);
		result = surfel_store_get(&store, &found, room.scene, NULL, &baked_room_coarse, &diag, &done);
		setrlimit(RLIMIT_FSIZE, &before);
		assert_int_equal(result, GR_OK);
		assert_true(done.baked && !done.path);
		assert_int_equal(surfel_set_hash(found), surfel_set_hash(room.set));
		assert_int_equal(diag.warnings, 1);
		assert_true(is_said(&diag, strerror(EFBIG)));
		assert_true(is_said(&diag, "cache") == !one_place);
		surfel_set_destroy(&found);
		surfel_store_finish(&store);
		gr_diag_finish(&diag);
		diag = (struct gr_diag){ 0 };
	}
	signal(SIGXFSZ, SIG_DFL);
}

/* Who wants the file and nothing else hears of it before the work, not after. */
static void one_place_or_none(void **state)
{
	struct surfel_store_done done;
	struct gr_diag diag = { 0 };
	struct surfel_store store;
	struct surfel_set *found;

	(void)state;
	assert_int_equal(surfel_store_at(&store, in_folder("nowhere/my.surfels")), GR_OK);
	assert_int_equal(surfel_store_get(&store, &found, room.scene, NULL, &baked_room_coarse, &diag, &done),
			 GR_ERR_IO);
	assert_null(found);
	assert_int_equal(diag.count, 1);
	assert_int_equal(diag.errors, 1);
	assert_true(is_said(&diag, strerror(ENOENT)) && !is_said(&diag, "cache"));
	surfel_store_finish(&store);
	gr_diag_finish(&diag);
}

/* Four processes at once: one bakes, three wait and read. */
static void four_at_once(void **state)
{
	struct surfel_bake_params params = baked_room_coarse;
	char path[128];
	int baked = 0, waited = 0;
	pid_t children[4];

	(void)state;
	params.links = 1024;
	params.spacing_m = 0.3f;
	snprintf(path, sizeof path, "%s/four.surfels", room.folder);
	for (int i = 0; i < 4; i++) {
		children[i] = fork();
		if (children[i] == 0) {
			struct surfel_store store;
			struct surfel_store_done done;
			struct surfel_set *found;
			struct gr_diag diag = { 0 };

			if (surfel_store_at(&store, path) != GR_OK ||
			    surfel_store_get(&store, &found, room.scene, NULL, &params, &diag, &done) !=
				    GR_OK)
				_exit(99);
			_exit((done.baked ? 1 : 0) + (done.waited_s > 0.02 ? 2 : 0));
		}
	}
	for (int i = 0; i < 4; i++) {
		int status;

		assert_int_equal(waitpid(children[i], &status, 0), children[i]);
		assert_true(WIFEXITED(status) && WEXITSTATUS(status) < 4);
		baked += WEXITSTATUS(status) & 1;
		waited += WEXITSTATUS(status) >> 1;
	}
	printf("# 4 processes at once: %d baked, %d waited\n", baked, waited);
	assert_int_equal(baked, 1);
	unlink(path);
}

/* One that never ends is not waited for without end; the next place has the file. */
static void wait_is_bounded(void **state)
{
	char host[64] = "", holder[128];
	struct surfel_store_done done;
	struct gr_diag diag = { 0 };
	struct surfel_store store;
	char path[128];
	int pipe_fd[2];
	pid_t child;
	char byte;

	(void)state;
	snprintf(path, sizeof path, "%s/stuck.surfels", room.folder);
	assert_int_equal(pipe(pipe_fd), 0);
	child = fork();
	if (child == 0) {
		char lock[160];
		int fd;

		snprintf(lock, sizeof lock, "%s.lock", path);
		fd = open(lock, O_RDWR | O_CREAT, 0644);
		gethostname(host, sizeof host - 1);
		if (fd < 0 || flock(fd, LOCK_EX) != 0 ||
		    dprintf(fd, "%ld %s\n", (long)getpid(), host) < 3 || write(pipe_fd[1], "r", 1) != 1)
			_exit(1);
		pause();
		_exit(0);
	}
	assert_int_equal(read(pipe_fd[0], &byte, 1), 1);
	assert_int_equal(surfel_store_at(&store, path), GR_OK);
	store.wait_s = 1;
	get(&store, &diag, &done);
	assert_true(done.baked && !done.path && done.waited_s >= 1 && done.waited_s < 5);
	gethostname(host, sizeof host - 1);
	snprintf(holder, sizeof holder, "process %ld on %s has been baking", (long)child, host);
	assert_true(is_said(&diag, holder));
	store.cache = strdup(in_folder("cache.surfels"));
	store.one_place = false;
	for (int round = 0; round < 2; round++) {
		get(&store, &diag, &done);
		/* the second time nobody is waited for */
		assert_true(done.baked == (round == 0) && (done.waited_s > 0.9) == (round == 0));
		assert_string_equal(done.path, store.cache);
	}
	unlink(store.cache);
	surfel_store_finish(&store);
	gr_diag_finish(&diag);
	kill(child, SIGKILL);
	waitpid(child, NULL, 0);
	close(pipe_fd[0]);
	close(pipe_fd[1]);
	unlink(in_folder("stuck.surfels.lock"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bakes_once),
		cmocka_unit_test(rebuilt),
		cmocka_unit_test(goes_to_the_cache),
		cmocka_unit_test(full_after_the_lock),
		cmocka_unit_test(disk_full),
		cmocka_unit_test(nothing_can_be_written),
		cmocka_unit_test(one_place_or_none),
		cmocka_unit_test(four_at_once),
		cmocka_unit_test(wait_is_bounded),
	};

	return cmocka_run_group_tests(tests, set_up, tear_down);
}
