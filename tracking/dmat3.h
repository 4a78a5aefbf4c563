/*
 * 3x3 matrices in double precision, row by row, for fits: products, turns as
 * matrices and angles, singular values. Pure.
 */
#ifndef GROTTO_TRACKING_DMAT3_H
#define GROTTO_TRACKING_DMAT3_H

#include "tracking/rotation.h"

struct dmat3 {
	double m[3][3];
};

#define DMAT3_IDENTITY ((struct dmat3){ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } })

struct dmat3 dmat3_mul(const struct dmat3 *a, const struct dmat3 *b);
struct dmat3 dmat3_transposed(const struct dmat3 *a);
double dmat3_det(const struct dmat3 *a);
/* out = a v; out may be v. */
void dmat3_apply(const struct dmat3 *a, const double v[3], double out[3]);
/* out = a^T v; out may be v. */
void dmat3_apply_transposed(const struct dmat3 *a, const double v[3], double out[3]);
struct dmat3 dmat3_from_rotation(const struct rotation *r);
/*
 * Heading, pitch, roll in radians, as a layout has them: about +Y, then about
 * the turned X, then about the line of sight; pitch in +-pi/2. Straight up or
 * down the heading is what the roll would be, and the roll 0.
 */
void dmat3_angles(const struct dmat3 *turn, double out[3]);

/*
 * a = u diag(s) v^T, s falling and never negative, u and v orthogonal (their
 * determinants may be -1). One-sided Jacobi rotations (Hestenes, J. SIAM 6,
 * 1958), which find small singular values to full relative precision. What a
 * matrix of lesser rank leaves open of u is filled up.
 */
struct svd3 {
	struct dmat3 u, v;
	double s[3];
};
struct svd3 svd3(const struct dmat3 *a);

#endif
