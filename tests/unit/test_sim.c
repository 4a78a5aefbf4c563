/* The simulated visitor. */
#include "tests/unit/visitor.h"

#include "base/clock.h"

#define MS GR_NS_PER_MS
#define S GR_NS_PER_S

static void assert_same_sample(const struct track_sample *a, const struct track_sample *b)
{
	assert_true(a->time_ns == b->time_ns);
	assert_int_equal(a->body, b->body);
	assert_int_equal(a->valid, b->valid);
	assert_int_equal(a->buttons, b->buttons);
	assert_memory_equal(&a->T_room_body, &b->T_room_body, sizeof a->T_room_body);
}

static void test_sim_starts_at_the_start(void **state)
{
	struct track_source *source = sim(&plain);
	struct gr_pose pose;

	(void)state;
	track_sim_truth(source, TRACK_HEAD, 0, &pose);
	assert_true(distance(&pose, &plain.start_head) < 1e-6f);
	assert_true(turn_between(&pose, &plain.start_head) < 1e-6f);
	track_sim_truth(source, TRACK_WAND, 0, &pose);
	assert_true(distance(&pose, &plain.start_wand) < 1e-6f);
	assert_true(turn_between(&pose, &plain.start_wand) < 1e-6f);
	track_source_destroy(&source);
	assert_null(source);
	track_source_destroy(&source);
}

/* Whatever the rhythm and the size of the reads, the same samples arrive. */
static void test_sim_is_deterministic(void **state)
{
	struct track_sim_params params = plain;
	struct track_source *a, *b;
	struct track_sample in_a[2048], in_b[2048];
	int na = 0, nb = 0;
	struct unit_random random = unit_random_start("sim rhythm");

	(void)state;
	params.noise_position_m = 0.001f;
	params.noise_angle_rad = 0.01f;
	params.dropout_per_s = 0.5f;
	params.dropout_ns = 150 * MS;
	params.latency_ns = 13 * MS;
	a = sim(&params);
	b = sim(&params);
	for (int64_t now = 0; now <= 10 * S; now += MS)
		na += track_poll(a, now, in_a + na, 2048 - na);
	for (int64_t now = 0; now <= 10 * S;) {
		int room = 1 + (int)unit_random_range(&random, 0, 4);
		int got = track_poll(b, now, in_b + nb, room);

		nb += got;
		if (got < room)
			now += (int64_t)unit_random_range(&random, 0, 200e6);
		if (now > 10 * S && now < 11 * S)
			now = 10 * S;
		if (got < room && now == 10 * S)
			break;
	}
	nb += track_poll(b, 10 * S, in_b + nb, 2048 - nb);
	assert_int_equal(na, nb);
	assert_int_equal(na, 2 * 999); /* times 0 to 9.98 s */
	for (int i = 0; i < na; i++)
		assert_same_sample(&in_a[i], &in_b[i]);
	track_source_destroy(&a);
	track_source_destroy(&b);
}

static void test_sim_stays_inside(void **state)
{
	struct unit_random random = unit_random_start("sim bounds");

	(void)state;
	for (int round = 0; round < 60; round++) {
		struct track_sim_params params = plain;
		struct track_source *source;
		float furthest = 0;
		vec3 start;

		for (int i = 0; i < 3; i++) {
			params.room_min[i] = (float)unit_random_range(&random, -3, 0);
			params.room_max[i] = params.room_min[i] + (float)unit_random_range(&random, 0.1, 4);
			start[i] =
				glm_lerp(params.room_min[i], params.room_max[i],
					 (float)unit_random_range(&random, 0, 1));
		}
		gr_pose_heading(start, (float)unit_random_range(&random, -4, 4), &params.start_head);
		params.walk_radius_m = (float)unit_random_range(&random, 0, 5);
		params.wand = false;
		source = sim(&params);
		for (int64_t t = 0; t < 100 * S; t += 37 * MS) {
			struct gr_pose pose;

			track_sim_truth(source, TRACK_HEAD, t, &pose);
			assert_true(gr_pose_valid(&pose));
			for (int i = 0; i < 3; i++) {
				float margin = fminf(0.25f, (params.room_max[i] - params.room_min[i]) / 2);
				float low = fminf(params.room_min[i] + margin, start[i]);
				float high = fmaxf(params.room_max[i] - margin, start[i]);

				assert_true(pose.p[i] >= low - 1e-5f && pose.p[i] <= high + 1e-5f);
			}
			furthest = fmaxf(furthest, distance(&pose, &params.start_head));
		}
		assert_true(furthest <= hypotf(params.walk_radius_m, 0.016f));
		track_source_destroy(&source);
	}
}

/* The walk is as fast as asked, closed, smooth, and uses its radius. */
static void test_sim_walks(void **state)
{
	struct track_sim_params params = plain;
	struct track_source *source;
	struct gr_pose last, pose, before = { 0 };
	double path = 0, furthest = 0, jerkiest = 0;
	const double round_s = 6.0972230 * 0.8 / 0.6;

	(void)state;
	for (int i = 0; i < 3; i++) {
		params.room_min[i] = -1000;
		params.room_max[i] = 1000;
	}
	source = sim(&params);
	track_sim_truth(source, TRACK_HEAD, 0, &last);
	for (int64_t t = MS; t <= (int64_t)(round_s * 1e9); t += MS) {
		track_sim_truth(source, TRACK_HEAD, t, &pose);
		path += hypot(pose.p[0] - last.p[0], pose.p[2] - last.p[2]);
		furthest = fmax(furthest, distance(&pose, &params.start_head));
		if (t > MS)
			for (int i = 0; i < 3; i++)
				jerkiest = fmax(jerkiest, fabs(pose.p[i] - 2 * last.p[i] + before.p[i]));
		before = last;
		last = pose;
	}
	printf("# walk: %.3f m in %.3f s, furthest %.3f m\n", path, round_s, furthest);
	assert_true(fabs(path / round_s - 0.6) < 0.005);
	assert_true(furthest > 0.79 && furthest < 0.81);
	assert_true(distance(&last, &params.start_head) < 2e-3f);
	assert_true(jerkiest < 1e-5); /* 1 ms steps: below 10 m/s^2 */
	track_source_destroy(&source);
}

static void test_sim_rate_and_latency(void **state)
{
	static const float rates[] = { 1, 59.94f, 100, 240, 1000 };

	(void)state;
	for (size_t k = 0; k < sizeof rates / sizeof *rates; k++) {
		struct track_sim_params params = plain;
		struct track_source *source;
		struct track_sample got[8];
		int64_t now = 777 * S, period = llround(1e9 / (double)rates[k]);
		int count = 0;

		params.rate_hz = rates[k];
		params.latency_ns = 42 * MS;
		params.wand = false;
		source = sim(&params);
		assert_int_equal(track_fd(source), -1);
		assert_true(track_next(source, now) == now);
		while (now < 787 * S) {
			int64_t next;
			int n = track_poll(source, now, got, 8);

			assert_in_range(n, 1, 1);
			assert_true(got[0].time_ns + 42 * MS <= now);
			assert_true(now - got[0].time_ns - 42 * MS < period);
			count++;
			next = track_next(source, now);
			assert_true(next > now);
			assert_int_equal(track_poll(source, next - 1, got, 8), 0);
			now = next;
		}
		assert_in_range(count, (int)(rates[k] * 10) - 1, (int)(rates[k] * 10) + 2);
		track_source_destroy(&source);
	}
}

static void test_sim_noise_statistics(void **state)
{
	struct track_sim_params params = plain;
	struct track_source *source;
	struct track_sample got[64];
	double sum[6] = { 0 }, square[6] = { 0 }, neighbours[6] = { 0 }, last[6] = { 0 };
	int count = 0;

	(void)state;
	params.rate_hz = 1000;
	params.noise_position_m = 0.002f;
	params.noise_angle_rad = 0.01f;
	params.wand = false;
	source = sim(&params);
	for (int64_t now = 0; now < 40 * S; now += 10 * MS) {
		int n = track_poll(source, now, got, 64);

		for (int k = 0; k < n; k++, count++) {
			struct gr_pose truth, back, error;

			track_sim_truth(source, TRACK_HEAD, got[k].time_ns, &truth);
			gr_pose_inverse(&truth, &back);
			back.p[0] = back.p[1] = back.p[2] = 0;
			gr_pose_mul(&back, &got[k].T_room_body, &error);
			for (int i = 0; i < 6; i++) {
				double e = i < 3 ? got[k].T_room_body.p[i] - truth.p[i] :
						   2 * error.q[i - 3];
				sum[i] += e;
				square[i] += e * e;
				neighbours[i] += e * last[i];
				last[i] = e;
			}
		}
	}
	assert_in_range(count, 39900, 40010);
	for (int i = 0; i < 6; i++) {
		double want = i < 3 ? 0.002 : 0.01, sigma = sqrt(square[i] / count);

		printf("# noise %d: sigma %.6f of %.3f, mean %.2e, correlation %.4f\n", i, sigma, want,
		       sum[i] / count, neighbours[i] / square[i]);
		/* Four standard errors of 40,000 independent draws. */
		assert_true(fabs(sigma / want - 1) < 4 / sqrt(2.0 * count));
		assert_true(fabs(sum[i] / count) < 4 * want / sqrt(count));
		assert_true(fabs(neighbours[i] / square[i]) < 4 / sqrt(count));
	}
	track_source_destroy(&source);
}

static void test_sim_drop_outs(void **state)
{
	struct track_sim_params params = plain;
	struct track_source *source, *late;
	struct track_sample got[64], again[64];
	int lost = 0, count = 0, begun = 0, run = 0, shortest = 1000000;
	bool was = false;

	(void)state;
	params.dropout_per_s = 0.2f;
	params.dropout_ns = 300 * MS;
	params.wand = false;
	source = sim(&params);
	for (int64_t now = 0; now < 2000 * S; now += 100 * MS) {
		int n = track_poll(source, now, got, 64);

		for (int k = 0; k < n; k++, count++) {
			bool is = !got[k].valid;

			lost += is;
			begun += is && !was;
			if (was && !is && run < shortest)
				shortest = run;
			run = is ? (was ? run + 1 : 1) : 0;
			was = is;
		}
	}
	/* Starts are a Poisson process that drop-outs overlap: lost share 1 - exp(-rate length). */
	printf("# drop-outs: %d begun, %.4f lost (expected %.4f), shortest %d samples\n", begun,
	       (double)lost / count, 1 - exp(-0.2 * 0.3), shortest);
	assert_true(fabs((double)lost / count - (1 - exp(-0.06))) < 0.012);
	assert_int_equal(shortest, 30);
	/* One who comes later finds the drop-out that is under way. */
	late = sim(&params);
	(void)track_poll(late, 1500 * S, again, 64);
	(void)track_poll(late, 1999 * S + 900 * MS, again, 64);
	for (int64_t now = 2000 * S; now < 2100 * S; now += 100 * MS) {
		int n = track_poll(source, now, got, 64);
		int m = track_poll(late, now, again, 64);

		for (int k = 1; k <= n && k <= m; k++)
			assert_same_sample(&got[n - k], &again[m - k]);
	}
	track_source_destroy(&late);
	track_source_destroy(&source);
}

static void test_sim_buttons(void **state)
{
	struct track_source *source = sim(&plain);
	struct track_sample got[64];
	int pressed[3] = { 0 }, count = 0;

	(void)state;
	for (int64_t now = 0; now < 200 * S; now += 100 * MS) {
		int n = track_poll(source, now, got, 64);

		for (int k = 0; k < n; k++) {
			if (got[k].body == TRACK_HEAD)
				assert_int_equal(got[k].buttons, 0);
			count += got[k].body == TRACK_WAND;
			for (int i = 0; i < 3; i++)
				pressed[i] += got[k].buttons == 1u << i;
			assert_true(got[k].buttons <= 4);
		}
	}
	printf("# buttons: %d %d %d of %d samples\n", pressed[0], pressed[1], pressed[2], count);
	for (int i = 0; i < 3; i++)
		assert_in_range(pressed[i], count / 100, count / 5);
	track_source_destroy(&source);
}

/* A caller who was away gets the last second, not the whole time. */
static void test_sim_backlog(void **state)
{
	struct track_source *source = sim(&plain);
	struct track_sample got[1024];

	(void)state;
	assert_int_equal(track_poll(source, 0, got, 1024), 2);
	assert_int_equal(track_poll(source, 100 * S, got, 1024), 2 * 101);
	assert_true(got[0].time_ns == 99 * S);
	assert_int_equal(track_poll(source, 100 * S, got, 1024), 0);
	assert_int_equal(track_poll(source, 0, got, 1024), 0);
	assert_int_equal(track_poll(source, 101 * S, got, 0), 0);
	assert_int_equal(track_poll(source, 101 * S, got, 1), 1);
	assert_int_equal(got[0].body, TRACK_HEAD);
	assert_int_equal(track_poll(source, 101 * S, got, 1), 1);
	assert_int_equal(got[0].body, TRACK_WAND);
	track_source_destroy(&source);
}

static void test_sim_refuses(void **state)
{
	struct track_sim_params bad[14];
	struct gr_diag diag = { 0 };
	size_t n = sizeof bad / sizeof *bad;

	(void)state;
	for (size_t i = 0; i < n; i++)
		bad[i] = plain;
	bad[0].rate_hz = 0;
	bad[1].rate_hz = NAN;
	bad[2].rate_hz = 1001;
	bad[3].noise_position_m = -1;
	bad[4].noise_angle_rad = INFINITY;
	bad[5].latency_ns = -1;
	bad[6].dropout_per_s = NAN;
	bad[7].dropout_ns = INT64_MAX;
	bad[8].walk_radius_m = -1;
	bad[9].walk_speed_m_s = NAN;
	bad[10].head = bad[10].wand = false;
	bad[11].start_head.q[3] = 0;
	bad[12].room_max[1] = bad[12].room_min[1];
	bad[13].start_head.p[2] = 5;
	for (size_t i = 0; i < n; i++) {
		struct track_source *source = NULL;

		assert_int_equal(track_sim_create(&source, &bad[i], &diag), GR_ERR_RANGE);
		assert_null(source);
		assert_true(diag.errors > 0);
		if (i < 10)
			assert_non_null(strstr(diag.items[0].text, "must be"));
		gr_diag_finish(&diag);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_sim_starts_at_the_start),
		cmocka_unit_test(test_sim_is_deterministic),
		cmocka_unit_test(test_sim_stays_inside),
		cmocka_unit_test(test_sim_walks),
		cmocka_unit_test(test_sim_rate_and_latency),
		cmocka_unit_test(test_sim_noise_statistics),
		cmocka_unit_test(test_sim_drop_outs),
		cmocka_unit_test(test_sim_buttons),
		cmocka_unit_test(test_sim_backlog),
		cmocka_unit_test(test_sim_refuses),
	};
	return cmocka_run_group_tests_name("tracking", tests, NULL, NULL);
}
