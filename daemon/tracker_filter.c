#include "daemon/tracker_filter.h"

static enum track_filter_kind kind_of(const struct layout_tracker *tracker)
{
	switch (tracker->filter.kind) {
	case LAYOUT_FILTER_AUTO:
		return layout_tracker_is_device(tracker) ? TRACK_FILTER_KALMAN : TRACK_FILTER_NONE;
	case LAYOUT_FILTER_NONE: return TRACK_FILTER_NONE;
	case LAYOUT_FILTER_ONE_EURO: return TRACK_FILTER_ONE_EURO;
	case LAYOUT_FILTER_EXPONENTIAL: return TRACK_FILTER_EXPONENTIAL;
	case LAYOUT_FILTER_KALMAN: return TRACK_FILTER_KALMAN;
	}
	return TRACK_FILTER_NONE;
}

static struct track_filter_params params_of(const struct layout_tracker *tracker)
{
	const struct layout_filter *f = &tracker->filter;
	const bool gate = f->gate && (f->kind != LAYOUT_FILTER_AUTO || layout_tracker_is_device(tracker));
	struct track_filter_params p = track_filter_defaults(kind_of(tracker));
	struct track_filter_tune *position = &p.position, *orientation = &p.orientation;

	position->noise = (double)f->noise_position_m;
	orientation->noise = (double)f->noise_angle_rad;
	position->move = (double)f->move_position;
	orientation->move = (double)f->move_angle;
	position->cutoff_hz = orientation->cutoff_hz = (double)f->cutoff_hz;
	position->slope_hz = orientation->slope_hz = (double)f->slope_hz;
	position->beta = (double)f->beta_position;
	orientation->beta = (double)f->beta_angle;
	position->tau_s = orientation->tau_s = (double)f->tau_s;
	position->gate = gate ? (double)f->gate_m : 0;
	position->gate_speed = (double)f->gate_m_s;
	orientation->gate = gate ? (double)f->gate_rad : 0;
	orientation->gate_speed = (double)f->gate_rad_s;
	p.gate_hold_s = (double)f->gate_hold_s;
	p.ahead_s = (double)f->ahead_s;
	p.decay_s = (double)f->decay_s;
	p.gap_s = (double)f->gap_s;
	p.blend_s = (double)f->blend_s;
	return p;
}

/* Whether its samples place the body, or (a gamepad's) only turn it. */
static bool gives(const struct layout_tracker *tracker, enum track_body body, bool only_turns)
{
	const enum layout_body wanted = body == TRACK_HEAD ? LAYOUT_HEAD : LAYOUT_WAND;

	if (!layout_tracker_is_device(tracker))
		return body == TRACK_HEAD ? tracker->head : tracker->wand;
	for (size_t i = 0; i < tracker->binding_count; i++) {
		const struct layout_binding *binding = &tracker->bindings[i];

		if (binding->body == wanted && (only_turns ? binding->orientation : binding->position))
			return true;
	}
	return false;
}

struct track_filter_params tracker_filter_of(const struct layout *layout, enum track_body body)
{
	struct track_filter_params none = track_filter_defaults(TRACK_FILTER_NONE);

	for (int only_turns = 0; only_turns < 2; only_turns++)
		for (size_t i = 0; i < layout->tracker_count; i++)
			if (gives(&layout->trackers[i], body, only_turns))
				return params_of(&layout->trackers[i]);
	none.position.gate = none.orientation.gate = 0;
	return none;
}
