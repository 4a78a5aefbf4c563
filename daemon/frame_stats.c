#include "daemon/frame_stats.h"

#include "base/clock.h"

#include <stddef.h>

static struct frame_open *find(struct frame_stats *stats, uint64_t frame)
{
	struct frame_open *open = &stats->open[frame % FRAME_STATS_OPEN];

	return frame != 0 && open->frame == frame ? open : NULL;
}

void frame_stats_begin(struct frame_stats *stats, uint64_t frame, uint64_t expected,
		       int64_t now_ns)
{
	struct frame_open *open = &stats->open[frame % FRAME_STATS_OPEN];

	if (open->frame != 0)
		stats->incomplete++;
	*open = (struct frame_open){ .frame = frame, .begin_ns = now_ns, .expected = expected };
	stats->begun++;
}

void frame_stats_applied(struct frame_stats *stats, unsigned node, uint64_t frame, int64_t now_ns)
{
	struct frame_open *open = find(stats, frame);

	if (!open || node >= FRAME_STATS_NODES || open->applied >> node & 1)
		return;
	open->applied |= UINT64_C(1) << node;
	if ((open->applied & open->expected) == open->expected)
		histogram_add(&stats->applied, (now_ns - open->begin_ns) / GR_NS_PER_US);
}

void frame_stats_swap_sent(struct frame_stats *stats, uint64_t frame, bool scheduled, int64_t now_ns)
{
	struct frame_open *open = find(stats, frame);
	int64_t took;

	if (!open)
		return;
	open->swap_sent_ns = now_ns;
	open->scheduled = scheduled;
	took = now_ns - open->begin_ns;
	histogram_add(&stats->swap_sent, took / GR_NS_PER_US);
	stats->smoothed_swap_ns = stats->smoothed_swap_ns == 0 ?
					  took : stats->smoothed_swap_ns + (took - stats->smoothed_swap_ns) / 8;
}

static void close_if_whole(struct frame_stats *stats, struct frame_open *open)
{
	if (open->frame == 0 || (open->arrived & open->expected) != open->expected)
		return;
	if (open->arrived & (open->arrived - 1) && !open->unknown) { /* two or more: there is a spread */
		const int64_t us = (open->last_swap_ns - open->first_swap_ns) / GR_NS_PER_US;

		histogram_add(&stats->skew, us);
		histogram_add(open->scheduled ? &stats->skew_scheduled : &stats->skew_told, us);
	}
	stats->complete++;
	open->frame = 0;
}

void frame_stats_swapped(struct frame_stats *stats, unsigned node, uint64_t frame,
			 int64_t swap_ns, int64_t now_ns)
{
	struct frame_open *open = find(stats, frame);

	if (!open || node >= FRAME_STATS_NODES || open->arrived >> node & 1)
		return;
	if (open->arrived == 0 || swap_ns < open->first_swap_ns)
		open->first_swap_ns = swap_ns;
	if (open->arrived == 0 || swap_ns > open->last_swap_ns)
		open->last_swap_ns = swap_ns;
	open->unknown |= swap_ns == 0;
	open->arrived |= UINT64_C(1) << node;
	if ((open->arrived & open->expected) == open->expected)
		histogram_add(&stats->last_swapped, (now_ns - open->begin_ns) / GR_NS_PER_US);
	if ((open->arrived & open->expected) == open->expected && open->swap_sent_ns != 0)
		histogram_add(&stats->swap_to_last, (now_ns - open->swap_sent_ns) / GR_NS_PER_US);
	close_if_whole(stats, open);
}

void frame_stats_gone(struct frame_stats *stats, unsigned node)
{
	if (node >= FRAME_STATS_NODES)
		return;
	for (int i = 0; i < FRAME_STATS_OPEN; i++) {
		struct frame_open *open = &stats->open[i];
		open->expected &= ~(UINT64_C(1) << node);
		if (open->frame != 0 && open->expected != 0)
			close_if_whole(stats, open);
	}
}

bool frame_stats_settled(const struct frame_stats *stats, uint64_t frame)
{
	const struct frame_open *open = &stats->open[frame % FRAME_STATS_OPEN];

	return open->frame != frame;
}
