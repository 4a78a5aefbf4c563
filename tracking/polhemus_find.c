/* Which devices there are, and which of those that are plugged in is meant. */
#include "tracking/polhemus_private.h"

#include "base/result.h"

#include <stdio.h>

#define VENDOR 0x0f44

const struct polhemus_model polhemus_models[TRACK_POLHEMUS_MODELS] = {
	[TRACK_POLHEMUS_MODEL_VIPER] = { "viper", "Polhemus VIPER", &polhemus_viper, 240,
					 { 0xbf01 }, { 0 } },
	[TRACK_POLHEMUS_MODEL_LIBERTY] = { "liberty", "Polhemus LIBERTY", &polhemus_liberty, 240,
					   { 0xff20, 0xff12 }, { 0xff21, 0xff11 } },
	[TRACK_POLHEMUS_MODEL_PATRIOT] = { "patriot", "Polhemus PATRIOT", &polhemus_liberty, 60,
					   { 0xef20, 0xef12 }, { 0xef21, 0xef11 } },
};

static bool among(const uint16_t *products, uint16_t product)
{
	for (int i = 0; i < POLHEMUS_PRODUCTS && products[i]; i++)
		if (products[i] == product)
			return true;
	return false;
}

static bool is_the_one(const struct polhemus *p)
{
	return !p->serial[0] || !strcmp(p->serial, p->node->serial) ||
	       !strcmp(p->serial, p->said_serial);
}

/* TRACK_ABSENT: it is another one. */
static enum track_state try_node(struct polhemus *p, struct track_usb_node *node, char *why,
				 size_t size)
{
	char said[TRACK_WHY] = "";
	enum track_state state = track_usb_open(&p->usb, node, polhemus_take, p, why, size);
	const char *serial;

	if (state != TRACK_RUNNING)
		return state;
	p->node = node;
	p->said_serial[0] = '\0';
	if (p->talk->says_serial || is_the_one(p))
		state = polhemus_start(p, said, sizeof said);
	if (state == TRACK_RUNNING && !is_the_one(p)) {
		polhemus_be_silent(p);
		state = TRACK_ABSENT;
	}
	serial = p->said_serial[0] ? p->said_serial : node->serial;
	if (state == TRACK_RUNNING)
		snprintf(why, size, "%s, USB %s, serial number %s%s%.100s", node->devnode, node->path,
			 serial[0] ? serial : "not said", said[0] ? "; " : "", said);
	else
		snprintf(why, size, "%s: %.180s", node->devnode, said);
	if (state != TRACK_RUNNING)
		track_usb_close(&p->usb);
	return state;
}

/* Nothing fits: what is nearest to it. */
static enum track_state none(const struct polhemus *p, const struct polhemus_model *m, char *why, size_t size)
{
	const int count = p->usb.count;

	for (int i = 0; i < count; i++) {
		const struct track_usb_node *node = &p->usb.nodes[i];

		if (!among(m->bare, node->product) || (p->path[0] && strcmp(p->path, node->path) != 0))
			continue;
		snprintf(why, size,
			 "the %s at USB %s (0f44:%04x) has no firmware yet: load the maker's with "
			 "fxload from a udev rule, then plug it in again",
			 m->name, node->path, node->product);
		return TRACK_FAILED;
	}
	if (p->serial[0])
		snprintf(why, size, "no %s with serial number %s%s%s is plugged in", m->name,
			 p->serial, p->path[0] ? " at USB " : "", p->path);
	else if (p->path[0])
		snprintf(why, size, "no %s is plugged in at USB %s", m->name, p->path);
	else if (p->params.number)
		snprintf(why, size, "no %s number %d is plugged in", m->name, p->params.number);
	else
		snprintf(why, size, "no %s (0f44:%04x) is plugged in", m->name, m->products[0]);
	return TRACK_ABSENT;
}

enum track_state polhemus_find(struct polhemus *p, char *why, size_t size)
{
	const struct polhemus_model *m = &polhemus_models[p->params.model];
	const bool any = !p->serial[0] && !p->path[0];
	enum track_state state = TRACK_ABSENT, each;
	char each_why[TRACK_WHY];
	int found = 0;

	if (track_usb_begin(&p->usb, VENDOR) < 0) {
		snprintf(why, size, "libusb cannot look at USB on this machine");
		track_usb_end(&p->usb);
		return TRACK_FAILED;
	}
	for (int i = 0; i < p->usb.count && state != TRACK_RUNNING; i++) {
		struct track_usb_node *node = &p->usb.nodes[i];

		if (!among(m->products, node->product) ||
		    (p->path[0] && strcmp(p->path, node->path) != 0) ||
		    (any && found++ != p->params.number))
			continue;
		each = try_node(p, node, each_why, sizeof each_why);
		/* One that cannot be asked may be the one. */
		if (each == TRACK_ABSENT)
			continue;
		state = each;
		snprintf(why, size, "%s", each_why);
	}
	if (state == TRACK_ABSENT)
		state = none(p, m, why, size);
	if (state != TRACK_RUNNING)
		track_usb_end(&p->usb);
	return state;
}
