/*
 * Vectors and RGB triples by value, for the tracer's inner loops. Plain float:
 * sums over many samples are kept in double by who adds them.
 */
#ifndef GROTTO_RENDERER_TRACE_VECTOR_H
#define GROTTO_RENDERER_TRACE_VECTOR_H

#include <math.h>
#include <stdbool.h>

#define TRACE_PI 3.14159265358979f

struct v3 {
	float x, y, z;
};

static inline struct v3 v3_of(const float a[3])
{
	return (struct v3){ a[0], a[1], a[2] };
}

static inline void v3_put(struct v3 a, float out[3])
{
	out[0] = a.x;
	out[1] = a.y;
	out[2] = a.z;
}

static inline struct v3 v3_all(float s)
{
	return (struct v3){ s, s, s };
}

static inline struct v3 v3_add(struct v3 a, struct v3 b)
{
	return (struct v3){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static inline struct v3 v3_sub(struct v3 a, struct v3 b)
{
	return (struct v3){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static inline struct v3 v3_mul(struct v3 a, struct v3 b)
{
	return (struct v3){ a.x * b.x, a.y * b.y, a.z * b.z };
}

static inline struct v3 v3_scale(struct v3 a, float s)
{
	return (struct v3){ a.x * s, a.y * s, a.z * s };
}

/* a + s b */
static inline struct v3 v3_ahead(struct v3 a, struct v3 b, float s)
{
	return (struct v3){ a.x + s * b.x, a.y + s * b.y, a.z + s * b.z };
}

static inline float v3_dot(struct v3 a, struct v3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct v3 v3_cross(struct v3 a, struct v3 b)
{
	return (struct v3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static inline float v3_length(struct v3 a)
{
	return sqrtf(v3_dot(a, a));
}

static inline struct v3 v3_unit(struct v3 a)
{
	return v3_scale(a, 1.0f / v3_length(a));
}

/* Without the call that fmaxf is; NaN gives the second. */
static inline float larger_of(float a, float b)
{
	return a > b ? a : b;
}

static inline float smaller_of(float a, float b)
{
	return a < b ? a : b;
}

static inline float v3_most(struct v3 a)
{
	return larger_of(a.x, larger_of(a.y, a.z));
}

static inline float v3_widest(struct v3 a)
{
	return larger_of(fabsf(a.x), larger_of(fabsf(a.y), fabsf(a.z)));
}

static inline float v3_mean(struct v3 a)
{
	return (a.x + a.y + a.z) * (1.0f / 3.0f);
}

static inline bool v3_black(struct v3 a)
{
	return a.x == 0.0f && a.y == 0.0f && a.z == 0.0f;
}

static inline bool v3_finite(struct v3 a)
{
	return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

/* Axes across a unit vector (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"). */
struct v3_frame {
	struct v3 u, v, n;
};

static inline struct v3_frame v3_frame_of(struct v3 n)
{
	float sign = copysignf(1.0f, n.z);
	float a = -1.0f / (sign + n.z);
	float b = n.x * n.y * a;

	return (struct v3_frame){
		.u = { 1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x },
		.v = { b, sign + n.y * n.y * a, -n.y },
		.n = n,
	};
}

static inline struct v3 v3_to_local(const struct v3_frame *f, struct v3 w)
{
	return (struct v3){ v3_dot(w, f->u), v3_dot(w, f->v), v3_dot(w, f->n) };
}

static inline struct v3 v3_from_local(const struct v3_frame *f, struct v3 w)
{
	return v3_ahead(v3_ahead(v3_scale(f->u, w.x), f->v, w.y), f->n, w.z);
}

#endif
