/* Letters of strokes, and bars: what the layout in use changes, beside the wand. */
#include "renderer/view/hud_private.h"

#include <math.h>
#include <string.h>

#define LETTERS_X 0.06f
#define LETTER_WIDTH 0.013f
#define LETTER_HEIGHT 0.02f
#define STROKE 0.0028f
#define BARS_X 0.085f
#define BAR 0.08f
#define ROWS_APART 0.03f

static const vec4 grey = HUD_GREY, dark = HUD_DARK, white = HUD_WHITE;
static const vec4 green = { 0.35f, 1, 0.35f, 1 };

/* A box from one point of the plane to another. */
static void add_stroke(struct hud_list *l, const float from[2], const float to[2], const vec4 color)
{
	const float dx = to[0] - from[0], dy = to[1] - from[1], length = hypotf(dx, dy);
	const float c = dx / length, s = dy / length, reach = length + STROKE;
	mat4 m = { { reach * c, reach * s, 0, 0 },
		   { -STROKE * s, STROKE * c, 0, 0 },
		   { 0, 0, STROKE, 0 },
		   { 0.5f * (from[0] + to[0]), 0.5f * (from[1] + to[1]), 0, 1 } };

	hud_add(l, HUD_BOX, m, color);
}

static void hue_color(float hue, vec4 out)
{
	for (int i = 0; i < 3; i++) {
		float at = fabsf(6 * hue - 2 * (float)i);

		at = at > 3 ? 6 - at : at;
		out[i] = fminf(fmaxf(2 - at, 0), 1);
	}
	out[3] = 1;
}

/* Strokes in a square of 1, from its lower left. */
struct letter {
	char name;
	int count;
	float strokes[5][4];
};

static const struct letter letters[] = {
	{ 'A', 3, { { 0, 0, 0.5f, 1 }, { 0.5f, 1, 1, 0 }, { 0.2f, 0.4f, 0.8f, 0.4f } } },
	{ 'G', 5, { { 1, 1, 0, 1 }, { 0, 1, 0, 0 }, { 0, 0, 1, 0 }, { 1, 0, 1, 0.45f }, { 1, 0.45f, 0.55f, 0.45f } } },
	{ 'H', 3, { { 0, 0, 0, 1 }, { 1, 0, 1, 1 }, { 0, 0.5f, 1, 0.5f } } },
	{ 'I', 3, { { 0.5f, 0, 0.5f, 1 }, { 0.2f, 1, 0.8f, 1 }, { 0.2f, 0, 0.8f, 0 } } },
	{ 'L', 2, { { 0, 1, 0, 0 }, { 0, 0, 1, 0 } } },
	{ 'P', 4, { { 0, 0, 0, 1 }, { 0, 1, 1, 1 }, { 1, 1, 1, 0.5f }, { 1, 0.5f, 0, 0.5f } } },
	{ 'Q', 5, { { 0, 0, 0, 1 }, { 0, 1, 1, 1 }, { 1, 1, 1, 0 }, { 1, 0, 0, 0 }, { 0.55f, 0.4f, 1.1f, -0.15f } } },
	{ 'S', 5, { { 1, 1, 0, 1 }, { 0, 1, 0, 0.5f }, { 0, 0.5f, 1, 0.5f }, { 1, 0.5f, 1, 0 }, { 1, 0, 0, 0 } } },
};

static void add_letter(struct hud_list *l, char name, float y, const vec4 color)
{
	for (size_t i = 0; i < sizeof letters / sizeof *letters; i++) {
		if (letters[i].name != name)
			continue;
		for (int k = 0; k < letters[i].count; k++) {
			const float *s = letters[i].strokes[k];
			const float low = y - 0.5f * LETTER_HEIGHT;
			const float from[2] = { LETTERS_X + LETTER_WIDTH * s[0], low + LETTER_HEIGHT * s[1] };
			const float to[2] = { LETTERS_X + LETTER_WIDTH * s[2], low + LETTER_HEIGHT * s[3] };

			add_stroke(l, from, to, color);
		}
	}
}

struct row {
	char letter;
	float share; /* of the whole bar; negative: no bar */
	vec4 color, letter_color;
};

static void add_rows(struct hud_list *l, const struct row *rows, int count)
{
	for (int i = 0; i < count; i++) {
		const float y = ROWS_APART * (0.5f * (float)(count - 1) - (float)i);
		const float share = fminf(rows[i].share, 1);
		const float full = BAR * fmaxf(share, 0), rest = BAR - full;
		/* Beside each other, not one in the other: nothing but their order hides parts. */
		const vec3 done = { full, 0.01f, 0.004f }, left = { rest, 0.004f, 0.002f };

		add_letter(l, rows[i].letter, y, rows[i].letter_color);
		if (!(share >= 0))
			continue;
		if (full > 0)
			hud_add_box(l, BARS_X + 0.5f * full, y, done, rows[i].color);
		if (rest > 0)
			hud_add_box(l, BARS_X + full + 0.5f * rest, y, left, dark);
	}
}

static struct row row(char letter, float share, const vec4 color)
{
	struct row r = { .letter = letter, .share = share };

	memcpy(r.color, color, sizeof r.color);
	memcpy(r.letter_color, white, sizeof r.letter_color);
	return r;
}

/* Intensity on a scale of ratios: from 0.01 W/sr none, at 100 kW/sr all. */
static float intensity_share(const float *rgb)
{
	const float most = fmaxf(fmaxf(rgb[0], rgb[1]), rgb[2]);

	return most > 1e-2f ? log10f(most / 1e-2f) / 7 : 0;
}

static void add_lighting(struct hud_list *l, const struct hud_view *v)
{
	const float *rgb = v->torch_intensity;
	const float most = fmaxf(fmaxf(rgb[0], rgb[1]), rgb[2]);
	const float least = fminf(fminf(rgb[0], rgb[1]), rgb[2]);
	struct row rows[3];
	vec4 hue, torch;

	if (!v->has_torch)
		return;
	hue_color(v->torch_hue, hue);
	hud_torch_color(v, torch);
	rows[0] = row('L', intensity_share(rgb), white);
	rows[1] = row('H', v->torch_hue, hue);
	rows[2] = row('S', most > 0 ? (most - least) / most : 0, torch);
	add_rows(l, rows, 3);
}

static void add_settings(struct hud_list *l, const struct hud_view *v)
{
	struct row rows[5];
	int count = 0;

	rows[count++] = row('A', v->absorption_per_m, white);
	rows[count++] = row('S', v->scattering_per_m, white);
	if (v->incremental >= 0)
		rows[count++] = row('I', v->incremental, white);
	if (v->work)
		rows[count++] = row(v->work, v->work_share, v->refines ? green : white);
	rows[count] = row('Q', -1, white);
	memcpy(rows[count].letter_color, !v->quality ? grey : v->refines ? green : white, sizeof(vec4));
	add_rows(l, rows, count + 1);
}

void hud_add_bars(struct hud_list *l, const struct hud_view *view)
{
	switch (view->mode) {
	case FRAME_HAND_LIGHTING: add_lighting(l, view); break;
	case FRAME_HAND_SETTINGS: add_settings(l, view); break;
	case FRAME_HAND_NAVIGATION: /* changes no value */
	case FRAME_HAND_MODES: break;
	}
}
