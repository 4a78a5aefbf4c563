/*
 * walk LAYOUT head.csv: does the recorded head walk as the layout's simulated
 * visitor does? Compares each sample with the truth at its time.
 */
#include "base/result.h"
#include "daemon/trackers.h"
#include "tracking/sim.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The n-th value of a line of plain numbers and quoted names without commas. */
static double value_at(const char *line, int n)
{
	while (n-- > 0 && line)
		line = strchr(line, ',') ? strchr(line, ',') + 1 : NULL;
	return line ? strtod(line, NULL) : NAN;
}

int main(int argc, char **argv)
{
	struct gr_diag diag = { 0 };
	struct layout *layout = NULL;
	struct trackers trackers;
	double worst = 0, last = -1, longest = 0, noise;
	char line[1024];
	long samples = 0;
	FILE *file = argc == 3 ? fopen(argv[2], "r") : NULL;

	if (!file || layout_load(argv[1], &layout, &diag) < 0 ||
	    trackers_open(&trackers, layout, &diag) < 0 || !fgets(line, sizeof line, file))
		return 2;
	noise = (double)layout->trackers[0].sim.noise_position_m;
	while (fgets(line, sizeof line, file)) {
		const double time_s = value_at(line, 1);
		struct gr_pose truth;

		track_sim_truth(trackers.all[0].source, TRACK_HEAD, llrint(time_s * 1e9), &truth);
		for (int i = 0; i < 3; i++)
			worst = fmax(worst, fabs(value_at(line, 5 + i) - (double)truth.p[i]));
		if (!(time_s > last))
			return printf("samples go back in time: %s", line), 1;
		if (last >= 0)
			longest = fmax(longest, time_s - last);
		last = time_s;
		samples++;
	}
	printf("# %ld samples of the head, at most %.3f mm from the truth (noise %.3f mm), longest gap %.1f ms\n",
	       samples, worst * 1e3, noise * 1e3, longest * 1e3);
	trackers_close(&trackers);
	layout_destroy(&layout);
	fclose(file);
	/* Of three coordinates of some thousand samples none is six deviations away by chance. */
	return samples > 0 && worst <= 6 * noise + 1e-6 ? 0 : 1;
}
