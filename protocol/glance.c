#include "protocol/glance.h"

#include "base/cursor.h"
#include "base/result.h"

#include <math.h>

size_t fdp_glance_encode(const struct fdp_glance *glance, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);

	gr_write_f32(&w, glance->log_sum);
	gr_write_f32(&w, glance->solid_angle);
	gr_write_f32(&w, glance->max);
	return w.ok ? w.len : 0;
}

int fdp_glance_decode(const uint8_t *bytes, size_t len, struct fdp_glance *out)
{
	struct gr_reader r = gr_reader(bytes, len);

	out->log_sum = gr_read_f32(&r);
	out->solid_angle = gr_read_f32(&r);
	out->max = gr_read_f32(&r);
	if (!r.ok || gr_reader_left(&r) || !isfinite(out->log_sum) || !isfinite(out->solid_angle) ||
	    !isfinite(out->max))
		return GR_ERR_FORMAT;
	return out->solid_angle >= 0 && out->max >= 0 ? GR_OK : GR_ERR_FORMAT;
}
