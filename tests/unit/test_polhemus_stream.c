/* What Polhemus' trackers send as a stream, and over time: frames, rates, sensors. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "tests/unit/polhemus_make.h"
#include "tracking/device_clock.h"
#include "tracking/polhemus_reports.h"
#include "tracking/polhemus_stream.h"

#define PERIOD_NS (GR_NS_PER_S / 240)

/* ---- the stream ---- */

struct harvest {
	uint32_t frames[64]; /* the numbers of the poses that were found */
	size_t count, others, checksums, formats;
};

static void harvest(struct track_polhemus_stream *s, struct harvest *h)
{
	struct track_liberty_pose liberty;
	struct track_viper_pose viper;
	const uint8_t *frame;
	size_t len;
	int r;

	while ((r = track_polhemus_stream_next(s, &frame, &len)) != GR_NOTHING) {
		h->checksums += r == -TRACK_FAULT_CHECKSUM;
		h->formats += r == -TRACK_FAULT_FORMAT;
		if (r != GR_OK)
			continue;
		assert_true(h->count < 64);
		if (s->style == TRACK_POLHEMUS_VIPER && track_viper_pose(frame, len, &viper) == GR_OK)
			h->frames[h->count++] = viper.frame;
		else if (s->style == TRACK_POLHEMUS_LIBERTY &&
			 track_liberty_pose(frame, len, &liberty) == GR_OK)
			h->frames[h->count++] = liberty.frame;
		else
			h->others++;
	}
}

/* In packets of these sizes in turn. */
static struct harvest feed(enum track_polhemus_style style, const uint8_t *bytes, size_t len,
			   size_t first, size_t then)
{
	struct track_polhemus_stream *s = malloc(sizeof *s);
	struct harvest h = { 0 };
	size_t size = first;

	track_polhemus_stream_begin(s, style);
	while (len > 0) {
		const size_t n = size < len ? size : len;
		uint8_t *packet = unit_copy(bytes, n);

		assert_int_equal(track_polhemus_stream_push(s, packet, n), n);
		free(packet);
		harvest(s, &h);
		bytes += n;
		len -= n;
		size = then;
	}
	free(s);
	return h;
}

struct text {
	uint8_t bytes[8192];
	size_t len;
};

static void add(struct text *t, const void *bytes, size_t len)
{
	memcpy(t->bytes + t->len, bytes, len);
	t->len += len;
}

static void add_frame(struct text *t, enum track_polhemus_style style, uint32_t number)
{
	uint8_t bytes[MAKE_VIPER_MOST];
	size_t len;

	if (style == TRACK_POLHEMUS_VIPER)
		len = make_viper_pose(bytes, number, 7);
	else
		len = make_liberty_pose(bytes, "LY", 'C', number % 16, number, 100, true);
	add(t, bytes, len);
}

static void frames_are_found_however_they_are_split(void **state)
{
	(void)state;
	for (int style = 0; style < 2; style++) {
		struct text t = { .len = 0 };
		uint8_t reply[MAKE_VIPER_MOST];

		for (uint32_t i = 0; i < 20; i++) {
			add_frame(&t, (enum track_polhemus_style)style, i);
			/* What answers a command comes between. */
			if (i % 4 == 0 && style == TRACK_POLHEMUS_VIPER)
				add(&t, reply, make_viper_reply(reply, 7, TRACK_VIPER_ACK, NULL, 0));
			else if (i % 4 == 0)
				add(&t, "LY\0\x15 \0\4\0\3\0\1\0", 12);
			else if (i % 4 == 1 && style == TRACK_POLHEMUS_LIBERTY)
				add(&t, "\r\nPATRIOT LIBERTY Rev. LY1\r\n", 28);
		}
		for (size_t first = 1; first < 200; first++)
			for (size_t then = 1; then <= 512; then = then * 2 + first % 3) {
				const struct harvest h = feed((enum track_polhemus_style)style,
							      t.bytes, t.len, first, then);

				assert_int_equal(h.count, 20);
				assert_int_equal(h.others, 5);
				assert_int_equal(h.checksums + h.formats, 0);
				for (uint32_t i = 0; i < 20; i++)
					assert_int_equal(h.frames[i], i);
			}
	}
}

static void a_stream_that_is_joined_is_followed_from_the_next_frame(void **state)
{
	(void)state;
	for (int style = 0; style < 2; style++) {
		struct text t = { .len = 0 };
		size_t frame;

		add_frame(&t, (enum track_polhemus_style)style, 0);
		frame = t.len;
		for (uint32_t i = 1; i < 10; i++)
			add_frame(&t, (enum track_polhemus_style)style, i);
		for (size_t from = 1; from < frame; from++) {
			const struct harvest h = feed((enum track_polhemus_style)style,
						      t.bytes + from, t.len - from, 64, 64);

			assert_int_equal(h.count, 9);
			assert_int_equal(h.frames[0], 1);
			assert_int_equal(h.checksums + h.formats, 0); /* nobody's fault */
		}
	}
}

static void what_is_damaged_costs_itself_alone(void **state)
{
	struct unit_random random = unit_random_start("damage");
	size_t lost = 0, told = 0;

	(void)state;
	for (int round = 0; round < 2000; round++) {
		const int style = round % 2;
		struct text t = { .len = 0 };
		struct harvest h;
		size_t frame, at;

		for (uint32_t i = 0; i < 20; i++)
			add_frame(&t, (enum track_polhemus_style)style, i);
		frame = t.len / 20;
		/* A hole: bytes that never came, within one frame. */
		at = 5 * frame + unit_random_u32(&random) % (frame - 1);
		const size_t left = 6 * frame - at;
		const size_t hole = 1 + unit_random_u32(&random) % (left < 40 ? left : 40);
		memmove(t.bytes + at, t.bytes + at + hole, t.len - at - hole);
		t.len -= hole;
		h = feed((enum track_polhemus_style)style, t.bytes, t.len, 64, 64);
		/* Without a checksum, the one before such a hole is not believed either. */
		lost += 20 - h.count;
		told += h.checksums + h.formats > 0 || h.others > 0;
		assert_true(h.count >= (style == TRACK_POLHEMUS_VIPER ? 19u : 18u));
		assert_true(h.count < 20 || style == TRACK_POLHEMUS_LIBERTY);
		assert_int_equal(h.frames[h.count - 1], 19);
	}
	printf("# 2000 holes: %zu frames lost, %zu holes seen\n", lost, told);
}

static void a_length_from_outside_is_not_waited_for(void **state)
{
	struct text t = { .len = 0 };
	struct harvest h;

	(void)state;
	/* "VPRP" and a size of 4 GB, of 3, of just under a kilobyte; then real ones. */
	add(&t, "VPRP\xff\xff\xff\xff", 8);
	add(&t, "VPRC\3\0\0\0", 8);
	add(&t, "VPRP\xe0\3\0\0", 8);
	for (uint32_t i = 0; i < 20; i++)
		add_frame(&t, TRACK_POLHEMUS_VIPER, i);
	h = feed(TRACK_POLHEMUS_VIPER, t.bytes, t.len, 64, 64);
	assert_int_equal(h.count, 20);
	/* Told once where frames were before. */
	t.len = 0;
	add_frame(&t, TRACK_POLHEMUS_VIPER, 0);
	add(&t, "garbage and VPRP and more of that", 33);
	add_frame(&t, TRACK_POLHEMUS_VIPER, 1);
	h = feed(TRACK_POLHEMUS_VIPER, t.bytes, t.len, 7, 7);
	assert_int_equal(h.count, 2);
	assert_int_equal(h.formats, 1);
	assert_int_equal(h.checksums, 0);
	/* As much as there is room for. */
	struct track_polhemus_stream *s = malloc(sizeof *s);
	track_polhemus_stream_begin(s, TRACK_POLHEMUS_VIPER);
	assert_int_equal(track_polhemus_stream_push(s, t.bytes, 2000), 2000);
	assert_int_equal(track_polhemus_stream_push(s, t.bytes, 2000), 48);
	free(s);
}

/* ---- times and sensors ---- */

struct frames {
	struct track_polhemus_state state;
	int64_t now_ns;
	uint64_t missed;
	uint32_t lost;
};

static struct frames begin(double rate_hz)
{
	struct frames f = { .now_ns = GR_NS_PER_S };

	track_polhemus_begin(&f.state, rate_hz);
	return f;
}

static int64_t tell(struct frames *f, uint32_t number, uint32_t sensors)
{
	struct track_report report;
	uint64_t missed;

	f->lost = track_polhemus_frame(&f->state, number, f->now_ns, &missed);
	f->missed += missed;
	for (unsigned i = 0; i < 16; i++)
		if (sensors >> i & 1)
			track_polhemus_report(&f->state,
					      &(struct track_polhemus_sensor){ .sensor = i }, &report);
	return f->state.device_ns;
}

static void time_is_the_frames_number(void **state)
{
	struct frames f = begin(240);
	int64_t start_ns = 0, ns;

	(void)state;
	/* Across the counter's wrap, with a hole of 9 and a burst of 8. */
	for (uint32_t i = 0; i < 1000; i++) {
		if (i >= 500 && i < 509)
			continue;
		f.now_ns = GR_NS_PER_S + (i / 100 % 2 ? i : i / 8 * 8) * PERIOD_NS;
		ns = tell(&f, UINT32_MAX - 300 + i, 1);
		if (i == 0)
			start_ns = ns;
		assert_int_equal(ns - start_ns, i * f.state.period_ns);
	}
	assert_int_equal(f.missed, 9);
	assert_int_equal(f.state.frame, UINT64_C(0xffffffff) - 300 + 999);
}

static void a_count_that_begins_anew_is_a_step(void **state)
{
	struct frames f = begin(240);
	int64_t last_ns = 0;

	(void)state;
	for (uint32_t i = 0; i < 100; i++, f.now_ns += PERIOD_NS)
		last_ns = tell(&f, 100000 + i, 1);
	assert_true(tell(&f, 3, 1) - last_ns > TRACK_CLOCK_STEP_NS);
	last_ns = f.state.device_ns;
	f.now_ns += PERIOD_NS;
	assert_int_equal(tell(&f, 4, 1) - last_ns, f.state.period_ns);
	/* Forward, by more than the time explains. */
	f.now_ns += PERIOD_NS;
	assert_true(tell(&f, 5000, 1) - f.state.device_ns == 0);
	assert_int_equal(f.missed, 0);
	/* A pause that the time does explain is a gap. */
	f.now_ns += 100 * PERIOD_NS;
	tell(&f, 5100, 1);
	assert_int_equal(f.missed, 99);
	/* Told to begin again: time goes on. */
	last_ns = f.state.device_ns;
	track_polhemus_begin(&f.state, 240);
	assert_true(tell(&f, 0, 1) - last_ns > TRACK_CLOCK_STEP_NS);
}

static void a_rate_that_is_another_is_found(void **state)
{
	static const double rates_hz[] = { 30, 60, 94, 120, 188, 240, 480, 960 };

	(void)state;
	for (size_t k = 0; k < sizeof rates_hz / sizeof *rates_hz; k++) {
		struct frames f = begin(240);
		int steps = 0;
		int64_t last_ns = 0;

		for (uint32_t i = 0; i < 5 * rates_hz[k]; i++) {
			/* Held up for 100 ms each two thirds of a second. */
			const int64_t at_ns = (int64_t)(i * 1e9 / rates_hz[k]);
			const int64_t in_ns = at_ns % 660000000;

			f.now_ns = GR_NS_PER_S + at_ns + (in_ns < 100000000 ? 100000000 - in_ns : 0);
			const int64_t ns = tell(&f, i, 1);
			steps += i > 0 && ns - last_ns > TRACK_CLOCK_STEP_NS;
			last_ns = ns;
		}
		assert_int_equal(f.state.period_ns, (int64_t)(1e9 / rates_hz[k] + 0.5));
		assert_int_equal(steps, rates_hz[k] != 240);
	}
}

static void one_stall_changes_no_rate(void **state)
{
	(void)state;
	for (int64_t stall_ms = 50; stall_ms < 5000; stall_ms += 50) {
		struct frames f = begin(240);
		int64_t last_ns = 0;

		for (uint32_t i = 0; i < 10 * 240; i++) {
			const int64_t at_ns = i * PERIOD_NS;
			const int64_t until_ns = (3000 + stall_ms) * GR_NS_PER_MS;

			f.now_ns = GR_NS_PER_S +
				   (at_ns > 3 * GR_NS_PER_S && at_ns < until_ns ? until_ns : at_ns);
			const int64_t ns = tell(&f, i, 1);
			assert_true(i == 0 || ns - last_ns == f.state.period_ns);
			last_ns = ns;
		}
		assert_int_equal(f.state.period_ns, (int64_t)(1e9 / 240 + 0.5));
	}
}

static void a_sensor_that_is_pulled_is_lost_after_three_frames(void **state)
{
	struct frames f = begin(240);
	uint32_t i;

	(void)state;
	for (i = 0; i < 10; i++, f.now_ns += PERIOD_NS) {
		tell(&f, i, 0x15);
		assert_int_equal(f.lost, 0);
	}
	/* Once is a frame that was damaged. */
	tell(&f, i++, 0x05);
	for (int k = 0; k < 5; k++) {
		f.now_ns += PERIOD_NS;
		tell(&f, i++, 0x15);
		assert_int_equal(f.lost, 0);
	}
	for (int k = 0; k < 6; k++) {
		f.now_ns += PERIOD_NS;
		tell(&f, i++, 0x05);
		assert_int_equal(f.lost, k == 3 ? 0x10 : 0);
	}
	/* Back, and all of them gone. */
	for (int k = 0; k < 5; k++) {
		f.now_ns += PERIOD_NS;
		tell(&f, i++, 0x15);
		assert_int_equal(f.lost, 0);
	}
	for (int k = 0; k < 6; k++) {
		f.now_ns += PERIOD_NS;
		tell(&f, i++, 0);
		assert_int_equal(f.lost, k == 3 ? 0x15 : 0);
	}
	struct track_report report;
	track_polhemus_lost(&f.state, 4, &report);
	assert_int_equal(report.sensor, 4);
	assert_int_equal(report.has, TRACK_LOST | TRACK_DEVICE_TIME);
	assert_int_equal(report.device_ns, f.state.device_ns);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(frames_are_found_however_they_are_split),
		cmocka_unit_test(a_stream_that_is_joined_is_followed_from_the_next_frame),
		cmocka_unit_test(what_is_damaged_costs_itself_alone),
		cmocka_unit_test(a_length_from_outside_is_not_waited_for),
		cmocka_unit_test(time_is_the_frames_number),
		cmocka_unit_test(a_count_that_begins_anew_is_a_step),
		cmocka_unit_test(a_rate_that_is_another_is_found),
		cmocka_unit_test(one_stall_changes_no_rate),
		cmocka_unit_test(a_sensor_that_is_pulled_is_lost_after_three_frames),
	};

	return cmocka_run_group_tests_name("polhemus_stream", tests, NULL, NULL);
}
