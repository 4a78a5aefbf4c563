#include "protocol/key.h"

#include "base/result.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define KEY_DIGITS ((size_t)FDP_KEY_BYTES * 2)
#define KEY_FORBIDDEN 0027 /* others nothing, the group may read */

static const char make_one[] = "make one with: grotto key FILE";

static ssize_t read_all(int fd, char *text, size_t size)
{
	size_t len = 0;

	while (len < size) {
		ssize_t got = read(fd, text + len, size - len);
		if (got < 0 && errno == EINTR)
			continue;
		if (got < 0)
			return -1;
		if (!got)
			break;
		len += (size_t)got;
	}
	return (ssize_t)len;
}

/* Size and mode come from the open file, so that nobody can swap it in between. */
static int check_file(int fd, const char *path, struct gr_diag *diag)
{
	struct stat st;

	if (fstat(fd, &st)) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "%s", strerror(errno));
		return GR_ERR_CONFIG;
	}
	if (!S_ISREG(st.st_mode)) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "a cluster key must be a regular file");
		return GR_ERR_CONFIG;
	}
	if (st.st_mode & KEY_FORBIDDEN) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL,
			    "mode %04o lets others at the cluster key; chmod 0640 or 0600",
			    (unsigned)(st.st_mode & 07777));
		return GR_ERR_CONFIG;
	}
	return GR_OK;
}

static int read_key(int fd, const char *path, uint8_t key[FDP_KEY_BYTES], struct gr_diag *diag)
{
	char text[KEY_DIGITS + 3]; /* room to see that a file is too long */
	ssize_t got = read_all(fd, text, sizeof text);
	size_t digits = 0, len, key_len = 0;
	const char *end = NULL;
	int result = GR_ERR_CONFIG;

	if (got < 0) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "%s", strerror(errno));
		goto out;
	}
	len = (size_t)got;
	if (len && text[len - 1] == '\n')
		len--;
	while (digits < len && strchr("0123456789abcdefABCDEF", text[digits]) && text[digits])
		digits++;
	if (digits != KEY_DIGITS || len != KEY_DIGITS) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 1, NULL,
			    "not a cluster key: %zu hexadecimal digits and a newline are wanted, "
			    "%zu digits%s found; %s", KEY_DIGITS, digits,
			    len > digits ? " and then something else" : "", make_one);
		goto out;
	}
	if (sodium_hex2bin(key, FDP_KEY_BYTES, text, len, NULL, &key_len, &end) ||
	    key_len != FDP_KEY_BYTES)
		goto out;
	if (sodium_is_zero(key, FDP_KEY_BYTES)) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 1, NULL,
			    "the all-zero key is no key; %s", make_one);
		goto out;
	}
	result = GR_OK;
out:
	sodium_memzero(text, sizeof text);
	return result;
}

int fdp_key_load(const char *path, uint8_t key[FDP_KEY_BYTES], struct gr_diag *diag)
{
	int fd, result;

	memset(key, 0, FDP_KEY_BYTES);
	if (!path)
		return GR_OK;
	/* O_NONBLOCK: a fifo in its place must not hang the daemon. */
	fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NONBLOCK);
	if (fd < 0) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "cluster key: %s%s%s",
			    strerror(errno), errno == ENOENT ? "; " : "",
			    errno == ENOENT ? make_one : "");
		return GR_ERR_CONFIG;
	}
	result = check_file(fd, path, diag);
	if (!result)
		result = read_key(fd, path, key, diag);
	close(fd);
	if (result)
		sodium_memzero(key, FDP_KEY_BYTES);
	return result;
}

int fdp_key_create(const char *path, struct gr_diag *diag)
{
	uint8_t key[FDP_KEY_BYTES];
	char text[KEY_DIGITS + 1];
	size_t done = 0;
	int fd = -1, result = GR_ERR_IO;

	if (sodium_init() < 0) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "no source of random bytes");
		return GR_ERR_UNSUPPORTED;
	}
	fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0640);
	if (fd < 0) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "cannot make a cluster key: %s",
			    strerror(errno));
		return GR_ERR_IO;
	}
	randombytes_buf(key, sizeof key);
	sodium_bin2hex(text, sizeof text, key, sizeof key);
	text[KEY_DIGITS] = '\n'; /* in the place of the NUL */
	while (done < sizeof text) {
		ssize_t put = write(fd, text + done, sizeof text - done);
		if (put < 0 && errno == EINTR)
			continue;
		if (put <= 0)
			goto out;
		done += (size_t)put;
	}
	if (!fchmod(fd, 0640) && !fsync(fd))
		result = GR_OK;
out:
	if (result)
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "cannot write the cluster key: %s",
			    strerror(errno));
	if (close(fd) && !result) {
		gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "cannot write the cluster key: %s",
			    strerror(errno));
		result = GR_ERR_IO;
	}
	if (result)
		unlink(path); /* ours: O_EXCL made it */
	sodium_memzero(key, sizeof key);
	sodium_memzero(text, sizeof text);
	return result;
}
