/*
 * bench-packing FILE...: what the deltas and whole states of recorded sessions, and the
 * shared light of scenes (FILE.scene), weigh packed, and how long that takes. A delta is
 * from each frame to the next, as the protocol sends it where nothing is lost; it is
 * packed as it is, and after XOR with the one before where that is as long.
 */
#include "tools/bench/packing.h"

#include "base/log.h"
#include "base/result.h"
#include "protocol/params.h"
#include "record/player.h"
#include "tools/bench/codecs.h"
#include "tools/bench/stats.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define UPDATES_MOST 4096 /* of a file; the rest is not looked at */
#define ROUNDS 15
#define LIGHT_FRAMES 120
#define LIGHT_NODES 4 /* that share the light; one of them sends */
#define MESSAGE_MOST 65536
#define PACKED_MOST 131072 /* whatever a codec makes of that */

struct update {
	size_t len;
	uint8_t *bytes;
};

/* Of one file, and what all files are packed with. */
struct session {
	struct codec_work *work;
	struct update *packed; /* UPDATES_MOST, with room for PACKED_MOST bytes each */
	struct update updates[UPDATES_MOST];
	size_t count;
};

static double cpu_us(void)
{
	struct timespec ts;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &ts);
	return (double)ts.tv_sec * 1e6 + (double)ts.tv_nsec * 1e-3;
}

static void forget(struct session *s)
{
	for (size_t i = 0; i < s->count; i++)
		free(s->updates[i].bytes);
	s->count = 0;
}

static bool keep(void *ctx, const uint8_t *bytes, size_t len)
{
	struct session *s = ctx;
	struct update *u = s->updates + s->count;

	if (s->count == UPDATES_MOST || len > MESSAGE_MOST)
		return false;
	u->bytes = malloc(len);
	if (!u->bytes)
		return false;
	memcpy(u->bytes, bytes, len);
	u->len = len;
	s->count++;
	return true;
}

/* whole: as for a joiner. False, with a line on stderr, when there is nothing to measure. */
static bool read_session(const char *path, bool whole, struct session *s)
{
	const struct record_player_params params = { .recording = 1 };
	const size_t room = param_delta_max();
	struct gr_diag diag = { 0 };
	struct record_player *player = NULL;
	struct param_state *state = NULL;
	uint8_t *bytes = malloc(room);
	struct record_play play;
	uint64_t last = 0;
	bool ok;

	s->count = 0;
	ok = bytes && param_state_create(&state) == GR_OK &&
	     record_player_open(&player, path, &params, &diag) == GR_OK;
	while (ok && s->count < UPDATES_MOST && record_player_next(player, state, &play) == GR_OK) {
		/* Where a frame is missing there is no such delta. */
		if (whole || (last && play.frame == last + 1)) {
			const long len = param_delta_encode(state, whole ? 0 : last, bytes, room);

			ok = len > 0 && keep(s, bytes, (size_t)len);
		}
		last = play.frame;
	}
	if (!s->count)
		fprintf(stderr, "bench-packing: %s: no frames that can be read\n", path);
	record_player_destroy(&player);
	param_state_destroy(&state);
	gr_diag_finish(&diag);
	free(bytes);
	return ok && s->count;
}

/* Each with the one before it; from the last to the first, so that those are as they were. */
static void apply_xor(struct session *s)
{
	for (size_t i = s->count; i-- > 1;) {
		const struct update *before = &s->updates[i - 1];
		struct update *u = &s->updates[i];

		for (size_t k = 0; u->len == before->len && k < u->len; k++)
			u->bytes[k] ^= before->bytes[k];
	}
}

struct cost {
	double bytes;              /* an update; what does not get shorter stays as it is */
	double pack_us, unpack_us; /* processor time, medians of the rounds */
};

/* False: what was packed came out as something else. */
static bool run_round(const struct session *s, const struct codec *codec, struct cost *out)
{
	struct update *packed = s->packed;
	static uint8_t back[PACKED_MOST];
	double at_us = cpu_us(), bytes = 0;
	bool right = true;

	for (size_t i = 0; i < s->count; i++)
		packed[i].len = codec->pack(s->work, codec->level, s->updates[i].bytes, s->updates[i].len,
					    packed[i].bytes, PACKED_MOST);
	out->pack_us = (cpu_us() - at_us) / (double)s->count;
	at_us = cpu_us();
	for (size_t i = 0; i < s->count; i++)
		right = codec->unpack(s->work, packed[i].bytes, packed[i].len, back, s->updates[i].len) && right;
	out->unpack_us = (cpu_us() - at_us) / (double)s->count;
	for (size_t i = 0; i < s->count; i++) {
		const struct update *u = &s->updates[i];

		right = codec->unpack(s->work, packed[i].bytes, packed[i].len, back, u->len) &&
			!memcmp(back, u->bytes, u->len) && right;
		bytes += (double)(packed[i].len < u->len ? packed[i].len : u->len);
	}
	out->bytes = bytes / (double)s->count;
	return right;
}

static bool run_codec(const struct session *s, const struct codec *codec, struct cost *out)
{
	double pack_us[ROUNDS], unpack_us[ROUNDS];

	for (int i = 0; i < ROUNDS; i++) {
		if (!run_round(s, codec, out))
			return false;
		pack_us[i] = out->pack_us;
		unpack_us[i] = out->unpack_us;
	}
	out->pack_us = stats_spread(pack_us, ROUNDS).median;
	out->unpack_us = stats_spread(unpack_us, ROUNDS).median;
	return true;
}

/* What it saves of the way to one node, at so many bits a nanosecond. */
static double gain_us(const struct cost *c, double plain_bytes, double gbit_s)
{
	return (plain_bytes - c->bytes) * 8e-3 / gbit_s - c->pack_us - c->unpack_us;
}

static bool print_row(const char *name, const char *form, const struct session *s)
{
	double plain = 0;

	for (size_t i = 0; i < s->count; i++)
		plain += (double)s->updates[i].len;
	plain /= (double)s->count;
	printf("| %s | %s | %zu | %.0f |", name, form, s->count, plain);
	for (int k = 0; k < CODECS; k++) {
		struct cost c;

		if (!codecs[k].pack) {
			printf(" not built |");
			continue;
		}
		if (!run_codec(s, &codecs[k], &c)) {
			fprintf(stderr, "bench-packing: %s gives other bytes back\n", codecs[k].name);
			return false;
		}
		printf(" %.0f, %.2f + %.2f, %+.1f / %+.1f |", c.bytes, c.pack_us, c.unpack_us,
		       gain_us(&c, plain, 1), gain_us(&c, plain, 10));
	}
	printf("\n");
	fflush(stdout);
	return true;
}

/* As it is, and each after XOR with the one before. */
static bool print_both(const char *name, const char *what, const char *what_xor, struct session *s)
{
	if (!print_row(name, what, s))
		return false;
	apply_xor(s);
	return print_row(name, what_xor, s);
}

static bool run_file(const char *path, struct session *s)
{
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
	bool ok;

	if (dot && !strcmp(dot, ".scene")) {
		ok = packing_light(path, LIGHT_NODES, LIGHT_FRAMES, keep, s) && s->count &&
		     print_both(name, "light, one of 4", "light, XOR", s);
		forget(s);
		return ok;
	}
	ok = read_session(path, false, s) && print_both(name, "deltas", "deltas, XOR", s);
	forget(s);
	ok = ok && read_session(path, true, s) && print_row(name, "whole states", s);
	forget(s);
	return ok;
}

/* Room for each packed update, so that none is in the cache for having been the last. */
static struct update *packed_updates(void)
{
	struct update *packed = calloc(UPDATES_MOST, sizeof *packed);
	uint8_t *room = packed ? malloc((size_t)UPDATES_MOST * PACKED_MOST) : NULL;

	if (!room) {
		free(packed);
		return NULL;
	}
	for (size_t i = 0; i < UPDATES_MOST; i++)
		packed[i].bytes = room + i * PACKED_MOST;
	return packed;
}

static void end(struct session **session)
{
	struct session *s = *session;

	*session = NULL;
	if (!s)
		return;
	codec_work_destroy(&s->work);
	if (s->packed)
		free(s->packed[0].bytes);
	free(s->packed);
	free(s);
}

static struct session *begin(void)
{
	struct session *s = calloc(1, sizeof *s);

	if (s) {
		s->packed = packed_updates();
		s->work = codec_work_create();
	}
	if (s && (!s->packed || !s->work))
		end(&s);
	return s;
}

int main(int argc, char **argv)
{
	struct session *s;
	int status = GR_EXIT_OK;

	gr_log_init("bench-packing", GR_LOG_WARNING);
	if (argc < 2) {
		fprintf(stderr, "usage: bench-packing FILE... (recorded sessions; scenes, whose shared light it is)\n");
		return GR_EXIT_CONFIG;
	}
	s = begin();
	if (!s) {
		fprintf(stderr, "bench-packing: no memory\n");
		return GR_EXIT_RUNTIME;
	}
	printf("| session | what | count | bytes |");
	for (int k = 0; k < CODECS; k++)
		printf(" %s |", codecs[k].name);
	printf("\n|---|---|---|---|---|---|---|---|\n");
	for (int i = 1; i < argc && status == GR_EXIT_OK; i++)
		if (!run_file(argv[i], s))
			status = GR_EXIT_RUNTIME;
	end(&s);
	return status;
}
