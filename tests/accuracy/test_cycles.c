/*
 * The reference against the pictures of another path tracer: every folder under
 * reference/renders, within what the noise of both makes of it and a little.
 *
 * Quick: our pixel for four of theirs, few samples, so that our noise is a few per
 * cent of a block. With GROTTO_LONG every pixel, and as many samples as bring
 * our noise to LONG_NOISE of a block: then the blocks' mean relative difference
 * has to be under 1.5 %.
 */
#include "base/log.h"
#include "base/result.h"
#include "tests/accuracy/folder/agreement.h"
#include "tests/accuracy/folder/folder.h"
#include "tests/accuracy/folder/methods.h"
#include "tests/accuracy/folder/work.h"
#include "tests/unit/shared.h"
#include "tests/unit/unit.h"

#include <math.h>

#define QUICK_SAMPLES 32
#define LONG_FIRST 64    /* samples that measure the noise */
#define LONG_MOST 8192
#define LONG_NOISE 0.006 /* mean relative noise of a block that we add */
#define GOAL 0.015
/* Their light of a lamp at grazing angles is too low, most so in a mirror: docs/reference.md. */
#define MEAN_OFF 0.005

static bool is_long(void)
{
	const char *value = getenv("GROTTO_LONG");

	return value && *value && strcmp(value, "0") != 0;
}

/* Our picture beside theirs, both at our size. */
static void agree(const struct folder *folder, const struct folder_pictures *theirs, size_t camera,
		  int coarse, int samples, struct agreement *out, uint64_t *nonfinite)
{
	struct image picture, error = { 0 };
	struct made made;

	assert_int_equal(reference_make(folder, camera, coarse, samples, 0, &made), GR_OK);
	*nonfinite = made.nonfinite;
	assert_int_equal(compare_block_means(&theirs->picture, NULL, coarse, &picture), GR_OK);
	if (theirs->error.data)
		assert_int_equal(agreement_coarse_error(&theirs->error, coarse, &error), GR_OK);
	assert_int_equal(agreement_of(&made.picture, &made.error, &picture, &error, 8 / coarse, out),
			 GR_OK);
	image_finish(&picture);
	image_finish(&error);
	made_finish(&made);
}

/* What of the blocks' difference is ours; both add up as squares. */
static double own_noise(const struct agreement *a)
{
	return sqrt(fmax(a->noise * a->noise - a->their_noise * a->their_noise, 0));
}

static int samples_for(double noise)
{
	double times = noise / LONG_NOISE;
	double samples = LONG_FIRST * fmax(1, times * times);

	return samples < LONG_MOST ? (int)samples : LONG_MOST;
}

static void check_camera(struct folder *folder, size_t camera)
{
	int samples = QUICK_SAMPLES, coarse = is_long() ? 1 : 2;
	struct folder_pictures theirs;
	struct gr_diag diag = { 0 };
	struct agreement a;
	uint64_t nonfinite;
	double off;

	assert_int_equal(folder_pictures_read(folder, camera, &theirs, &diag), GR_OK);
	if (is_long()) {
		agree(folder, &theirs, camera, coarse, LONG_FIRST, &a, &nonfinite);
		samples = samples_for(own_noise(&a));
	}
	agree(folder, &theirs, camera, coarse, samples, &a, &nonfinite);
	off = fabs(a.ratio - 1);
	printf("# %-24s %s, %4d samples: mean %+.3f +- %.3f %%, blocks %.2f %% (noise %.2f %%, theirs "
	       "%.2f %%), within 3 standard errors %.1f %%\n", folder->name, folder->cameras[camera],
	       samples, 100 * (a.ratio - 1), 100 * a.ratio_error, 100 * a.blocks, 100 * a.noise,
	       100 * a.their_noise, 100 * a.within_blocks);
	fflush(stdout);
	folder_pictures_finish(&theirs);
	gr_diag_finish(&diag);
	assert_int_equal(nonfinite + a.nonfinite, 0);
	assert_true(off < MEAN_OFF + 3.5 * a.ratio_error);
	/* few samples know their own noise badly */
	assert_true(a.blocks < (is_long() ? 1.1 : 1.6) * a.noise + 0.01);
	if (is_long())
		assert_true(a.blocks < GOAL);
}

static void check_folder(const char *path, const char *work)
{
	struct gr_diag diag = { 0 };
	struct folder folder;
	int result = folder_open(&folder, path, work, &diag);

	gr_diag_log(&diag);
	gr_diag_finish(&diag);
	assert_int_equal(result, GR_OK);
	for (size_t i = 0; i < folder.file->camera_count; i++)
		check_camera(&folder, i);
	folder_close(&folder);
}

static int by_name(const struct dirent **a, const struct dirent **b)
{
	return strcmp((*a)->d_name, (*b)->d_name);
}

static void every_folder(void **state)
{
	struct dirent **entries = NULL;
	char root[1024], path[2048], work[1024];
	int count, folders = 0;

	(void)state;
	if (!shared_file("reference/renders", root))
		skip();
	count = scandir(root, &entries, NULL, by_name);
	assert_true(count >= 0 && work_make(work));
	for (int i = 0; i < count; i++) {
		snprintf(path, sizeof path, "%s/%s/scene.json", root, entries[i]->d_name);
		if (access(path, R_OK) == 0) {
			snprintf(path, sizeof path, "%s/%s", root, entries[i]->d_name);
			check_folder(path, work);
			folders++;
		}
		free(entries[i]);
	}
	free(entries);
	work_remove(work);
	assert_true(folders > 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(every_folder) };

	gr_log_init("test_cycles", GR_LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
