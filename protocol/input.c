#include "protocol/input.h"

#include "base/cursor.h"
#include "base/result.h"

#include <math.h>
#include <stdbool.h>

size_t fdp_input_encode(const struct fdp_input *input, uint8_t *bytes, size_t size)
{
	struct gr_writer w = gr_writer(bytes, size);

	gr_write_u32(&w, input->buttons);
	for (int i = 0; i < 2; i++)
		gr_write_f32(&w, input->axes[i]);
	for (int i = 0; i < 2; i++)
		gr_write_f32(&w, input->pointer[i]);
	gr_write_f32(&w, input->wheel);
	return w.ok ? w.len : 0;
}

static bool within(float value, float most)
{
	return fabsf(value) <= most; /* NaN is not */
}

int fdp_input_decode(const uint8_t *bytes, size_t len, struct fdp_input *out)
{
	struct gr_reader r = gr_reader(bytes, len);

	out->buttons = gr_read_u32(&r);
	for (int i = 0; i < 2; i++)
		out->axes[i] = gr_read_f32(&r);
	for (int i = 0; i < 2; i++)
		out->pointer[i] = gr_read_f32(&r);
	out->wheel = gr_read_f32(&r);
	if (!r.ok || gr_reader_left(&r))
		return GR_ERR_FORMAT;
	for (int i = 0; i < 2; i++)
		if (!within(out->axes[i], 1) || !within(out->pointer[i], 1))
			return GR_ERR_FORMAT;
	return within(out->wheel, FDP_INPUT_WHEEL_MOST) ? GR_OK : GR_ERR_FORMAT;
}
