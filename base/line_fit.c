#include "base/line_fit.h"

#include <math.h>

void gr_line_fit_add(struct gr_line_fit *fit, double x, double y, double weight)
{
	fit->w += weight;
	fit->x += weight * x;
	fit->y += weight * y;
	fit->xx += weight * x * x;
	fit->xy += weight * x * y;
}

void gr_line_fit_solve(const struct gr_line_fit *s, double prior, double most, double *out_y0,
		       double *out_slope, double *out_error)
{
	/* Normal equations with the prior of the slope. */
	const double spread = s->xx - s->x * s->x / s->w + 1 / (prior * prior);
	const double slope = (s->xy - s->x * s->y / s->w) / spread;

	*out_slope = fmin(fmax(slope, -most), most);
	*out_y0 = (s->y - *out_slope * s->x) / s->w;
	if (out_error)
		*out_error = 1 / sqrt(spread);
}
