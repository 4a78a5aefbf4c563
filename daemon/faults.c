#include <config.h> /* clock_nanosleep */

#include "daemon/faults.h"

#include "base/clock.h"
#include "base/log.h"
#include "base/result.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define KILL_AFTER_NS (20 * GR_NS_PER_MS)

struct held {
	int64_t due_ns; /* 0: free */
	size_t len;
	struct net_address from;
};

struct faults {
	struct loop *loop;
	int timer;
	size_t datagram_max;
	uint64_t salt, seed, random;
	bool active; /* something is set, or held */
	bool stall_once;
	struct faults_settings set;
	struct faults_counts counts;
	int64_t kill_ns; /* 0: not asked to */
	void (*due_fn)(void *ctx);
	void *due_ctx;
	net_receive_fn fn; /* while faults_receive runs */
	void *fn_ctx;
	size_t held_count;
	struct held held[FAULTS_HELD];
	uint8_t *bytes; /* FAULTS_HELD * datagram_max */
};

static const struct setting {
	const char *name, *unit;
	size_t offset;
	double most;
} settings[] = {
	{ "loss_in", " %", offsetof(struct faults_settings, loss_in), 100 },
	{ "loss_out", " %", offsetof(struct faults_settings, loss_out), 100 },
	{ "delay_ms", " ms", offsetof(struct faults_settings, delay_ms), 1000 },
	{ "jitter_ms", " ms", offsetof(struct faults_settings, jitter_ms), 1000 },
	{ "duplicate", " %", offsetof(struct faults_settings, duplicate), 100 },
	{ "reorder", " %", offsetof(struct faults_settings, reorder), 100 },
	{ "stall_ms", " ms", offsetof(struct faults_settings, stall_ms), 60000 },
	{ "stall_every", " frames", offsetof(struct faults_settings, stall_every), 1000000 },
};
#define SETTINGS (sizeof settings / sizeof *settings)

static double *value_at(struct faults_settings *set, size_t i)
{
	return (double *)(void *)((char *)set + settings[i].offset);
}

static double value_of(const struct faults_settings *set, size_t i)
{
	return *value_at((struct faults_settings *)set, i);
}

/* splitmix64 (Steele, Lea, Flood 2014), as a number of [0, 1). */
static double draw(struct faults *f)
{
	uint64_t z = f->random += UINT64_C(0x9e3779b97f4a7c15);

	z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
	z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
	return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static bool happens(struct faults *f, double percent)
{
	return percent > 0 && draw(f) * 100 < percent;
}

bool faults_on(const struct faults *f)
{
	for (size_t i = 0; f && i < SETTINGS; i++)
		if (value_of(&f->set, i) > 0)
			return true;
	return false;
}

static void arm(struct faults *f)
{
	int64_t at_ns = f->kill_ns ? f->kill_ns : LOOP_NEVER;

	for (size_t i = 0; f->held_count > 0 && i < FAULTS_HELD; i++)
		if (f->held[i].due_ns != 0 && f->held[i].due_ns < at_ns)
			at_ns = f->held[i].due_ns;
	loop_timer_set(f->loop, f->timer, at_ns);
	f->active = f->held_count > 0 || faults_on(f);
}

static void on_timer(void *ctx, int64_t now_ns)
{
	struct faults *f = ctx;

	if (f->kill_ns && now_ns >= f->kill_ns)
		kill(getpid(), SIGKILL);
	if (f->due_fn)
		f->due_fn(f->due_ctx);
	arm(f);
}

int faults_create(struct faults **out, struct loop *loop, size_t datagram_max, uint64_t salt)
{
	struct faults *f = calloc(1, sizeof *f);

	*out = NULL;
	if (!f)
		return GR_ERR_NOMEM;
	f->loop = loop;
	f->datagram_max = datagram_max;
	f->salt = salt;
	f->bytes = malloc(FAULTS_HELD * datagram_max + 1);
	f->timer = loop_timer_create(loop, on_timer, f);
	if (!f->bytes || f->timer < 0) {
		free(f->bytes);
		free(f);
		return GR_ERR_NOMEM;
	}
	gr_warning("faults may be injected here (test.faults): no layout for visitors");
	*out = f;
	return GR_OK;
}

void faults_destroy(struct faults **faults)
{
	struct faults *f = *faults;

	if (!f)
		return;
	loop_timer_set(f->loop, f->timer, LOOP_NEVER);
	free(f->bytes);
	free(f);
	*faults = NULL;
}

void faults_on_due(struct faults *f, void (*fn)(void *ctx), void *ctx)
{
	f->due_fn = fn;
	f->due_ctx = ctx;
}

static bool lost_out(struct faults *f)
{
	bool lost = happens(f, f->set.loss_out);

	f->counts.lost_out += lost;
	return lost;
}

void faults_send(struct faults *f, struct net *net, int to, size_t peers, const uint8_t *bytes,
		 size_t len)
{
	if (!f || f->set.loss_out <= 0) {
		net_send(net, to, bytes, len);
	} else if (to != NET_TO_ALL) {
		if (!lost_out(f))
			net_send(net, to, bytes, len);
	} else {
		for (size_t i = 0; i < peers; i++)
			if (!lost_out(f))
				net_send(net, (int)i, bytes, len);
	}
}

void faults_send_to(struct faults *f, struct net *net, const struct net_address *to,
		    const uint8_t *bytes, size_t len)
{
	if (!f || f->set.loss_out <= 0 || !lost_out(f))
		net_send_to(net, to, bytes, len);
}

static void hold(struct faults *f, const uint8_t *bytes, size_t len, const struct net_address *from,
		 int64_t due_ns)
{
	for (size_t i = 0; f->held_count < FAULTS_HELD && i < FAULTS_HELD; i++) {
		if (f->held[i].due_ns != 0)
			continue;
		f->held[i] = (struct held){ due_ns, len, *from };
		memcpy(f->bytes + i * f->datagram_max, bytes, len);
		f->held_count++;
		return;
	}
	f->counts.overflowed++;
}

/* In the order of their times, so that delay alone keeps the order. */
static void release(struct faults *f, int64_t now_ns)
{
	while (f->held_count > 0) {
		size_t first = FAULTS_HELD;

		for (size_t i = 0; i < FAULTS_HELD; i++)
			if (f->held[i].due_ns != 0 &&
			    (first == FAULTS_HELD || f->held[i].due_ns < f->held[first].due_ns))
				first = i;
		if (first == FAULTS_HELD || f->held[first].due_ns > now_ns)
			return;
		f->fn(f->fn_ctx, f->bytes + first * f->datagram_max, f->held[first].len,
		      &f->held[first].from, f->held[first].due_ns);
		f->held[first].due_ns = 0;
		f->held_count--;
	}
}

static void befall(void *ctx, const uint8_t *bytes, size_t len, const struct net_address *from,
		   int64_t arrived_ns)
{
	struct faults *f = ctx;
	int copies = 1;

	if (happens(f, f->set.loss_in)) {
		f->counts.lost_in++;
		return;
	}
	if (happens(f, f->set.duplicate)) {
		f->counts.duplicated++;
		copies = 2;
	}
	while (copies-- > 0) {
		double wait_ms = f->set.delay_ms + (f->set.jitter_ms > 0 ? draw(f) * f->set.jitter_ms : 0);
		int64_t wait_ns = (int64_t)(wait_ms * (double)GR_NS_PER_MS);

		f->counts.delayed += wait_ns > 0;
		if (happens(f, f->set.reorder)) {
			f->counts.reordered++;
			wait_ns += FAULTS_REORDER_NS;
		}
		if (wait_ns > 0)
			hold(f, bytes, len, from, arrived_ns + wait_ns);
		else
			f->fn(f->fn_ctx, bytes, len, from, arrived_ns);
	}
}

int faults_receive(struct faults *f, struct net *net, int fd, int most, net_receive_fn fn, void *ctx)
{
	int taken;

	if (!f || !f->active)
		return net_receive(net, fd, most, fn, ctx);
	f->fn = fn;
	f->fn_ctx = ctx;
	release(f, gr_clock_now(&gr_clock_monotonic));
	taken = net_receive(net, fd, most, befall, f);
	arm(f);
	return taken;
}

void faults_frame(struct faults *f, uint64_t frame)
{
	struct timespec sleep;
	int64_t ns;

	if (!f || f->set.stall_ms <= 0)
		return;
	if (!f->stall_once && (f->set.stall_every < 1 || frame % (uint64_t)f->set.stall_every != 0))
		return;
	ns = (int64_t)(f->set.stall_ms * (double)GR_NS_PER_MS);
	sleep = (struct timespec){ ns / GR_NS_PER_S, ns % GR_NS_PER_S };
	f->counts.stalls++;
	gr_warning("frame %" PRIu64 " stalls for %g ms, as asked", frame, f->set.stall_ms);
	if (f->stall_once) {
		f->stall_once = false;
		f->set.stall_ms = 0;
	}
	while (clock_nanosleep(CLOCK_MONOTONIC, 0, &sleep, &sleep) == EINTR)
		;
	arm(f);
}

static void warn(const struct faults *f)
{
	char text[256] = "";
	size_t len = 0;

	for (size_t i = 0; i < SETTINGS && len < sizeof text; i++)
		if (value_of(&f->set, i) > 0)
			len += (size_t)snprintf(text + len, sizeof text - len, "%s%s %g%s", len ? ", " : "",
						settings[i].name, value_of(&f->set, i), settings[i].unit);
	if (len)
		gr_warning("faults are injected, as asked: %s; seed %" PRIu64, text, f->seed);
}

static bool set_one(struct faults_settings *set, uint64_t *seed, const char *name, const char *text,
		    char *why, size_t size)
{
	char *end;
	double value;

	errno = 0;
	if (!strcmp(name, "seed")) {
		*seed = strtoull(text, &end, 10);
		if (end != text && !*end && errno == 0 && text[0] != '-')
			return true;
		snprintf(why, size, "seed '%.40s': a whole number from 0 to 18446744073709551615", text);
		return false;
	}
	for (size_t i = 0; i < SETTINGS; i++) {
		if (strcmp(name, settings[i].name) != 0)
			continue;
		value = strtod(text, &end);
		if (end != text && !*end && errno == 0 && value >= 0 && value <= settings[i].most) {
			*value_at(set, i) = value;
			return true;
		}
		snprintf(why, size, "%s '%.40s': a number from 0 to %g%s", name, text, settings[i].most,
			 settings[i].unit);
		return false;
	}
	snprintf(why, size, "no fault '%.40s'; there are loss_in, loss_out, delay_ms, jitter_ms, duplicate, "
		 "reorder, stall_ms, stall_every, and seed", name);
	return false;
}

int faults_set(struct faults *f, char *const *words, int count, char *why, size_t size)
{
	struct faults_settings set = f->set;
	uint64_t seed;

	/* Printed as a decimal that JSON readers keep whole. */
	seed = faults_on(f) ? f->seed : randombytes_random();
	if (count < 2 || count % 2 != 0) {
		snprintf(why, size, "write: faults set NAME VALUE...");
		return GR_ERR_RANGE;
	}
	for (int i = 0; i < count; i += 2)
		if (!set_one(&set, &seed, words[i], words[i + 1], why, size))
			return GR_ERR_RANGE;
	f->set = set;
	f->stall_once = set.stall_ms > 0 && set.stall_every < 1;
	f->seed = seed;
	f->random = seed ^ (f->salt * UINT64_C(0xd1342543de82ef95));
	warn(f);
	arm(f);
	return GR_OK;
}

void faults_clear(struct faults *f)
{
	f->set = (struct faults_settings){ 0 };
	f->stall_once = false;
	gr_notice("no faults are injected any more");
	arm(f);
}

void faults_kill(struct faults *f)
{
	gr_warning("dies now, as asked");
	f->kill_ns = gr_clock_now(&gr_clock_monotonic) + KILL_AFTER_NS;
	arm(f);
}

void faults_write_json(const struct faults *f, struct json *json, const char *key)
{
	json_open(json, key, '{');
	json_bool(json, "allowed", f != NULL);
	json_bool(json, "on", faults_on(f));
	if (f) {
		json_u64(json, "seed", f->seed);
		for (size_t i = 0; i < SETTINGS; i++)
			json_f64(json, settings[i].name, value_of(&f->set, i));
		json_u64(json, "lost_in", f->counts.lost_in);
		json_u64(json, "lost_out", f->counts.lost_out);
		json_u64(json, "delayed", f->counts.delayed);
		json_u64(json, "duplicated", f->counts.duplicated);
		json_u64(json, "reordered", f->counts.reordered);
		json_u64(json, "overflowed", f->counts.overflowed);
		json_u64(json, "stalls", f->counts.stalls);
	}
	json_close(json, '}');
}
