#include "tracking/handover.h"

void track_handover_put(struct track_handover *h, const struct track_report *report)
{
	const uint64_t n = atomic_load_explicit(&h->written, memory_order_relaxed);
	struct track_handover_slot *slot = &h->slots[n % TRACK_HANDOVER];

	/* The stamp of report n is 2 n + 2: a reader knows which one it holds. */
	gr_seqlock_write(&slot->sequence, slot->words, 2 * n + 2, report, sizeof *report);
	atomic_store_explicit(&h->written, n + 1, memory_order_release);
}

static bool take_one(const struct track_handover *h, uint64_t n, struct track_report *out)
{
	const struct track_handover_slot *slot = &h->slots[n % TRACK_HANDOVER];
	uint64_t stamp;

	return gr_seqlock_read(&slot->sequence, slot->words, &stamp, out, sizeof *out) &&
	       stamp == 2 * n + 2;
}

int track_handover_take(const struct track_handover *h, struct track_reader *reader,
			struct track_report *out, int room)
{
	const uint64_t written = atomic_load_explicit(&h->written, memory_order_acquire);
	int count = 0;

	if (written - reader->next > TRACK_HANDOVER) {
		reader->missed += written - TRACK_HANDOVER - reader->next;
		reader->next = written - TRACK_HANDOVER;
	}
	while (count < room && reader->next < written) {
		if (take_one(h, reader->next, &out[count]))
			count++;
		else /* the writer has come round meanwhile */
			reader->missed++;
		reader->next++;
	}
	return count;
}
