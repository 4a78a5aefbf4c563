/* Measured costs in a file: what was written is read, and nothing else is. */
#include "tests/unit/unit.h"

#include "base/result.h"
#include "renderer/gi/costs_file.h"

#include <fcntl.h>
#include <math.h>
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#define DEVICE "Some GPU (with \xc3\xa9 and\nlines), 4.6.0"

static const struct gi_costs costs = { 1234567.891, 3.25, 0, 0.005, 1e6 };

static void assert_alike(const struct gi_costs *a, const struct gi_costs *b)
{
	assert_true(fabs(a->lattice_frame - b->lattice_frame) < 1e-3);
	assert_true(fabs(a->lattice_cell_step - b->lattice_cell_step) < 1e-3);
	assert_true(fabs(a->surfel_frame - b->surfel_frame) < 2e-3);
	assert_true(fabs(a->surfel_tap - b->surfel_tap) < 1e-3);
	assert_true(fabs(a->surfel_link - b->surfel_link) < 1e-3);
}

static void round_trip(void **state)
{
	char text[COSTS_FILE_MAX];
	size_t len = gi_costs_encode(&costs, DEVICE, text);
	struct gi_costs found;
	const char *why;

	(void)state;
	assert_int_equal(gi_costs_decode(text, len, DEVICE, &found, &why), GR_OK);
	assert_null(why);
	assert_alike(&found, &costs);
	assert_int_equal(gi_costs_decode(text, len, "Another GPU", &found, &why), GR_ERR_MISMATCH);
	assert_string_equal(why, "it is of another GPU or driver");
	assert_int_equal(gi_costs_decode(text, len, "Some GPU", &found, &why), GR_ERR_MISMATCH);
}

static void anything_else_is_refused(void **state)
{
	struct unit_random r = unit_random_start("anything_else_is_refused");
	char text[COSTS_FILE_MAX];
	size_t len = gi_costs_encode(&costs, DEVICE, text);
	struct gi_costs found;
	const char *why;

	(void)state;
	/* every length but the right one, every bit of every byte */
	for (size_t cut = 0; cut < len; cut++) {
		uint8_t *copy = unit_copy(text, cut);

		assert_int_not_equal(gi_costs_decode((char *)copy, cut, DEVICE, &found, &why), GR_OK);
		assert_non_null(why);
		free(copy);
	}
	for (size_t bit = 0; bit < 8 * len; bit++) {
		uint8_t *copy = unit_copy(text, len);

		copy[bit / 8] ^= (uint8_t)(1u << (bit % 8));
		assert_int_not_equal(gi_costs_decode((char *)copy, len, DEVICE, &found, &why), GR_OK);
		free(copy);
	}
	/* and much that was never one */
	for (int round = 0; round < 20000; round++) {
		size_t n = unit_random_u32(&r) % 300;
		uint8_t *copy = unit_copy(text, n < len ? n : len);

		n = n < len ? n : len;
		for (size_t i = unit_random_u32(&r) % (n + 1); i < n; i++)
			copy[i] = (uint8_t)unit_random_u32(&r);
		if (n < len || memcmp(copy, text, len) != 0)
			assert_int_not_equal(gi_costs_decode((char *)copy, n, DEVICE, &found, &why), GR_OK);
		free(copy);
	}
}

/* Right in form and checksum, wrong in what it says. */
static void numbers_that_cannot_be(void **state)
{
	static const char *const lines[] = {
		"lattice_frame 1\nlattice_cell_step 0\nsurfel_frame 1\nsurfel_tap 1\nsurfel_link 1\n",
		"lattice_frame 1\nlattice_cell_step 1\nsurfel_frame 1\nsurfel_tap 1\nsurfel_link 1000000000000000\n",
		"lattice_frame 1\nlattice_cell_step 1\nsurfel_frame 1\nsurfel_tap 1\nsurfel_link 99999999999999999999999\n",
		"lattice_frame 1\nlattice_cell_step -1\nsurfel_frame 1\nsurfel_tap 1\nsurfel_link 1\n",
		"lattice_frame 1\nlattice_cell_step nan\nsurfel_frame 1\nsurfel_tap 1\nsurfel_link 1\n",
		"lattice_frame\nlattice_cell_step 1\nsurfel_frame 1\nsurfel_tap 1\nsurfel_link 1\n",
	};

	(void)state;
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
		unsigned char hash[16];
		char text[COSTS_FILE_MAX], hex[33];
		int len = snprintf(text, sizeof text, "grotto-costs 2\ndevice x\n%s", lines[i]);
		struct gi_costs found;
		const char *why;

		crypto_generichash(hash, sizeof hash, (unsigned char *)text, (unsigned)len, NULL, 0);
		sodium_bin2hex(hex, sizeof hex, hash, sizeof hash);
		len += snprintf(text + len, sizeof text - (size_t)len, "sum %s\n", hex);
		assert_int_equal(gi_costs_decode(text, (size_t)len, "x", &found, &why), GR_ERR_FORMAT);
	}
}

static void write_text(const char *path, const char *text, size_t len)
{
	int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);

	assert_true(fd >= 0);
	assert_true(write(fd, text, len) == (ssize_t)len);
	close(fd);
}

static void files(void **state)
{
	char folder[] = "/tmp/grotto-costs-XXXXXX", inner[64], big[COSTS_FILE_MAX + 100];
	struct gi_costs found;
	const char *why;
	char *path;
	int lock;

	(void)state;
	assert_non_null(mkdtemp(folder));
	snprintf(inner, sizeof inner, "%s/a/b", folder);
	path = gi_costs_path(inner, DEVICE);
	assert_int_equal(gi_costs_load(path, DEVICE, &found, &why), GR_NOTHING);
	assert_int_equal(gi_costs_save(path, DEVICE, &costs), GR_OK); /* folders are made */
	assert_int_equal(gi_costs_load(path, DEVICE, &found, &why), GR_OK);
	assert_alike(&found, &costs);
	memset(big, 'x', sizeof big);
	write_text(path, big, sizeof big);
	assert_int_equal(gi_costs_load(path, DEVICE, &found, &why), GR_ERR_FORMAT);
	write_text(path, "", 0);
	assert_int_equal(gi_costs_load(path, DEVICE, &found, &why), GR_ERR_FORMAT);
	/* a pipe or a folder instead: refused, not waited for */
	unlink(path);
	assert_int_equal(mkfifo(path, 0600), 0);
	assert_int_equal(gi_costs_load(path, DEVICE, &found, &why), GR_ERR_FORMAT);
	unlink(path);
	assert_int_equal(mkdir(path, 0700), 0);
	assert_int_equal(gi_costs_load(path, DEVICE, &found, &why), GR_ERR_FORMAT);
	assert_int_equal(gi_costs_save(path, DEVICE, &costs), GR_ERR_IO);
	rmdir(path);
	/* one at a time */
	lock = gi_costs_lock(path, 0);
	assert_true(lock >= 0);
	assert_int_equal(gi_costs_lock(path, 60), -1);
	gi_costs_unlock(lock);
	lock = gi_costs_lock(path, 0);
	assert_true(lock >= 0);
	gi_costs_unlock(lock);
	assert_int_equal(gi_costs_save("/proc/nowhere/costs.txt", DEVICE, &costs), GR_ERR_IO);
	assert_int_equal(gi_costs_lock("/proc/nowhere/costs.txt", 100), -1);
	snprintf(big, sizeof big, "%s.lock", path);
	unlink(big);
	free(path);
	rmdir(inner);
	snprintf(inner, sizeof inner, "%s/a", folder);
	rmdir(inner);
	assert_int_equal(rmdir(folder), 0);
}

static void assert_folder(const char *expected)
{
	char *folder = gi_costs_folder();

	if (expected)
		assert_string_equal(folder, expected);
	else
		assert_null(folder);
	free(folder);
}

static void where_it_lies(void **state)
{
	(void)state;
	setenv("CACHE_DIRECTORY", "/var/cache/grotto:/var/cache/other", 1);
	setenv("XDG_CACHE_HOME", "/x", 1);
	setenv("HOME", "/home/x", 1);
	assert_folder("/var/cache/grotto");
	unsetenv("CACHE_DIRECTORY");
	assert_folder("/x/grotto");
	setenv("XDG_CACHE_HOME", "relative", 1);
	assert_folder("/home/x/.cache/grotto");
	unsetenv("XDG_CACHE_HOME");
	setenv("HOME", "", 1);
	assert_folder(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(round_trip),
		cmocka_unit_test(anything_else_is_refused),
		cmocka_unit_test(numbers_that_cannot_be),
		cmocka_unit_test(files),
		cmocka_unit_test(where_it_lies),
	};

	if (sodium_init() < 0)
		return 1;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
