/*
 * Diagnostics: what a loader found wrong, where, and what would be right.
 * A loader goes on after an error where it can, so that a person sees all
 * faults of a file at once. Lines read "file:line: key: text".
 */
#ifndef GROTTO_BASE_DIAG_H
#define GROTTO_BASE_DIAG_H

#include <stddef.h>

enum gr_severity {
	GR_DIAG_NOTE,    /* worth knowing: a gap between two walls, a dropped triangle */
	GR_DIAG_WARNING, /* will work, is probably not meant */
	GR_DIAG_ERROR,   /* refused */
};

struct gr_diag_item {
	enum gr_severity severity;
	char *text; /* the whole line without a newline */
};

/* Zero-initialise; finish with gr_diag_finish. Not thread safe. */
struct gr_diag {
	struct gr_diag_item *items;
	size_t count;
	size_t errors;
	size_t warnings;
};

/* file and key may be NULL, line 0 means none. */
void gr_diag_add(struct gr_diag *diag, enum gr_severity severity, const char *file, int line,
		 const char *key, const char *format, ...) __attribute__((format(printf, 6, 7)));
/* Writes every line through gr_log (error, warning or notice). */
void gr_diag_log(const struct gr_diag *diag);
void gr_diag_finish(struct gr_diag *diag);

#endif
