/* What a recording is of, and the requests about it. */
#include "daemon/master.h"

#include "base/clock.h"
#include "base/result.h"
#include "config.h"
#include "protocol/wire.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

_Static_assert(RECORD_NODES >= FDP_MAX_NODES && RECORD_TRACKERS >= TRACKERS_MAX,
	       "a record must have room for every node and tracker");

static void set_text(char *to, size_t size, const char *from)
{
	/* What does not fit is better left out than cut: it is a path, or no name of ours. */
	if (from && strlen(from) < size)
		strcpy(to, from);
}

static void fill_names(struct record_session *s, const struct layout *layout)
{
	s->node_count = (uint16_t)layout->node_count;
	for (size_t i = 0; i < layout->node_count; i++)
		set_text(s->nodes[i], sizeof s->nodes[i], layout->nodes[i].name);
	s->tracker_count = (uint16_t)layout->tracker_count;
	for (size_t i = 0; i < layout->tracker_count; i++)
		set_text(s->trackers[i], sizeof s->trackers[i], layout->trackers[i].name);
}

static void fill_session(const struct master *m, struct record_session *s)
{
	const struct layout *layout = m->params.layout;
	struct timespec wall;

	clock_gettime(CLOCK_REALTIME, &wall);
	*s = (struct record_session){
		.protocol = FDP_VERSION,
		.flags = (uint16_t)((m->params.frame_clock ? RECORD_FRAME_CLOCK : 0) |
				    (m->params.replay ? RECORD_OF_REPLAY : 0)),
		.session = m->session,
		.table_hash = param_table_hash(),
		.wall_ns = (int64_t)wall.tv_sec * GR_NS_PER_S + wall.tv_nsec,
		.start_ns = gr_clock_now(&gr_clock_monotonic),
		.zero_ns = m->params.live ? m->params.live->start_ns - m->params.live->base_ns : m->start_ns,
		.frame_hz = layout->rates.frame_hz,
	};
	memcpy(s->layout_hash, m->params.contents.layout_hash, sizeof s->layout_hash);
	memcpy(s->scene_hash, m->params.contents.scene_hash, sizeof s->scene_hash);
	set_text(s->grotto, sizeof s->grotto, PACKAGE_VERSION);
	set_text(s->layout, sizeof s->layout, layout->name);
	set_text(s->scene, sizeof s->scene, m->params.scene->name);
	set_text(s->layout_path, sizeof s->layout_path, m->params.layout_path);
	set_text(s->scene_path, sizeof s->scene_path, m->params.scene_path);
	fill_names(s, layout);
}

int master_record(struct master *m, const char *path, char *why, size_t size)
{
	struct record_session session;

	if (!m->recorder) {
		snprintf(why, size, "this master cannot record");
		return GR_ERR_STATE;
	}
	fill_session(m, &session);
	return recorder_start(m->recorder, path, &session, why, size);
}
