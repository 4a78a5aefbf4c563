/*
 * What of a scene file's `gi` a run changes, from text: "lpv.lattice=32,
 * lpv.steps=8". Keys are those of the scene file without "gi."; values are
 * checked as the scene file's are. Surfels and probes share theirs, so
 * "surfels." and "probes." mean the same group, for the method named.
 */
#ifndef GROTTO_TOOLS_BENCH_SETTINGS_H
#define GROTTO_TOOLS_BENCH_SETTINGS_H

#include "config/scene_file.h"

#include <stdbool.h>
#include <stdio.h>

#define BENCH_CASES_MAX 64
#define BENCH_LABEL_MAX 64

/* One method with its settings. */
struct bench_case {
	struct scene_gi gi;
	char label[BENCH_LABEL_MAX]; /* what tells it from others of its method, for people: "32 cells, 8 steps" */
};

const char *bench_method_name(enum scene_gi_method method);
/* The name of a method: "none", "lpv", ...; GR_ERR_RANGE with the choices on `err`. */
int bench_method_find(const char *name, size_t len, enum scene_gi_method *out, FILE *err);

struct bench_cases {
	struct bench_case items[BENCH_CASES_MAX];
	size_t count;
};
/*
 * methods: names with commas between. settings: cases with blanks between, a
 * case "key=value" with commas between; it counts for the method that its keys
 * begin with, and for that one replaces the usual sweep. NULL: only the usual
 * sweeps. lit_area (m^2) makes the surfels' usual spacings. "none" always comes
 * first. GR_OK, or GR_ERR_CONFIG with what is wrong on `err`.
 */
int bench_cases_make(struct bench_cases *out, const struct scene_file *file, const char *methods,
		     const char *settings, double lit_area, FILE *err);
/*
 * The scene file's own settings with that method instead, checked. word: what of
 * --settings gave them, for messages; NULL: nothing. GR_OK or GR_ERR_CONFIG.
 */
int bench_case_check(const struct scene_file *file, const struct scene_gi *gi, const char *word, FILE *err);

#endif
