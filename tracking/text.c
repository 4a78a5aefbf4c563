#include "tracking/text.h"

#include <string.h>

#define DIGITS_MOST 18	/* of a mantissa that count: 64 bits hold them */
#define POWER_MOST 400	/* of ten: beyond any double, and no counter runs over */

static bool digit(const struct track_text *t)
{
	return t->at < t->end && *t->at >= '0' && *t->at <= '9';
}

static void skip_blanks(struct track_text *t)
{
	while (t->at < t->end && (*t->at == ' ' || *t->at == '\t'))
		t->at++;
}

static bool passes(struct track_text *t, char c)
{
	if (t->at == t->end || *t->at != c)
		return false;
	t->at++;
	return true;
}

bool track_text_line(struct track_text *text, struct track_text *line)
{
	const size_t left = (size_t)(text->end - text->at);
	const char *feed = left ? memchr(text->at, '\n', left) : NULL;
	const char *end = feed ? feed : text->end;

	if (!left)
		return false;
	*line = (struct track_text){ text->at, end, true };
	if (line->end > line->at && line->end[-1] == '\r')
		line->end--;
	text->at = feed ? feed + 1 : end;
	return true;
}

bool track_text_word(struct track_text *text, const char *word)
{
	const size_t len = strlen(word);
	const size_t left = (size_t)(text->end - text->at);

	if (!text->ok || left < len || (len && memcmp(text->at, word, len) != 0) ||
	    (left > len && text->at[len] != ' ' && text->at[len] != '\t'))
		return false;
	text->at += len;
	return true;
}

uint32_t track_text_u32(struct track_text *text, uint32_t most)
{
	uint64_t value = 0;

	skip_blanks(text);
	if (!digit(text))
		text->ok = false;
	while (text->ok && digit(text)) {
		value = value * 10 + (uint64_t)(*text->at++ - '0');
		if (value > most)
			text->ok = false;
	}
	return text->ok ? (uint32_t)value : 0;
}

/* Digits with at most one point; *power: of ten, that the mantissa is to be taken times. */
static uint64_t mantissa(struct track_text *t, int *power)
{
	uint64_t value = 0;
	int kept = 0, seen = 0;
	bool point = false;

	for (; digit(t) || (!point && t->at < t->end && *t->at == '.'); t->at++) {
		if (*t->at == '.') {
			point = true;
			continue;
		}
		seen++;
		*power -= point;
		if (kept < DIGITS_MOST) {
			value = value * 10 + (uint64_t)(*t->at - '0');
			kept += value != 0;
		} else {
			++*power; /* worth less than the last place that is kept */
		}
	}
	if (!seen)
		t->ok = false;
	return value;
}

static int exponent(struct track_text *t)
{
	int value = 0;
	bool minus;

	if (!passes(t, 'e') && !passes(t, 'E'))
		return 0;
	minus = passes(t, '-');
	if (!minus)
		(void)passes(t, '+');
	if (!digit(t))
		t->ok = false;
	for (; digit(t); t->at++)
		if (value < POWER_MOST)
			value = value * 10 + (*t->at - '0');
	return minus ? -value : value;
}

static double times_ten_to(double value, int power)
{
	/* Exact up to 1e22, so that what has few digits is rounded once. */
	double scale = 1;
	int n = power < 0 ? -power : power;

	if (n > POWER_MOST)
		n = POWER_MOST;
	for (; n > 0; n--)
		scale *= 10;
	return power < 0 ? value / scale : value * scale;
}

double track_text_number(struct track_text *text, double most)
{
	int power = 0;
	uint64_t digits;
	double value;
	bool minus;

	skip_blanks(text);
	minus = passes(text, '-');
	if (!minus)
		(void)passes(text, '+');
	digits = mantissa(text, &power);
	power += exponent(text);
	/* 0e999 is 0, not 0 times infinity. */
	value = digits ? times_ten_to((double)digits, power) : 0;
	if (!text->ok || !(value <= most)) {
		text->ok = false;
		return 0;
	}
	return minus ? -value : value;
}

void track_text_expect(struct track_text *text, char c)
{
	skip_blanks(text);
	if (!text->ok || !passes(text, c))
		text->ok = false;
}

void track_text_close(struct track_text *text)
{
	while (text->ok && text->at < text->end && *text->at != ']' && *text->at != '[')
		text->at++;
	track_text_expect(text, ']');
}

bool track_text_done(struct track_text *text)
{
	skip_blanks(text);
	return text->ok && text->at == text->end;
}
