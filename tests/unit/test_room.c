/* Pictures put together: parts, eyes, turns. */
#include "tests/unit/unit.h"

#include "base/result.h"
#include "tools/room.h"

static struct room_picture picture_of(int width, int height, const uint8_t *grey)
{
	struct room_picture p;

	assert_int_equal(room_picture_create(&p, width, height), GR_OK);
	for (int i = 0; i < width * height; i++)
		memset(p.rgb + 3 * i, grey[i], 3);
	return p;
}

static uint8_t at(const struct room_picture *p, int x, int y)
{
	assert_true(x >= 0 && x < p->width && y >= 0 && y < p->height);
	return p->rgb[3 * (y * p->width + x)];
}

/* Two half-wall nodes and the two packings of stereo: each left eye in its half. */
static void test_parts(void **state)
{
	static const uint8_t side[] = { 10, 20, 200, 201, 30, 40, 202, 203 }; /* 4 x 2 */
	static const uint8_t over[] = { 50, 60, 70, 80, 204, 205, 206, 207 }; /* 2 x 4 */
	static const float left[4] = { 0, 0, 0.5f, 1 }, right[4] = { 0.5f, 0, 1, 1 };
	struct room_picture a = picture_of(4, 2, side), b = picture_of(2, 4, over), wall;

	(void)state;
	assert_int_equal(room_picture_create(&wall, 4, 2), GR_OK);
	room_add_part(&wall, left, &a, ROOM_LEFT_HALF);
	room_add_part(&wall, right, &b, ROOM_TOP_HALF);
	assert_int_equal(at(&wall, 0, 0), 10);
	assert_int_equal(at(&wall, 1, 1), 40);
	assert_int_equal(at(&wall, 2, 0), 50);
	assert_int_equal(at(&wall, 3, 1), 80);
	room_picture_finish(&a);
	room_picture_finish(&b);
	room_picture_finish(&wall);
}

/* Row 0 is the top, a wall's v grows upwards: the lower half lands below. */
static void test_lower_part(void **state)
{
	static const uint8_t grey[] = { 90 };
	static const float lower[4] = { 0, 0, 1, 0.5f };
	struct room_picture one = picture_of(1, 1, grey), wall;

	(void)state;
	assert_int_equal(room_picture_create(&wall, 2, 2), GR_OK);
	memset(wall.rgb, 0, 12);
	room_add_part(&wall, lower, &one, ROOM_WHOLE);
	assert_int_equal(at(&wall, 0, 0), 0);
	assert_int_equal(at(&wall, 1, 1), 90);
	room_picture_finish(&one);
	room_picture_finish(&wall);
}

/* A constant stays that constant however it is scaled: no darkening at borders. */
static void test_scaling_constant(void **state)
{
	static const float whole[4] = { 0, 0, 1, 1 };
	struct room_picture wall, source;

	(void)state;
	assert_int_equal(room_picture_create(&source, 37, 23), GR_OK);
	memset(source.rgb, 137, 37 * 23 * 3);
	for (int size = 1; size < 100; size += 7) {
		assert_int_equal(room_picture_create(&wall, size, 100 - size), GR_OK);
		room_add_part(&wall, whole, &source, ROOM_WHOLE);
		for (int i = 0; i < size * (100 - size) * 3; i++)
			assert_int_equal(wall.rgb[i], 137);
		room_picture_finish(&wall);
	}
	room_picture_finish(&source);
}

/* A wall turned by quarter turns shows its pixels turned. */
static void test_turns(void **state)
{
	static const uint8_t grey[] = { 1, 2, 3, 4 }; /* 1 2 over 3 4 */
	static const uint8_t turned[4][4] = {
		{ 1, 2, 3, 4 }, { 2, 4, 1, 3 }, { 4, 3, 2, 1 }, { 3, 1, 4, 2 },
	};
	static const double corner[4][2] = { { 0, 0 }, { 2, 0 }, { 2, 2 }, { 0, 2 } };
	static const double size[2] = { 2, 2 };
	struct room_picture wall = picture_of(2, 2, grey), room;

	(void)state;
	for (int t = 0; t < 4; t++) {
		struct unfold_place place = { .x = corner[t][0], .y = corner[t][1], .turns = t,
					      .width = 2, .height = 2 };

		assert_int_equal(room_compose(&place, size, &wall, 1, 100, &room), GR_OK);
		assert_int_equal(room.width, 2);
		for (int i = 0; i < 4; i++)
			assert_int_equal(at(&room, i % 2, i / 2), turned[t][i]);
		room_picture_finish(&room);
	}
	room_picture_finish(&wall);
}

static void test_limits(void **state)
{
	static const double size[2] = { 4, 1 };
	struct unfold_place places[2] = { { .width = 2, .height = 1 },
					  { .x = 2, .width = 2, .height = 1 } };
	struct room_picture walls[2] = { { 0 }, { 0 } }, room;

	(void)state;
	assert_int_equal(room_compose(places, size, walls, 2, 64, &room), GR_ERR_RANGE);
	assert_int_equal(room_picture_create(&walls[0], 200, 100), GR_OK);
	memset(walls[0].rgb, 255, 200 * 100 * 3);
	assert_int_equal(room_compose(places, size, walls, 2, 64, &room), GR_OK);
	assert_int_equal(room.width, 64);
	assert_int_equal(room.height, 16);
	assert_int_equal(at(&room, 31, 8), 255);
	assert_true(at(&room, 33, 8) < 64); /* nothing drawn there */
	room_picture_finish(&room);
	room_picture_finish(&walls[0]);
	assert_int_equal(room_picture_create(&walls[0], 0, 10), GR_ERR_RANGE);
	assert_int_equal(room_picture_create(&walls[0], 100000, 10), GR_ERR_RANGE);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_parts),   cmocka_unit_test(test_lower_part),
		cmocka_unit_test(test_scaling_constant),
		cmocka_unit_test(test_turns),   cmocka_unit_test(test_limits),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
