/* The history of samples, and how well it predicts the simulated visitor. */
#include "tests/unit/visitor.h"

#include "base/clock.h"
#include "base/result.h"
#include "tracking/window.h"

#define MS GR_NS_PER_MS
#define S GR_NS_PER_S

static struct track_sample sample_of(int64_t time_ns, float x, float heading, bool valid)
{
	struct track_sample s = { .time_ns = time_ns, .body = TRACK_HEAD, .valid = valid };

	gr_pose_heading((vec3){ x, 1, 0 }, heading, &s.T_room_body);
	return s;
}

static const struct track_filter_params *filters(enum track_filter_kind kind)
{
	static struct track_filter_params params[TRACK_BODIES];

	for (int body = 0; body < TRACK_BODIES; body++) {
		params[body] = track_filter_defaults(kind);
		params[body].position.gate = params[body].orientation.gate = 0;
		params[body].position.noise = 0.5e-3;
	}
	return params;
}

static void test_history_empty(void **state)
{
	struct track_history h;
	struct track_sample out = { .time_ns = 99 }, lost = sample_of(S, 0, 0, false);
	bool tracked = true;

	(void)state;
	track_history_init(&h, filters(TRACK_FILTER_NONE));
	assert_false(track_history_at(&h, TRACK_HEAD, S, S, &out, &tracked));
	/* A body that was only ever said to be lost was never seen either. */
	assert_int_equal(track_history_add(&h, &lost, S), GR_OK);
	assert_false(track_history_at(&h, TRACK_HEAD, S, S, &out, &tracked));
	assert_true(out.time_ns == 99 && tracked);
}

static void test_history_mixes(void **state)
{
	struct track_history h;
	struct track_sample a = sample_of(S, 0, 0, true), b = sample_of(S + 10 * MS, 1, 1, true), out;
	struct gr_pose want;
	bool tracked;

	(void)state;
	a.buttons = 1;
	b.buttons = 6;
	track_history_init(&h, filters(TRACK_FILTER_NONE));
	assert_int_equal(track_history_add(&h, &a, S), GR_OK);
	assert_int_equal(track_history_add(&h, &b, S), GR_OK);
	for (int i = 0; i <= 10; i++) {
		assert_true(track_history_at(&h, TRACK_HEAD, S + i * MS, S, &out, &tracked));
		gr_pose_heading((vec3){ (float)i / 10, 1, 0 }, (float)i / 10, &want);
		assert_true(distance(&out.T_room_body, &want) < 1e-6f);
		assert_true(turn_between(&out.T_room_body, &want) < 1e-5f);
		assert_int_equal(out.buttons, i < 10 ? 1 : 6);
		assert_true(tracked && out.valid && out.time_ns == S + i * MS);
	}
	/* Before all that is known: the oldest. */
	assert_true(track_history_at(&h, TRACK_HEAD, 0, S, &out, NULL));
	assert_true(distance(&out.T_room_body, &a.T_room_body) < 1e-6f);
	assert_false(track_history_at(&h, TRACK_WAND, S, S, &out, NULL));
}

static void test_history_goes_on_and_comes_back(void **state)
{
	struct track_history h;
	struct track_sample out;
	bool tracked;

	(void)state;
	track_history_init(&h, filters(TRACK_FILTER_NONE));
	for (int i = 0; i < 200; i++) {
		struct track_sample s = sample_of(i * 10 * MS, 0.02f * (float)i, 0.01f * (float)i, true);

		if (i & 1) /* the other name of the same turn must not spoil the fit */
			for (int k = 0; k < 4; k++)
				s.T_room_body.q[k] = -s.T_room_body.q[k];
		assert_int_equal(track_history_add(&h, &s, s.time_ns), GR_OK);
	}
	for (int ahead = 0; ahead < 300; ahead += 7) {
		/* 60 ms along the velocity, and back to the last sample from there on */
		float over = ahead > 60 ? (float)(ahead - 60) / 60 : 0;
		float steps = 199 + 6 * (over > 0 ? (1 + 2 * over) * expf(-over) : (float)ahead / 60);
		struct gr_pose want;

		gr_pose_heading((vec3){ 0.02f * steps, 1, 0 }, 0.01f * steps, &want);
		assert_true(track_history_at(&h, TRACK_HEAD, 1990 * MS + ahead * MS, 200 * MS, &out,
					     &tracked));
		assert_true(distance(&out.T_room_body, &want) < 2e-5f);
		assert_true(turn_between(&out.T_room_body, &want) < 2e-5f);
		assert_int_equal(tracked, ahead < 200);
		assert_int_equal(out.valid, ahead < 200);
	}
	/* One sample alone has no velocity. */
	track_history_init(&h, filters(TRACK_FILTER_NONE));
	out = sample_of(S, 3, 0, true);
	assert_int_equal(track_history_add(&h, &out, S), GR_OK);
	assert_true(track_history_at(&h, TRACK_HEAD, 2 * S, S, &out, NULL));
	assert_true(out.T_room_body.p[0] == 3);
}

static void test_history_drop_out(void **state)
{
	struct track_history h;
	struct track_sample s, out;
	bool tracked;

	(void)state;
	track_history_init(&h, filters(TRACK_FILTER_NONE));
	for (int i = 0; i < 20; i++) {
		s = sample_of(i * 10 * MS, 0.02f * (float)i, 0, true);
		assert_int_equal(track_history_add(&h, &s, s.time_ns), GR_OK);
	}
	/* Lost for ten seconds: the last good samples stay known. */
	for (int i = 20; i < 1020; i++) {
		s = sample_of(i * 10 * MS, NAN, 0, false);
		s.buttons = 2;
		assert_int_equal(track_history_add(&h, &s, s.time_ns), GR_OK);
	}
	assert_true(track_history_at(&h, TRACK_HEAD, 10 * S, S, &out, &tracked));
	assert_false(tracked);
	assert_true(fabsf(out.T_room_body.p[0] - 0.02f * 19) < 2e-5f);
	assert_true(track_history_at(&h, TRACK_HEAD, 10190 * MS, S, &out, &tracked));
	assert_int_equal(out.buttons, 2);
	s = sample_of(10200 * MS, 1, 0, true);
	assert_int_equal(track_history_add(&h, &s, s.time_ns), GR_OK);
	assert_true(track_history_at(&h, TRACK_HEAD, 10200 * MS, S, &out, &tracked));
	assert_true(tracked);
	/* What was shown goes over to what is seen again. */
	assert_true(fabsf(out.T_room_body.p[0] - 0.02f * 19) < 2e-5f);
	for (int i = 1; i < 30; i++) {
		s = sample_of((10200 + 10 * i) * MS, 1, 0, true);
		assert_int_equal(track_history_add(&h, &s, s.time_ns), GR_OK);
	}
	assert_true(track_history_at(&h, TRACK_HEAD, 10450 * MS, S, &out, &tracked));
	assert_true(fabsf(out.T_room_body.p[0] - 1) < 2e-5f);
	assert_int_equal(h.dropped, 0);
}

static void test_history_drops(void **state)
{
	struct track_history h;
	struct track_sample good = sample_of(5 * S, 0, 0, true), s;

	(void)state;
	track_history_init(&h, filters(TRACK_FILTER_NONE));
	assert_int_equal(track_history_add(&h, &good, 5 * S), GR_OK);
	assert_int_equal(track_history_add(&h, &good, 5 * S), GR_ERR_RANGE);
	s = sample_of(4 * S, 0, 0, true);
	assert_int_equal(track_history_add(&h, &s, 5 * S), GR_ERR_RANGE);
	s = sample_of(7 * S, 0, 0, true);
	assert_int_equal(track_history_add(&h, &s, 6 * S - 1), GR_ERR_RANGE);
	s = sample_of(6 * S, NAN, 0, true);
	assert_int_equal(track_history_add(&h, &s, 6 * S), GR_ERR_FORMAT);
	s = sample_of(6 * S, 0, 0, true);
	s.T_room_body.q[3] = 2;
	assert_int_equal(track_history_add(&h, &s, 6 * S), GR_ERR_FORMAT);
	s = sample_of(6 * S, 0, 0, true);
	s.body = (enum track_body)7;
	assert_int_equal(track_history_add(&h, &s, 6 * S), GR_ERR_RANGE);
	s.body = (enum track_body)-1;
	assert_int_equal(track_history_add(&h, &s, 6 * S), GR_ERR_RANGE);
	assert_int_equal(h.dropped, 7);
	s = sample_of(7 * S, 0, 0, true);
	assert_int_equal(track_history_add(&h, &s, 6 * S), GR_OK);
	assert_int_equal(h.count[TRACK_HEAD], 2);
	/* The last and the first time there are. */
	s = sample_of(INT64_MAX, 0, 0, true);
	assert_int_equal(track_history_add(&h, &s, 0), GR_ERR_RANGE);
	s = sample_of(INT64_MIN, 0, 0, true);
	assert_int_equal(track_history_add(&h, &s, INT64_MAX), GR_ERR_RANGE);
}

/* What the master does: the noisy, late samples of a visitor, asked ahead of time. */
static void predict(enum track_filter_kind kind, double most_m)
{
	struct track_sim_params params = plain;
	struct track_source *source;
	struct track_history h;
	struct track_sample got[16], out;
	double worst = 0, square = 0, held = 0;
	int count = 0;

	params.noise_position_m = 0.0005f;
	params.latency_ns = 15 * MS;
	source = sim(&params);
	track_history_init(&h, filters(kind));
	for (int64_t now = 0; now < 60 * S; now += 16666667) {
		int n = track_poll(source, now, got, 16);
		int64_t photon = now + 25 * MS;
		struct gr_pose truth;
		double e;

		for (int i = 0; i < n; i++)
			assert_int_equal(track_history_add(&h, &got[i], now), GR_OK);
		if (now < S)
			continue;
		track_sim_truth(source, TRACK_HEAD, photon, &truth);
		assert_true(track_history_at(&h, TRACK_HEAD, photon, 500 * MS, &out, NULL));
		e = distance(&out.T_room_body, &truth);
		worst = fmax(worst, e);
		square += e * e;
		held = fmax(held, distance(&got[n - 1 - (got[n - 1].body != TRACK_HEAD)].T_room_body, &truth));
		count++;
	}
	printf("# %s: head predicted 40..50 ms ahead of its last sample: rms %.2f mm, worst %.2f mm; "
	       "held instead: worst %.2f mm\n",
	       track_filter_name(kind), sqrt(square / count) * 1e3, worst * 1e3, held * 1e3);
	assert_true(worst < most_m);
	assert_true(worst < 0.5 * held);
	track_source_destroy(&source);
}

static void test_prediction_error(void **state)
{
	(void)state;
	predict(TRACK_FILTER_NONE, 6e-3);   /* measured 5.6 mm */
	predict(TRACK_FILTER_KALMAN, 6e-3); /* 5.6 mm */
	predict(TRACK_FILTER_ONE_EURO, 12e-3);
	predict(TRACK_FILTER_EXPONENTIAL, 12e-3);
}

static struct track_sample ask_window(struct track_source *source, int64_t now_ns)
{
	struct track_sample sample = { .valid = false };

	assert_int_equal(track_poll(source, now_ns, &sample, 1), 1);
	assert_true(sample.valid && sample.body == TRACK_WAND && gr_pose_valid(&sample.T_room_body));
	return sample;
}

/* Keyboard and mouse of the nodes' windows. */
static void windows_make_a_wand(void **state)
{
	const struct gr_pose head = { { 0, 1.2f, 0 }, { 0, 0, 0, 1 } };
	const struct gr_pose start = { { 0, 1.0f, -0.4f }, { 0, 0, 0, 1 } };
	struct track_window_input in = { .buttons = 1 };
	const vec3 ahead = { 0, 0, -1 };
	struct track_source *source;
	struct track_sample sample;
	vec3 to;

	(void)state;
	assert_int_equal(track_window_create(&source, &head, &start), GR_OK);
	assert_int_equal(track_poll(source, 100, &sample, 1), 0); /* nobody has touched a window */
	track_window_feed(source, 3, &in, 200);
	sample = ask_window(source, 300);
	assert_int_equal(sample.buttons, 1);
	assert_vector(sample.T_room_body.p, 0, 1, (double)-0.4f);
	assert_int_equal(track_poll(source, 300, &sample, 1), 0); /* times ascend */
	in.pointer[0] = 1;
	in.pointer[1] = 1;
	in.wheel = 4;
	in.axes[1] = -1;
	track_window_feed(source, 3, &in, 400);
	sample = ask_window(source, 500);
	gr_pose_direction(&sample.T_room_body, ahead, to);
	/* 45 degrees to the right and 30 up, twice as far away. */
	assert_vector(to, sin(M_PI / 4) * cos(M_PI / 6), sin(M_PI / 6), -cos(M_PI / 4) * cos(M_PI / 6));
	assert_vector(sample.T_room_body.p, 0, 1, -0.8);
	assert_int_equal(sample.axis_count, 2);
	assert_float_equal(sample.axes[1], -1, 0);
	/* Another window's keys count as well; the pointer is whose moved last. */
	in = (struct track_window_input){ .buttons = 4, .axes = { 1, -1 } };
	track_window_feed(source, 5, &in, 600);
	sample = ask_window(source, 700);
	assert_int_equal(sample.buttons, 5);
	assert_float_equal(sample.axes[0], 1, 0);
	assert_float_equal(sample.axes[1], -1, 0); /* not beyond */
	/* The wheel ends somewhere, and a window that falls silent holds nothing. */
	in.wheel = -1000;
	track_window_feed(source, 5, &in, 800);
	sample = ask_window(source, TRACK_WINDOW_SILENT_NS + 500);
	assert_vector(sample.T_room_body.p, 0, 1, -0.1);
	assert_int_equal(sample.buttons, 4);
	sample = ask_window(source, TRACK_WINDOW_SILENT_NS + 900);
	assert_int_equal(sample.buttons, 0);
	track_window_feed(source, TRACK_WINDOWS, &in, TRACK_WINDOW_SILENT_NS + 950);
	assert_int_equal(ask_window(source, TRACK_WINDOW_SILENT_NS + 1000).buttons, 0);
	track_source_destroy(&source);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(windows_make_a_wand),
		cmocka_unit_test(test_history_empty),
		cmocka_unit_test(test_history_mixes),
		cmocka_unit_test(test_history_goes_on_and_comes_back),
		cmocka_unit_test(test_history_drop_out),
		cmocka_unit_test(test_history_drops),
		cmocka_unit_test(test_prediction_error),
	};
	return cmocka_run_group_tests_name("tracking", tests, NULL, NULL);
}
