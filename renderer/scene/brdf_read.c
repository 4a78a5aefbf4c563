#include "renderer/scene/brdf_read.h"

#include "base/result.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define WORD_MAX 64

struct words {
	const char *at, *end;
	const char *name;
	int line;
	struct gr_diag *diag;
};

static int refuse(const struct words *w, const char *text, double value)
{
	gr_diag_add(w->diag, GR_DIAG_ERROR, w->name, w->line, NULL, text, value);
	return GR_ERR_CONFIG;
}

static bool is_space(char c)
{
	return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
}

/* Past spaces and comments; false at the end. */
static bool find_word(struct words *w)
{
	bool comment = false;

	for (; w->at < w->end; w->at++) {
		if (*w->at == '\n') {
			w->line++;
			comment = false;
		} else if (*w->at == '#') {
			comment = true;
		} else if (!comment && !is_space(*w->at)) {
			return true;
		}
	}
	return false;
}

/* Of a word; one that is longer than any number goes on. */
static bool is_end(const struct words *w)
{
	return w->at == w->end || is_space(*w->at) || *w->at == '#';
}

/* GR_NOTHING at the end of the text. */
static int next_number(struct words *w, double *out)
{
	char word[WORD_MAX + 1];
	size_t len = 0;
	char *rest;

	if (!find_word(w))
		return GR_NOTHING;
	while (!is_end(w) && len < WORD_MAX)
		word[len++] = *w->at++;
	word[len] = '\0';
	*out = strtod(word, &rest);
	if (*rest || rest == word || !isfinite(*out) || !is_end(w)) {
		for (size_t i = 0; i < len; i++)
			if (word[i] < ' ' || word[i] > '~')
				word[i] = '?';
		gr_diag_add(w->diag, GR_DIAG_ERROR, w->name, w->line, NULL,
			    "\"%s\" is no finite number", word);
		return GR_ERR_CONFIG;
	}
	return GR_OK;
}

static int number(struct words *w, const char *what, double *out)
{
	int result = next_number(w, out);

	if (result == GR_NOTHING) {
		gr_diag_add(w->diag, GR_DIAG_ERROR, w->name, w->line, NULL,
			    "ends where %s should stand: cut off?", what);
		return GR_ERR_CONFIG;
	}
	return result;
}

static int read_wavelengths(struct words *w, double *nm, size_t *count)
{
	double value;
	int result = number(w, "the number of wavelengths", &value);

	if (result != GR_OK)
		return result;
	if (value < 3 || value > BRDF_MAX_WAVELENGTHS || value != floor(value))
		return refuse(w, "%g wavelengths; a table has 3 to 512, and begins with their number", value);
	*count = (size_t)value;
	for (size_t i = 0; i < *count; i++) {
		result = number(w, "a wavelength", &nm[i]);
		if (result != GR_OK)
			return result;
		if (nm[i] < 300 || nm[i] > 900 || (i > 0 && nm[i] <= nm[i - 1]))
			return refuse(w, "wavelength %g; they rise from 300 to 900 nm", nm[i]);
	}
	return GR_OK;
}

static int read_angles(struct words *w, struct brdf_sample *out, double theta_i)
{
	static const char *const what[3] = { "phi_i", "theta_o", "phi_o" };
	double at[3];

	for (int i = 0; i < 3; i++) {
		int result = number(w, what[i], &at[i]);

		if (result != GR_OK)
			return result;
		if (fabs(at[i]) > 4 * M_PI)
			return refuse(w, "angle %g; angles are in radians", at[i]);
	}
	if (theta_i < 0 || theta_i > BRDF_MAX_THETA || at[1] < 0 || at[1] > BRDF_MAX_THETA)
		return refuse(w, "%g from the normal; directions are 0 to 1.57 from it, in radians",
			      theta_i < 0 || theta_i > BRDF_MAX_THETA ? theta_i : at[1]);
	out->theta_i = theta_i;
	out->theta_o = at[1];
	out->phi = fabs(remainder(at[2] - at[0], 2 * M_PI));
	return GR_OK;
}

static int read_sample(struct words *w, const double (*weights)[3], double theta_i,
		       struct brdf_samples *out)
{
	struct brdf_sample *sample = &out->samples[out->count];
	int result = read_angles(w, sample, theta_i);
	double rgb[3] = { 0 };

	for (size_t i = 0; i < out->wavelengths && result == GR_OK; i++) {
		double value;

		result = number(w, "a sample's value", &value);
		if (result != GR_OK)
			break;
		if (fabs(value) > BRDF_MAX_VALUE)
			return refuse(w, "value %g; at most 1e6 per steradian is taken", value);
		out->below_zero += value < 0;
		for (int c = 0; c < 3; c++)
			rgb[c] += weights[i][c] * value;
	}
	for (int c = 0; c < 3 && result == GR_OK; c++) {
		out->cut += rgb[c] < 0;
		sample->rgb[c] = rgb[c] > 0 ? rgb[c] : 0;
	}
	return result;
}

static int grow(struct brdf_samples *out, size_t *room)
{
	struct brdf_sample *more;

	if (out->count < *room)
		return GR_OK;
	*room = *room ? 2 * *room : 1024;
	more = realloc(out->samples, *room * sizeof *more);
	if (!more)
		return GR_ERR_NOMEM;
	out->samples = more;
	return GR_OK;
}

static int read_samples(struct words *w, const double (*weights)[3], struct brdf_samples *out)
{
	size_t room = 0;
	double theta_i;
	int result;

	while ((result = next_number(w, &theta_i)) == GR_OK) {
		if (out->count == BRDF_MAX_SAMPLES)
			return refuse(w, "more than %.0f samples", (double)BRDF_MAX_SAMPLES);
		result = grow(out, &room);
		if (result == GR_OK)
			result = read_sample(w, weights, theta_i, out);
		if (result != GR_OK)
			return result;
		out->count++;
	}
	if (result != GR_NOTHING)
		return result;
	return out->count >= 16 ? GR_OK
				: refuse(w, "%.0f samples; at least 16 make a table", (double)out->count);
}

int brdf_read(const char *text, size_t len, const char *name, struct brdf_samples *out,
	      struct gr_diag *diag)
{
	struct words w = { .at = text, .end = text + len, .name = name, .line = 1, .diag = diag };
	double nm[BRDF_MAX_WAVELENGTHS] = { 0 }, weights[BRDF_MAX_WAVELENGTHS][3];
	int result;

	memset(out, 0, sizeof *out);
	result = read_wavelengths(&w, nm, &out->wavelengths);
	if (result == GR_OK && brdf_color_weights(nm, out->wavelengths, weights) != GR_OK)
		result = refuse(&w, "the wavelengths up to %g nm leave a colour out; 400 to 700 nm are meant",
				nm[out->wavelengths - 1]);
	if (result == GR_OK)
		result = read_samples(&w, (const double(*)[3])weights, out);
	if (result != GR_OK)
		brdf_samples_finish(out);
	return result;
}

void brdf_samples_finish(struct brdf_samples *samples)
{
	free(samples->samples);
	memset(samples, 0, sizeof *samples);
}
