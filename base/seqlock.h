/*
 * A value that one thread writes and any thread reads, without locks: the
 * writer never waits, a reader sees a whole value or is told to try again
 * (Lameter, "Effective synchronization on Linux/NUMA systems", 2005; the
 * ordering is that of Boehm, "Can seqlocks get along with programming language
 * memory models?", 2012). The words are atomic themselves and ordered by
 * release and acquire instead of by fences, so ThreadSanitizer follows it.
 *
 * `size` is that of the value, a multiple of 8; `words` has size / 8 of them.
 */
#ifndef GROTTO_BASE_SEQLOCK_H
#define GROTTO_BASE_SEQLOCK_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Number of words of a type; its size must be a multiple of theirs. */
#define GR_SEQLOCK_WORDS(type) (sizeof(type) / sizeof(uint64_t))

/* `stamp` (even) is what the sequence becomes; the writer makes it ascend. Writer alone. */
static inline void gr_seqlock_write(_Atomic uint64_t *sequence, _Atomic uint64_t *words,
				    uint64_t stamp, const void *from, size_t size)
{
	const char *bytes = from;

	atomic_store_explicit(sequence, stamp - 1, memory_order_relaxed);
	for (size_t i = 0; i < size / sizeof(uint64_t); i++) {
		uint64_t word;

		memcpy(&word, bytes + i * sizeof word, sizeof word);
		/* Whoever sees this word sees the odd sequence before it, too. */
		atomic_store_explicit(&words[i], word, memory_order_release);
	}
	atomic_store_explicit(sequence, stamp, memory_order_release);
}

/*
 * True with *stamp and a whole value, false (the value is then meaningless)
 * when the writer was at it meanwhile. A stamp of 0: nothing was ever written.
 */
static inline bool gr_seqlock_read(const _Atomic uint64_t *sequence, const _Atomic uint64_t *words,
				   uint64_t *stamp, void *to, size_t size)
{
	char *bytes = to;

	*stamp = atomic_load_explicit(sequence, memory_order_acquire);
	for (size_t i = 0; i < size / sizeof(uint64_t); i++) {
		const uint64_t word = atomic_load_explicit(&words[i], memory_order_acquire);

		memcpy(bytes + i * sizeof word, &word, sizeof word);
	}
	return !(*stamp & 1) && atomic_load_explicit(sequence, memory_order_relaxed) == *stamp;
}

#endif
