/* A layout's words for buttons and axes, looked up among a driver's. */
#include "tracking/bind.h"

#include "base/result.h"

#include <stdio.h>
#include <string.h>

int track_name_index(const char *const *names, const char *name, size_t len)
{
	for (int i = 0; names && names[i]; i++)
		if (strlen(names[i]) == len && !memcmp(names[i], name, len))
			return i;
	return -1;
}

static size_t count_of(const char *const *names, size_t most)
{
	size_t n = 0;

	while (names && names[n] && n < most)
		n++;
	return n;
}

static void list_names(char *text, size_t size, const char *const *names)
{
	size_t len = strlen(text);

	for (size_t i = 0; names && names[i] && len < size; i++)
		len += (size_t)snprintf(text + len, size - len, "%s%s", len ? ", " : "", names[i]);
}

static int unknown(const char *word, size_t len, const char *const *first,
		   const char *const *second, const struct track_place *place, struct gr_diag *diag)
{
	char known[600] = "";

	list_names(known, sizeof known, first);
	list_names(known, sizeof known, second);
	gr_diag_add(diag, GR_DIAG_ERROR, place->file, place->line, place->key,
		    "\"%.*s\" is nothing that this device has; it has %s, and - for none",
		    len < 40 ? (int)len : 40, word, known[0] ? known : "none");
	return GR_ERR_CONFIG;
}

static int too_many(const struct track_place *place, unsigned most, struct gr_diag *diag)
{
	gr_diag_add(diag, GR_DIAG_ERROR, place->file, place->line, place->key,
		    "too many; at most %u", most);
	return GR_ERR_CONFIG;
}

/* The next word of a text; its length 0 at the end. */
static size_t next_word(const char **text)
{
	*text += strspn(*text, " \t");
	return strcspn(*text, " \t");
}

/* A word for an axis: its index or -1, and whether it is turned round. */
static int axis_word(const struct track_names *names, const char *word, size_t len, bool *negative)
{
	*negative = len > 1 && word[0] == '-';
	return track_name_index(names->axes, word + *negative, len - *negative);
}

static int button_word(struct track_button_from *from, const struct track_names *names,
		       const char *word, size_t len)
{
	bool negative = false;
	int index = track_name_index(names->buttons, word, len);

	*from = (struct track_button_from){ 0 };
	if (len == 1 && word[0] == '-')
		return GR_OK;
	from->kind = TRACK_FROM_BUTTON;
	if (index < 0) {
		from->kind = TRACK_FROM_AXIS;
		index = axis_word(names, word, len, &negative);
	}
	from->index = (uint8_t)index;
	from->negative = negative;
	return index < 0 ? GR_ERR_CONFIG : GR_OK;
}

int track_bind_buttons(struct track_binding *b, const struct track_names *names, const char *text,
		       const struct track_place *place, struct gr_diag *diag)
{
	size_t len;

	b->button_count = 0;
	if (!text) {
		b->button_count = (unsigned)count_of(names->buttons, TRACK_BUTTONS_MAX);
		for (unsigned i = 0; i < b->button_count; i++)
			b->buttons[i] =
				(struct track_button_from){ TRACK_FROM_BUTTON, (uint8_t)i, false };
		return GR_OK;
	}
	for (; (len = next_word(&text)) > 0; text += len) {
		if (b->button_count == TRACK_BUTTONS_MAX)
			return too_many(place, TRACK_BUTTONS_MAX, diag);
		if (button_word(&b->buttons[b->button_count++], names, text, len) < 0)
			return unknown(text, len, names->buttons, names->axes, place, diag);
	}
	return GR_OK;
}

int track_bind_axes(struct track_binding *b, const struct track_names *names, const char *text,
		    const struct track_place *place, struct gr_diag *diag)
{
	size_t len;

	b->axis_count = 0;
	if (!text) {
		b->axis_count = (unsigned)count_of(names->axes, TRACK_AXES);
		for (unsigned i = 0; i < b->axis_count; i++)
			b->axes[i] = (struct track_axis_from){ true, (uint8_t)i, false };
		return GR_OK;
	}
	for (; (len = next_word(&text)) > 0; text += len) {
		struct track_axis_from *to = &b->axes[b->axis_count];
		int index;

		if (b->axis_count == TRACK_AXES)
			return too_many(place, TRACK_AXES, diag);
		b->axis_count++;
		*to = (struct track_axis_from){ 0 };
		if (len == 1 && text[0] == '-')
			continue;
		index = axis_word(names, text, len, &to->negative);
		if (index < 0)
			return unknown(text, len, names->axes, NULL, place, diag);
		to->index = (uint8_t)index;
		to->given = true;
	}
	return GR_OK;
}
