/* VRPN's bytes: every kind of message, every length, and the names of a connection. */
#include "tests/unit/unit.h"

#include "base/result.h"
#include "tests/unit/vrpn_bytes.h"
#include "tracking/vrpn.h"

enum { POSE, BUTTON, BUTTONS, CHANNELS, OTHER };
#define DEVICE 3
#define SOMEBODY 4

struct session {
	struct track_vrpn_state state;
	struct track_vrpn_reports out;
	struct vrpn_bytes bytes;
};

/* The bytes in exactly as many as they are; what the last of them gave. */
static int take_all(struct session *s, bool datagram)
{
	uint8_t *copy = unit_copy(s->bytes.at, s->bytes.len);
	struct track_vrpn_message message;
	size_t at = 0, used;
	int r = GR_NOTHING;

	while (track_vrpn_decode(copy + at, s->bytes.len - at, &message, &used) == GR_OK) {
		r = track_vrpn_take(&s->state, &message, datagram, &s->out);
		at += used;
	}
	assert_int_equal(at, s->bytes.len);
	s->bytes.len = 0;
	free(copy);
	return r;
}

static int take_body(struct session *s, int32_t type, const void *body, size_t len)
{
	uint8_t *copy = unit_copy(body, len);
	const struct track_vrpn_message message = { .time_ns = 1, .sender = DEVICE, .type = type,
						    .body = copy, .len = len };
	const int r = track_vrpn_take(&s->state, &message, false, &s->out);

	free(copy);
	return r;
}

static int setup(void **state)
{
	struct session *s = calloc(1, sizeof *s);

	strcpy(s->state.device, "Tracker0");
	vrpn_name(&s->bytes, TRACK_VRPN_SENDER, 0, "VRPN Control");
	vrpn_name(&s->bytes, TRACK_VRPN_TYPE, POSE, "vrpn_Tracker Pos_Quat");
	vrpn_name(&s->bytes, TRACK_VRPN_TYPE, BUTTON, "vrpn_Button Change");
	vrpn_name(&s->bytes, TRACK_VRPN_TYPE, BUTTONS, "vrpn_Button States");
	vrpn_name(&s->bytes, TRACK_VRPN_TYPE, CHANNELS, "vrpn_Analog Channel");
	vrpn_name(&s->bytes, TRACK_VRPN_TYPE, OTHER, "vrpn_Tracker Velocity");
	vrpn_name(&s->bytes, TRACK_VRPN_SENDER, SOMEBODY, "Wand\n0");
	vrpn_name(&s->bytes, TRACK_VRPN_SENDER, DEVICE, "Tracker0");
	assert_int_equal(take_all(s, false), GR_OK);
	assert_true(s->state.there);
	assert_string_equal(s->state.others, "Wand?0");
	*state = s;
	return 0;
}

static int teardown(void **state)
{
	free(*state);
	return 0;
}

/* ---- frames ---- */

static void the_cookie(void **state)
{
	static const uint8_t ours[24] = "vrpn: ver. 07.35  0\0\0\0\0";
	uint8_t bytes[24];

	(void)state;
	track_vrpn_cookie(bytes);
	assert_memory_equal(bytes, ours, 24);
	assert_int_equal(track_vrpn_check_cookie(bytes), GR_OK);
	memcpy(bytes, "vrpn: ver. 07.99  3\0\0\0\0", 24);
	assert_int_equal(track_vrpn_check_cookie(bytes), GR_OK);
	memcpy(bytes, "vrpn: ver. 08.01  0\0\0\0\0", 24);
	assert_int_equal(track_vrpn_check_cookie(bytes), GR_ERR_VERSION);
	memcpy(bytes, "HTTP/1.1 400 Bad Request", 24);
	assert_int_equal(track_vrpn_check_cookie(bytes), GR_ERR_FORMAT);
}

static void a_message_byte_by_byte(void **state)
{
	static const uint8_t bytes[] = {
		0,    0,    0,	  0x1b,				/* 24 + 3 */
		0x65, 0x53, 0xf1, 0x00, 0,    0x0f, 0x42, 0x3f, /* 1700000000 s, 999999 us */
		0,    0,    0x01, 0x02, 0xff, 0xff, 0xff, 0xfc, /* sender 258, type -4 */
		0xde, 0xad, 0xbe, 0xef,				/* ignored */
		'a',  'b',  'c',  0xff, 0xff, 0xff, 0xff, 0xff, /* padding is not looked at */
	};
	struct track_vrpn_message m;
	size_t used = 0;

	(void)state;
	for (size_t len = 0; len < sizeof bytes; len++) {
		uint8_t *copy = unit_copy(bytes, len);

		assert_int_equal(track_vrpn_decode(copy, len, &m, &used), GR_NOTHING);
		free(copy);
	}
	assert_int_equal(track_vrpn_decode(bytes, sizeof bytes, &m, &used), GR_OK);
	assert_int_equal(used, 32);
	assert_int_equal(m.time_ns, INT64_C(1700000000999999000));
	assert_int_equal(m.sender, 258);
	assert_int_equal(m.type, -4);
	assert_int_equal(m.len, 3);
	assert_memory_equal(m.body, "abc", 3);
}

static void lengths_have_bounds(void **state)
{
	static const uint32_t none[] = { 0, 1, 23, TRACK_VRPN_MESSAGE_MOST + 1, 1u << 31, UINT32_MAX };
	static uint8_t bytes[TRACK_VRPN_MESSAGE_MOST + 8];
	struct track_vrpn_message m;
	size_t used;

	(void)state;
	for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
		struct vrpn_bytes b = { .len = 0 };

		/* At once, before any more bytes are waited for. */
		vrpn_u32(&b, none[i]);
		assert_int_equal(track_vrpn_decode(b.at, 4, &m, &used), -TRACK_FAULT_LENGTH);
	}
	bytes[2] = TRACK_VRPN_MESSAGE_MOST >> 8;
	bytes[3] = TRACK_VRPN_MESSAGE_MOST & 0xff;
	assert_int_equal(track_vrpn_decode(bytes, TRACK_VRPN_MESSAGE_MOST - 1, &m, &used), GR_NOTHING);
	assert_int_equal(track_vrpn_decode(bytes, sizeof bytes, &m, &used), GR_OK);
	assert_int_equal(used, TRACK_VRPN_MESSAGE_MOST);
	assert_int_equal(m.len, TRACK_VRPN_BODY_MOST);
	bytes[2] = 0;
	bytes[3] = 24;
	assert_int_equal(track_vrpn_decode(bytes, 24, &m, &used), GR_OK);
	assert_int_equal(used, 24);
	assert_int_equal(m.len, 0);
}

/* Every length of a body comes out as it went in, padded with zeros. */
static void what_is_written_is_read(void **state)
{
	uint8_t body[40], out[80];

	(void)state;
	memset(body, 0xa5, sizeof body);
	for (size_t n = 0; n <= sizeof body; n++) {
		const struct track_vrpn_message m = { .time_ns = INT64_C(123456789000), .sender = -7,
						      .type = 1999, .body = body, .len = n };
		const size_t whole = 24 + (n + 7) / 8 * 8;
		struct track_vrpn_message read;
		size_t len = 0, used;

		memset(out, 0xff, sizeof out);
		assert_false(track_vrpn_encode(&m, out, whole - 1, &len));
		assert_int_equal(len, 0);
		assert_true(track_vrpn_encode(&m, out, whole, &len));
		assert_int_equal(len, whole);
		for (size_t i = 24 + n; i < whole; i++)
			assert_int_equal(out[i], 0);
		assert_int_equal(track_vrpn_decode(out, len, &read, &used), GR_OK);
		assert_int_equal(read.time_ns, m.time_ns);
		assert_int_equal(read.sender, m.sender);
		assert_int_equal(read.type, m.type);
		assert_int_equal(read.len, n);
	}
}

/* ---- names ---- */

static int describe(struct session *s, int32_t what, int32_t id, const void *body, size_t len)
{
	vrpn_message(&s->bytes, 0, id, what, body, len);
	return take_all(s, false);
}

static void names_that_are_none(void **state)
{
	struct session *s = *state;
	uint8_t body[4 + 120];

	memset(body, 'x', sizeof body);
	memset(body, 0, 4);
	for (size_t n = 0; n <= 120; n++) {
		body[3] = (uint8_t)n;
		body[4 + (n ? n - 1 : 0)] = 0;
		/* 1 to 100 bytes with the NUL. */
		assert_int_equal(describe(s, TRACK_VRPN_SENDER, 9, body, 4 + n),
				 n >= 1 && n <= 100 ? GR_OK : -TRACK_FAULT_FORMAT);
		body[4 + (n ? n - 1 : 0)] = 'x';
	}
	body[3] = 5;
	assert_int_equal(describe(s, TRACK_VRPN_SENDER, 9, body, 9), -TRACK_FAULT_FORMAT); /* no NUL */
	body[8] = 0;
	assert_int_equal(describe(s, TRACK_VRPN_SENDER, 9, body, 9), GR_OK);
	assert_int_equal(describe(s, TRACK_VRPN_SENDER, 9, body, 10), -TRACK_FAULT_FORMAT);
	assert_int_equal(describe(s, TRACK_VRPN_SENDER, 9, body, 8), -TRACK_FAULT_FORMAT);
	assert_int_equal(describe(s, TRACK_VRPN_SENDER, 9, body, 3), -TRACK_FAULT_FORMAT);
	body[6] = 0;
	assert_int_equal(describe(s, TRACK_VRPN_SENDER, 9, body, 9), -TRACK_FAULT_FORMAT);
	body[6] = 'x';
	body[0] = 0x80; /* minus 2 GiB */
	assert_int_equal(describe(s, TRACK_VRPN_SENDER, 9, body, 9), -TRACK_FAULT_FORMAT);
	body[0] = 0;
	for (int what = TRACK_VRPN_TYPE; what <= TRACK_VRPN_SENDER; what++) {
		assert_int_equal(describe(s, what, -1, body, 9), -TRACK_FAULT_FORMAT);
		assert_int_equal(describe(s, what, 1999, body, 9), GR_OK);
		assert_int_equal(describe(s, what, 2000, body, 9), -TRACK_FAULT_FORMAT);
		assert_int_equal(describe(s, what, INT32_MAX, body, 9), -TRACK_FAULT_FORMAT);
	}
	assert_true(strlen(s->state.others) < sizeof s->state.others);
}

static void numbers_go_by_their_names(void **state)
{
	struct session *s = *state;

	/* Somebody else's, and a type that is of no use. */
	vrpn_pose(&s->bytes, 1, SOMEBODY, POSE, 0, 5);
	assert_int_equal(take_all(s, false), GR_NOTHING);
	vrpn_pose(&s->bytes, 1, DEVICE, OTHER, 0, 5);
	assert_int_equal(take_all(s, false), GR_NOTHING);
	vrpn_pose(&s->bytes, 1, DEVICE, 77, 0, 5); /* that has no name */
	assert_int_equal(take_all(s, false), GR_NOTHING);
	vrpn_pose(&s->bytes, 1, DEVICE, 2000, 0, 5);
	assert_int_equal(take_all(s, false), GR_NOTHING);
	vrpn_pose(&s->bytes, 1, INT32_MIN, INT32_MAX, 0, 5);
	assert_int_equal(take_all(s, false), GR_NOTHING);
	/* The number is given to another device: the old name is gone with it. */
	vrpn_name(&s->bytes, TRACK_VRPN_SENDER, DEVICE, "Another");
	take_all(s, false);
	vrpn_pose(&s->bytes, 1, DEVICE, POSE, 0, 5);
	assert_int_equal(take_all(s, false), GR_NOTHING);
	vrpn_name(&s->bytes, TRACK_VRPN_SENDER, 1999, "Tracker0");
	vrpn_name(&s->bytes, TRACK_VRPN_TYPE, POSE, "vrpn_Button Change");
	vrpn_name(&s->bytes, TRACK_VRPN_TYPE, 1999, "vrpn_Tracker Pos_Quat");
	vrpn_pose(&s->bytes, 1, 1999, 1999, 0, 5);
	assert_int_equal(take_all(s, false), GR_OK);
	assert_float_equal(s->out.reports[0].T_base_sensor.p[0], 5, 0);
	/* A pose is no button. */
	vrpn_pose(&s->bytes, 1, 1999, POSE, 0, 5);
	assert_int_equal(take_all(s, false), -TRACK_FAULT_LENGTH);
}

static void system_messages(void **state)
{
	struct session *s = *state;

	vrpn_message(&s->bytes, 0, 3883, TRACK_VRPN_UDP, "127.0.0.1", 10);
	assert_int_equal(take_all(s, false), GR_NOTHING);
	vrpn_message(&s->bytes, 0, 0, TRACK_VRPN_LOG, "x", 1);
	assert_int_equal(take_all(s, false), GR_NOTHING);
	vrpn_message(&s->bytes, 0, 0, INT32_MIN, "x", 1);
	assert_int_equal(take_all(s, false), GR_NOTHING);
	assert_false(s->out.ended);
	vrpn_message(&s->bytes, 0, 0, TRACK_VRPN_DISCONNECT, "", 0);
	assert_int_equal(take_all(s, false), GR_NOTHING);
	assert_true(s->out.ended);
	/* Whoever can send a datagram neither names things nor ends the connection. */
	vrpn_message(&s->bytes, 0, 0, TRACK_VRPN_DISCONNECT, "", 0);
	assert_int_equal(take_all(s, true), -TRACK_FAULT_FORMAT);
	assert_false(s->out.ended);
	vrpn_name(&s->bytes, TRACK_VRPN_SENDER, DEVICE, "Another");
	assert_int_equal(take_all(s, true), -TRACK_FAULT_FORMAT);
	assert_true(s->state.there);
}

/* ---- bodies ---- */

static void poses(void **state)
{
	static const double q[4] = { 0.1, -0.2, 0.3, 0.927361849549570375 }, zero[4] = { 0 };
	struct session *s = *state;
	uint8_t body[72] = { 0 };

	vrpn_pose_body(body, 31, -1.5, q);
	for (size_t len = 0; len <= sizeof body; len++)
		assert_int_equal(take_body(s, POSE, body, len), len == 64 ? GR_OK : -TRACK_FAULT_LENGTH);
	assert_int_equal(take_body(s, POSE, body, 64), GR_OK);
	assert_int_equal(s->out.count, 1);
	assert_int_equal(s->out.reports[0].sensor, 31);
	assert_vector(s->out.reports[0].T_base_sensor.p, -1.5, 1, 2);
	for (int i = 0; i < 4; i++)
		assert_float_equal(s->out.reports[0].T_base_sensor.q[i], q[i], 1e-7);
	vrpn_pose_body(body, 32, 0, q);
	assert_int_equal(take_body(s, POSE, body, 64), -TRACK_FAULT_SENSOR);
	vrpn_pose_body(body, INT32_MAX, 0, q);
	assert_int_equal(take_body(s, POSE, body, 64), -TRACK_FAULT_SENSOR);
	vrpn_pose_body(body, -1, 0, q);
	assert_int_equal(take_body(s, POSE, body, 64), -TRACK_FAULT_FORMAT);
	for (int i = 0; i < 7; i++) {
		static const double bad[] = { NAN, INFINITY, -INFINITY, 1e300, 1001 };

		for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
			struct vrpn_bytes one = { .len = 0 };

			vrpn_pose_body(body, 0, 0, q);
			vrpn_f64(&one, bad[k]);
			memcpy(body + 8 + 8L * i, one.at, 8);
			assert_int_equal(take_body(s, POSE, body, 64), -TRACK_FAULT_POSE);
		}
	}
	/* That a quaternion is none is found where all devices' are. */
	vrpn_pose_body(body, 0, 0, zero);
	assert_int_equal(take_body(s, POSE, body, 64), GR_OK);
}

static void buttons(void **state)
{
	struct session *s = *state;
	uint8_t body[8 + 4 * 260] = { 0 };

	body[3] = 2;
	body[7] = 1;
	for (size_t len = 0; len <= 16; len++)
		assert_int_equal(take_body(s, BUTTON, body, len), len == 8 ? GR_OK : -TRACK_FAULT_LENGTH);
	assert_int_equal(take_body(s, BUTTON, body, 8), GR_OK);
	assert_int_equal(s->out.count, 1);
	assert_int_equal(s->out.reports[0].has, TRACK_BUTTONS);
	assert_int_equal(s->out.reports[0].buttons, 4);
	/* Beside the pose of any sensor, and at once for each that was seen. */
	vrpn_pose(&s->bytes, 1, DEVICE, POSE, 5, 0);
	vrpn_pose(&s->bytes, 1, DEVICE, POSE, 7, 0);
	assert_int_equal(take_all(s, false), GR_OK);
	assert_int_equal(s->out.reports[0].buttons, 4);
	assert_true(s->out.reports[0].has & TRACK_BUTTONS);
	vrpn_button(&s->bytes, DEVICE, BUTTON, 31, 1);
	assert_int_equal(take_all(s, false), GR_OK);
	assert_int_equal(s->out.count, 2);
	assert_int_equal(s->out.reports[1].sensor, 7);
	assert_int_equal(s->out.reports[1].buttons, UINT32_C(0x80000004));
	vrpn_button(&s->bytes, DEVICE, BUTTON, 2, 0);
	assert_int_equal(take_all(s, false), GR_OK);
	assert_int_equal(s->out.reports[0].buttons, UINT32_C(0x80000000));
	/* More than a layout can name. */
	vrpn_button(&s->bytes, DEVICE, BUTTON, 32, 1);
	assert_int_equal(take_all(s, false), GR_OK);
	assert_int_equal(s->out.reports[0].buttons, UINT32_C(0x80000000));
	vrpn_button(&s->bytes, DEVICE, BUTTON, 256, 1);
	assert_int_equal(take_all(s, false), -TRACK_FAULT_FORMAT);
	vrpn_button(&s->bytes, DEVICE, BUTTON, -1, 1);
	assert_int_equal(take_all(s, false), -TRACK_FAULT_FORMAT);
	/* All at once: those that are not there are up. */
	memset(body, 0, sizeof body);
	body[3] = 3;
	body[7] = body[15] = 1;
	for (size_t len = 0; len <= 24; len++)
		assert_int_equal(take_body(s, BUTTONS, body, len), len == 16 ? GR_OK : -TRACK_FAULT_LENGTH);
	assert_int_equal(take_body(s, BUTTONS, body, 16), GR_OK);
	assert_int_equal(s->out.reports[0].buttons, 5);
	body[2] = 1;
	body[3] = 0; /* 256 */
	assert_int_equal(take_body(s, BUTTONS, body, 4 + 4 * 256), GR_OK);
	body[3] = 1;
	assert_int_equal(take_body(s, BUTTONS, body, 4 + 4 * 257), -TRACK_FAULT_FORMAT);
	body[0] = 0xff;
	assert_int_equal(take_body(s, BUTTONS, body, 4), -TRACK_FAULT_FORMAT);
}

static void channels(void **state)
{
	static const double values[] = { 0.5, -0.25, 1.5, -1e30, 0, 0, 0, 1, 0.125 };
	static const double counts[] = { -1, 0.5, 129, NAN, INFINITY, 1e300 };
	struct session *s = *state;
	struct vrpn_bytes body = { .len = 0 };

	vrpn_channels(&s->bytes, DEVICE, CHANNELS, 9, values);
	assert_int_equal(take_all(s, false), GR_OK);
	assert_int_equal(s->out.reports[0].has, TRACK_AXIS_VALUES);
	assert_int_equal(s->out.reports[0].axis_count, TRACK_AXES);
	assert_float_equal(s->out.reports[0].axes[0], 0.5, 0);
	assert_float_equal(s->out.reports[0].axes[1], -0.25, 0);
	assert_float_equal(s->out.reports[0].axes[2], 1, 0);
	assert_float_equal(s->out.reports[0].axes[3], -1, 0);
	assert_float_equal(s->out.reports[0].axes[7], 1, 0);
	vrpn_channels(&s->bytes, DEVICE, CHANNELS, 1, values);
	assert_int_equal(take_all(s, false), GR_OK);
	assert_int_equal(s->out.reports[0].axis_count, 1);
	assert_float_equal(s->out.reports[0].axes[1], 0, 0);
	vrpn_f64(&body, 2);
	vrpn_f64(&body, 0);
	vrpn_f64(&body, 0);
	for (size_t len = 0; len <= 40; len++)
		assert_int_equal(take_body(s, CHANNELS, body.at, len),
				 len == 24 ? GR_OK : -TRACK_FAULT_LENGTH);
	for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
		body.len = 0;
		vrpn_f64(&body, counts[i]);
		assert_int_equal(take_body(s, CHANNELS, body.at, 8), -TRACK_FAULT_FORMAT);
	}
	vrpn_channels(&s->bytes, DEVICE, CHANNELS, 1, &(double){ NAN });
	assert_int_equal(take_all(s, false), -TRACK_FAULT_FORMAT);
	assert_float_equal(s->state.axes[0], 0, 0); /* as it was */
}

/* ---- times, and what rests ---- */

static const struct track_report *pose_at(struct session *s, uint64_t time_us, int32_t sensor,
					  bool datagram)
{
	vrpn_pose(&s->bytes, time_us, DEVICE, POSE, sensor, 0);
	assert_int_equal(take_all(s, datagram), GR_OK);
	return &s->out.reports[0];
}

static void times(void **state)
{
	const uint64_t start = UINT64_C(1700000000000000);
	struct session *s = *state;

	assert_int_equal(pose_at(s, start, 0, false)->device_ns, 0);
	assert_true(s->out.reports[0].has & TRACK_DEVICE_TIME);
	assert_int_equal(pose_at(s, start + 10, 1, false)->device_ns, 10000);
	assert_int_equal(pose_at(s, start - 10, 2, false)->device_ns, -10000);
	/* A coarse clock says the same twice; by TCP that is no duplicate. */
	assert_false(pose_at(s, start + 10, 1, false)->has & TRACK_DEVICE_TIME);
	assert_true(pose_at(s, start + 10, 1, true)->has & TRACK_DEVICE_TIME);
	/* Time of day, then 1970, then 2106: whatever it is set to, nothing overflows. */
	assert_int_equal(pose_at(s, 40000000000, 0, false)->device_ns, 0);
	assert_int_equal(pose_at(s, UINT64_C(4294967295999999), 0, false)->device_ns, 0);
	assert_int_equal(pose_at(s, 0, 0, false)->device_ns, 0);
}

static void what_rests(void **state)
{
	struct session *s = *state;

	track_vrpn_rest(&s->state, &s->out);
	assert_int_equal(s->out.count, 0);
	vrpn_button(&s->bytes, DEVICE, BUTTON, 1, 1);
	take_all(s, false);
	track_vrpn_rest(&s->state, &s->out);
	assert_int_equal(s->out.count, 1);
	assert_int_equal(s->out.reports[0].sensor, 0);
	assert_int_equal(s->out.reports[0].buttons, 2);
	assert_false(s->out.reports[0].has & TRACK_DEVICE_TIME);
	/* A tracker that says nothing has lost its sensors. */
	pose_at(s, 1, 0, false);
	track_vrpn_rest(&s->state, &s->out);
	assert_int_equal(s->out.count, 0);
}

int main(void)
{
#define WITH(test) cmocka_unit_test_setup_teardown(test, setup, teardown)
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_cookie),
		cmocka_unit_test(a_message_byte_by_byte),
		cmocka_unit_test(lengths_have_bounds),
		cmocka_unit_test(what_is_written_is_read),
		WITH(names_that_are_none),
		WITH(numbers_go_by_their_names),
		WITH(system_messages),
		WITH(poses),
		WITH(buttons),
		WITH(channels),
		WITH(times),
		WITH(what_rests),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
