/* The simulated visitor and the history of samples. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "tracking/sim.h"

#include <math.h>

#define MS GR_NS_PER_MS
#define S GR_NS_PER_S

static const struct track_sim_params plain = {
	.start_head = { { 0.1f, 1.7f, 0.2f }, { 0, 0, 0, 1 } },
	.start_wand = { { 0.3f, 1.2f, -0.2f }, { 0, 0, 0, 1 } },
	.room_min = { -1.5f, 0, -1.5f },
	.room_max = { 1.5f, 3, 1.5f },
	.rate_hz = 100,
	.seed = 1,
	.walk_radius_m = 0.8f,
	.walk_speed_m_s = 0.6f,
	.head = true,
	.wand = true,
};

static struct track_source *sim(const struct track_sim_params *params)
{
	struct track_source *source = NULL;
	struct gr_diag diag = { 0 };

	assert_int_equal(track_sim_create(&source, params, &diag), GR_OK);
	assert_int_equal(diag.count, 0);
	return source;
}

static float turn_between(const struct gr_pose *a, const struct gr_pose *b)
{
	struct gr_pose back, d;

	gr_pose_inverse(a, &back);
	gr_pose_mul(&back, b, &d);
	return 2.0f * atan2f(sqrtf(d.q[0] * d.q[0] + d.q[1] * d.q[1] + d.q[2] * d.q[2]),
			     fabsf(d.q[3]));
}

static float distance(const struct gr_pose *a, const struct gr_pose *b)
{
	return glm_vec3_distance((float *)a->p, (float *)b->p);
}

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

static struct track_sample sample_of(int64_t time_ns, float x, float heading, bool valid)
{
	struct track_sample s = { .time_ns = time_ns, .body = TRACK_HEAD, .valid = valid };

	gr_pose_heading((vec3){ x, 1, 0 }, heading, &s.T_room_body);
	return s;
}

static void test_history_empty(void **state)
{
	struct track_history h;
	struct track_sample out = { .time_ns = 99 }, lost = sample_of(S, 0, 0, false);
	bool tracked = true;

	(void)state;
	track_history_init(&h);
	assert_false(track_history_at(&h, TRACK_HEAD, S, 50 * MS, S, &out, &tracked));
	/* A body that was only ever said to be lost was never seen either. */
	assert_int_equal(track_history_add(&h, &lost, S), GR_OK);
	assert_false(track_history_at(&h, TRACK_HEAD, S, 50 * MS, S, &out, &tracked));
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
	track_history_init(&h);
	assert_int_equal(track_history_add(&h, &a, S), GR_OK);
	assert_int_equal(track_history_add(&h, &b, S), GR_OK);
	for (int i = 0; i <= 10; i++) {
		assert_true(track_history_at(&h, TRACK_HEAD, S + i * MS, 0, S, &out, &tracked));
		gr_pose_heading((vec3){ (float)i / 10, 1, 0 }, (float)i / 10, &want);
		assert_true(distance(&out.T_room_body, &want) < 1e-6f);
		assert_true(turn_between(&out.T_room_body, &want) < 1e-5f);
		assert_int_equal(out.buttons, i < 10 ? 1 : 6);
		assert_true(tracked && out.valid && out.time_ns == S + i * MS);
	}
	/* Before all that is known: the oldest. */
	assert_true(track_history_at(&h, TRACK_HEAD, 0, 0, S, &out, NULL));
	assert_true(distance(&out.T_room_body, &a.T_room_body) < 1e-6f);
	assert_false(track_history_at(&h, TRACK_WAND, S, 0, S, &out, NULL));
}

static void test_history_extrapolates_capped(void **state)
{
	struct track_history h;
	struct track_sample out;
	bool tracked;

	(void)state;
	track_history_init(&h);
	for (int i = 0; i < 200; i++) {
		struct track_sample s = sample_of(i * 10 * MS, 0.02f * (float)i, 0.01f * (float)i, true);

		if (i & 1) /* the other name of the same turn must not spoil the fit */
			for (int k = 0; k < 4; k++)
				s.T_room_body.q[k] = -s.T_room_body.q[k];
		assert_int_equal(track_history_add(&h, &s, s.time_ns), GR_OK);
	}
	for (int ahead = 0; ahead < 300; ahead += 7) {
		float steps = 199 + fminf((float)ahead, 80) / 10;
		struct gr_pose want;

		gr_pose_heading((vec3){ 0.02f * steps, 1, 0 }, 0.01f * steps, &want);
		assert_true(track_history_at(&h, TRACK_HEAD, 1990 * MS + ahead * MS, 80 * MS, 200 * MS,
					     &out, &tracked));
		assert_true(distance(&out.T_room_body, &want) < 2e-5f);
		assert_true(turn_between(&out.T_room_body, &want) < 2e-5f);
		assert_int_equal(tracked, ahead < 200);
		assert_int_equal(out.valid, ahead < 200);
	}
	/* One sample alone has no velocity. */
	track_history_init(&h);
	out = sample_of(S, 3, 0, true);
	assert_int_equal(track_history_add(&h, &out, S), GR_OK);
	assert_true(track_history_at(&h, TRACK_HEAD, 2 * S, S, S, &out, NULL));
	assert_true(out.T_room_body.p[0] == 3);
}

static void test_history_drop_out(void **state)
{
	struct track_history h;
	struct track_sample s, out;
	bool tracked;

	(void)state;
	track_history_init(&h);
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
	assert_true(track_history_at(&h, TRACK_HEAD, 10 * S, 20 * MS, S, &out, &tracked));
	assert_false(tracked);
	assert_true(fabsf(out.T_room_body.p[0] - 0.02f * 21) < 2e-5f);
	assert_true(track_history_at(&h, TRACK_HEAD, 10190 * MS, 20 * MS, S, &out, &tracked));
	assert_int_equal(out.buttons, 2);
	s = sample_of(10200 * MS, 1, 0, true);
	assert_int_equal(track_history_add(&h, &s, s.time_ns), GR_OK);
	assert_true(track_history_at(&h, TRACK_HEAD, 10200 * MS, 0, S, &out, &tracked));
	assert_true(tracked);
	assert_int_equal(h.dropped, 0);
}

static void test_history_drops(void **state)
{
	struct track_history h;
	struct track_sample good = sample_of(5 * S, 0, 0, true), s;

	(void)state;
	track_history_init(&h);
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
static void test_prediction_error(void **state)
{
	struct track_sim_params params = plain;
	struct track_source *source;
	struct track_history h;
	struct track_sample got[16], out;
	double worst = 0, square = 0, held = 0;
	int count = 0;

	(void)state;
	params.noise_position_m = 0.0005f;
	params.latency_ns = 15 * MS;
	source = sim(&params);
	track_history_init(&h);
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
		assert_true(track_history_at(&h, TRACK_HEAD, photon, 100 * MS, 500 * MS, &out, NULL));
		e = distance(&out.T_room_body, &truth);
		worst = fmax(worst, e);
		square += e * e;
		assert_true(track_history_at(&h, TRACK_HEAD, photon, 0, 500 * MS, &out, NULL));
		held = fmax(held, distance(&out.T_room_body, &truth));
		count++;
	}
	printf("# head predicted 40..50 ms ahead of its last sample: rms %.2f mm, worst %.2f mm; "
	       "held instead: worst %.2f mm\n",
	       sqrt(square / count) * 1e3, worst * 1e3, held * 1e3);
	assert_true(worst < 6e-3); /* measured 5.6 mm */
	assert_true(worst < 0.5 * held);
	track_source_destroy(&source);
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
		cmocka_unit_test(test_history_empty),
		cmocka_unit_test(test_history_mixes),
		cmocka_unit_test(test_history_extrapolates_capped),
		cmocka_unit_test(test_history_drop_out),
		cmocka_unit_test(test_history_drops),
		cmocka_unit_test(test_prediction_error),
	};
	return cmocka_run_group_tests_name("tracking", tests, NULL, NULL);
}
