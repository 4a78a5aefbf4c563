#include "record/csv_private.h"

#include "base/clock.h"
#include "base/result.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

struct csv {
	FILE *const *files;
	const struct record_session *session;
	struct csv_frames frames;
};

const char *record_table_name(enum record_table table)
{
	static const char *const names[RECORD_TABLES] = { "head", "wand", "frames", "reports", "events" };

	return (unsigned)table < RECORD_TABLES ? names[table] : "unknown";
}

/* With all nine decimals, exactly. */
void csv_seconds(FILE *file, int64_t ns)
{
	const uint64_t size = ns < 0 ? -(uint64_t)ns : (uint64_t)ns;

	fprintf(file, "%s%" PRIu64 ".%09" PRIu64, ns < 0 ? "-" : "", size / GR_NS_PER_S,
		size % GR_NS_PER_S);
}

void csv_text(FILE *file, const char *text)
{
	fputc('"', file);
	for (; *text; text++) {
		if (*text == '"')
			fputc('"', file);
		fputc(*text, file);
	}
	fputc('"', file);
}

void csv_floats(FILE *file, const float *values, int count)
{
	for (int i = 0; i < count; i++)
		fprintf(file, ",%.9g", (double)values[i]);
}

static void write_heads(FILE *const files[RECORD_TABLES])
{
	static const char samples[] =
		"arrived_s,sample_s,tracker,valid,used,x_m,y_m,z_m,qx,qy,qz,qw,buttons,"
		"axis0,axis1,axis2,axis3,axis4,axis5,axis6,axis7,device_s\n";

	for (int i = RECORD_TABLE_HEAD; i <= RECORD_TABLE_WAND; i++)
		if (files[i])
			fputs(samples, files[i]);
	if (files[RECORD_TABLE_FRAMES])
		csv_frames_head(files[RECORD_TABLE_FRAMES]);
	if (files[RECORD_TABLE_REPORTS])
		fputs("arrived_s,node,report,frame,hash,swapped_frame,swapped_count,swapped_node_s,"
		      "render_us\n", files[RECORD_TABLE_REPORTS]);
	if (files[RECORD_TABLE_EVENTS])
		fputs("time_s,event,node,frame,ours,theirs,text\n", files[RECORD_TABLE_EVENTS]);
}

static void write_sample(const struct csv *csv, int64_t time_ns, const struct record_sample *s)
{
	FILE *file = csv->files[s->body == 0 ? RECORD_TABLE_HEAD : RECORD_TABLE_WAND];

	if (!file)
		return;
	csv_seconds(file, time_ns - csv->session->start_ns);
	fputc(',', file);
	csv_seconds(file, s->time_ns);
	fputc(',', file);
	csv_text(file, csv->session->trackers[s->tracker]);
	fprintf(file, ",%d,%d", !!(s->flags & RECORD_VALID), !!(s->flags & RECORD_TAKEN));
	csv_floats(file, s->T_room_body.p, 3);
	csv_floats(file, s->T_room_body.q, 4);
	fprintf(file, ",%" PRIu32, s->buttons);
	csv_floats(file, s->axes, s->axis_count);
	for (int i = s->axis_count; i < RECORD_AXES; i++)
		fputc(',', file);
	fputc(',', file);
	if (s->flags & RECORD_TIMED)
		csv_seconds(file, s->device_ns);
	fputc('\n', file);
}

static void write_report(const struct csv *csv, int64_t time_ns, const struct record_report *p)
{
	FILE *file = csv->files[RECORD_TABLE_REPORTS];

	if (!file)
		return;
	csv_seconds(file, time_ns - csv->session->start_ns);
	fputc(',', file);
	csv_text(file, csv->session->nodes[p->node]);
	fprintf(file, ",%s,%" PRIu64 ",%016" PRIx64 ",%" PRIu64 ",%" PRIu64 ",",
		record_report_name(p->kind), p->frame, p->hash, p->swapped_frame, p->swapped_count);
	csv_seconds(file, p->swap_ns);
	fprintf(file, ",%" PRIu32 "\n", p->render_us);
}

static void write_event(const struct csv *csv, int64_t time_ns, const char *event, const char *node,
			uint64_t frame)
{
	FILE *file = csv->files[RECORD_TABLE_EVENTS];

	csv_seconds(file, time_ns - csv->session->start_ns);
	fprintf(file, ",%s,", event);
	csv_text(file, node);
	if (frame > 0)
		fprintf(file, ",%" PRIu64 ",", frame);
	else
		fputs(",,", file);
}

static void note_event(const struct csv *csv, int64_t time_ns, const struct record_event *e)
{
	FILE *file = csv->files[RECORD_TABLE_EVENTS];

	if (!file)
		return;
	write_event(csv, time_ns, record_event_name(e->kind),
		    e->node == RECORD_ALL_NODES ? "" : csv->session->nodes[e->node], e->frame);
	if (e->kind == RECORD_MISMATCH)
		fprintf(file, "%016" PRIx64 ",%016" PRIx64 ",", e->ours, e->theirs);
	else
		fputs(",,", file);
	csv_text(file, e->text);
	fputc('\n', file);
}

static void note_lost(const struct csv *csv, int64_t time_ns, const struct record_lost *lost)
{
	FILE *file = csv->files[RECORD_TABLE_EVENTS];

	if (!file)
		return;
	write_event(csv, time_ns, "lost", "", 0);
	fprintf(file, ",,\"%" PRIu64 " entries, %" PRIu64 " of them frames: the disk was too slow\"\n",
		lost->entries, lost->frames);
}

static void note(struct csv *csv, const struct record_entry *entry)
{
	switch (entry->kind) {
	case RECORD_SAMPLE: write_sample(csv, entry->time_ns, &entry->sample); break;
	case RECORD_REPORT: write_report(csv, entry->time_ns, &entry->report); break;
	case RECORD_EVENT: note_event(csv, entry->time_ns, &entry->event); break;
	case RECORD_LOST: note_lost(csv, entry->time_ns, &entry->lost); break;
	case RECORD_STATE:
	case RECORD_DELTA:
	case RECORD_SWAP:
	case RECORD_SHOWN: break;
	}
	if (csv->frames.file)
		csv_frames_note(&csv->frames, entry);
}

static void note_block(struct csv *csv, struct record_reader *reader,
		       const struct record_block *block)
{
	struct record_cursor cursor = record_block_entries(reader, block);
	struct record_entry entry;

	if (block->gap) {
		record_states_gap(&csv->frames.states);
		if (csv->files[RECORD_TABLE_EVENTS] && record_cursor_next(&cursor, &entry)) {
			write_event(csv, entry.time_ns, "gap", "", 0);
			fputs(",,\"blocks are missing or damaged before this\"\n",
			      csv->files[RECORD_TABLE_EVENTS]);
		}
		cursor = record_block_entries(reader, block);
	}
	while (record_cursor_next(&cursor, &entry))
		note(csv, &entry);
}

int record_csv_write(struct record_reader *reader, int recording, FILE *const files[RECORD_TABLES])
{
	struct csv *csv = calloc(1, sizeof *csv);
	struct record_block block;
	int found = 0, r = csv ? record_states_init(&csv->frames.states) : GR_ERR_NOMEM;

	if (r == GR_OK) {
		csv->files = files;
		csv->session = record_reader_session(reader);
		csv->frames.file = files[RECORD_TABLE_FRAMES];
	}
	while (r == GR_OK && found <= recording &&
	       (r = record_reader_next(reader, &block)) == GR_OK) {
		found += block.first;
		if (found != recording)
			continue;
		if (block.first) {
			write_heads(files);
			csv->frames.start_ns = csv->session->start_ns;
			csv->frames.states_known = csv->session->table_hash == param_table_hash();
		}
		note_block(csv, reader, &block);
	}
	if (csv) {
		csv_frames_end(&csv->frames);
		record_states_finish(&csv->frames.states);
	}
	free(csv);
	if (r == GR_NOTHING || r == GR_OK)
		return found >= recording ? GR_OK : GR_NOTHING;
	return r;
}
