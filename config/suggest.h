/* "Did you mean": the known word nearest to a mistyped one. */
#ifndef GROTTO_CONFIG_SUGGEST_H
#define GROTTO_CONFIG_SUGGEST_H

#include <stddef.h>

/*
 * Edits that turn a into b: insert, delete, replace, and swap of neighbours
 * (optimal string alignment: Damerau 1964). Words beyond 64 bytes count as
 * wholly different.
 */
size_t suggest_distance(const char *a, const char *b);

/* The nearest word when it is near enough to be meant, else NULL. */
struct suggest {
	const char *word;
	const char *best;
	size_t distance;
};
void suggest_start(struct suggest *suggest, const char *word);
void suggest_offer(struct suggest *suggest, const char *candidate);
const char *suggest_answer(const struct suggest *suggest);

#endif
