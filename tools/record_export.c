#include "config.h" /* asprintf */

#include "tools/record_info.h"

#include "base/result.h"
#include "record/csv.h"
#include "tools/say.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static int find_table(const char *name)
{
	for (int i = 0; i < RECORD_TABLES; i++)
		if (!strcmp(name, record_table_name((enum record_table)i)))
			return i;
	fprintf(stderr, "grotto record: --table '%s': give one of", name);
	for (int i = 0; i < RECORD_TABLES; i++)
		fprintf(stderr, "%s %s", i ? "," : "", record_table_name((enum record_table)i));
	fprintf(stderr, "\n");
	return -1;
}

static bool open_one(FILE **file, const char *path)
{
	*file = !strcmp(path, "-") ? stdout : fopen(path, "we");
	if (!*file)
		fprintf(stderr, "%s: %s\n", path, strerror(errno));
	return *file != NULL;
}

static bool open_folder(FILE *files[RECORD_TABLES], const char *folder)
{
	if (mkdir(folder, 0777) != 0 && errno != EEXIST) {
		fprintf(stderr, "%s: cannot be made: %s\n", folder, strerror(errno));
		return false;
	}
	for (int i = 0; i < RECORD_TABLES; i++) {
		char *path = NULL;
		bool opened;

		if (asprintf(&path, "%s/%s.csv", folder, record_table_name((enum record_table)i)) < 0)
			return false;
		opened = open_one(&files[i], path);
		free(path);
		if (!opened)
			return false;
	}
	return true;
}

/* False when something was not written. */
static bool close_files(FILE *files[RECORD_TABLES], const char *out)
{
	bool well = true;

	for (int i = 0; i < RECORD_TABLES; i++) {
		if (!files[i])
			continue;
		if (ferror(files[i]) || (files[i] == stdout ? fflush(stdout) : fclose(files[i])) != 0) {
			fprintf(stderr, "%s: %s.csv cannot be written: %s\n", out,
				record_table_name((enum record_table)i), strerror(errno));
			well = false;
		}
	}
	return well;
}

int record_export(const char *path, const char *out, const char *table, int recording)
{
	FILE *files[RECORD_TABLES] = { NULL };
	const int index = table ? find_table(table) : 0;
	struct record_reader *reader = NULL;
	struct gr_diag diag = { 0 };
	bool opened;
	int r;

	if (index < 0)
		return GR_EXIT_CONFIG;
	r = record_reader_open(&reader, path, &diag);
	say_diag(&diag);
	gr_diag_finish(&diag);
	if (r < 0)
		return GR_EXIT_CONFIG;
	opened = table ? open_one(&files[index], out) : open_folder(files, out);
	if (opened)
		r = record_csv_write(reader, recording, files);
	record_reader_destroy(&reader);
	if (!close_files(files, out))
		return GR_EXIT_RUNTIME;
	if (!opened)
		return GR_EXIT_CONFIG;
	if (r != GR_OK)
		fprintf(stderr, r == GR_NOTHING ? "%s: holds no recording %d\n" : "%s: cannot be read (recording %d)\n",
			path, recording);
	return r == GR_OK ? GR_EXIT_OK : r == GR_NOTHING ? GR_EXIT_CONFIG : GR_EXIT_RUNTIME;
}
