/* What a master leaves to the next: round trips, damage, and a disk. */
#include "unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "daemon/saved_state.h"
#include "daemon/state_keeper.h"

#include <math.h>
#include <sodium.h>
#include <unistd.h>

static struct saved_state sample(void)
{
	struct saved_state s = {
		.layout_hash = { 1, 2 }, .scene_hash = { 3, 4 }, .saved_ns = 1000 * GR_NS_PER_S,
		.frame = 77, .time_ns = 1234567890,
		.T_scene_room = { .p = { 1, -2, 3 }, .q = { 0, 0.6f, 0, 0.8f } },
		.settings = { .gi_on = 1, .gi_steps = 9, .gi_gathers = 2, .tone_curve = 1, .gi_incremental = 0.5f,
			      .absorption = 0.1f, .scattering = 0.2f, .exposure = 2, .gamma_encode = 0.5f,
			      .eye_separation = 0.06f, .adaptation = 50, .luminance_max = 1e4f,
			      .tone_bias = 0.8f, .lamp_on = 5 },
		.hand = { .buttons = 3, .mode = HAND_LIGHTING, .flags = HAND_FLAG_QUALITY | HAND_FLAG_PUT_DOWN,
			  .hue = 0.4f, .position = { 1, 2, 3 }, .direction = { 0, -1, 0 } },
	};

	for (int i = 0; i < 3 * PARAM_MAX_LAMPS; i++)
		s.settings.lamp_intensity[i] = (float)i;
	return s;
}

static int decode(const uint8_t *bytes, size_t len, struct saved_state *out)
{
	char why[SAVED_STATE_REASON] = "";
	uint8_t *exact = unit_copy(bytes, len);
	const int r = saved_state_decode(exact, len, out, why);

	assert_true(r == GR_OK || why[0]);
	free(exact);
	return r;
}

static void round_trip(void **state)
{
	const struct saved_state s = sample();
	uint8_t bytes[SAVED_STATE_BYTES], again[SAVED_STATE_BYTES];
	struct saved_state out;
	struct master_state master = { .hand.torch = 1 };

	(void)state;
	saved_state_encode(&s, bytes);
	assert_int_equal(decode(bytes, sizeof bytes, &out), GR_OK);
	assert_int_equal(out.frame, s.frame);
	assert_int_equal(out.time_ns, s.time_ns);
	assert_int_equal(out.saved_ns, s.saved_ns);
	assert_memory_equal(&out.T_scene_room, &s.T_scene_room, sizeof s.T_scene_room);
	assert_memory_equal(&out.settings, &s.settings, sizeof s.settings);
	saved_state_encode(&out, again);
	assert_memory_equal(bytes, again, sizeof bytes);
	saved_state_give(&out, &master);
	assert_int_equal(master.hand.buttons, 3); /* a button that is held is not pressed anew */
	memset(&out, 0, sizeof out);
	saved_state_take(&out, &master);
	assert_memory_equal(&out.settings, &s.settings, sizeof s.settings);
	assert_memory_equal(&out.hand, &s.hand, sizeof s.hand);
	/* Another scene's file cannot be taken; one without a torch puts none down. */
	master.hand.torch = -1;
	saved_state_give(&s, &master);
	assert_false(master.hand.put_down);
}

/* Every length and every bit. */
static void damaged(void **state)
{
	const struct saved_state s = sample();
	uint8_t bytes[SAVED_STATE_BYTES + 1] = { 0 };
	struct saved_state out;

	(void)state;
	saved_state_encode(&s, bytes);
	for (size_t len = 0; len <= sizeof bytes; len++)
		assert_int_equal(decode(bytes, len, &out), len == SAVED_STATE_BYTES ? GR_OK : GR_ERR_FORMAT);
	for (size_t bit = 0; bit < 8 * (size_t)SAVED_STATE_BYTES; bit++) {
		bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
		assert_int_equal(decode(bytes, SAVED_STATE_BYTES, &out), GR_ERR_FORMAT);
		bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
	}
}

/* The checksum is right and the values are not. */
static void out_of_range(void **state)
{
	uint8_t bytes[SAVED_STATE_BYTES];
	struct saved_state s, out;

	(void)state;
#define REFUSED(...) do { s = sample(); __VA_ARGS__; saved_state_encode(&s, bytes); \
		assert_int_equal(decode(bytes, sizeof bytes, &out), GR_ERR_FORMAT); } while (0)
	REFUSED(s.T_scene_room.p[0] = NAN);
	REFUSED(s.T_scene_room.p[2] = 1e6f);
	REFUSED(s.T_scene_room.q[3] = 0.5f); /* no unit quaternion */
	REFUSED(s.time_ns = -1);
	REFUSED(s.frame = 0);
	REFUSED(s.settings.exposure = 0);
	REFUSED(s.settings.gi_steps = 1000);
	REFUSED(s.settings.adaptation = NAN);
	REFUSED(s.settings.tone_bias = 1);
	REFUSED(s.settings.lamp_on = 1u << 20);
	REFUSED(s.settings.lamp_intensity[47] = INFINITY);
	REFUSED(s.settings.gi_gathers = 0);
	REFUSED(s.hand.mode = HAND_MODES);
	REFUSED(s.hand.flags = 8);
	REFUSED(s.hand.hue = NAN);
	REFUSED(s.hand.position[1] = 1e7f);
	REFUSED(s.hand.direction[1] = 0);
#undef REFUSED
}

static void fits(void **state)
{
	const struct saved_state s = sample();
	const uint8_t other[32] = { 9 };
	const int64_t then = s.saved_ns;
	char why[SAVED_STATE_REASON];

	(void)state;
	assert_int_equal(saved_state_fits(&s, s.layout_hash, s.scene_hash, then + GR_NS_PER_S, why), GR_OK);
	assert_int_equal(saved_state_fits(&s, other, s.scene_hash, then, why), GR_ERR_MISMATCH);
	assert_non_null(strstr(why, "layout"));
	assert_int_equal(saved_state_fits(&s, s.layout_hash, other, then, why), GR_ERR_MISMATCH);
	assert_non_null(strstr(why, "scene"));
	assert_int_equal(saved_state_fits(&s, s.layout_hash, s.scene_hash,
					  then + SAVED_STATE_AGE_MOST_NS + 1, why), GR_NOTHING);
	assert_int_equal(saved_state_fits(&s, s.layout_hash, s.scene_hash, then - 100 * GR_NS_PER_S, why),
			 GR_NOTHING);
	assert_int_equal(saved_state_fits(&s, s.layout_hash, s.scene_hash, INT64_MIN, why), GR_NOTHING);
}

/* The file is whole at every moment, and at the end it is what was put last. */
static void kept(void **state)
{
	char folder[] = "/tmp/grotto-saved-XXXXXX", path[64], why[SAVED_STATE_REASON];
	struct state_keeper *keeper;
	struct saved_state s = sample(), out;
	uint8_t bytes[SAVED_STATE_BYTES];
	unsigned seen = 0;

	(void)state;
	assert_non_null(mkdtemp(folder));
	snprintf(path, sizeof path, "%s/master.state", folder);
	assert_int_equal(saved_state_load(path, &out, why), GR_NOTHING);
	assert_int_equal(state_keeper_create(&keeper, path, SAVED_STATE_BYTES), GR_OK);
	for (s.frame = 1; s.frame <= 300; s.frame++) {
		saved_state_encode(&s, bytes);
		state_keeper_put(keeper, bytes, sizeof bytes);
		usleep(500); /* so that some are seen while others are written */
		if (saved_state_load(path, &out, why) == GR_OK)
			seen++;
		else
			assert_int_equal(access(path, F_OK), -1); /* none yet */
	}
	state_keeper_put(keeper, bytes, 0); /* nothing is nothing */
	state_keeper_destroy(&keeper);
	assert_int_equal(saved_state_load(path, &out, why), GR_OK);
	assert_int_equal(out.frame, 300);
	printf("# read whole %u times while it was written\n", seen);
	assert_true(seen > 0);
	assert_int_equal(truncate(path, 100), 0);
	assert_int_equal(saved_state_load(path, &out, why), GR_ERR_FORMAT);
	/* No folder: told, and nothing else. */
	unlink(path);
	assert_int_equal(rmdir(folder), 0);
	assert_int_equal(state_keeper_create(&keeper, path, SAVED_STATE_BYTES), GR_OK);
	state_keeper_put(keeper, bytes, sizeof bytes);
	state_keeper_destroy(&keeper);
	state_keeper_destroy(&keeper);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(round_trip), cmocka_unit_test(damaged), cmocka_unit_test(out_of_range),
		cmocka_unit_test(fits),	      cmocka_unit_test(kept),
	};

	if (sodium_init() < 0)
		return 99;
	return cmocka_run_group_tests(tests, NULL, NULL);
}
