/* protocol/key.h: modes, forms, and the words for what is wrong. */
#include "unit.h"

#include "protocol/key.h"

#include "base/result.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[] = "test_key.XXXXXX";
static char path[64];

static int setup(void **state)
{
	(void)state;
	if (!mkdtemp(folder))
		return -1;
	snprintf(path, sizeof path, "%s/cluster.key", folder);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	unlink(path);
	return rmdir(folder);
}

static void write_key(const char *text, size_t len, mode_t mode)
{
	int fd;

	unlink(path);
	fd = open(path, O_WRONLY | O_CREAT | O_EXCL, 0600);
	assert_true(fd >= 0);
	assert_int_equal(write(fd, text, len), (ssize_t)len);
	assert_int_equal(fchmod(fd, mode), 0);
	close(fd);
}

/* The first line of what was found wrong must hold `words`. */
static void refused(const char *file, const char *words)
{
	struct gr_diag diag = { 0 };
	uint8_t key[FDP_KEY_BYTES], zero[FDP_KEY_BYTES] = { 0 };

	memset(key, 1, sizeof key);
	assert_int_equal(fdp_key_load(file, key, &diag), GR_ERR_CONFIG);
	assert_int_equal(diag.errors, 1);
	assert_non_null(strstr(diag.items[0].text, file));
	if (!strstr(diag.items[0].text, words))
		fail_msg("'%s' does not say '%s'", diag.items[0].text, words);
	assert_memory_equal(key, zero, sizeof key);
	gr_diag_finish(&diag);
}

static const char digits[] = "00112233445566778899aabbccddeeff00112233445566778899AABBCCDDEEFF\n";

static void loads(void **state)
{
	static const mode_t fine[] = { 0600, 0640, 0400, 0440 };
	struct gr_diag diag = { 0 };
	uint8_t key[FDP_KEY_BYTES];

	(void)state;
	for (size_t i = 0; i < sizeof fine / sizeof *fine; i++) {
		write_key(digits, 65, fine[i]);
		assert_int_equal(fdp_key_load(path, key, &diag), GR_OK);
		assert_int_equal(key[1], 0x11);
		assert_int_equal(key[31], 0xff);
	}
	write_key(digits, 64, 0600); /* an editor may have dropped the newline */
	assert_int_equal(fdp_key_load(path, key, &diag), GR_OK);
	assert_int_equal(diag.count, 0);
}

static void no_path(void **state)
{
	struct gr_diag diag = { 0 };
	uint8_t key[FDP_KEY_BYTES], zero[FDP_KEY_BYTES] = { 0 };

	(void)state;
	memset(key, 1, sizeof key);
	assert_int_equal(fdp_key_load(NULL, key, &diag), GR_OK);
	assert_memory_equal(key, zero, sizeof key);
}

static void modes(void **state)
{
	(void)state;
	for (mode_t mode = 0400; mode < 0700; mode++) {
		struct gr_diag diag = { 0 };
		uint8_t key[FDP_KEY_BYTES];

		if (!(mode & 0027))
			continue;
		write_key(digits, 65, mode);
		assert_int_equal(fdp_key_load(path, key, &diag), GR_ERR_CONFIG);
		gr_diag_finish(&diag);
	}
	write_key(digits, 65, 0644);
	refused(path, "mode 0644");
	write_key(digits, 65, 0660);
	refused(path, "chmod 0640");
}

static void forms(void **state)
{
	char text[80];

	(void)state;
	for (size_t n = 0; n < 64; n++) { /* every short length */
		write_key(digits, n, 0600);
		refused(path, "64 hexadecimal digits");
	}
	memcpy(text, digits, 65);
	text[65] = '\n';
	write_key(text, 66, 0600);
	refused(path, "64 hexadecimal digits");
	text[64] = '0';
	write_key(text, 65, 0600);
	refused(path, "65 digits found");
	memcpy(text, digits, 65);
	text[10] = 'g';
	write_key(text, 65, 0600);
	refused(path, "10 digits and then something else");
	text[10] = 0;
	write_key(text, 65, 0600);
	refused(path, "10 digits and then something else");
	memset(text, '0', 64);
	write_key(text, 65, 0600);
	refused(path, "all-zero");
}

static void not_files(void **state)
{
	char fifo[80];

	(void)state;
	refused(folder, "regular file");
	snprintf(fifo, sizeof fifo, "%s/fifo", folder);
	assert_int_equal(mkfifo(fifo, 0600), 0);
	refused(fifo, "regular file");
	unlink(fifo);
	refused(fifo, "No such file");
	refused(fifo, "grotto key");
}

static void creates(void **state)
{
	struct gr_diag diag = { 0 };
	uint8_t a[FDP_KEY_BYTES], b[FDP_KEY_BYTES];
	mode_t mask = umask(0);
	struct stat st;

	(void)state;
	unlink(path);
	assert_int_equal(fdp_key_create(path, &diag), GR_OK);
	assert_int_equal(stat(path, &st), 0);
	assert_int_equal(st.st_mode & 07777, 0640);
	assert_int_equal(st.st_size, 65);
	assert_int_equal(fdp_key_load(path, a, &diag), GR_OK);
	assert_int_equal(diag.count, 0);
	/* Never over an existing one. */
	assert_int_equal(fdp_key_create(path, &diag), GR_ERR_IO);
	assert_non_null(strstr(diag.items[0].text, "File exists"));
	gr_diag_finish(&diag);
	assert_int_equal(fdp_key_load(path, b, &diag), GR_OK);
	assert_memory_equal(a, b, sizeof a);
	unlink(path);
	assert_int_equal(fdp_key_create(path, &diag), GR_OK);
	assert_int_equal(fdp_key_load(path, b, &diag), GR_OK);
	assert_memory_not_equal(a, b, sizeof a);
	assert_int_equal(fdp_key_create("no/such/folder/key", &diag), GR_ERR_IO);
	gr_diag_finish(&diag);
	umask(mask);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(loads), cmocka_unit_test(no_path), cmocka_unit_test(modes),
		cmocka_unit_test(forms), cmocka_unit_test(not_files), cmocka_unit_test(creates),
	};

	return cmocka_run_group_tests(tests, setup, teardown);
}
