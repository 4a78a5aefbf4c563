/*
 * Work on many like items by several threads. Who does which item is left to
 * chance, so an item's result must depend on nothing but its number.
 *
 * Thread safety: one thread calls; the work runs on others, with all signals
 * blocked.
 */
#ifndef GROTTO_RENDERER_TRACE_CREW_H
#define GROTTO_RENDERER_TRACE_CREW_H

#include <stdbool.h>
#include <stddef.h>

/* Items begin..end-1; thread is 0..threads-1, for scratch memory of its own. */
typedef void (*crew_work)(void *ctx, size_t begin, size_t end, int thread);
/* About four times a second, on the calling thread; done 0..1. false stops. */
typedef bool (*crew_watch)(void *ctx, double done);

/* How many threads `wanted` means: 0 or less all cores; at most CREW_MOST. */
#define CREW_MOST 256
int crew_threads(int wanted);
/*
 * Does all items in portions of `portion`; returns when they are done. watch
 * may be NULL. GR_OK; GR_NOTHING when watch has stopped it: some are not done.
 * With threads 1, and where no thread can be started, the caller does the work.
 */
int crew_run(int threads, size_t items, size_t portion, crew_work work, void *ctx,
	     crew_watch watch, void *watch_ctx);

#endif
