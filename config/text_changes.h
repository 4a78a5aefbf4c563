/* Changes of a text, gathered first and made all at once. Private to config/. Pure. */
#ifndef GROTTO_CONFIG_TEXT_CHANGES_H
#define GROTTO_CONFIG_TEXT_CHANGES_H

#include <stddef.h>

#define TEXT_CHANGES_MOST 16

/* The bytes from begin to end become `text`. */
struct text_change {
	size_t begin, end;
	char text[800];
};

/* Zero-initialise. They may come in any order, and do not overlap. */
struct text_changes {
	struct text_change all[TEXT_CHANGES_MOST];
	size_t count;
};

/* A change to nothing yet; valid as long as the struct, up to TEXT_CHANGES_MOST of them. */
struct text_change *text_changes_add(struct text_changes *changes, size_t begin, size_t end);
/* To a change's text; what is beyond its room is cut off. */
void text_change_append(struct text_change *change, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
/* The text with all of them, and a NUL behind it; NULL: no memory. The caller frees. */
char *text_changes_apply(struct text_changes *changes, const char *text, size_t len, size_t *out_len);

#endif
