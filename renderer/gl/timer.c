#include "renderer/gl/timer.h"

#include "base/log.h"
#include "base/result.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

/* Frames whose queries may be on the way at once. */
#define RING 6

struct span {
	GLuint begin, end;
};

struct slot {
	struct span spans[TIMER_STAGES][TIMER_SPANS];
	int used[TIMER_STAGES]; /* spans that were ended */
	bool pending;           /* handed to the GPU, not yet read */
	bool forgotten;         /* pending, and not to be counted */
};

struct timers {
	struct slot slots[RING];
	int write;  /* slot of this frame; when it is still pending, the frame is not measured */
	int oldest; /* first slot that may be pending */
	bool open[TIMER_STAGES];
	bool works;
	struct timer_stats stats[TIMER_STAGES];
	double sum_ms[TIMER_STAGES];
	float window_ms[TIMER_STAGES][TIMER_WINDOW]; /* of frame i at i modulo TIMER_WINDOW */
};

int timers_create(struct timers **out)
{
	struct timers *t = calloc(1, sizeof *t);
	GLint bits = 0;

	*out = NULL;
	if (!t)
		return GR_ERR_NOMEM;
	glGetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
	t->works = bits > 0;
	if (!t->works)
		gr_notice("this OpenGL has no time stamps: no times per stage");
	for (int s = 0; s < RING && t->works; s++)
		glCreateQueries(GL_TIMESTAMP, TIMER_STAGES * TIMER_SPANS * 2,
				&t->slots[s].spans[0][0].begin);
	*out = t;
	return GR_OK;
}

void timers_destroy(struct timers **timers)
{
	struct timers *t = *timers;

	if (!t)
		return;
	for (int s = 0; s < RING && t->works; s++)
		glDeleteQueries(TIMER_STAGES * TIMER_SPANS * 2, &t->slots[s].spans[0][0].begin);
	free(t);
	*timers = NULL;
}

static struct slot *measured_slot(struct timers *t, int stage)
{
	struct slot *slot;

	if (!t->works || stage < 0 || stage >= TIMER_STAGES)
		return NULL;
	slot = &t->slots[t->write];
	return !slot->pending && slot->used[stage] < TIMER_SPANS ? slot : NULL;
}

void timers_begin(struct timers *timers, int stage, const char *name)
{
	struct slot *slot = measured_slot(timers, stage);

	if (!slot)
		return;
	timers->stats[stage].name = name;
	timers->open[stage] = true;
	glQueryCounter(slot->spans[stage][slot->used[stage]].begin, GL_TIMESTAMP);
}

void timers_end(struct timers *timers, int stage)
{
	struct slot *slot = measured_slot(timers, stage);

	if (!slot || !timers->open[stage])
		return;
	timers->open[stage] = false;
	glQueryCounter(slot->spans[stage][slot->used[stage]].end, GL_TIMESTAMP);
	slot->used[stage]++;
}

static bool slot_ready(const struct slot *slot)
{
	for (int stage = 0; stage < TIMER_STAGES; stage++) {
		for (int i = 0; i < slot->used[stage]; i++) {
			GLuint available = 0;

			glGetQueryObjectuiv(slot->spans[stage][i].end, GL_QUERY_RESULT_AVAILABLE,
					    &available);
			if (!available)
				return false;
		}
	}
	return true;
}

static void add_sample(struct timers *t, int stage, double ms)
{
	struct timer_stats *s = &t->stats[stage];

	s->last_ms = ms;
	s->min_ms = s->count == 0 || ms < s->min_ms ? ms : s->min_ms;
	s->max_ms = s->count == 0 || ms > s->max_ms ? ms : s->max_ms;
	t->window_ms[stage][s->count % TIMER_WINDOW] = (float)ms;
	s->count++;
	t->sum_ms[stage] += ms;
	s->mean_ms = t->sum_ms[stage] / (double)s->count;
}

static void collect(struct timers *t, struct slot *slot)
{
	for (int stage = 0; stage < TIMER_STAGES; stage++) {
		double ms = 0.0;

		for (int i = 0; i < slot->used[stage]; i++) {
			GLuint64 begin = 0, end = 0;

			glGetQueryObjectui64v(slot->spans[stage][i].begin, GL_QUERY_RESULT, &begin);
			glGetQueryObjectui64v(slot->spans[stage][i].end, GL_QUERY_RESULT, &end);
			if (end > begin)
				ms += (double)(end - begin) * 1e-6;
		}
		if (slot->used[stage] && !slot->forgotten)
			add_sample(t, stage, ms);
		slot->used[stage] = 0;
	}
	slot->pending = slot->forgotten = false;
}

static bool slot_used(const struct slot *slot)
{
	for (int stage = 0; stage < TIMER_STAGES; stage++) {
		if (slot->used[stage])
			return true;
	}
	return false;
}

void timers_frame(struct timers *timers)
{
	struct timers *t = timers;

	if (!t->works)
		return;
	memset(t->open, 0, sizeof t->open);
	if (!t->slots[t->write].pending && slot_used(&t->slots[t->write])) {
		t->slots[t->write].pending = true;
		t->write = (t->write + 1) % RING;
	}
	while (t->slots[t->oldest].pending && slot_ready(&t->slots[t->oldest])) {
		collect(t, &t->slots[t->oldest]);
		t->oldest = (t->oldest + 1) % RING;
	}
}

void timers_stats(const struct timers *timers, int stage, struct timer_stats *out)
{
	if (stage < 0 || stage >= TIMER_STAGES) {
		memset(out, 0, sizeof *out);
		return;
	}
	*out = timers->stats[stage];
}

size_t timers_window(const struct timers *timers, int stage, double ms[TIMER_WINDOW])
{
	uint64_t count, first;

	if (stage < 0 || stage >= TIMER_STAGES)
		return 0;
	count = timers->stats[stage].count;
	first = count > TIMER_WINDOW ? count - TIMER_WINDOW : 0;
	for (uint64_t i = first; i < count; i++)
		ms[i - first] = (double)timers->window_ms[stage][i % TIMER_WINDOW];
	return (size_t)(count - first);
}

void timers_reset(struct timers *timers)
{
	for (int stage = 0; stage < TIMER_STAGES; stage++) {
		const char *name = timers->stats[stage].name;

		timers->stats[stage] = (struct timer_stats){ .name = name };
		timers->sum_ms[stage] = 0;
	}
	for (int s = 0; s < RING; s++)
		timers->slots[s].forgotten = timers->slots[s].pending;
}
