/*
 * A recording as tables of comma-separated values (RFC 4180): a header line
 * whose names end with the unit, then a line each. docs/recording.md explains
 * the columns.
 */
#ifndef GROTTO_RECORD_CSV_H
#define GROTTO_RECORD_CSV_H

#include "record/reader.h"

#include <stdio.h>

enum record_table {
	RECORD_TABLE_HEAD, RECORD_TABLE_WAND, /* samples of the trackers */
	RECORD_TABLE_FRAMES,
	RECORD_TABLE_REPORTS, /* of the nodes */
	RECORD_TABLE_EVENTS,
	RECORD_TABLES,
};
const char *record_table_name(enum record_table table);

/*
 * Writes the tables whose file is not NULL, of the file's `recording`-th
 * recording (from 1). GR_OK; GR_NOTHING when there is no such recording;
 * GR_ERR_IO: reading failed (look at ferror for writing); GR_ERR_NOMEM.
 */
int record_csv_write(struct record_reader *reader, int recording,
		     FILE *const files[RECORD_TABLES]);

#endif
