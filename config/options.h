/*
 * The option table: one entry per key of a configuration file gives its type,
 * unit, range, default, choices and help, and where the value goes in a
 * struct. The table drives reading, range checks, defaults, "did you mean",
 * writing a file again and the reference pages (docs/layout.md, docs/scene.md).
 *
 * Private to config/. Not thread safe: one reader, one thread.
 */
#ifndef GROTTO_CONFIG_OPTIONS_H
#define GROTTO_CONFIG_OPTIONS_H

#include "base/diag.h"

#include <libconfig.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define OPTION_NAME_SIZE 32     /* with the final NUL; LAYOUT_NAME_MAX, SCENE_NAME_MAX */
#define OPTION_STRING_MAX 4095  /* bytes of a string */
#define OPTION_ABSENT (-1)      /* value of a choice that is not given and has no default */

/* What a key takes, and the C type at `offset`. */
enum option_type {
	OPTION_BOOL,   /* bool */
	OPTION_INT,    /* int[count] */
	OPTION_PORT,   /* uint16_t */
	OPTION_U32,    /* uint32_t */
	OPTION_FLOAT,  /* float[count], NaN when absent without a default */
	OPTION_TIME,   /* int64_t nanoseconds */
	OPTION_NAME,   /* char[OPTION_NAME_SIZE], "" when absent without a default */
	OPTION_STRING, /* char *, NULL when absent without a default */
	OPTION_CHOICE, /* int, index into choices, OPTION_ABSENT when absent without a default */
	OPTION_GROUP,  /* a struct whose first member is a const config_setting_t * */
	OPTION_LIST,   /* such structs: pointer at offset, size_t at count_offset */
};

struct option {
	const char *key; /* NULL ends a table */
	enum option_type type;
	bool required;
	unsigned count; /* of numbers (0 and 1: a scalar); of elements at most for a list */
	double min, max; /* in the file's unit, inclusive */
	double scale;    /* value in the struct = value in the file * scale; 0 means 1 */
	const char *unit;
	const char *standard; /* the default as text, numbers apart by blanks */
	const char *const *choices; /* ended by NULL */
	const struct option *group;
	size_t offset, size, count_offset; /* size: of a list's element */
	const char *help;
};

/* Where faults go. */
struct options_reader {
	const char *file;
	const config_setting_t *root;
	struct gr_diag *diag;
	size_t faults; /* errors of this file, those that were not printed included */
	bool nomem;
};

/* Lines about faults of one file that are printed; more are counted. */
#define OPTIONS_FAULTS_SHOWN 64

/*
 * Adds a line about `key` (a member, or a dotted path) of the group `at`.
 * The line number is the key's, or that of the nearest group around it when
 * the key is not in the file. at NULL means the file's root.
 */
void options_fault(struct options_reader *reader, enum gr_severity severity,
		   const config_setting_t *at, const char *key, const char *format, ...)
	__attribute__((format(printf, 5, 6)));

/* Whether the file gives this key. at NULL: no. */
bool options_given(const config_setting_t *at, const char *key);

/*
 * Reads the group `at` (NULL: all defaults) into `base`, which must be zeroed.
 * Every fault is reported; what is wrong keeps its default. Free with
 * options_free whatever happens.
 */
void options_read(struct options_reader *reader, const struct option *table,
		  const config_setting_t *at, void *base);
void options_free(const struct option *table, void *base);

/* Writes `base` as libconfig text that reads back to the same values. */
void options_write(FILE *file, const struct option *table, const void *base);
/* The reference page: one table for the top level and one per group. */
void options_print_markdown(FILE *file, const struct option *table);

/* A name may be a systemd instance and part of a file name. */
bool options_name_fit(const char *name);

#endif
