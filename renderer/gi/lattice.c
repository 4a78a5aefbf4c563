#include "renderer/gi/lattice.h"

#include "base/result.h"

#include <math.h>

int lattice_init(struct lattice *out, const float min[3], const float max[3], int longest)
{
	float side = 0;

	if (longest < 2 || longest > LATTICE_MAX)
		return GR_ERR_RANGE;
	for (int i = 0; i < 3; i++) {
		float extent = max[i] - min[i];

		if (!isfinite(min[i]) || !isfinite(max[i]) || !isfinite(extent) || extent < 0)
			return GR_ERR_RANGE;
		if (extent > side)
			side = extent;
	}
	if (!(side > 0))
		return GR_ERR_RANGE;
	out->d = side / (float)longest;
	for (int i = 0; i < 3; i++) {
		/* a thousandth of a cell over is rounding, not another layer */
		int n = (int)ceilf((max[i] - min[i]) / out->d - 1e-3f);

		out->size[i] = n < 1 ? 1 : (n > longest ? longest : n);
		out->origin[i] = min[i];
	}
	return GR_OK;
}
