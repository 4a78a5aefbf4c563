/*
 * The renderer that a node draws with, and the plan of the light that it was
 * made for: this node's own, or the one that the room has. Thread: GL's.
 */
#ifndef GROTTO_DAEMON_NODE_LIGHT_H
#define GROTTO_DAEMON_NODE_LIGHT_H

#include "config/layout.h"
#include "daemon/notify.h"
#include "renderer/plan_light.h"
#include "renderer/renderer.h"

struct node_light {
	/* Borrowed, set by the caller. */
	struct target *target;
	const struct layout *layout;
	const struct scene_file *file;
	const struct scene *scene;
	struct renderer_params params; /* light and alive are set here */
	bool window;                   /* the target is one, which is answered while surfels are baked */

	struct renderer *renderer; /* owned; NULL: none */
	struct light_plan own;     /* what this node's GPU would have led to, with gi.method = "auto" */
	bool planned;              /* it is "auto" */
	struct notify notify;
};

/*
 * The renderer with this node's own plan, and its first frame drawn, so that
 * the driver has compiled all. GR_OK; GR_NOTHING: a signal asks for the end, or
 * the window was closed; else as renderer_create.
 */
int node_light_open(struct node_light *light);
/*
 * The renderer anew, for the room's plan. It bakes, where no file has its
 * surfels: the watchdog is fed. GR_OK; GR_NOTHING as above, no renderer then.
 * GR_ERR_MISMATCH: the plan is refused, all is as it was; GR_ERR_UNSUPPORTED: it
 * cannot be had on this machine, the renderer is of the own plan, anew. Both are
 * in the log. Other errors: no renderer.
 */
int node_light_adopt(struct node_light *light, uint64_t code);
void node_light_close(struct node_light *light);

#endif
