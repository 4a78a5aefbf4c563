#include "daemon/tracker_stats.h"

#include "base/clock.h"

#include <math.h>

void tracker_stats_init(struct tracker_stats *stats)
{
	*stats = (struct tracker_stats){ .battery = -1, .window_ns = INT64_MIN };
}

static void end_window(struct tracker_stats *s, int64_t now_ns)
{
	const double seconds = (double)(now_ns - s->window_ns) * 1e-9;

	/* Of a window that nobody looked at for long, the rate is not that of a second. */
	s->rate_hz = (double)s->window_heard / seconds;
	s->jitter_ms =
		s->window_heard > 1 ? sqrt(s->squares_ms2 / (double)(s->window_heard - 1)) : 0;
	s->window_ns = now_ns;
	s->window_heard = 0;
	s->mean_ms = s->squares_ms2 = 0;
}

void tracker_stats_tick(struct tracker_stats *s, int64_t now_ns)
{
	if (s->window_ns == INT64_MIN)
		s->window_ns = now_ns;
	else if (now_ns - s->window_ns >= GR_NS_PER_S)
		end_window(s, now_ns);
	if (now_ns - s->heard_ns < TRACKER_SILENT_NS)
		return;
	for (int body = 0; body < TRACK_BODIES; body++) {
		s->dropouts += s->tracked[body];
		s->tracked[body] = false;
	}
}

void tracker_stats_heard(struct tracker_stats *s, unsigned sensor, int64_t arrived_ns)
{
	const double gap_ms = (double)(arrived_ns - s->round_ns) * 1e-6;
	const uint32_t bit = UINT32_C(1) << sensor;
	const bool first = !s->round;

	s->heard++;
	s->heard_ns = arrived_ns;
	if (!first && !(s->round & bit)) {
		s->round |= bit;
		return;
	}
	s->round = bit;
	s->round_ns = arrived_ns;
	/* Welford (1962); the first arrival ever has none before it. */
	if (!first) {
		const double before = gap_ms - s->mean_ms;

		s->mean_ms += before / (double)++s->window_heard;
		s->squares_ms2 += before * (gap_ms - s->mean_ms);
	}
}

void tracker_stats_sample(struct tracker_stats *s, enum track_body body, bool valid)
{
	if ((unsigned)body >= TRACK_BODIES)
		return;
	s->dropouts += s->tracked[body] && !valid;
	s->tracked[body] = valid;
}
