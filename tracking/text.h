/*
 * A cursor over bytes that should be text: words, numbers and blocks in
 * brackets, as trackers write them. Sticky failure as in base/cursor.h; no
 * locale, no NaN, no infinity, no hexadecimal, every number has a bound.
 * Pure; the bytes belong to the caller and need no NUL at their end.
 */
#ifndef GROTTO_TRACKING_TEXT_H
#define GROTTO_TRACKING_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct track_text {
	const char *at, *end;
	bool ok;
};

static inline struct track_text track_text(const void *bytes, size_t len)
{
	return (struct track_text){ bytes, (const char *)bytes + len, true };
}

/*
 * The next line, without its LF or CR LF, as a cursor of its own. False when
 * nothing is left.
 */
bool track_text_line(struct track_text *text, struct track_text *line);
/* Whether the next word, up to a blank, is this one; then it is passed. */
bool track_text_word(struct track_text *text, const char *word);
/* Decimal digits up to `most`; else failure, and 0. */
uint32_t track_text_u32(struct track_text *text, uint32_t most);
/* [+-]digits[.digits][e[+-]digits], of an amount up to `most`; else failure, and 0. */
double track_text_number(struct track_text *text, double most);
/* This character after any blanks, or failure. */
void track_text_expect(struct track_text *text, char c);
/* Up to and with the next ']'; a '[' or the end before it is a failure. */
void track_text_close(struct track_text *text);
/* No failure, and nothing but blanks left. */
bool track_text_done(struct track_text *text);

#endif
