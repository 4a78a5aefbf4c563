#include "tools/bench/settings.h"

#include "base/plain.h"
#include "base/result.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static const char *const method_names[] = {
	[SCENE_GI_NONE] = "none",	[SCENE_GI_LPV] = "lpv",	  [SCENE_GI_SURFELS] = "surfels",
	[SCENE_GI_PROBES] = "probes", [SCENE_GI_AUTO] = "auto",
};
#define METHODS (sizeof method_names / sizeof *method_names)

enum kind { WHOLE, REAL, MODE };

static const struct key {
	const char *name;
	enum kind kind;
	size_t offset;
} lpv_keys[] = {
	{ "lattice", WHOLE, offsetof(struct scene_gi, lattice) },
	{ "steps", WHOLE, offsetof(struct scene_gi, steps) },
	{ "rsm_pixels", WHOLE, offsetof(struct scene_gi, rsm_pixels) },
	{ "link_rays", WHOLE, offsetof(struct scene_gi, link_rays) },
	{ "incremental", REAL, offsetof(struct scene_gi, incremental) },
	{ "mode", MODE, offsetof(struct scene_gi, lpv_mode) },
	{ NULL, WHOLE, 0 },
}, surfel_keys[] = {
	{ "spacing_m", REAL, offsetof(struct scene_gi, spacing_m) },
	{ "links", WHOLE, offsetof(struct scene_gi, links) },
	{ "gathers", WHOLE, offsetof(struct scene_gi, gathers) },
	{ "taps", WHOLE, offsetof(struct scene_gi, taps) },
	{ "probes", WHOLE, offsetof(struct scene_gi, probes) },
	{ NULL, WHOLE, 0 },
}, auto_keys[] = {
	{ "budget_ms", REAL, offsetof(struct scene_gi, budget_ms) },
	{ NULL, WHOLE, 0 },
};

static const struct key *keys_of(enum scene_gi_method method)
{
	switch (method) {
	case SCENE_GI_LPV: return lpv_keys;
	case SCENE_GI_SURFELS:
	case SCENE_GI_PROBES: return surfel_keys;
	case SCENE_GI_AUTO: return auto_keys;
	case SCENE_GI_NONE: break;
	}
	return NULL;
}

const char *bench_method_name(enum scene_gi_method method)
{
	return (size_t)method < METHODS ? method_names[method] : "?";
}

int bench_method_find(const char *name, size_t len, enum scene_gi_method *out, FILE *err)
{
	for (size_t i = 0; i < METHODS; i++) {
		if (strlen(method_names[i]) == len && !strncmp(name, method_names[i], len)) {
			*out = (enum scene_gi_method)i;
			return GR_OK;
		}
	}
	fprintf(err, "'%.*s' is no method: there are", (int)(len < 64 ? len : 64), name);
	for (size_t i = 0; i < METHODS; i++)
		fprintf(err, " %s", method_names[i]);
	fprintf(err, "\n");
	return GR_ERR_RANGE;
}

static void make_label(struct bench_case *c)
{
	const struct scene_gi *gi = &c->gi;
	char spacing[GR_PLAIN_SIZE + 2] = "usual spacing";
	size_t len;

	c->label[0] = '\0';
	if (gi->spacing_m > 0)
		snprintf(spacing, sizeof spacing, "%s m", gr_plain((double)gi->spacing_m, 3).text);
	switch (gi->method) {
	case SCENE_GI_NONE: break;
	case SCENE_GI_LPV:
		snprintf(c->label, sizeof c->label, "%s%d cells, %d steps",
			 gi->lpv_mode == SCENE_LPV_THESIS ? "thesis, " : "", gi->lattice, gi->steps);
		break;
	case SCENE_GI_SURFELS:
		snprintf(c->label, sizeof c->label, "%s, %d links", spacing, gi->links);
		break;
	case SCENE_GI_PROBES:
		snprintf(c->label, sizeof c->label, "%d probes, %s, %d links", gi->probes, spacing,
			 gi->links);
		break;
	case SCENE_GI_AUTO:
		snprintf(c->label, sizeof c->label, "%s ms", gr_plain((double)gi->budget_ms, 3).text);
		break;
	}
	if (keys_of(gi->method) != surfel_keys)
		return;
	len = strlen(c->label);
	if (gi->gathers > 1)
		len += (size_t)snprintf(c->label + len, sizeof c->label - len, ", %d gathers", gi->gathers);
	if (gi->taps != 64 && len < sizeof c->label)
		snprintf(c->label + len, sizeof c->label - len, ", %d taps", gi->taps);
}

static bool set_value(struct scene_gi *gi, const struct key *key, const char *text)
{
	char *at = (char *)gi + key->offset, *end;
	double value;

	if (key->kind == MODE) {
		bool thesis = !strcmp(text, "thesis");

		if (!thesis && strcmp(text, "repaired") != 0)
			return false;
		*(enum scene_lpv_mode *)(void *)at = thesis ? SCENE_LPV_THESIS : SCENE_LPV_REPAIRED;
		return true;
	}
	errno = 0;
	value = strtod(text, &end);
	if (end == text || *end || errno || !isfinite(value) || fabs(value) > 1e9 ||
	    (key->kind == WHOLE && value != floor(value)))
		return false;
	if (key->kind == WHOLE)
		*(int *)(void *)at = (int)value;
	else
		*(float *)(void *)at = (float)value;
	return true;
}

/* "lpv.lattice=32": the method of the first one is that of all. */
static int take_setting(struct scene_gi *gi, char *text, bool first, FILE *err)
{
	char *dot = strchr(text, '.'), *equals = strchr(text, '=');
	enum scene_gi_method method;
	const struct key *key;

	if (!dot || !equals || dot > equals) {
		fprintf(err, "'%s' is no setting: write METHOD.KEY=VALUE, as lpv.lattice=32\n", text);
		return GR_ERR_CONFIG;
	}
	if (bench_method_find(text, (size_t)(dot - text), &method, err) != GR_OK)
		return GR_ERR_CONFIG;
	if (!first && method != gi->method) {
		fprintf(err, "'%s' is for another method than what stands before it: put a blank between cases\n",
			text);
		return GR_ERR_CONFIG;
	}
	gi->method = method;
	*equals = '\0';
	key = keys_of(method);
	for (; key && key->name && strcmp(key->name, dot + 1) != 0; key++)
		;
	if (!key || !key->name) {
		fprintf(err, "'%s' is no setting of %s; there are", dot + 1, bench_method_name(method));
		for (key = keys_of(method); key && key->name; key++)
			fprintf(err, " %s", key->name);
		fprintf(err, "\n");
		return GR_ERR_CONFIG;
	}
	if (!set_value(gi, key, equals + 1)) {
		fprintf(err, "'%s' cannot be the value of %s\n", equals + 1, text);
		return GR_ERR_CONFIG;
	}
	return GR_OK;
}

/* Without "file:line: ": the lines are of the text that was written to be checked. */
static const char *bare(const char *text, const char *path)
{
	size_t len = path ? strlen(path) : 0, digits;

	if (!len || strncmp(text, path, len) != 0 || text[len] != ':')
		return text;
	digits = strspn(text + len + 1, "0123456789");
	return strncmp(text + len + 1 + digits, ": ", 2) == 0 ? text + len + digits + 3 : text;
}

int bench_case_check(const struct scene_file *file, const struct scene_gi *gi, const char *word, FILE *err)
{
	struct scene_file changed = *file, *read = NULL;
	struct gr_diag diag = { 0 };
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	int result = GR_ERR_NOMEM;

	if (!out)
		return result;
	changed.gi = *gi;
	result = scene_file_write(out, &changed);
	fclose(out);
	if (result == GR_OK)
		result = scene_file_parse(text, size, file->path, &read, &diag);
	for (size_t i = 0; i < diag.count; i++)
		if (diag.items[i].severity == GR_DIAG_ERROR)
			fprintf(err, "%s '%s': %s\n", word ? "--settings" : "with", word ? word : bench_method_name(gi->method),
				bare(diag.items[i].text, file->path));
	gr_diag_finish(&diag);
	scene_file_destroy(&read);
	free(text);
	return result == GR_OK || result == GR_ERR_NOMEM ? result : GR_ERR_CONFIG;
}

/* word: that it was given as; NULL: of the usual ones. */
static int add(struct bench_cases *cases, const struct scene_file *file, const struct scene_gi *gi,
	       const char *word, FILE *err)
{
	struct bench_case *c = &cases->items[cases->count];
	int result = bench_case_check(file, gi, word, err);

	if (result != GR_OK)
		return result;
	if (cases->count >= BENCH_CASES_MAX) {
		fprintf(err, "more than %d cases\n", BENCH_CASES_MAX);
		return GR_ERR_CONFIG;
	}
	c->gi = *gi;
	make_label(c);
	cases->count++;
	return GR_OK;
}

/* Two digits: a label should not claim more. */
static float round_off(double value)
{
	double power = pow(10, floor(log10(value)) - 1);

	return (float)(round(value / power) * power);
}

/* A small sweep over what trades time for error. */
static int add_usual(struct bench_cases *cases, const struct scene_file *file,
		     enum scene_gi_method method, double lit_area, FILE *err)
{
	static const int lattices[] = { 16, 24, 32 }, probes[] = { 8, 16 };
	static const double surfels[] = { 1000, 4000, 16000 };
	int result = GR_OK;

	for (size_t i = 0; i < 3 && result == GR_OK; i++) {
		struct scene_gi gi = file->gi;

		gi.method = method;
		switch (method) {
		case SCENE_GI_NONE:
		case SCENE_GI_AUTO:
			if (i > 0)
				return result;
			break;
		case SCENE_GI_LPV: gi.lattice = lattices[i]; break;
		case SCENE_GI_SURFELS:
			if (lit_area > 0)
				gi.spacing_m = round_off(sqrt(lit_area / surfels[i]));
			break;
		case SCENE_GI_PROBES:
			if (i > 1)
				return result;
			gi.probes = probes[i];
			break;
		}
		/* no sharing on one machine, and no lattice is shared */
		gi.share = SCENE_SHARE_LOCAL;
		result = add(cases, file, &gi, NULL, err);
	}
	return result;
}

/* The cases of that method in `settings`; counts them, and all that stand there. */
static int add_given(struct bench_cases *cases, const struct scene_file *file,
		     enum scene_gi_method method, const char *settings, size_t *out_taken,
		     size_t *out_all, FILE *err)
{
	char *text = strdup(settings ? settings : ""), *row_place, *row;
	int result = text ? GR_OK : GR_ERR_NOMEM;

	*out_taken = *out_all = 0;
	for (row = text ? strtok_r(text, " \t\n", &row_place) : NULL; row && result == GR_OK;
	     row = strtok_r(NULL, " \t\n", &row_place)) {
		struct scene_gi gi = file->gi;
		char *place, *item, *word = strdup(row);
		bool first = true;

		result = word ? GR_OK : GR_ERR_NOMEM;
		for (item = word ? strtok_r(row, ",", &place) : NULL; item && result == GR_OK;
		     item = strtok_r(NULL, ",", &place), first = false)
			result = take_setting(&gi, item, first, err);
		*out_all += !first;
		if (result == GR_OK && gi.method == method && !first) {
			gi.share = SCENE_SHARE_LOCAL;
			++*out_taken;
			result = add(cases, file, &gi, word, err);
		}
		free(word);
	}
	free(text);
	return result;
}

int bench_cases_make(struct bench_cases *out, const struct scene_file *file, const char *methods,
		     const char *settings, double lit_area, FILE *err)
{
	size_t taken, used = 0, all = 0;
	int result;

	out->count = 0;
	result = add_usual(out, file, SCENE_GI_NONE, lit_area, err);
	for (const char *name = methods; result == GR_OK && *name;) {
		size_t len = strcspn(name, ",");
		enum scene_gi_method method;

		result = bench_method_find(name, len, &method, err);
		if (result == GR_OK && method != SCENE_GI_NONE) {
			result = add_given(out, file, method, settings, &taken, &all, err);
			used += taken;
			if (result == GR_OK && !taken)
				result = add_usual(out, file, method, lit_area, err);
		}
		name += len + (name[len] == ',');
	}
	if (result == GR_OK && used < all) {
		fprintf(err, "%zu of the %zu cases are for methods that are not among '%s'\n", all - used, all,
			methods);
		result = GR_ERR_CONFIG;
	}
	return result == GR_ERR_RANGE ? GR_ERR_CONFIG : result;
}
