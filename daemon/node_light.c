#include "daemon/node_light.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "daemon/loop.h"

#include <inttypes.h>

#define WARM_UP_NS (60 * GR_NS_PER_S)

/* Progress is proof of work, as the watchdog wants it. */
static bool go_on(void *ctx)
{
	struct node_light *light = ctx;

	notify_feed(&light->notify, gr_clock_now(&gr_clock_monotonic));
	if (light->window && !target_poll(light->target))
		return false;
	return !loop_signal_waits();
}

/*
 * Drivers finish compiling at the first draw, which can take longer than a
 * barrier waits: so the first draw happens before the node joins. The light
 * is left out: the master has all nodes compute it anew when one joins.
 */
static int warm_up(struct node_light *light)
{
	struct render_frame frame;
	int r;

	render_frame_init(&frame, light->file);
	frame.T_room_head = light->layout->start_head;
	frame.gi_on = false;
	frame.eye_separation_m = light->layout->eye_separation_m;
	r = renderer_draw(light->renderer, &frame);
	if (r < 0)
		return r;
	r = renderer_finished(light->renderer, WARM_UP_NS);
	return r < 0 ? r : GR_OK;
}

static int create(struct node_light *light, const struct light_plan *plan)
{
	int r;

	light->params.light = plan;
	light->params.alive = (struct alive){ go_on, light };
	r = renderer_create(&light->renderer, light->target, &light->params, light->file, light->scene);
	if (r == GR_OK)
		r = warm_up(light);
	if (r != GR_OK)
		renderer_destroy(&light->renderer);
	return r;
}

int node_light_open(struct node_light *light)
{
	int r;

	notify_init(&light->notify);
	r = create(light, NULL);
	if (r == GR_OK && renderer_light_plan(light->renderer)) {
		light->own = *renderer_light_plan(light->renderer);
		light->planned = true;
	}
	return r;
}

int node_light_adopt(struct node_light *light, uint64_t code)
{
	const char *why = "the scene file names the method";
	char room[GI_PLAN_TEXT], own[GI_PLAN_TEXT];
	struct light_plan plan;
	int r;

	plan = light->own;
	if (!light->planned ||
	    (code != plan.plan.code && !light_plan_adopt(&plan, &light->own, light->file, code, &why))) {
		gr_error("the room's plan of the light, %016" PRIx64 ", is not taken: %s", code, why);
		return GR_ERR_MISMATCH;
	}
	gi_plan_settings(room, sizeof room, &plan.plan.gi);
	gi_plan_settings(own, sizeof own, &light->own.plan.gi);
	gr_notice("the room's plan of the light is %s, and is taken; this node's own would have been %s", room,
		  own);
	notify_status("takes the room's plan of the light");
	/* first, for two may not fit into the GPU's memory */
	renderer_destroy(&light->renderer);
	r = create(light, &plan);
	if (r == GR_OK || r == GR_NOTHING)
		return r;
	gr_error("the room's plan of the light, %s, cannot be had on this machine: %s; name gi.method and settings "
		 "that suit all nodes in the scene file", room, gr_result_name(r));
	r = create(light, &light->own);
	return r == GR_OK ? GR_ERR_UNSUPPORTED : r;
}

void node_light_close(struct node_light *light)
{
	renderer_destroy(&light->renderer);
}
