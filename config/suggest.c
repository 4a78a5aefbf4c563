#include "config/suggest.h"

#include <ctype.h>
#include <stdint.h>
#include <string.h>

#define SUGGEST_WORD_MAX 64

static size_t least(size_t a, size_t b)
{
	return a < b ? a : b;
}

/* Case and the choice of '-' or '_' are half of all slips: they cost nothing. */
static int fold(char c)
{
	return c == '-' ? '_' : tolower((unsigned char)c);
}

size_t suggest_distance(const char *a, const char *b)
{
	size_t rows[3][SUGGEST_WORD_MAX + 1];
	size_t *before = rows[0], *last = rows[1], *now = rows[2];
	size_t len_a = strlen(a), len_b = strlen(b);

	if (len_a > SUGGEST_WORD_MAX || len_b > SUGGEST_WORD_MAX)
		return len_a > len_b ? len_a : len_b;
	for (size_t j = 0; j <= len_b; j++)
		last[j] = before[j] = j;
	for (size_t i = 1; i <= len_a; i++) {
		size_t *spare = before;

		now[0] = i;
		for (size_t j = 1; j <= len_b; j++) {
			size_t cost = fold(a[i - 1]) != fold(b[j - 1]);

			now[j] = least(least(last[j], now[j - 1]) + 1, last[j - 1] + cost);
			if (i > 1 && j > 1 && fold(a[i - 1]) == fold(b[j - 2]) &&
			    fold(a[i - 2]) == fold(b[j - 1]))
				now[j] = least(now[j], before[j - 2] + 1);
		}
		before = last;
		last = now;
		now = spare;
	}
	return last[len_b];
}

void suggest_start(struct suggest *suggest, const char *word)
{
	*suggest = (struct suggest){ word, NULL, SIZE_MAX };
}

void suggest_offer(struct suggest *suggest, const char *candidate)
{
	size_t distance = suggest_distance(suggest->word, candidate);
	size_t shorter = least(strlen(suggest->word), strlen(candidate));

	/* "far" for "far_m", "lower" for "lower_left": a whole beginning counts as near. */
	if (distance > 1 && !strncmp(suggest->word, candidate, shorter) &&
	    (shorter >= 4 || candidate[shorter] == '_'))
		distance = 1;
	if (distance < suggest->distance) {
		suggest->distance = distance;
		suggest->best = candidate;
	}
}

const char *suggest_answer(const struct suggest *suggest)
{
	size_t len = strlen(suggest->word);
	size_t allowed = len < 4 ? 1 : len < 9 ? 2 : 3;

	return suggest->best && suggest->distance <= allowed ? suggest->best : NULL;
}
