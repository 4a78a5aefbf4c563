/*
 * GPU time per stage by GL_TIMESTAMP queries in a ring, read some frames
 * later so that nothing waits (seed 004 section 4.6). On software renderers,
 * where the GPU is this CPU, it is the time the commands took to run.
 */
#ifndef GROTTO_RENDERER_GL_TIMER_H
#define GROTTO_RENDERER_GL_TIMER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TIMER_STAGES 16
/* How often a stage may run in one frame (once an eye); the times add up, more are not measured. */
#define TIMER_SPANS 4

/* Frames that medians and spread are of: the last so many in which the stage ran. */
#define TIMER_WINDOW 512

struct timer_stats {
	const char *name; /* NULL: unused */
	uint64_t count;   /* frames in which the stage ran */
	double last_ms, mean_ms, min_ms, max_ms;
};

struct timers;
int timers_create(struct timers **out);
void timers_destroy(struct timers **timers);
/* Stages are known by index; the name is kept, not copied. A stage may not nest in itself. */
void timers_begin(struct timers *timers, int stage, const char *name);
void timers_end(struct timers *timers, int stage);
/*
 * At the end of a frame: collects what is ready, never waits. When the GPU is
 * more than six frames behind, frames go unmeasured.
 */
void timers_frame(struct timers *timers);
void timers_stats(const struct timers *timers, int stage, struct timer_stats *out);
/*
 * The last frames' times of a stage, oldest first, at most TIMER_WINDOW;
 * returns how many. For medians and spread: see tools/bench/stats.h.
 */
size_t timers_window(const struct timers *timers, int stage, double ms[TIMER_WINDOW]);
/*
 * Forgets what was measured, for warm-up frames. Frames on their way to the
 * GPU are forgotten, too: from the next frame on it counts.
 */
void timers_reset(struct timers *timers);

#endif
