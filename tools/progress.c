#include "tools/progress.h"

#include "base/clock.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#define BAR_WIDTH 30
#define PLAIN_EVERY_NS (10 * GR_NS_PER_S)

void progress_start(struct progress *progress, const char *what)
{
	progress_hold_signals();
	*progress = (struct progress){
		.what = what,
		.terminal = isatty(STDERR_FILENO) == 1,
		.next_ns = gr_clock_now(&gr_clock_monotonic) + PLAIN_EVERY_NS,
	};
}

char *progress_time(double seconds, char *text, size_t size)
{
	long s = lround(fmin(fmax(seconds, 0), 1e8));

	if (s < 100)
		snprintf(text, size, "%ld s", s);
	else if (s < 6000)
		snprintf(text, size, "%ld min %ld s", s / 60, s % 60);
	else
		snprintf(text, size, "%ld h %ld min", s / 3600, s / 60 % 60);
	return text;
}

static void draw_bar(struct progress *progress, double done, const char *left, const char *note)
{
	int filled = (int)(done * BAR_WIDTH);

	fprintf(stderr, "\r\033[K%s [", progress->what);
	for (int i = 0; i < BAR_WIDTH; i++)
		fputc(i < filled ? '#' : '.', stderr);
	fprintf(stderr, "] %3.0f %%%s%s%s", 100 * done, left, note ? ", " : "", note ? note : "");
	fflush(stderr);
	progress->shown = true;
}

void progress_show(struct progress *progress, double done, double seconds_left, const char *note)
{
	char left[64] = "", time[32];
	int64_t now;

	if (seconds_left >= 0)
		snprintf(left, sizeof left, ", %s left", progress_time(seconds_left, time, sizeof time));
	if (progress->terminal) {
		draw_bar(progress, done, left, note);
		return;
	}
	now = gr_clock_now(&gr_clock_monotonic);
	if (now < progress->next_ns)
		return;
	progress->next_ns = now + PLAIN_EVERY_NS;
	fprintf(stderr, "%s: %.0f %%%s%s%s\n", progress->what, 100 * done, left, note ? ", " : "",
		note ? note : "");
}

static void ends(sigset_t *out)
{
	sigemptyset(out);
	sigaddset(out, SIGINT);
	sigaddset(out, SIGTERM);
}

/* One that came too late to stop the work does not stop what writes its results. */
static void release_signals(void)
{
	const struct timespec at_once = { 0, 0 };
	sigset_t set;

	ends(&set);
	while (sigtimedwait(&set, NULL, &at_once) >= 0)
		;
	sigprocmask(SIG_UNBLOCK, &set, NULL);
}

void progress_end(struct progress *progress)
{
	if (progress->shown)
		fprintf(stderr, "\r\033[K");
	progress->shown = false;
	release_signals();
}

void progress_hold_signals(void)
{
	sigset_t set;

	ends(&set);
	sigprocmask(SIG_BLOCK, &set, NULL);
}

bool progress_asked_to_end(void)
{
	const struct timespec at_once = { 0, 0 };
	sigset_t set;

	ends(&set);
	if (sigtimedwait(&set, NULL, &at_once) < 0)
		return false;
	sigprocmask(SIG_UNBLOCK, &set, NULL);
	return true;
}
