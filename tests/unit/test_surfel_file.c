/* Bake files: what is written comes back; whatever was changed is refused, with a reason. */
#include "base/result.h"
#include "renderer/gi/surfel_file.h"
#include "tests/unit/baked_room.h"

#include <math.h>
#include <sodium.h>
#include <unistd.h>

static struct baked_room room;
static uint8_t key[SURFEL_KEY_BYTES];
static uint8_t *whole;
static size_t whole_len;

static char *in_folder(const char *name)
{
	static char path[BAKED_ROOM_PATH_BYTES];

	return baked_room_path(&room, name, path);
}

static uint8_t *read_file(const char *path, size_t *len)
{
	FILE *file = fopen(path, "rb");
	uint8_t *bytes;

	assert_non_null(file);
	fseek(file, 0, SEEK_END);
	*len = (size_t)ftell(file);
	rewind(file);
	bytes = malloc(*len);
	assert_int_equal(fread(bytes, 1, *len, file), *len);
	fclose(file);
	return bytes;
}

static int set_up(void **state)
{
	(void)state;
	if (baked_room_make(&room) != 0)
		return -1;
	surfel_file_key(room.scene, &baked_room_coarse, key);
	if (surfel_file_write(room.set, key, in_folder("a.surfels")) != GR_OK)
		return -1;
	whole = read_file(in_folder("a.surfels"), &whole_len);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	unlink(in_folder("a.surfels"));
	free(whole);
	return baked_room_remove(&room);
}

/* What decode says to a copy of so many bytes; the reason must hold `reason`. */
static int decode(const uint8_t *bytes, size_t len, const char *reason)
{
	uint8_t *copy = unit_copy(bytes, len);
	struct gr_diag diag = { 0 };
	struct surfel_set *found;
	int result = surfel_file_decode(&found, key, copy, len, "copy", &diag);

	if (result == GR_OK) {
		assert_non_null(found);
		surfel_set_destroy(&found);
	} else {
		assert_null(found);
		assert_int_equal(diag.count, 1);
		if (reason && !strstr(diag.items[0].text, reason))
			fail_msg("'%s' does not say '%s'", diag.items[0].text, reason);
	}
	gr_diag_finish(&diag);
	free(copy);
	return result;
}

static void comes_back(void **state)
{
	struct gr_diag diag = { 0 };
	struct surfel_set *found;

	(void)state;
	assert_int_equal(surfel_file_read(&found, key, in_folder("a.surfels"), &diag), GR_OK);
	assert_int_equal(surfel_set_hash(found), surfel_set_hash(room.set));
	assert_int_equal(found->rays, room.set->rays);
	assert_true(fabs(found->seconds - room.set->seconds) < 1e-5);
	surfel_set_destroy(&found);
	assert_int_equal(surfel_file_read(&found, key, in_folder("none.surfels"), &diag), GR_NOTHING);
	assert_int_equal(diag.count, 0);
	printf("# %zu surfels in %zu bytes\n", room.set->count, whole_len);
}

static void cut_short(void **state)
{
	(void)state;
	for (size_t len = 0; len < whole_len; len += len < 600 || len + 600 > whole_len ? 1 : 997)
		assert_int_equal(decode(whole, len, len < 8 ? "not a file" : "cut short"), GR_ERR_FORMAT);
	uint8_t *longer = calloc(1, whole_len + 1);
	memcpy(longer, whole, whole_len);
	assert_int_equal(decode(longer, whole_len + 1, "longer"), GR_ERR_FORMAT);
	free(longer);
}

/* A flipped bit anywhere: all of the head, a sweep through the rest, all of the end. */
static void flipped_bit(void **state)
{
	struct unit_random random = unit_random_start("flipped_bit");
	size_t flips = 0;

	(void)state;
	for (size_t at = 0; at < whole_len; at += at < 300 || at + 40 > whole_len ? 1 : 211) {
		uint8_t bit = (uint8_t)(1u << (unit_random_u32(&random) % 8));

		whole[at] ^= bit;
		assert_true(decode(whole, whole_len, NULL) < 0);
		whole[at] ^= bit;
		flips++;
	}
	printf("# %zu flipped bits, all refused\n", flips);
	assert_int_equal(decode(whole, whole_len, NULL), GR_OK);
}

static void other_version_or_scene(void **state)
{
	uint8_t other[SURFEL_KEY_BYTES];
	struct surfel_bake_params params = baked_room_coarse;

	(void)state;
	whole[12]++;
	assert_int_equal(decode(whole, whole_len, "another version"), GR_ERR_VERSION);
	whole[12]--;
	whole[16]++;
	assert_int_equal(decode(whole, whole_len, "another scene"), GR_ERR_MISMATCH);
	whole[16]--;
	params.links++;
	surfel_file_key(room.scene, &params, other);
	assert_memory_not_equal(other, key, sizeof key);
	room.scene->hash[3]++;
	surfel_file_key(room.scene, &baked_room_coarse, other);
	room.scene->hash[3]--;
	assert_memory_not_equal(other, key, sizeof key);
	params = baked_room_coarse;
	params.threads = 7; /* changes nothing */
	surfel_file_key(room.scene, &params, other);
	assert_memory_equal(other, key, sizeof key);
}

/* Someone who knows the form: a right checksum over wrong contents. */
static void sign(uint8_t *bytes, size_t len)
{
	crypto_generichash(bytes + len - 32, 32, bytes, len - 32, NULL, 0);
}

static void hostile(void **state)
{
	static const uint32_t words[] = { 0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0xfffffffe,
					  0x7f800000, 0x7fc00000, 1 << 20 };
	struct unit_random random = unit_random_start("hostile");
	uint8_t *bytes = unit_copy(whole, whole_len);
	struct surfel_part parts[SURFEL_PARTS];
	size_t links_at = 256, accepted = 0, tried = 0;

	(void)state;
	/* every number of the head, with every value that breaks sums */
	for (size_t at = 56; at < 200; at += 4)
		for (size_t k = 0; k < sizeof words / sizeof *words; k++) {
			memcpy(bytes + at, &words[k], 4);
			sign(bytes, whole_len);
			accepted += decode(bytes, whole_len, NULL) == GR_OK;
			tried++;
			memcpy(bytes + at, whole + at, 4);
		}
	/* a link to nowhere */
	surfel_set_parts(room.set, parts);
	for (int i = 0; i < 5; i++)
		links_at += parts[i].bytes;
	const uint32_t nowhere = (uint32_t)room.set->count;
	memcpy(bytes + links_at, &nowhere, 4);
	sign(bytes, whole_len);
	assert_int_equal(decode(bytes, whole_len, "not there"), GR_ERR_FORMAT);
	memcpy(bytes + links_at, whole + links_at, 4);
	/* anything anywhere: whatever is taken must hold */
	for (int i = 0; i < 3000; i++) {
		size_t at = 256 + unit_random_u32(&random) % (whole_len - 256 - 36);
		uint32_t word = words[unit_random_u32(&random) % (sizeof words / sizeof *words)];

		memcpy(bytes + at, &word, 4);
		sign(bytes, whole_len);
		accepted += decode(bytes, whole_len, NULL) == GR_OK;
		tried++;
		memcpy(bytes + at, whole + at, 4);
	}
	printf("# %zu signed but wrong files: %zu could do no harm, the rest was refused\n", tried,
	       accepted);
	free(bytes);
}

/* Light, places and reflectances that are no numbers, in a file that is whole: refused, and said which. */
static void not_finite(void **state)
{
	struct surfel_set *set = room.set;
	const struct {
		float *at;
		const char *reason;
	} places[] = {
		{ &set->spacing_m, "its spacing is not a length" },
		{ &set->surfels[1].position[2], "a surfel is nowhere" },
		{ &set->taps[3].position[0], "a point of a surfel is nowhere" },
		{ &set->area[0], "a surfel's area" },
		{ &set->albedo[2][1], "reflectance is out of range" },
		{ &set->fixed_emissive[0][2], "a surfel's light is not finite" },
		{ &set->fixed_other[set->count - 1][0], "a surfel's light is not finite" },
		{ &set->fixed_way[1][0], "a surfel's light has come from nowhere" },
		{ &set->extinction, "its air is none" },
		{ &set->probes.fixed_way[0][1], "a probe's light has come from nowhere" },
		{ &set->probes.directions[0][1], "a direction of its probes" },
		{ &set->probes.fixed[0][SURFEL_SH - 1][2], "a probe's light or distances are not finite" },
		{ &set->probes.distance[0][7][1], "a probe's light or distances are not finite" },
		{ &set->probes.cell_m, "its probes do not stand in a grid" },
	};
	const float wrong[] = { NAN, -NAN, INFINITY };
	const char *path = in_folder("wrong.surfels");

	(void)state;
	for (size_t i = 0; i < sizeof places / sizeof *places; i++)
		for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
			const float before = *places[i].at;
			uint8_t *bytes;
			size_t len;

			/* an area may be as large as it likes */
			if (places[i].at == &set->area[0] && !isnan(wrong[k]))
				continue;
			*places[i].at = wrong[k];
			assert_int_equal(surfel_file_write(set, key, path), GR_OK);
			*places[i].at = before;
			bytes = read_file(path, &len);
			assert_int_equal(decode(bytes, len, places[i].reason), GR_ERR_FORMAT);
			free(bytes);
		}
	unlink(path);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(comes_back),
		cmocka_unit_test(cut_short),
		cmocka_unit_test(flipped_bit),
		cmocka_unit_test(other_version_or_scene),
		cmocka_unit_test(hostile),
		cmocka_unit_test(not_finite),
	};

	return cmocka_run_group_tests(tests, set_up, tear_down);
}
