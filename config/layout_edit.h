/*
 * Changes what a calibration has found in a layout's text, and nothing else of
 * it: comments, blanks and order stay as they are, byte by byte.
 *
 * Pure but for the last two, which read and write the file. Angles are degrees here, as
 * the file has them; lengths metres.
 */
#ifndef GROTTO_CONFIG_LAYOUT_EDIT_H
#define GROTTO_CONFIG_LAYOUT_EDIT_H

#include "base/diag.h"

#include <stdbool.h>
#include <stddef.h>

/* Written to a hundredth of a millimetre and 0.0001 degrees. */
struct layout_edit {
	size_t tracker; /* of the layout, by its place in the list */
	/* Its base, or the offset of one of its bindings. */
	enum { LAYOUT_EDIT_BASE, LAYOUT_EDIT_OFFSET } what;
	size_t binding;       /* whose offset */
	double position[3];   /* of the base, or the offset */
	double angles_deg[3]; /* of the base: heading, pitch, roll */
	double scale;         /* of the base; 0: as it is */
	/* What stands in a comment beside it, begun with "calibrated "; one that was there gives way. */
	const char *note;
};

/*
 * The text with the change: len bytes in, *out_len out, a NUL behind them; the
 * caller frees. It is read again, and must be what was asked for and the same
 * layout in all else. GR_OK; GR_ERR_CONFIG: the text is no layout; GR_ERR_FORMAT:
 * its form is one that this cannot change (both with a line in diag);
 * GR_ERR_NOMEM.
 */
int layout_edit(const char *text, size_t len, const char *path, const struct layout_edit *edit,
		char **out, size_t *out_len, struct gr_diag *diag);

/* A layout's text as layout_load reads it; the caller frees. Errors as of that. */
int layout_text_load(const char *path, char **out, size_t *out_len, struct gr_diag *diag);
/*
 * Puts a file in the place of another in one step: written beside it, with its
 * owner and mode, synced, renamed. A link stays one: what it leads to is
 * replaced. GR_OK; GR_ERR_MISMATCH: the file is no longer `old`; GR_ERR_IO;
 * both with a line in diag, and the file as it was. GR_ERR_NOMEM.
 */
int layout_replace(const char *path, const char *old, size_t old_len, const char *text, size_t len,
		   struct gr_diag *diag);

#endif
