#include "tools/programs.h"

#include <config.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool own_folder(char folder[PATH_MAX])
{
	ssize_t n = readlink("/proc/self/exe", folder, PATH_MAX - 1);
	char *slash;

	if (n <= 0)
		return false;
	folder[n] = '\0';
	slash = strrchr(folder, '/');
	if (!slash)
		return false;
	*slash = '\0';
	return true;
}

/* folder/between/name as a path without "..", when it is there with that access. */
static char *try_path(const char *folder, const char *between, const char *name, int mode)
{
	char path[PATH_MAX];
	int n = snprintf(path, sizeof path, "%s/%s%s", folder, between, name);

	if (n < 0 || (size_t)n >= sizeof path || access(path, mode) != 0)
		return NULL;
	return realpath(path, NULL);
}

static char *find(const char *const between[], size_t count, const char *fallback,
		  const char *name, int mode)
{
	char folder[PATH_MAX];
	char *path = NULL;

	if (own_folder(folder))
		for (size_t i = 0; i < count && !path; i++)
			path = try_path(folder, between[i], name, mode);
	return path ? path : try_path(fallback, "", name, mode);
}

char *programs_find(const char *name)
{
	static const char *const between[] = { "", "../daemon/", "../sbin/" };

	return find(between, sizeof between / sizeof between[0], GROTTO_SBINDIR, name, X_OK);
}

char *programs_own(const char *name)
{
	static const char *const between[] = { "", "../libexec/grotto/" };

	return find(between, sizeof between / sizeof between[0], GROTTO_PKGLIBEXECDIR, name, X_OK);
}

char *programs_data(const char *relative)
{
	/* An installed program has no source tree two folders up: share/grotto comes first. */
	static const char *const between[] = { "../share/grotto/", "../../" };

	return find(between, sizeof between / sizeof between[0], GROTTO_DATADIR, relative, R_OK);
}
