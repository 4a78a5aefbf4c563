#include "tracking/window.h"

#include "base/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct window {
	struct track_window_input input;
	int64_t heard_ns;
	bool heard;
};

struct window_source {
	struct track_source source;
	struct gr_pose start_head, start_wand;
	struct window windows[TRACK_WINDOWS];
	float pointer[2], wheel; /* of the window in which they changed last */
	bool touched;
	int64_t last_ns; /* of the last sample */
};

/* Head and wand keep their heights: speed goes by the distance on the floor plan. */
static void place(const struct window_source *s, struct gr_pose *out)
{
	const float reach = fminf(fmaxf(exp2f(s->wheel / TRACK_WINDOW_NOTCHES), TRACK_WINDOW_REACH_LEAST),
				  TRACK_WINDOW_REACH_MOST);
	struct gr_pose heading = GR_POSE_IDENTITY, pitch = GR_POSE_IDENTITY;
	vec3 at;

	for (int i = 0; i < 3; i++)
		at[i] = i == 1 ? s->start_wand.p[i] :
				 s->start_head.p[i] + reach * (s->start_wand.p[i] - s->start_head.p[i]);
	/* About the vertical of the room, then about the wand's own right hand. */
	gr_pose_heading(GR_POSE_IDENTITY.p, -TRACK_WINDOW_HEADING * s->pointer[0], &heading);
	pitch.q[0] = sinf(0.5f * TRACK_WINDOW_PITCH * s->pointer[1]);
	pitch.q[3] = cosf(0.5f * TRACK_WINDOW_PITCH * s->pointer[1]);
	*out = s->start_wand;
	gr_pose_mul(&heading, out, out);
	gr_pose_mul(out, &pitch, out);
	glm_quat_normalize(out->q);
	memcpy(out->p, at, sizeof at);
}

/* Of all windows: whoever holds a button holds it. */
static void hold(const struct window_source *s, int64_t now_ns, struct track_sample *out)
{
	for (int i = 0; i < TRACK_WINDOWS; i++) {
		const struct window *w = &s->windows[i];

		if (!w->heard || now_ns - w->heard_ns > TRACK_WINDOW_SILENT_NS)
			continue;
		out->buttons |= w->input.buttons;
		for (int k = 0; k < 2; k++)
			out->axes[k] = fminf(fmaxf(out->axes[k] + w->input.axes[k], -1), 1);
	}
}

static int window_poll(struct track_source *source, int64_t now_ns, struct track_sample *out, int room)
{
	struct window_source *s = (struct window_source *)source;

	if (room < 1 || !s->touched || now_ns <= s->last_ns)
		return 0;
	s->last_ns = now_ns;
	*out = (struct track_sample){
		.time_ns = now_ns, .body = TRACK_WAND, .valid = true, .axis_count = 2,
	};
	place(s, &out->T_room_body);
	hold(s, now_ns, out);
	return 1;
}

static int window_fd(const struct track_source *source)
{
	(void)source;
	return -1;
}

static int64_t window_next(const struct track_source *source, int64_t now_ns)
{
	(void)now_ns;
	return ((const struct window_source *)source)->touched ? now_ns : INT64_MAX;
}

static void window_destroy(struct track_source *source)
{
	free(source);
}

static const struct track_source_ops window_ops = {
	.kind = "window",
	.poll = window_poll,
	.fd = window_fd,
	.next = window_next,
	.destroy = window_destroy,
};

int track_window_create(struct track_source **out, const struct gr_pose *start_head,
			const struct gr_pose *start_wand)
{
	struct window_source *s = calloc(1, sizeof *s);

	*out = NULL;
	if (!s)
		return GR_ERR_NOMEM;
	s->source.ops = &window_ops;
	s->start_head = *start_head;
	s->start_wand = *start_wand;
	s->last_ns = INT64_MIN;
	*out = &s->source;
	return GR_OK;
}

void track_window_feed(struct track_source *source, unsigned window,
		       const struct track_window_input *input, int64_t now_ns)
{
	struct window_source *s = (struct window_source *)source;
	struct window *w;

	if (window >= TRACK_WINDOWS)
		return;
	w = &s->windows[window];
	if (!w->heard || memcmp(input->pointer, w->input.pointer, sizeof input->pointer) != 0 ||
	    input->wheel != w->input.wheel) {
		memcpy(s->pointer, input->pointer, sizeof s->pointer);
		s->wheel = input->wheel;
	}
	*w = (struct window){ *input, now_ns, true };
	s->touched = true;
}
