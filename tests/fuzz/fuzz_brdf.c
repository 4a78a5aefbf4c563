/* A measured BRDF's text: refused with one line, or samples that are in range. */
#include "base/result.h"
#include "renderer/scene/brdf_read.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct gr_diag diag = { 0 };
	struct brdf_samples samples;
	int result = brdf_read((const char *)data, size, "fuzz", &samples, &diag);

	if (result == GR_OK ? diag.errors != 0 : result != GR_ERR_CONFIG || diag.errors != 1)
		abort();
	for (size_t i = 0; i < samples.count; i++) {
		const struct brdf_sample *s = &samples.samples[i];

		if (!(s->theta_i >= 0 && s->theta_i < 1.58 && s->theta_o >= 0 && s->theta_o < 1.58 &&
		      s->phi >= 0 && s->phi < 3.15))
			abort();
		for (int c = 0; c < 3; c++)
			if (!(s->rgb[c] >= 0 && isfinite(s->rgb[c])))
				abort();
	}
	brdf_samples_finish(&samples);
	gr_diag_finish(&diag);
	return 0;
}
