#include "renderer/trace/crew.h"

#include "base/clock.h"
#include "base/result.h"

#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <unistd.h>

#define WATCH_NS (GR_NS_PER_S / 4)

struct crew {
	crew_work work;
	void *ctx;
	size_t items, portion;
	atomic_size_t next;
	atomic_bool stop;
	pthread_mutex_t lock;
	pthread_cond_t change;
	int working; /* under the lock */
};

struct hand {
	struct crew *crew;
	int thread;
	pthread_t id;
};

int crew_threads(int wanted)
{
	long cores = wanted > 0 ? wanted : sysconf(_SC_NPROCESSORS_ONLN);

	return cores < 1 ? 1 : cores > CREW_MOST ? CREW_MOST : (int)cores;
}

/* One portion; false: there is none left. */
static bool do_portion(struct crew *crew, int thread)
{
	size_t begin = atomic_fetch_add(&crew->next, crew->portion);
	size_t end;

	if (begin >= crew->items || atomic_load(&crew->stop))
		return false;
	end = crew->items - begin < crew->portion ? crew->items : begin + crew->portion;
	crew->work(crew->ctx, begin, end, thread);
	return true;
}

static double share_done(struct crew *crew)
{
	size_t next = atomic_load(&crew->next);

	return next >= crew->items ? 1 : (double)next / (double)crew->items;
}

static void *run_hand(void *argument)
{
	struct hand *hand = argument;
	struct crew *crew = hand->crew;

	while (do_portion(crew, hand->thread))
		;
	pthread_mutex_lock(&crew->lock);
	crew->working--;
	pthread_cond_signal(&crew->change);
	pthread_mutex_unlock(&crew->lock);
	return NULL;
}

static void work_alone(struct crew *crew, crew_watch watch, void *watch_ctx)
{
	int64_t told = gr_clock_now(&gr_clock_monotonic);

	while (do_portion(crew, 0)) {
		int64_t now = gr_clock_now(&gr_clock_monotonic);

		if (!watch || now - told < WATCH_NS)
			continue;
		told = now;
		if (!watch(watch_ctx, share_done(crew)))
			atomic_store(&crew->stop, true);
	}
}

static void wait_for_hands(struct crew *crew, crew_watch watch, void *watch_ctx)
{
	pthread_mutex_lock(&crew->lock);
	while (crew->working > 0) {
		int64_t until = gr_clock_now(&gr_clock_monotonic) + WATCH_NS;
		struct timespec at = { until / GR_NS_PER_S, until % GR_NS_PER_S };

		if (pthread_cond_timedwait(&crew->change, &crew->lock, &at) == 0 || !watch)
			continue;
		pthread_mutex_unlock(&crew->lock);
		if (!watch(watch_ctx, share_done(crew)))
			atomic_store(&crew->stop, true);
		pthread_mutex_lock(&crew->lock);
	}
	pthread_mutex_unlock(&crew->lock);
}

static int start_hands(struct crew *crew, struct hand *hands, int threads)
{
	sigset_t all, before;
	int started = 0;

	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	crew->working = threads;
	for (; started < threads; started++) {
		hands[started].crew = crew;
		hands[started].thread = started;
		if (pthread_create(&hands[started].id, NULL, run_hand, &hands[started]) != 0)
			break;
	}
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	pthread_mutex_lock(&crew->lock);
	crew->working -= threads - started;
	pthread_mutex_unlock(&crew->lock);
	return started;
}

int crew_run(int threads, size_t items, size_t portion, crew_work work, void *ctx,
	     crew_watch watch, void *watch_ctx)
{
	struct crew crew = { .work = work, .ctx = ctx, .items = items, .portion = portion };
	struct hand hands[CREW_MOST];
	pthread_condattr_t monotonic;
	int started = 0;

	pthread_mutex_init(&crew.lock, NULL);
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_cond_init(&crew.change, &monotonic);
	pthread_condattr_destroy(&monotonic);
	if (threads > 1 && items > portion)
		started = start_hands(&crew, hands, threads > CREW_MOST ? CREW_MOST : threads);
	if (started > 0)
		wait_for_hands(&crew, watch, watch_ctx);
	else
		work_alone(&crew, watch, watch_ctx);
	for (int i = 0; i < started; i++)
		pthread_join(hands[i].id, NULL);
	pthread_cond_destroy(&crew.change);
	pthread_mutex_destroy(&crew.lock);
	return atomic_load(&crew.stop) ? GR_NOTHING : GR_OK;
}
