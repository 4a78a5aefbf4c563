#include "daemon/replay_source.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"
#include "daemon/loop.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct replay_source {
	struct frame_source source;
	struct replay_params params;
	struct record_player *player;
	/* Read ahead between frames, so that no frame waits for the disk. */
	struct param_state *ahead;
	struct record_play play, shown; /* of `ahead`; of the frame under way */
	int result;                     /* of reading ahead */
	int64_t cut_ns;                 /* pauses left out of the record so far */
	int64_t base_ns, base_record_ns; /* the first frame here, and there */
	uint64_t begun, steps;          /* steps: frames that may still begin */
	struct replay_check check;
};

static void read_ahead(struct replay_source *s)
{
	const int64_t last_ns = s->play.time_ns;

	if (s->result != GR_OK)
		return;
	s->result = record_player_next(s->player, s->ahead, &s->play);
	if (s->result == GR_OK && s->begun > 0 && s->play.time_ns - last_ns > REPLAY_PAUSE_NS)
		s->cut_ns += s->play.time_ns - last_ns - REPLAY_PAUSE_NS;
}

static bool over(const struct frame_source *source)
{
	const struct replay_source *s = (const struct replay_source *)source;

	return s->result != GR_OK || (s->params.frames > 0 && s->begun >= s->params.frames);
}

static int64_t due(const struct frame_source *source)
{
	const struct replay_source *s = (const struct replay_source *)source;
	int64_t there_ns = s->play.time_ns - s->cut_ns - s->base_record_ns;

	if (s->params.step)
		return s->steps > 0 ? 0 : LOOP_NEVER;
	if (s->params.as_fast)
		return FRAME_SOURCE_GRID;
	return s->begun == 0 ? 0 : s->base_ns + llrint((double)there_ns / s->params.speed);
}

static int next(struct frame_source *source, const struct frame_moment *moment,
		struct param_state *state, struct frame_next *out)
{
	struct replay_source *s = (struct replay_source *)source;
	uint64_t epoch;

	if (over(source))
		return s->result == GR_OK ? GR_NOTHING : s->result;
	if (s->begun == 0) {
		s->base_ns = moment->now_ns;
		s->base_record_ns = s->play.time_ns;
	}
	param_state_copy(state, s->ahead);
	s->shown = s->play;
	memcpy(&epoch, param_get(state, PARAM_GI_EPOCH), sizeof epoch);
	*out = (struct frame_next){
		.frame = s->play.frame,
		/* Nodes that join compute the light from its start, whatever the record says. */
		.restarts_light = moment->restart_light || epoch == s->play.frame,
		.jumps = s->play.jumps,
		.previous_frame = s->play.previous_frame,
		.previous_hash = s->play.previous_hash,
	};
	return GR_OK;
}

static void begun(struct frame_source *source, uint64_t live, uint64_t hash, int64_t now_ns)
{
	struct replay_source *s = (struct replay_source *)source;

	(void)now_ns;
	s->begun++;
	s->steps -= s->steps > 0;
	replay_check_begin(&s->check, s->shown.frame, s->shown.hash, hash, live);
	read_ahead(s);
}

static void held(struct frame_source *source, unsigned node, uint64_t frame, uint64_t hash)
{
	replay_check_held(&((struct replay_source *)source)->check, node, frame, hash);
}

static const struct frame_source_ops replay_ops = {
	.next = next, .due = due, .begun = begun, .over = over, .held = held,
};

static void hex(const uint8_t *hash, char out[17])
{
	for (int i = 0; i < 8; i++)
		snprintf(out + (ptrdiff_t)2 * i, 3, "%02x", hash[i]);
}

static bool same(const struct replay_params *params, const char *what, const uint8_t *recorded,
		 const uint8_t *ours, const char *right, struct gr_diag *diag)
{
	char there[17], here[17];

	if (!ours || memcmp(recorded, ours, 32) == 0)
		return true;
	hex(recorded, there);
	hex(ours, here);
	gr_diag_add(diag, GR_DIAG_ERROR, params->path, 0, what,
		    "is of another %s: %s..., this one is %s...; %s", what, there, here, right);
	return false;
}

static int check_room(const struct replay_source *s, const struct replay_room *room,
		      struct gr_diag *diag)
{
	const struct record_session *session = record_player_session(s->player);
	bool right = same(&s->params, "layout", session->layout_hash, room->layout_hash,
			  "give the recorded one, or --other-layout", diag);

	right &= same(&s->params, "scene", session->scene_hash, room->scene_hash,
		      "give the recorded one", diag);
	return right ? GR_OK : GR_ERR_CONFIG;
}

int replay_source_create(struct replay_source **out, const struct replay_params *params,
			 const struct replay_room *room, struct gr_diag *diag)
{
	const struct record_player_params player = { params->recording, params->from_ns };
	struct replay_source *s = calloc(1, sizeof *s);
	int r;

	*out = NULL;
	if (!s)
		return GR_ERR_NOMEM;
	s->source.ops = &replay_ops;
	s->params = *params;
	r = param_state_create(&s->ahead);
	if (r == GR_OK)
		r = record_player_open(&s->player, params->path, &player, diag);
	if (r == GR_OK)
		r = check_room(s, room, diag);
	if (r == GR_OK) {
		read_ahead(s);
		r = s->result;
		if (r != GR_OK)
			gr_diag_add(diag, GR_DIAG_ERROR, params->path, 0, NULL,
				    "has no whole state to begin with%s", params->from_ns ? " after that time" : "");
	}
	if (r != GR_OK) {
		replay_source_destroy(&s);
		return r == GR_NOTHING || r == GR_ERR_VERSION ? GR_ERR_CONFIG : r;
	}
	*out = s;
	return GR_OK;
}

void replay_source_destroy(struct replay_source **source)
{
	struct replay_source *s = *source;

	*source = NULL;
	if (!s)
		return;
	record_player_destroy(&s->player);
	param_state_destroy(&s->ahead);
	free(s);
}

struct frame_source *replay_source_frames(struct replay_source *s)
{
	return &s->source;
}

int replay_source_step(struct replay_source *s, uint64_t frames)
{
	if (!s->params.step)
		return GR_ERR_STATE;
	s->steps += frames;
	return GR_OK;
}

/* Of the file, as far as was read. Frames lost at its end leave no gap between numbers, bytes do. */
static uint64_t bytes_damaged(const struct replay_source *s)
{
	struct record_damage damage;

	record_player_damage(s->player, &damage);
	return damage.bytes + damage.tail;
}

bool replay_source_end(struct replay_source *s)
{
	const struct replay_check *c = &s->check;
	struct record_player_counts counts;
	bool passed;

	/* Who was stopped in mid-frame is not told that its answer is missing. */
	replay_check_end(&s->check, over(&s->source) ? 0 : s->shown.frame);
	record_player_counts(s->player, &counts);
	passed = replay_check_passed(c) && counts.wrong == 0 && s->result >= 0;
	if (passed)
		gr_notice("replayed %" PRIu64 " frames: master and nodes held the recorded state in each, %" PRIu64
			  " answers", c->frames, c->node_equal);
	else
		gr_error("replayed %" PRIu64 " frames: %" PRIu64 " states differ from the record, %" PRIu64
			 " answers are missing, %" PRIu64 " states of the file are not what their hash says",
			 c->frames, c->different, c->unanswered, counts.wrong);
	if (c->first.frame)
		gr_error("the first difference: frame %" PRIu64 ", recorded %016" PRIx64 ", found %016" PRIx64,
			 c->first.frame, c->first.recorded, c->first.found);
	if (counts.missing)
		gr_warning("%" PRIu64 " frames of the record are missing or damaged and were left out",
			   counts.missing);
	if (bytes_damaged(s))
		gr_warning("%s: %" PRIu64 " bytes are damaged or no whole block: what they held was left out",
			   s->params.path, bytes_damaged(s));
	if (s->result < 0)
		gr_error("%s: cannot be read any further", s->params.path);
	return passed;
}

void replay_source_write_json(const struct replay_source *s, struct json *json,
			      const char *(*node_name)(const void *ctx, int node), const void *ctx)
{
	const struct replay_check *c = &s->check;
	struct record_player_counts counts;

	record_player_counts(s->player, &counts);
	json_string(json, "path", s->params.path);
	json_u64(json, "frames", c->frames);
	json_u64(json, "frames_missing", counts.missing);
	json_u64(json, "bytes_damaged", bytes_damaged(s));
	json_u64(json, "frames_wrong", counts.wrong);
	json_u64(json, "master_equal", c->master_equal);
	json_u64(json, "nodes_equal", c->node_equal);
	json_u64(json, "different", c->different);
	json_u64(json, "unanswered", c->unanswered);
	json_bool(json, "over", over(&s->source));
	if (c->first.frame) {
		json_open(json, "first_difference", '{');
		json_u64(json, "frame", c->first.frame);
		json_string(json, "where", c->first.node == REPLAY_CHECK_MASTER ? "master"
									       : node_name(ctx, c->first.node));
		json_hash(json, "recorded", c->first.recorded);
		json_hash(json, "found", c->first.found);
		json_close(json, '}');
	}
}
