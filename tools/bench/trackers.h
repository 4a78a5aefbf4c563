/* grotto bench trackers: filters beside each other, on a hand that works or a recorded log. */
#ifndef GROTTO_TOOLS_BENCH_TRACKERS_H
#define GROTTO_TOOLS_BENCH_TRACKERS_H

/* argv[0] is "trackers". Returns the exit status. */
int bench_trackers(int argc, char **argv);

#endif
