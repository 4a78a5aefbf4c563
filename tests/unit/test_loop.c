/* The event loop: timers, descriptors that come and go in callbacks, signals. */
#include "tests/unit/unit.h"

#include "base/clock.h"
#include "base/result.h"
#include "daemon/loop.h"

#include <signal.h>
#include <sys/eventfd.h>
#include <unistd.h>

static int64_t now(void)
{
	return gr_clock_now(&gr_clock_monotonic);
}

struct fired {
	struct loop *loop;
	int count, timer;
	int64_t at_ns;
};

static void on_timer(void *ctx, int64_t now_ns)
{
	struct fired *f = ctx;

	f->count++;
	f->at_ns = now_ns;
}

static void timer_fires_once_and_not_early(void **state)
{
	struct loop *loop;
	struct fired f = { 0 };
	int64_t at;
	int timer;

	(void)state;
	assert_int_equal(loop_create(&loop), GR_OK);
	timer = loop_timer_create(loop, on_timer, &f);
	assert_true(timer >= 0);
	at = now() + 5 * GR_NS_PER_MS;
	assert_int_equal(loop_timer_set(loop, timer, at), GR_OK);
	assert_int_equal(loop_once(loop, 1000), GR_OK);
	assert_int_equal(f.count, 1);
	assert_true(f.at_ns >= at);
	assert_int_equal(loop_once(loop, 0), GR_NOTHING);
	/* A time that is past fires at once; LOOP_NEVER disarms. */
	loop_timer_set(loop, timer, 1);
	assert_int_equal(loop_once(loop, 1000), GR_OK);
	assert_int_equal(f.count, 2);
	loop_timer_set(loop, timer, now() + GR_NS_PER_MS);
	loop_timer_set(loop, timer, LOOP_NEVER);
	assert_int_equal(loop_once(loop, 20), GR_NOTHING);
	loop_timer_set(loop, timer, -5);
	assert_int_equal(loop_once(loop, 1000), GR_OK);
	assert_int_equal(f.count, 3);
	loop_destroy(&loop);
	assert_null(loop);
}

static void on_timer_again(void *ctx, int64_t now_ns)
{
	struct fired *f = ctx;

	f->count++;
	loop_timer_set(f->loop, f->timer, now_ns + GR_NS_PER_MS);
	if (f->count == 3)
		loop_stop(f->loop);
}

static void timer_may_be_set_in_its_callback(void **state)
{
	struct fired f = { 0 };

	(void)state;
	assert_int_equal(loop_create(&f.loop), GR_OK);
	f.timer = loop_timer_create(f.loop, on_timer_again, &f);
	loop_timer_set(f.loop, f.timer, 1);
	while (!loop_stopped(f.loop))
		assert_true(loop_once(f.loop, 1000) >= 0);
	assert_int_equal(f.count, 3);
	loop_destroy(&f.loop);
}

struct pair {
	struct loop *loop;
	int own, other, count;
};

static void remove_other(void *ctx, uint32_t events)
{
	struct pair *p = ctx;

	(void)events;
	p->count++;
	loop_remove(p->loop, p->other);
	loop_remove(p->loop, p->own);
}

/* Both are readable in one batch; the first callback removes the second's descriptor. */
static void removed_descriptor_gets_no_event(void **state)
{
	struct loop *loop;
	int a = eventfd(1, EFD_NONBLOCK), b = eventfd(1, EFD_NONBLOCK);
	struct pair pa, pb;

	(void)state;
	assert_int_equal(loop_create(&loop), GR_OK);
	pa = (struct pair){ loop, a, b, 0 };
	pb = (struct pair){ loop, b, a, 0 };
	assert_int_equal(loop_add(loop, a, EPOLLIN, remove_other, &pa), GR_OK);
	assert_int_equal(loop_add(loop, a, EPOLLIN, remove_other, &pa), GR_ERR_RANGE);
	assert_int_equal(loop_add(loop, b, EPOLLIN, remove_other, &pb), GR_OK);
	assert_int_equal(loop_once(loop, 1000), GR_OK);
	assert_int_equal(pa.count + pb.count, 1);
	assert_int_equal(loop_once(loop, 0), GR_NOTHING);
	assert_int_equal(loop_modify(loop, a, EPOLLIN), GR_ERR_RANGE);
	close(a);
	close(b);
	loop_destroy(&loop);
}

struct reuse {
	struct loop *loop;
	int fds[2], fresh, stale_events;
};

static void fresh_event(void *ctx, uint32_t events)
{
	struct reuse *r = ctx;

	(void)events;
	r->stale_events++;
}

static void replace_other(void *ctx, uint32_t events)
{
	struct reuse *r = ctx;

	(void)events;
	if (r->fresh >= 0)
		return;
	/* The slot of one that waits in this batch goes to a descriptor without events. */
	for (int i = 0; i < 2; i++)
		loop_remove(r->loop, r->fds[i]);
	r->fresh = eventfd(0, EFD_NONBLOCK);
	assert_int_equal(loop_add(r->loop, r->fresh, EPOLLIN, fresh_event, r), GR_OK);
}

static void stale_event_misses_the_new_owner(void **state)
{
	struct reuse r = { .fresh = -1 };

	(void)state;
	assert_int_equal(loop_create(&r.loop), GR_OK);
	for (int i = 0; i < 2; i++) {
		r.fds[i] = eventfd(1, EFD_NONBLOCK);
		assert_int_equal(loop_add(r.loop, r.fds[i], EPOLLIN, replace_other, &r), GR_OK);
	}
	assert_int_equal(loop_once(r.loop, 1000), GR_OK);
	assert_true(r.fresh >= 0);
	assert_int_equal(r.stale_events, 0);
	for (int i = 0; i < 2; i++)
		close(r.fds[i]);
	close(r.fresh);
	loop_destroy(&r.loop);
}

static void ignore_event(void *ctx, uint32_t events)
{
	(void)ctx;
	(void)events;
}

static void full_tables_are_refused(void **state)
{
	struct loop *loop;
	struct fired f = { 0 };
	int fds[LOOP_FDS + 1], n = 0;

	(void)state;
	assert_int_equal(loop_create(&loop), GR_OK);
	while (n < LOOP_FDS) {
		fds[n] = eventfd(0, EFD_NONBLOCK);
		assert_int_equal(loop_add(loop, fds[n], EPOLLIN, ignore_event, NULL), GR_OK);
		n++;
	}
	fds[n] = eventfd(0, EFD_NONBLOCK);
	assert_int_equal(loop_add(loop, fds[n], EPOLLIN, ignore_event, NULL), GR_ERR_RANGE);
	assert_int_equal(loop_timer_create(loop, on_timer, &f), GR_ERR_RANGE);
	assert_int_equal(loop_timer_set(loop, 0, 1), GR_ERR_RANGE);
	for (int i = 0; i <= n; i++)
		close(fds[i]);
	loop_destroy(&loop);
}

static void signal_stops_the_loop(void **state)
{
	struct loop *loop;

	(void)state;
	assert_int_equal(loop_create(&loop), GR_OK);
	assert_int_equal(loop_catch_signals(loop), GR_OK);
	kill(getpid(), SIGTERM);
	assert_int_equal(loop_once(loop, 1000), GR_OK);
	assert_true(loop_stopped(loop));
	assert_int_equal(loop_signal(loop), SIGTERM);
	loop_destroy(&loop);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(timer_fires_once_and_not_early),
		cmocka_unit_test(timer_may_be_set_in_its_callback),
		cmocka_unit_test(removed_descriptor_gets_no_event),
		cmocka_unit_test(stale_event_misses_the_new_owner),
		cmocka_unit_test(full_tables_are_refused),
		cmocka_unit_test(signal_stops_the_loop),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
