/*
 * Real-time priority for the calling thread alone: what a daemon does for its
 * barrier comes before ordinary work of the machine.
 */
#ifndef GROTTO_DAEMON_PRIORITY_H
#define GROTTO_DAEMON_PRIORITY_H

/*
 * SCHED_RR at `priority` (1..99; 0 asks for nothing), or as much as RLIMIT_RTPRIO
 * allows. Threads and processes begun later do not inherit it. Logs what it got;
 * being refused is no failure. Returns the priority that holds, 0: ordinary.
 */
int priority_take(int priority);

#endif
