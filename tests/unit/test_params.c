/* protocol/params.h: the table, values and versions, deltas. */
#include "unit.h"

#include "protocol/state.h"

#include "base/result.h"

#include <ctype.h>
#include <math.h>

struct fixture {
	struct param_state *a, *b;
	uint8_t bytes[PARAM_DELTA_MAX];
};

static int setup(void **state)
{
	struct fixture *f = calloc(1, sizeof *f);

	assert_non_null(f);
	assert_int_equal(param_state_create(&f->a), GR_OK);
	assert_int_equal(param_state_create(&f->b), GR_OK);
	*state = f;
	return 0;
}

static int teardown(void **state)
{
	struct fixture *f = *state;

	param_state_destroy(&f->a);
	param_state_destroy(&f->b);
	assert_null(f->a);
	free(f);
	return 0;
}

static double element(const struct param_state *state, enum param_id id, unsigned i)
{
	const void *v = param_get(state, id);

	switch (param_info(id)->type) {
	case PARAM_F32: return (double)((const float *)v)[i];
	case PARAM_I32: return ((const int32_t *)v)[i];
	case PARAM_U32: return ((const uint32_t *)v)[i];
	case PARAM_U64: return (double)((const uint64_t *)v)[i];
	}
	return NAN;
}

static void put(void *values, const struct param_info *info, unsigned i, double v)
{
	switch (info->type) {
	case PARAM_F32: ((float *)values)[i] = (float)v; break;
	case PARAM_I32: ((int32_t *)values)[i] = (int32_t)v; break;
	case PARAM_U32: ((uint32_t *)values)[i] = (uint32_t)v; break;
	case PARAM_U64: ((uint64_t *)values)[i] = (uint64_t)v; break;
	}
}

/* A value inside the range; the whole of it for floats, less its ends for integers. */
static double some_value(const struct param_info *info, struct unit_random *r)
{
	return info->min + (info->max - info->min) * 0.999 * unit_random_range(r, 0, 1);
}

static void set_random(struct param_state *s, enum param_id id, struct unit_random *r, uint64_t frame)
{
	const struct param_info *info = param_info(id);
	uint64_t values[64];

	for (unsigned i = 0; i < info->count; i++)
		put(values, info, i, some_value(info, r));
	assert_true(param_set(s, id, values, frame) >= 0);
}

static void table(void **state)
{
	const struct fixture *f = *state;
	uint64_t hash = param_table_hash();

	for (int i = 0; i < PARAM_COUNT; i++) {
		const struct param_info *info = param_info((enum param_id)i);

		assert_true(strlen(info->name) > 0 && strlen(info->name) < 32);
		for (const char *c = info->name; *c; c++)
			assert_true(islower((unsigned char)*c) || isdigit((unsigned char)*c) || *c == '_');
		assert_true(info->count > 0);
		assert_int_equal(info->size, info->count * (info->type == PARAM_U64 ? 8 : 4));
		assert_true(info->min < info->max);
		assert_true(strlen(info->help) > 0);
		assert_int_equal(param_version(f->a, (enum param_id)i), 0);
		assert_true(param_valid((enum param_id)i, param_get(f->a, (enum param_id)i)));
		for (unsigned k = 0; k < info->count; k++)
			assert_true(fabs(element(f->a, (enum param_id)i, k) - info->def) <= 1e-7 * fabs(info->def));
	}
	assert_string_equal(param_info(PARAM_HEAD_POSITION)->name, "head_position");
	assert_int_not_equal(hash, 0);
	assert_int_equal(hash, param_table_hash());
}

static void set_and_get(void **state)
{
	struct fixture *f = *state;
	struct unit_random r = unit_random_start("set_and_get");
	const float head[3] = { 0.1f, 1.7f, -0.3f };
	const uint32_t on = 0;

	assert_int_equal(param_set(f->a, PARAM_HEAD_POSITION, head, 5), GR_OK);
	assert_int_equal(param_version(f->a, PARAM_HEAD_POSITION), 5);
	assert_memory_equal(param_f32(f->a, PARAM_HEAD_POSITION), head, sizeof head);
	assert_int_equal(param_set(f->a, PARAM_HEAD_POSITION, head, 6), GR_NOTHING);
	assert_int_equal(param_version(f->a, PARAM_HEAD_POSITION), 5);
	assert_int_equal(param_set(f->a, PARAM_GI_ON, &on, 6), GR_OK);
	assert_int_equal(*param_u32(f->a, PARAM_GI_ON), 0);
	/* Frames: 0 is the defaults', and none goes back. */
	assert_int_equal(param_set(f->a, PARAM_HEAD_POSITION, head, 0), GR_ERR_RANGE);
	assert_int_equal(param_set(f->a, PARAM_HEAD_POSITION, head, 4), GR_ERR_RANGE);
	for (int i = 0; i < PARAM_COUNT; i++)
		set_random(f->b, (enum param_id)i, &r, 9);
}

/* Every element of every parameter: both ends pass, beyond them and NaN do not. */
static void ranges(void **state)
{
	struct fixture *f = *state;

	for (int i = 0; i < PARAM_COUNT; i++) {
		const enum param_id id = (enum param_id)i;
		const struct param_info *info = param_info(id);
		uint64_t values[64], kept[64];

		for (unsigned k = 0; k < info->count; k++) {
			memcpy(values, param_get(f->a, id), info->size);
			memcpy(kept, values, info->size);
			put(values, info, k, info->min);
			assert_true(param_set(f->b, id, values, 1) >= 0);
			if (info->type == PARAM_F32) {
				put(values, info, k, info->max);
				assert_true(param_set(f->b, id, values, 1) >= 0);
			}
			if (info->type == PARAM_F32) {
				const float bad[] = { NAN, INFINITY, -INFINITY,
						      nextafterf((float)info->max, INFINITY),
						      nextafterf((float)info->min, -INFINITY) };

				for (size_t b = 0; b < sizeof bad / sizeof *bad; b++) {
					((float *)values)[k] = bad[b];
					assert_int_equal(param_set(f->a, id, values, 1), GR_ERR_RANGE);
				}
			} else if (info->type == PARAM_U32 && info->max < UINT32_MAX) {
				((uint32_t *)values)[k] = (uint32_t)info->max;
				assert_true(param_set(f->b, id, values, 1) >= 0);
				((uint32_t *)values)[k]++;
				assert_int_equal(param_set(f->a, id, values, 1), GR_ERR_RANGE);
			} else if (info->type == PARAM_U64 && info->max < 1.8e19) {
				((uint64_t *)values)[k] = UINT64_MAX;
				assert_int_equal(param_set(f->a, id, values, 1), GR_ERR_RANGE);
			}
			assert_memory_equal(param_get(f->a, id), kept, info->size);
			assert_int_equal(param_version(f->a, id), 0);
		}
	}
}

/* Random histories: any older state with any base it holds comes to the same state. */
static void round_trips(void **state)
{
	struct fixture *f = *state;
	struct unit_random r = unit_random_start("round_trips");

	for (int round = 0; round < 300; round++) {
		struct param_state *history[12];
		const uint64_t last = 11;

		assert_int_equal(param_state_create(&history[0]), GR_OK);
		for (uint64_t frame = 1; frame <= last; frame++) {
			assert_int_equal(param_state_create(&history[frame]), GR_OK);
			param_state_copy(history[frame], history[frame - 1]);
			for (unsigned n = unit_random_u32(&r) % 6; n; n--)
				set_random(history[frame], (enum param_id)(unit_random_u32(&r) % PARAM_COUNT),
					   &r, frame);
		}
		for (uint64_t held = 0; held <= last; held++) {
			const uint64_t base = held ? unit_random_u32(&r) % (held + 1) : 0;
			const long len = param_delta_encode(history[last], base, f->bytes, sizeof f->bytes);
			uint8_t *exact;
			uint64_t said;

			assert_true(len > 0 && (size_t)len <= param_delta_max());
			exact = unit_copy(f->bytes, (size_t)len);
			param_state_copy(f->b, history[held]);
			assert_int_equal(param_delta_base(exact, (size_t)len, &said), GR_OK);
			assert_int_equal(said, base);
			assert_int_equal(param_delta_apply(f->b, exact, (size_t)len), GR_OK);
			assert_int_equal(param_state_hash(f->b, 1), param_state_hash(history[last], 1));
			free(exact);
		}
		for (uint64_t frame = 0; frame <= last; frame++)
			param_state_destroy(&history[frame]);
	}
}

static long full_delta(struct fixture *f, struct unit_random *r)
{
	for (int i = 0; i < PARAM_COUNT; i++)
		while (!param_version(f->a, (enum param_id)i)) /* until it is not the default */
			set_random(f->a, (enum param_id)i, r, 3 + unit_random_u32(r) % 5);
	return param_delta_encode(f->a, 2, f->bytes, sizeof f->bytes);
}

/* The largest delta fills the room exactly; one byte less is refused. */
static void room(void **state)
{
	struct fixture *f = *state;
	struct unit_random r = unit_random_start("room");

	long len = full_delta(f, &r);

	assert_true(len > 0 && (size_t)len <= param_delta_max());
	for (size_t size = 0; size < (size_t)len; size++)
		assert_true(param_delta_encode(f->a, 2, f->bytes, size) < 0);
}

static void assert_untouched(struct fixture *f, uint64_t hash)
{
	assert_int_equal(param_state_hash(f->b, 0), hash);
}

static void truncated(void **state)
{
	struct fixture *f = *state;
	struct unit_random r = unit_random_start("truncated");
	const long len = full_delta(f, &r);
	const uint64_t hash = param_state_hash(f->b, 0);

	for (size_t n = 0; n < (size_t)len; n++) {
		uint8_t *exact = unit_copy(f->bytes, n);

		assert_int_equal(param_delta_apply(f->b, exact, n), GR_ERR_FORMAT);
		free(exact);
		assert_untouched(f, hash);
	}
}

/* Each byte, each other value: refused and nothing changed, or inside every range. */
static void corrupted(void **state)
{
	struct fixture *f = *state;
	struct unit_random r = unit_random_start("corrupted");
	const long len = full_delta(f, &r);
	const uint64_t hash = param_state_hash(f->b, 0);
	struct param_state *fresh;
	unsigned long refused = 0, harmless = 0;

	assert_int_equal(param_state_create(&fresh), GR_OK);
	for (size_t at = 0; at < (size_t)len; at++) {
		for (unsigned x = 1; x < 256; x += getenv("GROTTO_LONG") ? 1 : 13) {
			uint8_t *exact = unit_copy(f->bytes, (size_t)len);

			exact[at] = (uint8_t)(exact[at] ^ x);
			if (param_delta_apply(f->b, exact, (size_t)len)) {
				refused++;
				assert_untouched(f, hash);
			} else {
				harmless++;
				for (int i = 0; i < PARAM_COUNT; i++)
					assert_true(param_valid((enum param_id)i, param_get(f->b, (enum param_id)i)));
				param_state_copy(f->b, fresh);
			}
			free(exact);
		}
	}
	printf("# %lu corruptions refused, %lu gave other values inside the ranges\n", refused, harmless);
	param_state_destroy(&fresh);
}

/* The faults that a delta can have, by name. */
static void bad_deltas(void **state)
{
	struct fixture *f = *state;
	const uint32_t off = 0, curve = 0;
	/* base, entries; ids left out, version less base, value; the same again */
	uint8_t *entry = f->bytes + 2, *second = entry + 6;
	const size_t entry_len = 6, len = 2 + 2 * entry_len;
	uint64_t hash;

	assert_int_equal(param_set(f->a, PARAM_GI_ON, &off, 7), GR_OK);
	assert_int_equal(param_set(f->a, PARAM_TONE_CURVE, &curve, 8), GR_OK);
	assert_int_equal(param_delta_encode(f->a, 5, f->bytes, sizeof f->bytes), (long)len);
	hash = param_state_hash(f->b, 0);
#define REFUSED(change, undo) do { change; \
		assert_int_equal(param_delta_apply(f->b, f->bytes, len), GR_ERR_FORMAT); \
		assert_untouched(f, hash); undo; } while (0)
	REFUSED(f->bytes[1] = 1, f->bytes[1] = 2);           /* one entry less than there are */
	REFUSED(f->bytes[1] = 3, f->bytes[1] = 2);           /* one more */
	REFUSED(f->bytes[1] = 0x7f, f->bytes[1] = 2);        /* more than there are parameters */
	REFUSED(entry[0] = PARAM_COUNT, entry[0] = PARAM_GI_ON);
	REFUSED(second[0] = PARAM_COUNT, second[0] = PARAM_TONE_CURVE - PARAM_GI_ON - 1);
	REFUSED(entry[1] = 0, entry[1] = 2);                 /* not after the base */
	REFUSED(entry[2] = 2, entry[2] = 0);                 /* outside its range */
	assert_int_equal(param_delta_apply(f->b, f->bytes, len), GR_OK);
	/* Backwards: the state already has a later value. */
	hash = param_state_hash(f->b, 0);
	REFUSED(entry[1] = 1, entry[1] = 2);
#undef REFUSED
	/* A version beyond all numbers. */
	{
		static const uint8_t wraps[] = { 5, 1, PARAM_GI_ON, 0xff, 0xff, 0xff, 0xff, 0xff,
						 0xff, 0xff, 0xff, 0xff, 1, 0, 0, 0, 0 };

		assert_int_equal(param_delta_apply(f->b, wraps, sizeof wraps), GR_ERR_FORMAT);
		assert_untouched(f, hash);
	}
}

/* Base 0 is the whole truth: what it does not name is back at its default. */
static void snapshot_resets(void **state)
{
	struct fixture *f = *state;
	const float gamma = 0.5f;
	const uint32_t off = 0;
	long len;

	assert_int_equal(param_set(f->b, PARAM_GAMMA_ENCODE, &gamma, 90), GR_OK);
	assert_int_equal(param_set(f->a, PARAM_GI_ON, &off, 7), GR_OK);
	len = param_delta_encode(f->a, 0, f->bytes, sizeof f->bytes);
	assert_int_equal(param_delta_apply(f->b, f->bytes, (size_t)len), GR_OK);
	assert_int_equal(param_state_hash(f->b, 0), param_state_hash(f->a, 0));
}

static void hashes(void **state)
{
	struct fixture *f = *state;
	const uint64_t start = param_state_hash(f->a, 0);
	const float time = 0.07f;
	uint64_t changed;

	assert_int_equal(start, param_state_hash(f->b, 0));
	assert_int_not_equal(start, param_state_hash(f->a, 1)); /* chained */
	assert_int_equal(param_set(f->a, PARAM_EYE_SEPARATION, &time, 1), GR_OK);
	assert_int_equal(param_set(f->b, PARAM_EYE_SEPARATION, &time, 2), GR_OK);
	changed = param_state_hash(f->a, 0);
	assert_int_not_equal(changed, start);
	assert_int_not_equal(changed, param_state_hash(f->b, 0)); /* versions count */
}

/* docs/protocol.md lists every parameter as the table has it. GROTTO_PRINT=1 prints the lines. */
static void documented(void **state)
{
	static const char *const types[] = { "f32", "i32", "u32", "u64" };
	static char text[65536];
	FILE *file = fopen(PROTOCOL_DOC, "r");

	(void)state;
	assert_non_null(file);
	text[fread(text, 1, sizeof text - 1, file)] = 0;
	fclose(file);
	for (int i = 0; i < PARAM_COUNT; i++) {
		const struct param_info *info = param_info((enum param_id)i);
		char line[512];

		snprintf(line, sizeof line, "| %d | `%s` | %s | %u | %g | %g | %g | %s | %s |\n", i,
			 info->name, types[info->type], (unsigned)info->count, info->def, info->min,
			 info->max, info->unit, info->help);
		if (getenv("GROTTO_PRINT"))
			printf("%s", line);
		else if (!strstr(text, line))
			fail_msg("%s has no line: %s", PROTOCOL_DOC, line);
	}
}

int main(void)
{
#define T(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
	const struct CMUnitTest tests[] = {
		T(table), T(set_and_get), T(ranges), T(round_trips), T(room), T(truncated),
		T(corrupted), T(bad_deltas), T(snapshot_resets), T(hashes), T(documented),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
