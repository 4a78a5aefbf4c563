#include "renderer/gi/dispatch.h"

#include "base/result.h"

int dispatch_plan(uint64_t items, uint32_t group, struct dispatch *out)
{
	uint64_t groups = items / group + (items % group != 0);
	uint64_t rows = groups / DISPATCH_AXIS_MAX + (groups % DISPATCH_AXIS_MAX != 0);

	if (rows > DISPATCH_AXIS_MAX)
		return GR_ERR_RANGE;
	if (rows == 0)
		rows = 1;
	out->y = (uint32_t)rows;
	/* even rows: little is left over past the end */
	out->x = (uint32_t)((groups + rows - 1) / rows);
	if (out->x == 0)
		out->x = 1;
	return GR_OK;
}
