/*
 * Where settings stand in a libconfig text, byte by byte, so that a value can
 * be changed and all else be kept: libconfig itself tells lines alone and
 * forgets comments. For a text that libconfig has taken (config_text.h); of any
 * other text the answer is "not there" or a place within it, never a byte beyond.
 *
 * Private to config/. Pure.
 */
#ifndef GROTTO_CONFIG_SETTING_PLACE_H
#define GROTTO_CONFIG_SETTING_PLACE_H

#include <stdbool.h>
#include <stddef.h>

struct setting_text {
	const char *bytes;
	size_t len;
};

/* A value: its first byte, and the one after its last; brackets are part of it. */
struct setting_place {
	size_t begin, end;
	size_t key;  /* of a member: where its name begins */
	size_t after; /* behind the ';' or ',' that ends it, or `end` where there is none */
};

/* The whole text, as a group without brackets. */
struct setting_place setting_place_root(const struct setting_text *text);
/* A member of a group by its name. False: the group has none. */
bool setting_place_member(const struct setting_text *text, const struct setting_place *group,
			  const char *name, struct setting_place *out);
/* An element of a list or array. */
bool setting_place_element(const struct setting_text *text, const struct setting_place *list,
			   size_t index, struct setting_place *out);
/* Where the text goes on that is neither blank nor comment, from `at` on and before `end`. */
size_t setting_place_skip(const struct setting_text *text, size_t at, size_t end);

#endif
