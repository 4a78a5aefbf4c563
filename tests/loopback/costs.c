/*
 * costs FROM TO FACTOR: a file of costs (renderer/gi/costs_file.h) for the device of FROM, as
 * if that GPU took FACTOR times what is usual. So that nodes plan differently on any machine.
 */
#include "base/result.h"
#include "renderer/gi/costs_file.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv)
{
	struct gi_costs costs = gi_costs_usual;
	char device[COSTS_DEVICE_MAX] = "";
	double factor;
	FILE *from;

	if (argc != 4 || sodium_init() < 0 || !(from = fopen(argv[1], "r")))
		return 2;
	factor = atof(argv[3]);
	if (fscanf(from, "%*[^\n]\ndevice %255[^\n]", device) != 1 || !(factor > 0)) {
		fclose(from);
		return 2;
	}
	fclose(from);
	costs.lattice_frame *= factor;
	costs.lattice_cell_step *= factor;
	costs.surfel_frame *= factor;
	costs.surfel_tap *= factor;
	costs.surfel_link *= factor;
	return gi_costs_save(argv[2], device, &costs) == GR_OK ? 0 : 1;
}
