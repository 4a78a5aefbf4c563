/* A folder of one's own for what is made on the way. */
#ifndef GROTTO_TESTS_FOLDER_WORK_H
#define GROTTO_TESTS_FOLDER_WORK_H

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static inline bool work_make(char path[1024])
{
	const char *tmp = getenv("TMPDIR");

	snprintf(path, 1024, "%s/grotto-folder.XXXXXX", tmp ? tmp : "/tmp");
	return mkdtemp(path) != NULL;
}

/* Its files and itself; none of them is a folder. */
static inline void work_remove(const char *path)
{
	DIR *dir = opendir(path);
	struct dirent *entry;

	while (dir && (entry = readdir(dir))) {
		char name[2048];

		if (entry->d_name[0] == '.')
			continue;
		snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
		remove(name);
	}
	if (dir)
		closedir(dir);
	rmdir(path);
}

#endif
