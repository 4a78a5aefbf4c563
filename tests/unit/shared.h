/*
 * Reference data that is not part of the source: GROTTO_SHARED, or ../shared
 * beside the source tree. Tests that want it skip where it is absent.
 */
#ifndef GROTTO_TESTS_SHARED_H
#define GROTTO_TESTS_SHARED_H

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* Path of a file there, or NULL (said on stdout) when it cannot be read. */
static inline const char *shared_file(const char *name, char path[1024])
{
	const char *folder = getenv("GROTTO_SHARED");
	const char *source = getenv("srcdir");

	if (folder)
		snprintf(path, 1024, "%s/%s", folder, name);
	else
		snprintf(path, 1024, "%s/../shared/%s", source ? source : ".", name);
	if (access(path, R_OK) == 0)
		return path;
	printf("# skipped: no %s (set GROTTO_SHARED to the folder of the reference data)\n", path);
	return NULL;
}

#endif
