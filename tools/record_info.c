#include "tools/record_info.h"

#include "base/result.h"
#include "record/survey.h"
#include "tools/say.h"

#include <inttypes.h>
#include <json-c/json.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

struct info {
	const char *path;
	struct json_object *recordings; /* NULL: in words */
	int count;
	bool faults; /* something that was recorded is not right any more, or is missing */
};

static void hex(const uint8_t *bytes, char out[65])
{
	for (int i = 0; i < 32; i++)
		snprintf(out + (ptrdiff_t)2 * i, 3, "%02x", bytes[i]);
}

static void date(int64_t wall_ns, char *out, size_t size)
{
	const time_t seconds = (time_t)(wall_ns / 1000000000);
	struct tm utc;

	out[0] = '\0';
	if (gmtime_r(&seconds, &utc))
		strftime(out, size, "%Y-%m-%d %H:%M:%S UTC", &utc);
}

/* Names of a file from anywhere: nothing that a terminal would obey. */
static const char *shown(const char *text, char *out, size_t size)
{
	size_t n = 0;

	for (; *text && n + 1 < size; text++)
		out[n++] = (unsigned char)*text < 0x7f ? *text : '?';
	out[n] = '\0';
	return out;
}

static uint64_t total(const uint64_t *counts, size_t n)
{
	uint64_t sum = 0;

	for (size_t i = 0; i < n; i++)
		sum += counts[i];
	return sum;
}

static void print_frames(const struct record_survey *s)
{
	if (s->frames == 0) {
		printf("  frames    none\n");
		return;
	}
	printf("  frames    %" PRIu64 ", numbers %" PRIu64 " to %" PRIu64 ", %" PRIu64 " with a whole state",
	       s->frames, s->first_frame, s->last_frame, s->wholes);
	if (s->frames_missing)
		printf("; %" PRIu64 " missing", s->frames_missing);
	if (s->frames_unusable)
		printf("; %" PRIu64 " of no use, their base is missing", s->frames_unusable);
	if (s->frames_wrong)
		printf("; %" PRIu64 " not what their hash says", s->frames_wrong);
	printf("%s\n", s->states_known ? "" : "; of other parameters than this grotto's: not looked at");
}

static void print_names(const char *what, const struct record_session *s, bool nodes,
			const uint64_t *counts, const char *unit)
{
	const int n = nodes ? s->node_count : s->tracker_count;
	char name[RECORD_NAME_BYTES];

	printf("  %-9s", what);
	for (int i = 0; i < n; i++)
		printf("%s %s %" PRIu64, i ? "," : "",
		       shown(nodes ? s->nodes[i] : s->trackers[i], name, sizeof name), counts[i]);
	printf("%s%s\n", n ? " " : " none", n ? unit : "");
}

static void print_events(const struct record_survey *s)
{
	bool any = false;

	printf("  events   ");
	for (unsigned kind = RECORD_JOINED; kind <= RECORD_SETTING; kind++)
		if (s->events[kind]) {
			printf("%s %" PRIu64 " %s", any ? "," : "", s->events[kind], record_event_name((uint8_t)kind));
			any = true;
		}
	printf("%s; %" PRIu64 " swaps\n", any ? "" : " none", s->swaps);
}

static bool rules_kept(const struct record_rules *r)
{
	return r->different + r->early + r->back == 0;
}

static void print_rules(const struct record_rules *r)
{
	printf("  rules     %s: %" PRIu64 " answers of nodes with the frame's hash, %" PRIu64 " with another; %" PRIu64
	       " swaps before all were ready or late, %" PRIu64 " out of order\n",
	       rules_kept(r) ? "kept" : "BROKEN", r->equal, r->different, r->early, r->back);
}

static void print_end(const struct record_survey *s)
{
	if (s->lost)
		printf("  lost      %" PRIu64 " entries, %" PRIu64 " of them frames: the disk was too slow\n",
		       s->lost, s->lost_frames);
	if (s->gaps)
		printf("  gaps      %" PRIu64 ": blocks are missing or damaged\n", s->gaps);
	printf("  end       %s\n", s->ended ? record_end_name(s->end.reason)
					 : "none: it was cut off, or is still being written");
}

static void print_survey(const struct info *info, const struct record_survey *s)
{
	char when[64], hash[65], layout[RECORD_NAME_BYTES], scene[RECORD_NAME_BYTES], grotto[RECORD_NAME_BYTES];

	date(s->session.wall_ns, when, sizeof when);
	printf("recording %d: %s, %.3f s, grotto %s%s%s\n", info->count, when,
	       s->last_ns > 0 ? (double)(s->last_ns - s->session.start_ns) * 1e-9 : 0.0,
	       shown(s->session.grotto, grotto, sizeof grotto),
	       s->session.flags & RECORD_FRAME_CLOCK ? ", frame clock" : "",
	       s->session.flags & RECORD_OF_REPLAY ? ", of a replay" : "");
	hex(s->session.layout_hash, hash);
	printf("  layout    %s %.16s\n", shown(s->session.layout, layout, sizeof layout), hash);
	hex(s->session.scene_hash, hash);
	printf("  scene     %s %.16s, %g frames a second\n",
	       shown(s->session.scene, scene, sizeof scene), hash, (double)s->session.frame_hz);
	print_frames(s);
	print_names("trackers", &s->session, false, s->samples, "samples");
	print_names("nodes", &s->session, true, s->reports, "reports");
	print_events(s);
	print_rules(&s->rules);
	print_end(s);
}

static void add_count(struct json_object *to, const char *key, uint64_t value)
{
	json_object_object_add(to, key, json_object_new_uint64(value));
}

static void add_text(struct json_object *to, const char *key, const char *text)
{
	char plain[RECORD_PATH_BYTES];

	json_object_object_add(to, key, json_object_new_string(shown(text, plain, sizeof plain)));
}

static struct json_object *named_counts(const struct record_session *s, bool nodes,
					const uint64_t *counts)
{
	struct json_object *object = json_object_new_object();
	const int n = nodes ? s->node_count : s->tracker_count;
	char name[RECORD_NAME_BYTES];

	for (int i = 0; i < n; i++)
		add_count(object, shown(nodes ? s->nodes[i] : s->trackers[i], name, sizeof name), counts[i]);
	return object;
}

static void add_survey(struct info *info, const struct record_survey *s)
{
	struct json_object *o = json_object_new_object(), *events = json_object_new_object(),
			   *rules = json_object_new_object();
	char text[65];

	add_text(o, "grotto", s->session.grotto);
	add_text(o, "layout", s->session.layout);
	add_text(o, "scene", s->session.scene);
	hex(s->session.layout_hash, text);
	add_text(o, "layout_hash", text);
	hex(s->session.scene_hash, text);
	add_text(o, "scene_hash", text);
	add_text(o, "layout_path", s->session.layout_path);
	add_text(o, "scene_path", s->session.scene_path);
	date(s->session.wall_ns, text, sizeof text);
	add_text(o, "date", text);
	json_object_object_add(o, "seconds", json_object_new_double(
		s->last_ns > 0 ? (double)(s->last_ns - s->session.start_ns) * 1e-9 : 0.0));
	json_object_object_add(o, "frame_clock",
			       json_object_new_boolean(s->session.flags & RECORD_FRAME_CLOCK));
	json_object_object_add(o, "of_replay",
			       json_object_new_boolean(s->session.flags & RECORD_OF_REPLAY));
	json_object_object_add(o, "ended", json_object_new_boolean(s->ended));
	add_count(o, "blocks", s->blocks);
	add_count(o, "bytes", s->bytes);
	add_count(o, "frames", s->frames);
	add_count(o, "wholes", s->wholes);
	add_count(o, "first_frame", s->first_frame);
	add_count(o, "last_frame", s->last_frame);
	add_count(o, "frames_missing", s->frames_missing);
	add_count(o, "frames_unusable", s->frames_unusable);
	add_count(o, "frames_wrong", s->frames_wrong);
	add_count(o, "lost", s->lost);
	add_count(o, "gaps", s->gaps);
	add_count(o, "swaps", s->swaps);
	json_object_object_add(o, "samples", named_counts(&s->session, false, s->samples));
	json_object_object_add(o, "reports", named_counts(&s->session, true, s->reports));
	json_object_object_add(o, "shown", named_counts(&s->session, true, s->shown));
	for (unsigned kind = RECORD_JOINED; kind <= RECORD_SETTING; kind++)
		add_count(events, record_event_name((uint8_t)kind), s->events[kind]);
	json_object_object_add(o, "events", events);
	add_count(o, "samples_total", total(s->samples, RECORD_TRACKERS));
	add_count(rules, "equal", s->rules.equal);
	add_count(rules, "different", s->rules.different);
	add_count(rules, "early", s->rules.early);
	add_count(rules, "back", s->rules.back);
	json_object_object_add(o, "rules", rules);
	json_object_array_add(info->recordings, o);
}

static void on_survey(void *ctx, const struct record_survey *survey)
{
	struct info *info = ctx;

	info->count++;
	info->faults = info->faults || survey->frames_wrong || survey->gaps || survey->lost ||
		       !rules_kept(&survey->rules);
	if (info->recordings)
		add_survey(info, survey);
	else
		print_survey(info, survey);
}

static void print_damage(const struct record_damage *d, uint64_t size)
{
	printf("file: %" PRIu64 " bytes", size);
	if (d->bad || d->bytes || d->missing || d->unordered || d->versions)
		printf("; damage: %" PRIu64 " blocks not sound, %" PRIu64 " missing, %" PRIu64
		       " out of order, %" PRIu64 " of another version, %" PRIu64 " bytes stepped over",
		       d->bad, d->missing, d->unordered, d->versions, d->bytes);
	if (d->tail)
		printf("; the last %" PRIu64 " bytes are no whole block", d->tail);
	printf("\n");
}

static void print_json(const struct info *info, const struct record_damage *d, uint64_t size)
{
	struct json_object *root = json_object_new_object(), *damage = json_object_new_object();

	add_count(root, "size", size);
	add_count(damage, "bad", d->bad);
	add_count(damage, "missing", d->missing);
	add_count(damage, "unordered", d->unordered);
	add_count(damage, "versions", d->versions);
	add_count(damage, "bytes", d->bytes);
	add_count(damage, "tail", d->tail);
	json_object_object_add(root, "damage", damage);
	json_object_object_add(root, "recordings", json_object_get(info->recordings));
	printf("%s\n", json_object_to_json_string_ext(root, JSON_C_TO_STRING_PLAIN));
	json_object_put(root);
}

static struct record_reader *open_record(const char *path)
{
	struct record_reader *reader = NULL;
	struct gr_diag diag = { 0 };

	record_reader_open(&reader, path, &diag);
	say_diag(&diag);
	gr_diag_finish(&diag);
	return reader;
}

int record_info(const char *path, bool json)
{
	struct info info = { .path = path, .recordings = json ? json_object_new_array() : NULL };
	struct record_reader *reader = open_record(path);
	struct record_damage damage;
	int r;

	if (!reader) {
		json_object_put(info.recordings);
		return GR_EXIT_CONFIG;
	}
	r = record_survey(reader, on_survey, &info);
	record_reader_damage(reader, &damage);
	if (r == GR_OK && json)
		print_json(&info, &damage, record_reader_size(reader));
	else if (r == GR_OK)
		print_damage(&damage, record_reader_size(reader));
	record_reader_destroy(&reader);
	json_object_put(info.recordings);
	if (r == GR_NOTHING)
		fprintf(stderr, damage.versions ? "%s: is a recording of another version of grotto\n"
						: "%s: holds no recording\n", path);
	else if (r < 0)
		fprintf(stderr, "%s: %s\n", path, gr_result_name(r));
	if (r != GR_OK)
		return r == GR_NOTHING ? GR_EXIT_CONFIG : GR_EXIT_RUNTIME;
	/* A torn tail is what a crash leaves, and no fault of the rest. */
	return info.faults || damage.bad || damage.missing || damage.unordered || damage.bytes
		       ? GR_EXIT_RUNTIME : GR_EXIT_OK;
}
