#include "record/rules.h"

#include <string.h>

#define BIT(node) (UINT64_C(1) << (node))

void record_rules_gap(struct record_rules *rules)
{
	memset(rules->open, 0, sizeof rules->open);
}

static void note_frame(struct record_rules *rules, const struct record_frame *f)
{
	const unsigned slot = f->frame % RECORD_RULES_OPEN;

	memset(&rules->open[slot], 0, sizeof rules->open[slot]);
	rules->open[slot].frame = f->frame;
	rules->open[slot].hash = f->hash;
	rules->open[slot].live = f->live;
}

static void note_report(struct record_rules *rules, const struct record_report *p)
{
	const unsigned slot = p->frame % RECORD_RULES_OPEN;
	const bool ready = strcmp(record_report_name(p->kind), "ready") == 0;

	if (strcmp(record_report_name(p->kind), "swapped") == 0 || p->frame == 0 ||
	    rules->open[slot].frame != p->frame)
		return;
	if (p->hash != rules->open[slot].hash) {
		rules->different++;
		return;
	}
	if (!(rules->open[slot].answered & BIT(p->node)))
		rules->equal++;
	rules->open[slot].answered |= BIT(p->node);
	if (ready)
		rules->open[slot].ready |= BIT(p->node);
}

static void note_event(struct record_rules *rules, const struct record_event *e)
{
	const bool gone = e->kind == RECORD_LEFT || e->kind == RECORD_EVICTED || e->kind == RECORD_JOINED;

	if (e->node >= RECORD_NODES)
		return;
	for (int i = 0; i < RECORD_RULES_OPEN; i++)
		if (gone || (e->kind == RECORD_LATE && rules->open[i].frame == e->frame))
			rules->open[i].excused |= BIT(e->node);
}

static void note_swap(struct record_rules *rules, uint64_t frame)
{
	const unsigned slot = frame % RECORD_RULES_OPEN;

	rules->back += frame <= rules->last_swap;
	rules->last_swap = frame;
	if (rules->open[slot].frame == frame)
		rules->early += (rules->open[slot].live &
				 ~(rules->open[slot].ready | rules->open[slot].excused)) != 0;
}

void record_rules_note(struct record_rules *rules, const struct record_entry *entry)
{
	switch (entry->kind) {
	case RECORD_STATE:
	case RECORD_DELTA: note_frame(rules, &entry->frame); break;
	case RECORD_REPORT: note_report(rules, &entry->report); break;
	case RECORD_EVENT: note_event(rules, &entry->event); break;
	case RECORD_SWAP: note_swap(rules, entry->swap.frame); break;
	case RECORD_LOST: record_rules_gap(rules); break;
	case RECORD_SAMPLE:
	case RECORD_SHOWN: break;
	}
}
