/* What this master leaves to its successor, and what it has from the one before. */
#include "daemon/master_private.h"

#include "base/clock.h"
#include "base/result.h"
#include "daemon/saved_state.h"
#include "daemon/state_keeper.h"

#include <inttypes.h>
#include <string.h>
#include <time.h>

static int64_t real_time(void)
{
	struct timespec ts;

	if (clock_gettime(CLOCK_REALTIME, &ts) < 0)
		return 0;
	return (int64_t)ts.tv_sec * GR_NS_PER_S + ts.tv_nsec;
}

void master_resume(struct master *m, const char *path)
{
	const struct fdp_contents *contents = &m->params.contents;
	struct saved_state saved;
	char why[SAVED_STATE_REASON] = "";
	const int64_t real_ns = real_time();
	int r = saved_state_load(path, &saved, why);

	if (r == GR_NOTHING) /* the first start */
		return;
	if (r == GR_OK)
		r = saved_state_fits(&saved, contents->layout_hash, contents->scene_hash, real_ns, why);
	if (r != GR_OK) {
		gr_log(r < 0 ? GR_LOG_WARNING : GR_LOG_NOTICE, "%s is not used: %s; the room begins afresh",
		       path, why);
		return;
	}
	saved_state_give(&saved, &m->params.live->scene_state);
	m->params.live->base_ns = saved.time_ns;
	gr_notice("goes on from frame %" PRIu64 " of the master before, saved %.1f s ago", saved.frame,
		  (double)(real_ns - saved.saved_ns) * 1e-9);
}

/* Who follows leaves what it follows: it may be the first to start again when all have stopped. */
static uint64_t take_followed(struct master *m)
{
	uint64_t frame, time_ns;
	const struct param_state *followed = fdp_standby_state(m->standby, &frame, NULL);

	if (frame == 0 || frame == m->saved_frame)
		return 0;
	memcpy(&time_ns, param_get(followed, PARAM_FRAME_TIME), sizeof time_ns);
	master_state_adopt(&m->params.live->scene_state, followed);
	m->params.live->last_time_ns = (int64_t)time_ns;
	return frame;
}

void master_save(struct master *m)
{
	struct saved_state saved = { .saved_ns = real_time() };
	uint8_t bytes[SAVED_STATE_BYTES];

	if (!m->keeper)
		return;
	saved.frame = master_rules(m) ? m->frame : take_followed(m);
	if (saved.frame == 0 || saved.frame == m->saved_frame)
		return;
	m->saved_frame = saved.frame;
	saved.time_ns = m->params.live->last_time_ns;
	memcpy(saved.layout_hash, m->params.contents.layout_hash, sizeof saved.layout_hash);
	memcpy(saved.scene_hash, m->params.contents.scene_hash, sizeof saved.scene_hash);
	saved_state_take(&saved, &m->params.live->scene_state);
	saved_state_encode(&saved, bytes);
	state_keeper_put(m->keeper, bytes, sizeof bytes);
}

void master_use_keeper(struct master *m, struct state_keeper *keeper)
{
	m->keeper = keeper;
}
