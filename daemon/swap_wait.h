/*
 * Waiting for the time of a swap. A timer wakes a process tens of microseconds
 * late, and on an idle processor later still; so the last stretch is spent
 * looking at the clock.
 */
#ifndef GROTTO_DAEMON_SWAP_WAIT_H
#define GROTTO_DAEMON_SWAP_WAIT_H

#include <stdint.h>

/*
 * Returns once CLOCK_MONOTONIC is at_ns or past it, with what it is then. Sleeps
 * until busy_ns before; from there on it looks at the clock, and gives the
 * processor to whoever else is ready between two looks: several nodes of one
 * machine then come to their time together, not one after the other.
 */
int64_t swap_wait(int64_t at_ns, int64_t busy_ns);
/*
 * Between a swap and telling of it: another node of this machine whose swap is
 * due comes first, for its wall is seen and our word is not.
 */
void swap_give_way(void);

#endif
