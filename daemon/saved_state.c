#include "daemon/saved_state.h"

#include "base/cursor.h"
#include "base/result.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#define VERSION 3
#define SUM_BYTES 32
#define SLACK_NS (60 * INT64_C(1000000000)) /* a clock that was set a little */

static const uint8_t magic[4] = { 'G', 'R', 'S', 'S' };

static void sum(const uint8_t *bytes, uint8_t out[SUM_BYTES])
{
	crypto_generichash(out, SUM_BYTES, bytes, SAVED_STATE_BYTES - SUM_BYTES, NULL, 0);
}

static void write_hand(struct gr_writer *w, const struct saved_hand *hand)
{
	gr_write_u32(w, hand->buttons);
	gr_write_u32(w, hand->mode);
	gr_write_u32(w, hand->flags);
	gr_write_f32(w, hand->hue);
	for (int i = 0; i < 3; i++)
		gr_write_f32(w, hand->position[i]);
	for (int i = 0; i < 3; i++)
		gr_write_f32(w, hand->direction[i]);
}

void saved_state_encode(const struct saved_state *state, uint8_t bytes[SAVED_STATE_BYTES])
{
	const struct master_settings *s = &state->settings;
	const float reals[] = { s->gi_incremental, s->absorption, s->scattering, s->exposure,
				s->gamma_encode, s->eye_separation, s->adaptation,
				s->luminance_max, s->tone_bias };
	struct gr_writer w = gr_writer(bytes, SAVED_STATE_BYTES - SUM_BYTES);

	gr_write_bytes(&w, magic, sizeof magic);
	gr_write_u32(&w, VERSION);
	gr_write_bytes(&w, state->layout_hash, 32);
	gr_write_bytes(&w, state->scene_hash, 32);
	gr_write_u64(&w, (uint64_t)state->saved_ns);
	gr_write_u64(&w, state->frame);
	gr_write_u64(&w, (uint64_t)state->time_ns);
	for (int i = 0; i < 3; i++)
		gr_write_f32(&w, state->T_scene_room.p[i]);
	for (int i = 0; i < 4; i++)
		gr_write_f32(&w, state->T_scene_room.q[i]);
	gr_write_u32(&w, s->gi_on);
	gr_write_u32(&w, s->gi_steps);
	gr_write_u32(&w, s->gi_gathers);
	gr_write_u32(&w, s->tone_curve);
	for (size_t i = 0; i < sizeof reals / sizeof *reals; i++)
		gr_write_f32(&w, reals[i]);
	gr_write_u32(&w, s->lamp_on);
	for (int i = 0; i < 3 * PARAM_MAX_LAMPS; i++)
		gr_write_f32(&w, s->lamp_intensity[i]);
	write_hand(&w, &state->hand);
	sum(bytes, bytes + w.len);
}

static void read_hand(struct gr_reader *r, struct saved_hand *hand)
{
	hand->buttons = gr_read_u32(r);
	hand->mode = gr_read_u32(r);
	hand->flags = gr_read_u32(r);
	hand->hue = gr_read_f32(r);
	for (int i = 0; i < 3; i++)
		hand->position[i] = gr_read_f32(r);
	for (int i = 0; i < 3; i++)
		hand->direction[i] = gr_read_f32(r);
}

static void read_all(struct gr_reader *r, struct saved_state *out)
{
	struct master_settings *s = &out->settings;
	float *const reals[] = { &s->gi_incremental, &s->absorption, &s->scattering, &s->exposure,
				 &s->gamma_encode, &s->eye_separation, &s->adaptation,
				 &s->luminance_max, &s->tone_bias };

	memcpy(out->layout_hash, gr_read_bytes(r, 32), 32);
	memcpy(out->scene_hash, gr_read_bytes(r, 32), 32);
	out->saved_ns = (int64_t)gr_read_u64(r);
	out->frame = gr_read_u64(r);
	out->time_ns = (int64_t)gr_read_u64(r);
	for (int i = 0; i < 3; i++)
		out->T_scene_room.p[i] = gr_read_f32(r);
	for (int i = 0; i < 4; i++)
		out->T_scene_room.q[i] = gr_read_f32(r);
	s->gi_on = gr_read_u32(r);
	s->gi_steps = gr_read_u32(r);
	s->gi_gathers = gr_read_u32(r);
	s->tone_curve = gr_read_u32(r);
	for (size_t i = 0; i < sizeof reals / sizeof *reals; i++)
		*reals[i] = gr_read_f32(r);
	s->lamp_on = gr_read_u32(r);
	for (int i = 0; i < 3 * PARAM_MAX_LAMPS; i++)
		s->lamp_intensity[i] = gr_read_f32(r);
	read_hand(r, &out->hand);
}

static bool hand_in_range(const struct saved_hand *hand, struct param_state *params)
{
	float place[3 * PARAM_MAX_LAMPS] = { 0 };

	memcpy(place, hand->position, sizeof hand->position);
	return hand->mode < HAND_MODES && !(hand->flags & ~(HAND_FLAG_QUALITY | HAND_FLAG_PUT_DOWN)) &&
	       param_set(params, PARAM_HAND_HUE, &hand->hue, 1) >= 0 &&
	       param_set(params, PARAM_LAMP_POSITION, place, 1) >= 0 &&
	       (!(hand->flags & HAND_FLAG_PUT_DOWN) ||
		fabsf(glm_vec3_norm2((float *)hand->direction) - 1) < 1e-2f);
}

/* Whatever it says must be what a frame's parameters may be. */
static bool in_range(const struct saved_state *s, const char **refused)
{
	const uint64_t time = (uint64_t)s->time_ns;
	struct param_state *params;
	bool ok = false;

	*refused = "memory";
	if (param_state_create(&params) < 0)
		return false;
	*refused = "time or frame";
	if (s->time_ns >= 0 && s->frame > 0 && s->frame < UINT64_MAX / 2 &&
	    param_set(params, PARAM_FRAME_TIME, &time, 1) >= 0) {
		*refused = "room";
		ok = gr_pose_valid(&s->T_scene_room) &&
		     param_set(params, PARAM_ROOM_POSITION, s->T_scene_room.p, 1) >= 0 &&
		     param_set(params, PARAM_ROOM_ROTATION, s->T_scene_room.q, 1) >= 0;
	}
	if (ok)
		ok = master_settings_apply(&s->settings, params, 1, refused) >= 0;
	if (ok && param_set(params, PARAM_LAMP_ON, &s->settings.lamp_on, 1) < 0) {
		*refused = "lamp_on";
		ok = false;
	}
	if (ok && !hand_in_range(&s->hand, params)) {
		*refused = "hand";
		ok = false;
	}
	param_state_destroy(&params);
	return ok;
}

int saved_state_decode(const uint8_t *bytes, size_t len, struct saved_state *out,
		       char why[SAVED_STATE_REASON])
{
	struct gr_reader r = gr_reader(bytes, SAVED_STATE_BYTES - SUM_BYTES);
	const char *refused = "its length";
	uint8_t expected[SUM_BYTES];
	uint32_t version;

	if (len != SAVED_STATE_BYTES) {
		snprintf(why, SAVED_STATE_REASON, "%zu bytes, a saved state has %d", len, SAVED_STATE_BYTES);
		return GR_ERR_FORMAT;
	}
	if (memcmp(gr_read_bytes(&r, sizeof magic), magic, sizeof magic)) {
		snprintf(why, SAVED_STATE_REASON, "not a master's saved state");
		return GR_ERR_FORMAT;
	}
	version = gr_read_u32(&r);
	if (version != VERSION) {
		snprintf(why, SAVED_STATE_REASON, "version %" PRIu32 ", this master reads %d", version, VERSION);
		return GR_ERR_FORMAT;
	}
	sum(bytes, expected);
	if (sodium_memcmp(expected, bytes + SAVED_STATE_BYTES - SUM_BYTES, SUM_BYTES)) {
		snprintf(why, SAVED_STATE_REASON, "damaged: its checksum is another");
		return GR_ERR_FORMAT;
	}
	*out = (struct saved_state){ .frame = 0 };
	read_all(&r, out);
	if (!gr_reader_done(&r) || !in_range(out, &refused)) {
		snprintf(why, SAVED_STATE_REASON, "%s is outside its range", refused);
		return GR_ERR_FORMAT;
	}
	return GR_OK;
}

int saved_state_fits(const struct saved_state *state, const uint8_t layout_hash[32],
		     const uint8_t scene_hash[32], int64_t real_ns, char why[SAVED_STATE_REASON])
{
	int64_t age_ns;

	if (memcmp(state->layout_hash, layout_hash, 32) || memcmp(state->scene_hash, scene_hash, 32)) {
		snprintf(why, SAVED_STATE_REASON, "of another %s",
			 memcmp(state->layout_hash, layout_hash, 32) ? "layout" : "scene");
		return GR_ERR_MISMATCH;
	}
	if (__builtin_sub_overflow(real_ns, state->saved_ns, &age_ns) || age_ns < -SLACK_NS ||
	    age_ns > SAVED_STATE_AGE_MOST_NS) {
		snprintf(why, SAVED_STATE_REASON, "not of the last %d minutes",
			 (int)(SAVED_STATE_AGE_MOST_NS / INT64_C(60000000000)));
		return GR_NOTHING;
	}
	return GR_OK;
}

int saved_state_load(const char *path, struct saved_state *out, char why[SAVED_STATE_REASON])
{
	uint8_t bytes[SAVED_STATE_BYTES + 1]; /* one more: a longer file is seen to be so */
	FILE *file = fopen(path, "re");
	size_t len;
	bool failed;

	if (!file) {
		snprintf(why, SAVED_STATE_REASON, "%s", strerror(errno));
		return errno == ENOENT ? GR_NOTHING : GR_ERR_IO;
	}
	len = fread(bytes, 1, sizeof bytes, file);
	failed = ferror(file);
	fclose(file);
	if (failed) {
		snprintf(why, SAVED_STATE_REASON, "cannot be read");
		return GR_ERR_IO;
	}
	return saved_state_decode(bytes, len, out, why);
}

void saved_state_take(struct saved_state *out, const struct master_state *state)
{
	const struct hand *hand = &state->hand;

	out->T_scene_room = state->T_scene_room;
	out->settings = state->settings;
	out->hand = (struct saved_hand){
		.buttons = hand->buttons,
		.mode = hand->mode,
		.flags = (hand->quality ? HAND_FLAG_QUALITY : 0) | (hand->put_down ? HAND_FLAG_PUT_DOWN : 0),
		.hue = hand->hue,
	};
	memcpy(out->hand.position, hand->position, sizeof hand->position);
	memcpy(out->hand.direction, hand->direction, sizeof hand->direction);
}

void saved_state_give(const struct saved_state *saved, struct master_state *state)
{
	struct hand *hand = &state->hand;

	state->T_scene_room = saved->T_scene_room;
	state->settings = saved->settings;
	hand->buttons = saved->hand.buttons;
	hand->mode = (enum hand_mode)saved->hand.mode;
	hand->quality = saved->hand.flags & HAND_FLAG_QUALITY;
	hand->put_down = saved->hand.flags & HAND_FLAG_PUT_DOWN && hand->torch >= 0;
	hand->hue = saved->hand.hue;
	memcpy(hand->position, saved->hand.position, sizeof hand->position);
	memcpy(hand->direction, saved->hand.direction, sizeof hand->direction);
}
