/*
 * What the doctor found: one line each, how bad it is, and what to do about it.
 * Judges make findings from facts and touch nothing else, so they can be tested
 * with facts that no machine has.
 */
#ifndef GROTTO_TOOLS_DOCTOR_FINDING_H
#define GROTTO_TOOLS_DOCTOR_FINDING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum finding_level {
	FINDING_OK,
	FINDING_SKIP, /* could not be looked at, or says nothing here; never taken for OK */
	FINDING_WARN, /* works, but worse than it could, or not for sure */
	FINDING_FAIL, /* the room will not work so */
	FINDING_LEVELS
};

#define FINDING_TEXT 320

struct finding {
	enum finding_level level;
	const char *check;         /* name of the check, set by the table */
	char text[FINDING_TEXT];   /* what was found */
	char remedy[FINDING_TEXT]; /* what to do; "" where there is nothing to do */
};

/* Zero-initialise; findings_finish frees. Not thread safe. */
struct findings {
	struct finding *items;
	size_t count, room;
	size_t of[FINDING_LEVELS];
	const char *check; /* of those added next; a string that lives as long */
	bool nomem;        /* one was lost */
};

struct finding finding(enum finding_level level, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
/* The same with what to do. */
struct finding finding_do(struct finding of, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

void findings_add(struct findings *findings, struct finding one);
void findings_finish(struct findings *findings);
void findings_print(const struct findings *findings, FILE *file);
/* {"ok":..., "findings":[{"check","level","text","remedy"}]}; GR_OK or GR_ERR_NOMEM. */
int findings_print_json(const struct findings *findings, FILE *file);

#endif
