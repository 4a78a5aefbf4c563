/* A plan's settings in 64 bits. */
#include "renderer/gi/plan.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define POWER_BIAS 16

struct field {
	unsigned bits;
	int least, most; /* that a scene file may say */
};
enum { METHOD, MODE, LATTICE, STEPS, RSM_PIXELS, LINK_RAYS, DIGITS, POWER, LINKS, GATHERS, TAPS, PROBES };
static const struct field fields[] = {
	[METHOD] = { 3, SCENE_GI_NONE, SCENE_GI_PROBES },
	[MODE] = { 1, 0, 1 },
	[LATTICE] = { 8, 8, 128 },
	[STEPS] = { 8, 1, 128 },
	[RSM_PIXELS] = { 12, 16, 2048 },
	[LINK_RAYS] = { 13, 1, 4096 },
	[DIGITS] = { 7, 0, 99 },
	[POWER] = { 5, 0, 31 },
	[LINKS] = { 13, 16, 4096 },
	[GATHERS] = { 5, 1, 16 },
	[TAPS] = { 7, 16, 64 },
	[PROBES] = { 7, 0, 64 },
};

struct coder {
	uint64_t code;
	unsigned at;
	bool ok;
};

static void put(struct coder *c, int field, int value)
{
	c->code |= (uint64_t)(unsigned)value << c->at;
	c->at += fields[field].bits;
}

static int get(struct coder *c, int field)
{
	const struct field *f = &fields[field];
	int value = (int)(c->code >> c->at & ((1u << f->bits) - 1));

	c->at += f->bits;
	if (value < f->least || value > f->most)
		c->ok = false;
	return value;
}

static void put_spacing(struct coder *c, float spacing)
{
	char text[32];
	int first = 0, second = 0, power = -POWER_BIAS;

	if (spacing > 0) {
		snprintf(text, sizeof text, "%.1e", (double)spacing);
		first = text[0] - '0';
		second = text[2] - '0';
		power = atoi(text + 4);
	}
	put(c, DIGITS, 10 * first + second);
	put(c, POWER, power + POWER_BIAS);
}

static float get_spacing(struct coder *c)
{
	int digits = get(c, DIGITS), power = get(c, POWER) - POWER_BIAS;
	double spacing = digits * pow(10, power - 1);

	if (digits == 0 ? power != -POWER_BIAS : digits < 10 || spacing > 1000)
		c->ok = false;
	return (float)spacing;
}

uint64_t gi_plan_code(const struct scene_gi *gi)
{
	struct coder c = { 0 };

	/* one more, so that no plan is 0 */
	put(&c, METHOD, (int)gi->method + 1);
	if (gi->method == SCENE_GI_LPV) {
		put(&c, MODE, gi->lpv_mode == SCENE_LPV_THESIS);
		put(&c, LATTICE, gi->lattice);
		put(&c, STEPS, gi->steps);
		put(&c, RSM_PIXELS, gi->rsm_pixels);
		put(&c, LINK_RAYS, gi->link_rays);
	} else if (gi->method != SCENE_GI_NONE) {
		put_spacing(&c, gi->spacing_m);
		put(&c, LINKS, gi->links);
		put(&c, GATHERS, gi->gathers);
		put(&c, TAPS, gi->taps);
		put(&c, PROBES, gi->method == SCENE_GI_PROBES ? gi->probes : 0);
	}
	return c.code;
}

static void get_lattice(struct coder *c, struct scene_gi *gi)
{
	gi->lpv_mode = get(c, MODE) ? SCENE_LPV_THESIS : SCENE_LPV_REPAIRED;
	gi->lattice = get(c, LATTICE);
	gi->steps = get(c, STEPS);
	gi->rsm_pixels = get(c, RSM_PIXELS);
	gi->link_rays = get(c, LINK_RAYS);
}

static void get_surfels(struct coder *c, struct scene_gi *gi)
{
	int probes;

	gi->spacing_m = get_spacing(c);
	gi->links = get(c, LINKS);
	gi->gathers = get(c, GATHERS);
	gi->taps = get(c, TAPS);
	probes = get(c, PROBES);
	if ((gi->method == SCENE_GI_PROBES) != (probes > 0))
		c->ok = false;
	if (probes > 0)
		gi->probes = probes;
}

bool gi_plan_decode(uint64_t code, struct scene_gi *out)
{
	struct coder c = { .code = code, .ok = true };
	struct scene_gi gi = *out;

	/* the method's own number is one less */
	if (!(code & 7))
		return false;
	c.code = code - 1;
	gi.method = (enum scene_gi_method)get(&c, METHOD);
	if (gi.method == SCENE_GI_LPV)
		get_lattice(&c, &gi);
	else if (gi.method == SCENE_GI_SURFELS || gi.method == SCENE_GI_PROBES)
		get_surfels(&c, &gi);
	if (!c.ok || code >> c.at)
		return false;
	*out = gi;
	return true;
}
