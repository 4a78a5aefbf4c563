#include <config.h> /* mkostemp */

#include "config/layout_edit.h"

#include "base/result.h"
#include "config/config_text.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int refuse(struct gr_diag *diag, const char *path, int result, const char *what)
{
	gr_diag_add(diag, GR_DIAG_ERROR, path, 0, NULL, "%s: %s; nothing was changed", what,
		    result == GR_ERR_IO ? strerror(errno) : "read it again");
	return result;
}

/* Whether the file still holds `old`; *out is what it is then. */
static int still(const char *path, const char *old, size_t old_len, struct stat *out,
		 struct gr_diag *diag)
{
	char *text;
	size_t len;
	int r;

	if (stat(path, out) < 0)
		return refuse(diag, path, GR_ERR_IO, "cannot be looked at");
	r = config_text_load(path, &text, &len, diag);
	if (r < 0)
		return r == GR_ERR_CONFIG ? GR_ERR_MISMATCH : r;
	if (len != old_len || memcmp(text, old, len) != 0)
		r = refuse(diag, path, GR_ERR_MISMATCH, "has changed since it was read");
	free(text);
	return r;
}

static bool same(const struct stat *a, const struct stat *b)
{
	return a->st_dev == b->st_dev && a->st_ino == b->st_ino && a->st_size == b->st_size &&
	       a->st_mtim.tv_sec == b->st_mtim.tv_sec && a->st_mtim.tv_nsec == b->st_mtim.tv_nsec;
}

static bool write_all(int fd, const char *text, size_t len)
{
	while (len > 0) {
		const ssize_t n = write(fd, text, len);

		if (n < 0 && errno != EINTR)
			return false;
		if (n > 0) {
			text += n;
			len -= (size_t)n;
		}
	}
	return true;
}

/* Whose the old one is, and who may read it. */
static bool keep_owner(int fd, const struct stat *old)
{
	struct stat now;

	if (fstat(fd, &now) < 0)
		return false;
	if ((now.st_uid != old->st_uid || now.st_gid != old->st_gid) &&
	    fchown(fd, old->st_uid, old->st_gid) < 0)
		return false;
	return fchmod(fd, old->st_mode & 07777) == 0;
}

/* The rename is on the disk as well, as far as the file system tells. */
static void sync_folder(const char *path)
{
	char copy[PATH_MAX];
	int fd;

	snprintf(copy, sizeof copy, "%s", path);
	fd = open(dirname(copy), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd < 0)
		return;
	(void)fsync(fd);
	close(fd);
}

static int replace(const char *path, const struct stat *old, const char *text, size_t len,
		   struct gr_diag *diag)
{
	char beside[PATH_MAX + 8];
	struct stat now;
	int fd, r = GR_OK;

	snprintf(beside, sizeof beside, "%s.XXXXXX", path);
	fd = mkostemp(beside, O_CLOEXEC);
	if (fd < 0)
		return refuse(diag, path, GR_ERR_IO, "nothing can be written beside it");
	if (!keep_owner(fd, old))
		r = refuse(diag, path, GR_ERR_IO, "its owner and mode cannot be kept");
	else if (!write_all(fd, text, len) || fsync(fd) < 0)
		r = refuse(diag, path, GR_ERR_IO, "cannot be written");
	if (close(fd) < 0 && r == GR_OK)
		r = refuse(diag, path, GR_ERR_IO, "cannot be written");
	if (r == GR_OK && (stat(path, &now) < 0 || !same(&now, old)))
		r = refuse(diag, path, GR_ERR_MISMATCH, "has changed just now");
	if (r == GR_OK && rename(beside, path) < 0)
		r = refuse(diag, path, GR_ERR_IO, "cannot be replaced");
	if (r < 0)
		unlink(beside);
	else
		sync_folder(path);
	return r;
}

int layout_text_load(const char *path, char **out, size_t *out_len, struct gr_diag *diag)
{
	return config_text_load(path, out, out_len, diag);
}

int layout_replace(const char *path, const char *old, size_t old_len, const char *text, size_t len,
		   struct gr_diag *diag)
{
	char resolved[PATH_MAX];
	struct stat status;
	int r;

	if (!realpath(path, resolved))
		return refuse(diag, path, GR_ERR_IO, "cannot be found");
	r = still(resolved, old, old_len, &status, diag);
	if (r < 0)
		return r;
	/* Of a file that may not be written, a rename would make one that was. */
	if (access(resolved, W_OK) < 0)
		return refuse(diag, path, GR_ERR_IO, "may not be written");
	return replace(resolved, &status, text, len, diag);
}
