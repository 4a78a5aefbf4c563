/*
 * A weighted least-squares line whose slope is known beforehand to some
 * degree: y = y0 + slope * x, with the slope near 0 by `prior` (one standard
 * deviation, in the unit of y / x), so that a short past gives no wild slope.
 * A weight is 1 / sigma^2 of its y.
 */
#ifndef GROTTO_BASE_LINE_FIT_H
#define GROTTO_BASE_LINE_FIT_H

/* Zero-initialise. */
struct gr_line_fit {
	double w, x, y, xx, xy;
};

void gr_line_fit_add(struct gr_line_fit *fit, double x, double y, double weight);
/*
 * After at least one point. The slope is kept within +-most (the line then
 * still is the best with that slope). *out_error is one standard deviation of
 * the slope; may be NULL.
 */
void gr_line_fit_solve(const struct gr_line_fit *fit, double prior, double most, double *out_y0,
		       double *out_slope, double *out_error);

#endif
