/*
 * grotto-node: reads and checks everything, opens its port and the GPU, gives
 * up privileges, says READY, and draws its wall until it is told to end.
 */
#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "daemon/control.h"
#include "daemon/json.h"
#include "daemon/node.h"
#include "daemon/node_control.h"
#include "daemon/node_input.h"
#include "daemon/node_light.h"
#include "daemon/options.h"
#include "daemon/priority.h"
#include "daemon/privileges.h"
#include "daemon/room_files.h"
#include "renderer/tone/projector.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define REPORT_MAX 65536

struct opened {
	struct room_files files;
	size_t index;
	struct loop *loop;
	struct net *net;
	struct target *target;
	struct projector *projector; /* NULL: what the scene takes for one */
	struct node_light light;
	struct pictures *pictures;
	struct node *node;
	struct faults *faults;
	struct control *control;
	int swap_log; /* -1: none */
};

static int find_node(struct opened *o, const char *name)
{
	const struct layout *layout = o->files.layout;
	char names[1024] = "";
	size_t len = 0;
	int i = layout_find_node(layout, name);

	if (i >= 0) {
		o->index = (size_t)i;
		return GR_OK;
	}
	for (size_t k = 0; k < layout->node_count && len < sizeof names; k++)
		len += (size_t)snprintf(names + len, sizeof names - len, "%s%s", k ? ", " : "",
					layout->nodes[k].name);
	gr_error("--node %s: %s has no such node; it has %s", name, layout->path, names);
	return GR_ERR_CONFIG;
}

static enum renderer_eyes eyes_of(enum layout_eyes eyes)
{
	switch (eyes) {
	case LAYOUT_EYES_MONO: return RENDERER_MONO;
	case LAYOUT_EYES_QUAD_BUFFER: return RENDERER_QUAD_BUFFER;
	case LAYOUT_EYES_SIDE_BY_SIDE: return RENDERER_SIDE_BY_SIDE;
	case LAYOUT_EYES_TOP_BOTTOM: return RENDERER_TOP_BOTTOM;
	case LAYOUT_EYES_LEFT: return RENDERER_LEFT;
	case LAYOUT_EYES_RIGHT: return RENDERER_RIGHT;
	}
	return RENDERER_MONO;
}

static void fill_renderer(struct renderer_params *params, const struct opened *o,
			  const struct node_options *options)
{
	const struct layout *layout = o->files.layout;
	int pixels[2];

	layout_node_pixels(layout, o->index, pixels);
	*params = (struct renderer_params){
		.width = pixels[0],
		.height = pixels[1],
		.eyes = eyes_of(layout->nodes[o->index].eyes),
		.wall_given = true,
		.keep_radiance = options->pictures && options->exr,
		.projector = o->projector,
		.dither = layout->nodes[o->index].projector.dither,
	};
	layout_node_corners(layout, o->index, params->wall.lower_left, params->wall.lower_right,
			    params->wall.upper_left);
}

/* What the layout says of this node's projector. */
static int open_projector(struct opened *o)
{
	const struct layout *layout = o->files.layout;
	struct gr_diag diag = { 0 };
	int r;

	o->projector = calloc(1, sizeof *o->projector);
	if (!o->projector)
		return GR_ERR_NOMEM;
	r = projector_load(layout, &layout->nodes[o->index].projector, &o->files.scene_file->tone,
			   o->projector, &diag);
	gr_diag_log(&diag);
	gr_diag_finish(&diag);
	if (r == GR_NOTHING) {
		free(o->projector);
		o->projector = NULL;
		return GR_OK;
	}
	if (r == GR_OK)
		gr_notice("pictures are encoded for a projector that was measured");
	return r;
}

/* --target may ask for a window where the layout has none. */
static enum target_depth depth_of(const struct layout_node *node, enum target_kind kind)
{
	if (node->projector.depth == LAYOUT_DEPTH_FLOAT)
		return kind == TARGET_HEADLESS ? TARGET_DEPTH_FLOAT : TARGET_DEPTH_10;
	return node->projector.depth == LAYOUT_DEPTH_10 ? TARGET_DEPTH_10 : TARGET_DEPTH_8;
}

static enum target_kind kind_of(const struct layout_node *node, int choice)
{
	switch ((enum node_target_choice)choice) {
	case NODE_TARGET_HEADLESS: return TARGET_HEADLESS;
	case NODE_TARGET_WINDOW: return TARGET_WINDOW;
	case NODE_TARGET_FULLSCREEN: return TARGET_FULLSCREEN;
	case NODE_TARGET_LAYOUT: break;
	}
	switch (node->target) {
	case LAYOUT_TARGET_HEADLESS: return TARGET_HEADLESS;
	case LAYOUT_TARGET_WINDOW: return TARGET_WINDOW;
	case LAYOUT_TARGET_FULLSCREEN: return TARGET_FULLSCREEN;
	}
	return TARGET_HEADLESS;
}

static int open_target(struct opened *o, const struct node_options *options,
		       const struct renderer_params *renderer)
{
	const struct layout_node *node = &o->files.layout->nodes[o->index];
	struct target_params params = {
		.kind = kind_of(node, options->target),
		.title = node->name,
		.display = options->display ? options->display : node->display,
		.gpu = options->gpu >= -1 ? options->gpu : node->gpu,
		.monitor = node->monitor,
		.quad_buffer = renderer->eyes == RENDERER_QUAD_BUFFER,
		.debug = gr_log_enabled(GR_LOG_DEBUG),
	};
	int r;

	params.depth = depth_of(node, params.kind);
	renderer_target_size(renderer, &params.width, &params.height);
	r = target_create(&o->target, &params);
	if (r >= 0)
		gr_notice("draws with %s (%s), %d x %d pixels of %d bits", target_renderer_name(o->target),
			  target_platform_name(o->target), params.width, params.height,
			  target_bits(o->target));
	return r;
}

static int open_pictures(struct opened *o, const struct node_options *options,
			 const struct renderer_params *renderer)
{
	struct pictures_params params = { .dir = options->pictures, .name = options->node };

	if (!options->pictures)
		return GR_OK;
	target_size(o->target, &params.width, &params.height);
	if (options->exr)
		params.radiance_eyes = renderer->eyes == RENDERER_QUAD_BUFFER ||
				       renderer->eyes == RENDERER_SIDE_BY_SIDE ||
				       renderer->eyes == RENDERER_TOP_BOTTOM ? 2 : 1;
	return pictures_create(&o->pictures, &params);
}

static int open_swap_log(struct opened *o, const char *path)
{
	if (!path)
		return GR_OK;
	o->swap_log = open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0640);
	if (o->swap_log >= 0)
		return GR_OK;
	gr_error("--swap-log %s: %s", path, strerror(errno));
	return GR_ERR_CONFIG;
}

/*
 * A software OpenGL computes in the thread that calls it: with a real-time
 * priority it would leave nothing of a processor to anybody else.
 */
static void take_priority(const struct opened *o, int priority)
{
	static const char *const software[] = { "llvmpipe", "softpipe", "swrast" };
	const char *name = target_renderer_name(o->target);

	for (size_t i = 0; i < sizeof software / sizeof *software; i++)
		if (priority > 0 && strstr(name, software[i])) {
			gr_info("ordinary priority, not %d: %s computes in the thread that answers",
				priority, software[i]);
			return;
		}
	priority_take(priority);
}

/* A room that is being tested: who may be disturbed must be heard. */
static int open_faults(struct opened *o)
{
	const struct layout *layout = o->files.layout;
	char path[NODE_CONTROL_PATH];
	int r;

	if (!layout->test.faults)
		return GR_OK;
	r = faults_create(&o->faults, o->loop, net_datagram_max(&layout->network), o->index + 1);
	if (r < 0)
		return r;
	node_use_faults(o->node, o->faults);
	if (!node_control_path(layout, layout->nodes[o->index].name, path))
		return GR_OK;
	return control_create(&o->control, o->loop, path, node_answer, o->node);
}

static int open_light(struct opened *o, const struct renderer_params *params, bool window)
{
	o->light = (struct node_light){
		.target = o->target,
		.layout = o->files.layout,
		.file = o->files.scene_file,
		.scene = o->files.scene,
		.params = *params,
		.window = window,
	};
	return node_light_open(&o->light);
}

static int open_all(struct opened *o, const struct node_options *options)
{
	struct renderer_params renderer;
	struct node_params params = {
		.layout = o->files.layout,
		.index = o->index,
		.scene_file = o->files.scene_file,
		.window = kind_of(&o->files.layout->nodes[o->index], options->target) !=
			  TARGET_HEADLESS,
		.input = node_input_wanted(o->files.layout),
		.once = options->once,
		.every = (uint64_t)options->every,
	};
	int r = net_open_node(&o->net, o->files.layout, o->index);

	if (r < 0)
		return r;
	r = open_projector(o);
	if (r < 0)
		return r;
	fill_renderer(&renderer, o, options);
	r = open_target(o, options, &renderer);
	if (r >= 0)
		r = open_light(o, &renderer, params.window);
	if (r == GR_NOTHING)
		return r;
	if (r >= 0)
		r = open_pictures(o, options, &renderer);
	if (r >= 0)
		r = open_swap_log(o, options->swap_log);
	if (r >= 0)
		take_priority(o, options->common.priority);
	if (r >= 0)
		r = privileges_drop(options->common.user, options->pictures);
	/* Root could write it; can who is left? */
	if (r >= 0 && options->common.report && json_try(options->common.report) < 0)
		r = GR_ERR_CONFIG;
	if (r < 0)
		return r;
	params.contents = room_files_contents(&o->files);
	params.swap_log = o->swap_log;
	memcpy(params.key, o->files.key, sizeof params.key);
	r = node_create(&o->node, o->loop, o->net, o->target, o->light.renderer, o->pictures, &params);
	return r < 0 ? r : open_faults(o);
}

/* The room has another plan of the light: ours, then, too. GR_OK: go on. */
static int adopt(struct opened *o)
{
	int r = node_light_adopt(&o->light, o->node->plan.wanted), taken = GR_OK;

	if (r == GR_ERR_MISMATCH)
		node_plan_tried(&o->node->plan, o->node->plan.present);
	else
		taken = node_take_renderer(o->node, o->light.renderer);
	if (r == GR_NOTHING || taken < 0)
		return r == GR_NOTHING ? r : taken;
	/* who came for one show has nothing to wait for */
	if (r < 0 && o->node->params.once)
		return GR_ERR_CONFIG;
	return r == GR_ERR_MISMATCH || r == GR_ERR_UNSUPPORTED ? GR_OK : r;
}

static int serve(struct opened *o)
{
	int status = node_run(o->node);

	while (o->node->plan.wanted != 0) {
		int r = adopt(o);

		if (r == GR_NOTHING)
			return GR_EXIT_OK;
		if (r < 0)
			return r == GR_ERR_CONFIG ? GR_EXIT_CONFIG : GR_EXIT_RUNTIME;
		notify_status("waiting for the master");
		status = node_run(o->node);
	}
	return status;
}

static int finish(struct opened *o, const char *report, int status)
{
	char *text;
	uint64_t saved = 0;
	size_t len;

	notify_stopping();
	node_leave(o->node);
	if (o->pictures && pictures_finish(o->pictures, &saved) < 0)
		status = GR_EXIT_RUNTIME;
	if (!report)
		return status;
	text = malloc(REPORT_MAX);
	if (!text || node_write_json(o->node, saved, text, REPORT_MAX, &len) < 0 ||
	    json_save(report, text, len) < 0)
		status = GR_EXIT_RUNTIME;
	free(text);
	return status;
}

static void close_all(struct opened *o)
{
	control_destroy(&o->control);
	node_destroy(&o->node);
	faults_destroy(&o->faults);
	pictures_destroy(&o->pictures);
	if (o->swap_log >= 0)
		close(o->swap_log);
	node_light_close(&o->light);
	target_destroy(&o->target);
	free(o->projector);
	net_close(&o->net);
	room_files_finish(&o->files);
	loop_destroy(&o->loop);
}

int main(int argc, char **argv)
{
	struct node_options options;
	struct opened o = { .swap_log = -1 };
	int r, status = GR_EXIT_CONFIG;

	gr_log_init("grotto-node", GR_LOG_INFO);
	switch (node_options_parse(&options, argc, argv)) {
	case OPTIONS_RUN: break;
	case OPTIONS_DONE: return GR_EXIT_OK;
	case OPTIONS_WRONG: return GR_EXIT_CONFIG;
	}
	gr_log_init(options.node, (enum gr_log_level)options.common.log_level);
	/* Now, and not at the end of a long run. */
	r = options.common.report ? json_try(options.common.report) : GR_OK;
	if (r >= 0)
		r = room_files_load(&o.files, &options.common);
	if (r >= 0)
		r = find_node(&o, options.node);
	if (r < 0) {
		status = room_files_exit(r);
		goto out;
	}
	status = GR_EXIT_RUNTIME;
	/* Before the GL driver starts threads of its own, which must not take the signals. */
	if (loop_create(&o.loop) < 0 || loop_catch_signals(o.loop) < 0) {
		gr_error("no event loop");
		goto out;
	}
	r = open_all(&o, &options);
	if (r != GR_OK) {
		status = r == GR_NOTHING ? GR_EXIT_OK : r == GR_ERR_CONFIG ? GR_EXIT_CONFIG : GR_EXIT_RUNTIME;
		goto out;
	}
	notify_ready("waiting for the master");
	status = finish(&o, options.common.report, serve(&o));
out:
	close_all(&o);
	return status;
}
