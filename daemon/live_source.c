#include "daemon/live_source.h"

#include "base/result.h"
#include "protocol/glance.h"
#include "protocol/input.h"

#include <math.h>
#include <string.h>

/* The frame's time on the master's scale. */
static int64_t frame_time(const struct live_source *live, uint64_t frame, int64_t now_ns)
{
	if (!live->frame_clock)
		return live->base_ns + now_ns - live->start_ns;
	return live->base_ns + llrint((double)frame * 1e9 / (double)live->layout->rates.frame_hz);
}

static int next(struct frame_source *source, const struct frame_moment *moment,
		struct param_state *state, struct frame_next *out)
{
	struct live_source *live = (struct live_source *)source;
	const uint64_t frame = moment->last + 1;
	const int64_t time_ns = frame_time(live, frame, moment->now_ns);

	live->polled_ns = moment->now_ns;
	trackers_poll(live->trackers, time_ns, moment->now_ns);
	trackers_sample(live->trackers,
			time_ns + moment->to_swap_ns + live->layout->rates.display_latency_ns,
			&live->input);
	live->input.step_ns = moment->last == 0 ? 0 : time_ns - live->last_time_ns;
	live->input.time_ns = live->last_time_ns = time_ns;
	*out = (struct frame_next){ .frame = frame, .restarts_light = moment->restart_light };
	/* Says in `refused` what was outside its range; the frame is good. */
	(void)master_state_frame(&live->scene_state, &live->input, moment->restart_light, state, frame,
				 &out->refused);
	return GR_OK;
}

static const struct frame_source_ops live_ops = { .next = next };

void live_source_init(struct live_source *live, const struct layout *layout,
		      const struct scene_file *scene, struct trackers *trackers, bool frame_clock)
{
	*live = (struct live_source){
		.source.ops = &live_ops,
		.layout = layout,
		.trackers = trackers,
		.frame_clock = frame_clock,
	};
	master_state_init(&live->scene_state, layout, scene);
	master_state_start_input(&live->scene_state, &live->input);
}

void live_source_window_input(struct live_source *live, unsigned node, const struct fdp_input *input,
			      int64_t now_ns)
{
	struct track_window_input in = { .buttons = input->buttons, .wheel = input->wheel };

	memcpy(in.axes, input->axes, sizeof in.axes);
	memcpy(in.pointer, input->pointer, sizeof in.pointer);
	/* With the frame clock time goes by frames: what is held counts until another word comes. */
	trackers_window_input(live->trackers, node, &in,
			      live->frame_clock ? live->last_time_ns : live->base_ns + now_ns - live->start_ns);
}

void live_source_glance(struct live_source *live, unsigned node, const struct fdp_glance *glance)
{
	const struct adapt_sample sample = { (double)glance->log_sum, (double)glance->solid_angle,
					     (double)glance->max };

	/* What no wall can look like changes nothing. */
	(void)master_adapt_take(&live->scene_state.adapt, node, &sample);
}

void live_source_node_gone(struct live_source *live, unsigned node)
{
	master_adapt_forget(&live->scene_state.adapt, node);
}

void live_source_adopt(struct live_source *live, const struct param_state *params, uint64_t last,
		       int64_t frame_ns, int64_t now_ns)
{
	uint64_t time_ns;

	memcpy(&time_ns, param_get(params, PARAM_FRAME_TIME), sizeof time_ns);
	master_state_adopt(&live->scene_state, params);
	live->last_time_ns = (int64_t)time_ns;
	live->start_ns = frame_ns;
	live->base_ns = live->last_time_ns;
	/* By the frame clock scene time is a function of the number alone. */
	if (live->frame_clock)
		live->base_ns += now_ns - frame_ns -
				 llrint((double)last * 1e9 / (double)live->layout->rates.frame_hz);
}
