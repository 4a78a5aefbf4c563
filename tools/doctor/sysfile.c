#include <config.h> /* O_CLOEXEC */

#include "tools/doctor/sysfile.h"

#include "base/result.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool make_path(char path[SYSFILE_PATH], const char *root, const char *format, va_list args)
{
	int n = snprintf(path, SYSFILE_PATH, "%s", root), more;

	if (n < 0 || n >= SYSFILE_PATH)
		return false;
	more = vsnprintf(path + n, SYSFILE_PATH - (size_t)n, format, args);
	return more >= 0 && n + more < SYSFILE_PATH;
}

static int read_path(const char *path, char *text, size_t size)
{
	/* O_NONBLOCK: a FIFO would wait for a writer. */
	int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
	struct stat status;
	size_t len = 0;
	ssize_t n = 0;

	text[0] = '\0';
	if (fd < 0)
		return GR_ERR_IO;
	if (fstat(fd, &status) < 0 || !S_ISREG(status.st_mode)) {
		close(fd);
		errno = EINVAL;
		return GR_ERR_IO;
	}
	while (len < size && (n = read(fd, text + len, size - len)) != 0) {
		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0)
			break;
		len += (size_t)n;
	}
	close(fd);
	if (n < 0 || len == size) {
		text[0] = '\0';
		return n < 0 ? GR_ERR_IO : GR_ERR_RANGE;
	}
	text[len] = '\0';
	return GR_OK;
}

int sysfile_read(const char *root, char *text, size_t size, const char *format, ...)
{
	char path[SYSFILE_PATH];
	va_list args;
	bool fits;

	va_start(args, format);
	fits = make_path(path, root, format, args);
	va_end(args);
	text[0] = '\0';
	return fits ? read_path(path, text, size) : GR_ERR_RANGE;
}

bool sysfile_word(const char *root, char *text, size_t size, const char *format, ...)
{
	char path[SYSFILE_PATH], whole[256] = "";
	va_list args;
	bool fits;

	va_start(args, format);
	fits = make_path(path, root, format, args);
	va_end(args);
	text[0] = '\0';
	if (!fits || read_path(path, whole, sizeof whole) < 0)
		return false;
	snprintf(text, size, "%.*s", (int)strcspn(whole, " \t\r\n"), whole);
	return text[0] != '\0';
}

bool sysfile_number(const char *root, int64_t *out, const char *format, ...)
{
	char path[SYSFILE_PATH], text[64], *end;
	long long value;
	va_list args;
	bool fits;

	*out = 0;
	va_start(args, format);
	fits = make_path(path, root, format, args);
	va_end(args);
	if (!fits || read_path(path, text, sizeof text) < 0)
		return false;
	errno = 0;
	value = strtoll(text, &end, 10);
	if (end == text || errno != 0 || end[strspn(end, " \t\r\n")] != '\0')
		return false;
	*out = value;
	return true;
}

bool sysfile_link(const char *root, char *name, size_t size, const char *format, ...)
{
	char path[SYSFILE_PATH], to[SYSFILE_PATH];
	const char *last;
	va_list args;
	ssize_t n;
	bool fits;

	name[0] = '\0';
	va_start(args, format);
	fits = make_path(path, root, format, args);
	va_end(args);
	n = fits ? readlink(path, to, sizeof to - 1) : -1;
	if (n <= 0)
		return false;
	to[n] = '\0';
	last = strrchr(to, '/');
	snprintf(name, size, "%s", last ? last + 1 : to);
	return name[0] != '\0';
}

bool sysfile_exists(const char *root, const char *format, ...)
{
	char path[SYSFILE_PATH];
	va_list args;
	bool fits;

	va_start(args, format);
	fits = make_path(path, root, format, args);
	va_end(args);
	return fits && access(path, F_OK) == 0;
}
