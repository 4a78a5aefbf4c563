/* `grotto record --info` and `--export`: what is in the file of a recording. */
#ifndef GROTTO_TOOLS_RECORD_INFO_H
#define GROTTO_TOOLS_RECORD_INFO_H

#include <stdbool.h>

/* Prints what the file holds. An exit status (enum gr_exit): 1 when it is damaged. */
int record_info(const char *path, bool json);
/*
 * Writes its tables into the folder `out`, or the one called `table` into the
 * file `out` ("-": standard output). `recording`: which of the file's, from 1.
 */
int record_export(const char *path, const char *out, const char *table, int recording);

#endif
