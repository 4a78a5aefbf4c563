/* Polhemus' bytes: decoders, axes. */
#include "tests/unit/unit.h"

#include "base/pose.h"
#include "base/result.h"
#include "tests/unit/polhemus_make.h"
#include "tracking/polhemus_reports.h"

/* ---- VIPER ---- */

static void checksum_is_arc(void **state)
{
	(void)state;
	assert_int_equal(track_viper_checksum((const uint8_t *)"123456789", 9), 0xBB3D);
	assert_int_equal(track_viper_checksum(NULL, 0), 0);
}

static void commands_are_the_known_bytes(void **state)
{
	static const uint8_t units[] = { 0x56, 0x50, 0x52, 0x43, 0x20, 0, 0, 0, 0, 0, 0, 0, 0x07,
					 0,    0,    0,    0,    0,    0, 0, 0, 0, 0, 0, 0, 0,
					 0,    0,    0x03, 0,    0,    0, 2, 0, 0, 0, 0x74, 0x7f,
					 0,    0 };
	static const uint8_t go[] = { 0x56, 0x50, 0x52, 0x43, 0x18, 0, 0, 0, 0, 0, 0,
				      0,    0x13, 0,    0,    0,    0, 0, 0, 0, 0, 0,
				      0,    0,    0,    0,    0,    0, 0x63, 0xf2, 0, 0 };
	static const uint8_t payload[8] = { 3, 0, 0, 0, 2, 0, 0, 0 };
	uint8_t out[TRACK_VIPER_COMMAND_MOST], long_payload[TRACK_VIPER_COMMAND_MOST] = { 0 };

	(void)state;
	assert_int_equal(track_viper_command(out, TRACK_VIPER_UNITS, TRACK_VIPER_SET, 0, 0, payload,
					     sizeof payload),
			 sizeof units);
	assert_memory_equal(out, units, sizeof units);
	assert_int_equal(track_viper_command(out, TRACK_VIPER_CONTINUOUS, TRACK_VIPER_SET, 0, 0, NULL,
					     0),
			 sizeof go);
	assert_memory_equal(out, go, sizeof go);
	assert_int_equal(track_viper_command(out, TRACK_VIPER_UNITS, TRACK_VIPER_SET, 0, 0,
					     long_payload, 33),
			 0);
}

static void viper_poses_are_read(void **state)
{
	uint8_t bytes[MAKE_VIPER_MOST];
	struct track_viper_pose pose;
	float place[3], turn[4];

	(void)state;
	for (uint32_t sensors = 0; sensors < 0x20000; sensors = sensors * 2 + 1) {
		const size_t len = make_viper_pose(bytes, 1000, sensors & 0xffff);
		uint8_t *exact = unit_copy(bytes, len);

		assert_int_equal(track_viper_pose(exact, len, &pose), GR_OK);
		free(exact);
		assert_int_equal(pose.frame, 1000);
		assert_int_equal(pose.unit, 7);
		assert_int_equal(pose.count, __builtin_popcount(sensors & 0xffff));
		for (unsigned i = 0; i < pose.count; i++) {
			make_place(i, 1000, place, turn);
			assert_int_equal(pose.sensors[i].sensor, i);
			assert_int_equal(pose.sensors[i].position_unit, TRACK_VIPER_METRES);
			assert_int_equal(pose.sensors[i].orientation_unit, TRACK_VIPER_QUATERNION);
			assert_int_equal(pose.sensors[i].buttons, 2);
			assert_int_equal(pose.sensors[i].distortion, 51);
			assert_memory_equal(pose.sensors[i].place, place, sizeof place);
			assert_memory_equal(pose.sensors[i].turn, turn, sizeof turn);
		}
	}
}

static void units_are_metres(void **state)
{
	(void)state;
	assert_true(track_viper_metres(0) == 0.0254f);
	assert_true(track_viper_metres(1) == 0.3048f);
	assert_true(track_viper_metres(2) == 0.01f);
	assert_true(track_viper_metres(3) == 1.0f);
	assert_true(track_viper_metres(4) == 0);
}

static void assert_viper_refused(const uint8_t *bytes, size_t len, int fault)
{
	struct track_viper_pose pose = { .unit = 99 };
	uint8_t *exact = unit_copy(bytes, len);

	assert_int_equal(track_viper_pose(exact, len, &pose), -fault);
	assert_int_equal(pose.unit, 99);
	free(exact);
}

static void seal(uint8_t *bytes, size_t len)
{
	struct gr_writer w = gr_writer(bytes + len - 4, 4);

	gr_write_u32(&w, track_viper_checksum(bytes, len - 4));
}

static void viper_refuses_what_is_wrong(void **state)
{
	uint8_t bytes[MAKE_VIPER_MOST + 1] = { 0 };
	const size_t len = make_viper_pose(bytes, 5, 3);
	uint8_t bad[MAKE_VIPER_MOST];

	(void)state;
	for (size_t n = 0; n <= len + 1; n++)
		if (n != len)
			assert_viper_refused(bytes, n, TRACK_FAULT_LENGTH);
	/* Every bit that tips is seen: in head and sum as what it breaks first. */
	for (size_t bit = 0; bit < len * 8; bit++) {
		struct track_viper_pose pose;

		memcpy(bad, bytes, len);
		bad[bit / 8] ^= (uint8_t)(1u << bit % 8);
		assert_true(track_viper_pose(bad, len, &pose) < 0);
	}
	memcpy(bad, bytes, len);
	bad[16] = 1; /* the other mode */
	seal(bad, len);
	assert_viper_refused(bad, len, TRACK_FAULT_FORMAT);
	memcpy(bad, bytes, len);
	bad[20] = 17; /* more sensors than there can be */
	seal(bad, len);
	assert_viper_refused(bad, len, TRACK_FAULT_FORMAT);
	bad[20] = 3; /* more than the frame has */
	seal(bad, len);
	assert_viper_refused(bad, len, TRACK_FAULT_LENGTH);
}

static void viper_replies_are_read(void **state)
{
	uint8_t bytes[MAKE_VIPER_MOST + 1] = { 0 }, payload[400];
	struct track_viper_reply reply;

	(void)state;
	for (size_t i = 0; i < sizeof payload; i++)
		payload[i] = (uint8_t)i;
	for (size_t n = 0; n <= sizeof payload; n += 20) {
		const size_t len = make_viper_reply(bytes, 20, TRACK_VIPER_ACK, payload, n);

		for (size_t cut = 0; cut <= len + 1; cut++) {
			uint8_t *exact = unit_copy(bytes, cut);
			const int r = track_viper_reply(exact, cut, &reply);

			assert_int_equal(r, cut == len ? GR_OK : -TRACK_FAULT_LENGTH);
			free(exact);
		}
		assert_int_equal(reply.command, 20);
		assert_int_equal(reply.action, TRACK_VIPER_ACK);
		assert_int_equal(reply.len, n < TRACK_VIPER_PAYLOAD ? n : TRACK_VIPER_PAYLOAD);
		assert_memory_equal(reply.payload, payload, reply.len);
	}
}

/* ---- LIBERTY ---- */

static void liberty_poses_are_read(void **state)
{
	static const char *const names[] = { "LY", "PA", "LU" };
	uint8_t bytes[MAKE_LIBERTY_MOST + 1] = { 0 };
	struct track_liberty_pose pose;

	(void)state;
	for (int button = 0; button < 2; button++)
		for (unsigned station = 0; station < 16; station++) {
			const size_t len = make_liberty_pose(bytes, names[station % 3], 'C', station,
							     240, 100, button);

			for (size_t cut = 0; cut <= len + 1; cut++) {
				uint8_t *exact = unit_copy(bytes, cut);
				const int r = track_liberty_pose(exact, cut, &pose);

				assert_int_equal(r, cut == len ? GR_OK : -TRACK_FAULT_LENGTH);
				free(exact);
			}
			assert_int_equal(len, button ? 52 : 48);
			assert_int_equal(pose.station, station);
			assert_int_equal(pose.frame, 240);
			assert_int_equal(pose.stamp_ms, 1000);
			assert_int_equal(pose.error, 0);
			assert_int_equal(pose.distortion, 3);
			assert_int_equal(pose.has_button, button);
			assert_int_equal(pose.button, button);
			assert_true(pose.place_cm[0] == 100 * (0.5f + 0.24f));
			assert_true(pose.turn[0] == 0.5f && pose.turn[1] == -0.5f);
		}
}

static void assert_liberty_refused(uint8_t *bytes, size_t at, uint8_t value, int fault)
{
	struct track_liberty_pose pose = { .frame = 99 };
	const uint8_t was = bytes[at];

	bytes[at] = value;
	assert_int_equal(track_liberty_pose(bytes, MAKE_LIBERTY_MOST, &pose), -fault);
	assert_int_equal(pose.frame, 99);
	bytes[at] = was;
}

static void liberty_refuses_what_is_wrong(void **state)
{
	uint8_t bytes[MAKE_LIBERTY_MOST];
	uint16_t detected, active;

	(void)state;
	make_liberty_pose(bytes, "LY", 'C', 0, 1, 100, true);
	assert_liberty_refused(bytes, 0, 'l', TRACK_FAULT_FORMAT);
	assert_liberty_refused(bytes, 1, 'A', TRACK_FAULT_FORMAT);
	assert_liberty_refused(bytes, 2, 0, TRACK_FAULT_SENSOR);
	assert_liberty_refused(bytes, 2, 17, TRACK_FAULT_FORMAT);
	assert_liberty_refused(bytes, 3, TRACK_LIBERTY_MAP_COMMAND, TRACK_FAULT_FORMAT);
	assert_liberty_refused(bytes, 6, 43, TRACK_FAULT_LENGTH);
	assert_liberty_refused(bytes, 7, 3, TRACK_FAULT_FORMAT);
	assert_int_equal(track_liberty_map(bytes, sizeof bytes, &detected, &active),
			 -TRACK_FAULT_FORMAT);
	assert_int_equal(track_liberty_map((const uint8_t *)"LY\0\x15 \0\4\0\3\0\1\0", 12, &detected,
					   &active),
			 GR_OK);
	assert_int_equal(detected, 3);
	assert_int_equal(active, 1);
	assert_int_equal(track_liberty_map((const uint8_t *)"LY\0\x15 \0\3\0\3\0\1", 11, &detected,
					   &active),
			 -TRACK_FAULT_LENGTH);
	/* As long as a head is, but of another body. */
	assert_int_equal(track_liberty_map((const uint8_t *)"LY\0\x15 \0\4\0\3\0\1", 11, &detected,
					   &active),
			 -TRACK_FAULT_LENGTH);
}

/* ---- axes ---- */

static void axes_keep_their_hand(void **state)
{
	mat3 m;
	float back[3];

	(void)state;
	for (int i = 0; i < 3; i++) {
		const float unit[3] = { i == 0, i == 1, i == 2 };

		track_polhemus_to_base(unit, m[i]);
		track_polhemus_from_base(m[i], back);
		assert_memory_equal(back, unit, sizeof unit);
	}
	assert_true(glm_mat3_det(m) == 1);
	/* Forward, right, down. */
	assert_vector(m[0], 0, 0, -1);
	assert_vector(m[1], 1, 0, 0);
	assert_vector(m[2], 0, -1, 0);
}

/* A turn in the device's axes and the same in the base's take a point to the same place. */
static void turns_follow_the_axes(void **state)
{
	struct unit_random random = unit_random_start("turns");

	(void)state;
	for (int round = 0; round < 1000; round++) {
		struct track_polhemus_state s = { 0 };
		struct track_polhemus_sensor sensor = { .sensor = 2 };
		struct gr_pose device = GR_POSE_IDENTITY;
		struct track_report report;
		vec3 point, moved, expected, here;

		for (int i = 0; i < 4; i++)
			device.q[i] = (float)unit_random_range(&random, -1, 1);
		glm_quat_normalize(device.q);
		for (int i = 0; i < 3; i++) {
			point[i] = (float)unit_random_range(&random, -1, 1);
			sensor.place_m[i] = device.p[i] = (float)unit_random_range(&random, -2, 2);
		}
		sensor.turn[0] = device.q[3];
		memcpy(&sensor.turn[1], device.q, 3 * sizeof(float));
		track_polhemus_begin(&s, 240);
		track_polhemus_report(&s, &sensor, &report);
		gr_pose_point(&device, point, moved);
		track_polhemus_to_base(moved, expected);
		track_polhemus_to_base(point, here);
		gr_pose_point(&report.T_base_sensor, here, moved);
		assert_true(glm_vec3_distance(moved, expected) < 1e-5f);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(checksum_is_arc),
		cmocka_unit_test(commands_are_the_known_bytes),
		cmocka_unit_test(viper_poses_are_read),
		cmocka_unit_test(units_are_metres),
		cmocka_unit_test(viper_refuses_what_is_wrong),
		cmocka_unit_test(viper_replies_are_read),
		cmocka_unit_test(liberty_poses_are_read),
		cmocka_unit_test(liberty_refuses_what_is_wrong),
		cmocka_unit_test(axes_keep_their_hand),
		cmocka_unit_test(turns_follow_the_axes),
	};

	return cmocka_run_group_tests_name("polhemus_decode", tests, NULL, NULL);
}
