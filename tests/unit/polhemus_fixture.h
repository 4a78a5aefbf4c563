/* A Polhemus tracker's driver, on the test's own thread or its own, and mocks for it. */
#ifndef GROTTO_TESTS_UNIT_POLHEMUS_FIXTURE_H
#define GROTTO_TESTS_UNIT_POLHEMUS_FIXTURE_H

#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "tests/unit/mock_polhemus.h"
#include "tests/unit/polhemus_make.h"
#include "tracking/polhemus.h"

#include <poll.h>

/* No test is so slow on any machine. */
#define PATIENCE_NS (60 * GR_NS_PER_S)

static UMockdevTestbed *bed; /* main makes it */

struct fixture {
	struct mock_polhemus mock, second;
	struct track_device *device;
	struct track_reader reader;
	struct mock_polhemus *ticked;
	pthread_t ticker;
	_Atomic bool ticks;
};

static inline int setup(void **state)
{
	*state = calloc(1, sizeof(struct fixture));
	return *state ? 0 : -1;
}

static inline void *tick(void *ctx)
{
	struct fixture *f = ctx;

	while (f->ticks) {
		mock_polhemus_tick(f->ticked);
		poll(NULL, 0, 2);
	}
	return NULL;
}

/* The device sends by itself from now on, whatever the test does. */
static inline void start_ticking(struct fixture *f, struct mock_polhemus *mock)
{
	f->ticked = mock;
	f->ticks = true;
	assert_int_equal(pthread_create(&f->ticker, NULL, tick, f), 0);
}

static inline void stop_ticking(struct fixture *f)
{
	if (f->ticks) {
		f->ticks = false;
		pthread_join(f->ticker, NULL);
	}
}

static inline void gone(struct mock_polhemus *mock)
{
	if (mock->usb)
		mock_polhemus_unplug(mock);
}

static inline int teardown(void **state)
{
	struct fixture *f = *state;

	track_device_destroy(&f->device);
	stop_ticking(f);
	gone(&f->mock);
	gone(&f->second);
	mock_polhemus_finish(&f->mock);
	mock_polhemus_finish(&f->second);
	free(f);
	return 0;
}

static inline void create(struct fixture *f, struct track_polhemus_params params)
{
	if (!params.rate_hz)
		params.rate_hz = 240;
	assert_int_equal(track_polhemus_create(&f->device, &params, &gr_clock_monotonic), GR_OK);
}

static inline void create_model(struct fixture *f, enum track_polhemus_model model)
{
	create(f, (struct track_polhemus_params){ .model = model });
}

static inline struct track_status status_of(const struct fixture *f)
{
	struct track_status status;

	track_device_status(f->device, &status);
	return status;
}

static inline struct track_counters counters_of(const struct fixture *f)
{
	struct track_counters counters;

	track_device_counters(f->device, &counters);
	return counters;
}

static inline void until(struct fixture *f, enum track_state wanted)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + PATIENCE_NS;

	do {
		track_device_turn(f->device, 20);
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
	} while (status_of(f).state != wanted);
}

static inline void assert_why(const struct fixture *f, const char *part)
{
	const struct track_status status = status_of(f);

	if (!strstr(status.why, part))
		fail_msg("\"%s\" is not in \"%s\"", part, status.why);
}

/* Of a state that it is in already for another reason. */
static inline void until_why(struct fixture *f, const char *part)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + PATIENCE_NS;

	while (!strstr(status_of(f).why, part)) {
		track_device_turn(f->device, 20);
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
	}
}

static inline struct track_report next(struct fixture *f)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + PATIENCE_NS;
	struct track_report r;

	while (track_device_take(f->device, &f->reader, &r, 1) == 0) {
		track_device_turn(f->device, 20);
		assert_true(gr_clock_now(&gr_clock_monotonic) < end_ns);
	}
	return r;
}

/* The place that make_place gives, in the base's axes. */
static inline void assert_made(const struct track_report *r, uint32_t frame)
{
	float place[3], turn[4];

	make_place(r->sensor, frame, place, turn);
	assert_int_equal(r->has & (TRACK_POSITION | TRACK_ORIENTATION | TRACK_DEVICE_TIME),
			 TRACK_POSITION | TRACK_ORIENTATION | TRACK_DEVICE_TIME);
	assert_vector(r->T_base_sensor.p, (double)place[1], -(double)place[2], -(double)place[0]);
	assert_vector(r->T_base_sensor.q, (double)turn[2], -(double)turn[3], -(double)turn[1]);
	assert_true(fabsf(r->T_base_sensor.q[3] - turn[0]) < 1e-6f);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

#endif
