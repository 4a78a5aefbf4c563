/*
 * A layout for a loopback cave: the same walls and nodes, all on this
 * machine. What it changes: addresses and ports (free ones of 127.0.0.1,
 * unicast, no key), the control socket, where the pictures go, and what the
 * person asked for (fewer pixels, stereo, another rate).
 */
#ifndef GROTTO_TOOLS_DEMO_PLAN_H
#define GROTTO_TOOLS_DEMO_PLAN_H

#include "base/diag.h"
#include "config/layout.h"

#include <stdbool.h>

struct demo_plan {
	const char *control_socket;
	float pixels_scale; /* 1: as the layout says */
	bool window;        /* GLFW windows instead of headless targets */
	bool stereo;        /* side by side where the layout has one eye */
	float rate_hz;      /* 0: the layout's */
};

/*
 * Changes the layout in memory (its strings stay malloc'd and its own).
 * GR_OK; GR_ERR_CONFIG, GR_ERR_IO or GR_ERR_NOMEM with a line in diag.
 */
int demo_plan_apply(const struct demo_plan *plan, struct layout *layout, struct gr_diag *diag);

#endif
