/* A person with the wand at the points of a room: what is asked, and what is taken for an answer. */
#include "tools/calibrate.h"

#include "base/clock.h"
#include "base/result.h"
#include "tracking/lever.h"
#include "tracking/still.h"

#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define BATCH 64
#define SAMPLES_LEAST 10
#define LINE 80

enum answer { ANSWER_NONE, ANSWER_MEASURE, ANSWER_SKIP, ANSWER_BACK, ANSWER_QUIT, ANSWER_GONE };

/* One who is asked: keys, and the device's buttons. */
struct asked {
	const struct calibrate *of;
	struct calibrate_reader *reader;
	uint32_t buttons; /* as they were */
	char line[LINE];  /* what was typed so far */
	size_t len;
	bool ended; /* nothing more will be typed */
};

static void pause_a_little(const struct asked *a)
{
	const int64_t ns = calibrate_reader_pause_ns(a->reader);

	(void)nanosleep(&(struct timespec){ ns / GR_NS_PER_S, ns % GR_NS_PER_S }, NULL);
}

static enum answer answer_of(const char *line)
{
	switch (line[0]) {
	case '\0': return ANSWER_MEASURE;
	case 's': return ANSWER_SKIP;
	case 'b': return ANSWER_BACK;
	case 'q': return ANSWER_QUIT;
	default: fprintf(stderr, "Enter measures, s skips, b goes back, q ends\n"); return ANSWER_NONE;
	}
}

/* A line, if one is whole by now. */
static enum answer read_keys(struct asked *a)
{
	struct pollfd keys = { .fd = STDIN_FILENO, .events = POLLIN };
	char c;

	while (!a->ended && poll(&keys, 1, 0) > 0) {
		if (read(STDIN_FILENO, &c, 1) != 1) {
			a->ended = true;
		} else if (c == '\n') {
			a->line[a->len] = '\0';
			a->len = 0;
			return answer_of(a->line);
		} else if (a->len < LINE - 1) {
			a->line[a->len++] = c;
		}
	}
	return ANSWER_NONE;
}

/* A button that goes down is Enter. */
static enum answer read_buttons(struct asked *a)
{
	struct calibrate_report reports[BATCH];
	enum answer answer = ANSWER_NONE;
	int n;

	do {
		n = calibrate_read(a->reader, reports, BATCH);
		for (int i = 0; i < n; i++) {
			if (reports[i].buttons & ~a->buttons)
				answer = ANSWER_MEASURE;
			a->buttons = reports[i].buttons;
		}
	} while (n == BATCH);
	return n < 0 ? ANSWER_GONE : answer;
}

/* Until the person says something. */
static enum answer await(struct asked *a)
{
	enum answer answer;

	for (;;) {
		answer = read_keys(a);
		if (answer == ANSWER_NONE)
			answer = read_buttons(a);
		if (answer != ANSWER_NONE)
			return answer;
		if (a->ended) {
			fprintf(stderr, "grotto trackers: the input ended before all was measured\n");
			return ANSWER_GONE;
		}
		pause_a_little(a);
	}
}

/* What is to be said of a sensor that said too little; and what it lacks. */
static bool enough(const struct asked *a, size_t count, size_t lost, bool turned)
{
	char state[300];

	if (count >= SAMPLES_LEAST && lost == 0 && turned)
		return true;
	calibrate_reader_state(a->reader, state, sizeof state);
	if (lost)
		fprintf(stderr, "  the device lost the sensor meanwhile; again\n");
	else if (count >= SAMPLES_LEAST)
		fprintf(stderr, "  the sensor says no orientation, and the arm from it is not 0; again\n");
	else
		fprintf(stderr, "  %zu reports in %.3g s, at least %d are needed (%s); again\n", count,
			a->of->seconds, SAMPLES_LEAST, state);
	return false;
}

static bool has_arm(const struct calibrate *c)
{
	const float *o = c->binding->sensor_body.position;

	return c->what == CALIBRATE_ARM || o[0] != 0 || o[1] != 0 || o[2] != 0;
}

/* A second of samples at rest. GR_OK, GR_NOTHING (said why; again), GR_ERR_IO. */
static int measure(struct asked *a, struct survey_point *point)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + (int64_t)(a->of->seconds * 1e9);
	struct still still = { 0 };
	struct calibrate_report reports[BATCH];
	size_t lost = 0;
	bool turned = true;
	int n = 0;

	while (n >= 0 && gr_clock_now(&gr_clock_monotonic) < end_ns) {
		pause_a_little(a);
		n = calibrate_read(a->reader, reports, BATCH);
		for (int i = 0; i < n; i++) {
			double at[3];

			lost += reports[i].lost;
			a->buttons = reports[i].buttons;
			if (!reports[i].placed)
				continue;
			turned = turned && (reports[i].turned || !has_arm(a->of));
			calibrate_body_at(a->of, reports[i].p, &reports[i].q, at);
			still_add(&still, reports[i].p, &reports[i].q, at);
		}
	}
	if (n < 0)
		return GR_ERR_IO;
	if (!enough(a, still.count, lost, turned))
		return GR_NOTHING;
	if (!(still_spread_m(&still) <= a->of->still_m)) {
		fprintf(stderr, "  it moved by %.1f mm (rms), at most %.1f: hold it still; again\n",
			still_spread_m(&still) * 1e3, a->of->still_m * 1e3);
		return GR_NOTHING;
	}
	memcpy(point->p, still.p, sizeof point->p);
	point->q = still_turn(&still);
	point->measured = true;
	fprintf(stderr, "  %zu samples, spread %.1f mm\n", still.count, still_spread_m(&still) * 1e3);
	return GR_OK;
}

static void ask_for(const struct calibrate *c, const struct survey_point *point, size_t i, size_t count)
{
	const bool head = c->binding->body == LAYOUT_HEAD;

	fprintf(stderr, "%zu of %zu: %s (%.3f %.3f %.3f m): %s there, hold still, press Enter%s (s b q)\n",
		i + 1, count, point->name, point->room[0], point->room[1], point->room[2],
		head ? "the middle between the eyes" : "the wand's tip", head ? "" : " or a button");
}

int calibrate_ask_points(const struct calibrate *c, struct calibrate_reader *reader,
			 struct survey_point *points, size_t count)
{
	struct asked a = { .of = c, .reader = reader };
	int r = GR_OK;

	(void)read_buttons(&a); /* what is held down already is no answer */
	for (size_t i = 0; i < count && r >= 0;) {
		enum answer answer;

		if (points[i].measured) {
			i++;
			continue;
		}
		ask_for(c, &points[i], i, count);
		answer = await(&a);
		if (answer == ANSWER_QUIT)
			return GR_NOTHING;
		if (answer == ANSWER_GONE)
			return GR_ERR_IO;
		if (answer == ANSWER_MEASURE)
			r = measure(&a, &points[i]);
		if (answer == ANSWER_SKIP)
			i++;
		if (answer == ANSWER_BACK && i > 0)
			points[--i].measured = false;
	}
	return r < 0 ? r : GR_OK;
}

/* ---- pivot ---- */

static int gather(struct asked *a, struct survey_point *out, size_t *count)
{
	const int64_t end_ns = gr_clock_now(&gr_clock_monotonic) + (int64_t)(a->of->seconds * 1e9);
	struct calibrate_report reports[BATCH];
	size_t unturned = 0;
	int n = 0;

	while (n >= 0 && gr_clock_now(&gr_clock_monotonic) < end_ns) {
		pause_a_little(a);
		n = calibrate_read(a->reader, reports, BATCH);
		for (int i = 0; i < n && *count < LEVER_SAMPLES; i++) {
			struct survey_point *point = &out[*count];

			if (!reports[i].placed || !reports[i].turned) {
				unturned += reports[i].placed;
				continue;
			}
			memset(point, 0, sizeof *point);
			snprintf(point->name, sizeof point->name, "%zu", ++*count);
			point->measured = true;
			memcpy(point->p, reports[i].p, sizeof point->p);
			point->q = reports[i].q;
		}
	}
	if (n < 0)
		return GR_ERR_IO;
	if (*count == 0 && unturned) {
		fprintf(stderr, "grotto trackers: the sensor says no orientation: its arm cannot be told so\n");
		return GR_ERR_UNSUPPORTED;
	}
	return enough(a, *count, 0, true) ? GR_OK : GR_NOTHING;
}

int calibrate_ask_pivot(const struct calibrate *c, struct calibrate_reader *reader,
			struct survey_point **out, size_t *out_count)
{
	struct asked a = { .of = c, .reader = reader };
	int r = GR_NOTHING;

	*out = calloc(LEVER_SAMPLES, sizeof **out);
	if (!*out)
		return GR_ERR_NOMEM;
	(void)read_buttons(&a);
	while (r == GR_NOTHING) {
		enum answer answer;

		fprintf(stderr, "put the %s on a point that does not move, press Enter or a button, and turn it "
				"about all axes for %.3g s (q ends)\n",
			c->binding->body == LAYOUT_HEAD ? "middle between the eyes" : "wand's tip", c->seconds);
		answer = await(&a);
		if (answer == ANSWER_QUIT)
			return GR_NOTHING;
		if (answer == ANSWER_GONE)
			return GR_ERR_IO;
		*out_count = 0;
		if (answer == ANSWER_MEASURE)
			r = gather(&a, *out, out_count);
	}
	if (r == GR_OK)
		fprintf(stderr, "  %zu samples\n", *out_count);
	return r;
}
