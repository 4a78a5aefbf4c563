/* libFuzzer target: any bytes are a projector's table, which then can be looked up, or are refused. */
#include "base/result.h"
#include "renderer/tone/projector.h"

#include <math.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct projector projector; /* large: not on the stack of each of them */
	struct gr_diag diag = { 0 };
	int result = projector_parse(data, size, "fuzz.csv", &projector, &diag);

	if ((result == GR_OK) != !diag.count)
		abort();
	for (int i = 0; result == GR_OK && i <= 32; i++)
		for (int c = 0; c < 3; c++) {
			double light = projector_light(&projector, c, i / 32.0);
			double code = projector_code(&projector, c, light);

			if (!(code >= 0 && code <= 1) || !isfinite(light))
				abort();
		}
	gr_diag_finish(&diag);
	return 0;
}
