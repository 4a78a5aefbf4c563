#include "tools/bench/truth.h"

#include "base/result.h"
#include "tools/bench/random.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846
#define MAX_BOUNCES 32

static const float no_override[3] = { -1, -1, -1 };

static double uniform(struct bench_random *random)
{
	return bench_random_u32(random) * 0x1p-32;
}

static float dot3(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

int truth_init(struct truth *out, const struct scene *scene, const struct truth_spot *spot)
{
	int result;

	memset(out, 0, sizeof *out);
	out->scene = scene;
	out->spot = *spot;
	result = rays_create(&out->rays, scene);
	if (result == GR_OK)
		result = surface_lookup_create(&out->lookup, scene);
	if (result != GR_OK)
		truth_finish(out);
	return result;
}

void truth_finish(struct truth *truth)
{
	rays_destroy(&truth->rays);
	surface_lookup_destroy(&truth->lookup);
}

/* Two unit vectors across n. */
static void frame_of(const float n[3], float u[3], float v[3])
{
	float sign = copysignf(1.0f, n[2]); /* Duff et al. 2017 */
	float a = -1.0f / (sign + n[2]);
	float b = n[0] * n[1] * a;

	u[0] = 1.0f + sign * n[0] * n[0] * a;
	u[1] = sign * b;
	u[2] = -sign * n[0];
	v[0] = b;
	v[1] = sign + n[1] * n[1] * a;
	v[2] = -n[1];
}

void truth_direct(const struct truth *truth, const float position[3], const float normal[3],
		  float out[3])
{
	float to[3], off[3], length, cosine, inside;

	memset(out, 0, 3 * sizeof *out);
	for (int i = 0; i < 3; i++)
		to[i] = truth->spot.position[i] - position[i];
	length = sqrtf(dot3(to, to));
	cosine = dot3(to, normal) / length;
	inside = -dot3(to, truth->spot.direction) / length;
	if (cosine <= 0 || inside < cosf(truth->spot.half_angle))
		return;
	for (int i = 0; i < 3; i++)
		off[i] = position[i] + 1e-4f * normal[i];
	if (rays_blocked(truth->rays, off, truth->spot.position))
		return;
	for (int c = 0; c < 3; c++)
		out[c] = truth->spot.intensity[c] * cosine / (length * length);
}

void truth_map(const struct truth *truth, int pixels, struct truth_texel *out)
{
	const float side = tanf(truth->spot.half_angle);
	float u[3], v[3];

	frame_of(truth->spot.direction, u, v);
	for (int y = 0; y < pixels; y++) {
		for (int x = 0; x < pixels; x++) {
			struct truth_texel *t = out + (size_t)y * (size_t)pixels + x;
			float a = side * (2 * ((float)x + 0.5f) / (float)pixels - 1);
			float b = side * (2 * ((float)y + 0.5f) / (float)pixels - 1);
			float to[3], length, solid, cosine;
			struct ray_hit hit;
			struct surface_point at;

			memset(t, 0, sizeof *t);
			for (int i = 0; i < 3; i++)
				to[i] = truth->spot.direction[i] + a * u[i] + b * v[i];
			length = sqrtf(dot3(to, to));
			for (int i = 0; i < 3; i++)
				to[i] /= length;
			if (!rays_nearest(truth->rays, truth->spot.position, to, INFINITY, &hit))
				continue;
			surface_at(truth->lookup, &hit, to, no_override, &at);
			for (int i = 0; i < 3; i++) {
				t->position[i] = truth->spot.position[i] + hit.distance * to[i];
				t->normal[i] = at.facing[i];
			}
			solid = 4 * side * side / (float)(pixels * pixels) / (length * length * length);
			cosine = fmaxf(-dot3(to, at.facing), 1e-4f);
			t->area = solid * hit.distance * hit.distance / cosine;
			if (length * cosf(truth->spot.half_angle) > 1)
				continue;
			for (int c = 0; c < 3; c++)
				t->exitance[c] = at.albedo[c] * truth->spot.intensity[c] * cosine /
						 (hit.distance * hit.distance);
		}
	}
}

static double triangle(const struct scene *scene, size_t t, float n[3])
{
	const float *p0 = scene->vertices[scene->indices[3 * t]].position;
	const float *p1 = scene->vertices[scene->indices[3 * t + 1]].position;
	const float *p2 = scene->vertices[scene->indices[3 * t + 2]].position;
	float a[3], b[3], length;

	for (int i = 0; i < 3; i++) {
		a[i] = p1[i] - p0[i];
		b[i] = p2[i] - p0[i];
	}
	n[0] = a[1] * b[2] - a[2] * b[1];
	n[1] = a[2] * b[0] - a[0] * b[2];
	n[2] = a[0] * b[1] - a[1] * b[0];
	length = sqrtf(dot3(n, n));
	for (int i = 0; i < 3; i++)
		n[i] /= length;
	return 0.5 * (double)length;
}

/* Nothing within margin in front of and around a point. */
static bool clear_around(const struct truth *truth, const float position[3], const float n[3],
			 float margin)
{
	float from[3];

	for (int i = 0; i < 3; i++)
		from[i] = position[i] + 1e-3f * n[i];
	for (int k = 0; k < 26; k++) {
		int m = k < 13 ? k : k + 1;
		float d[3] = { (float)(m % 3 - 1), (float)(m / 3 % 3 - 1), (float)(m / 9 - 1) };
		struct ray_hit hit;
		float length = sqrtf(dot3(d, d));

		for (int i = 0; i < 3; i++)
			d[i] /= length;
		if (dot3(d, n) < -1e-3f)
			continue;
		if (rays_nearest(truth->rays, from, d, margin, &hit))
			return false;
	}
	return true;
}

size_t truth_points(const struct truth *truth, uint64_t seed, float margin,
		    struct truth_sample *out, size_t count)
{
	size_t triangles = truth->scene->index_count / 3, found = 0;
	struct bench_random random = { seed * 2 + 1 };
	double total = 0;
	float n[3];

	for (size_t t = 0; t < triangles; t++)
		total += triangle(truth->scene, t, n);
	for (size_t k = 0; k < count; k++) {
		double at = ((double)k + uniform(&random)) / (double)count * total, sum = 0;
		double u = sqrt(uniform(&random)), v = uniform(&random);
		struct truth_sample *s = &out[found];
		size_t t = 0;

		for (; t + 1 < triangles; t++) {
			sum += triangle(truth->scene, t, n);
			if (sum > at)
				break;
		}
		triangle(truth->scene, t, n);
		memset(s, 0, sizeof *s);
		for (int i = 0; i < 3; i++) {
			const uint32_t *index = truth->scene->indices + 3 * t;

			s->position[i] = (float)((1 - u) * (double)truth->scene->vertices[index[0]].position[i] +
				u * (1 - v) * (double)truth->scene->vertices[index[1]].position[i] +
				u * v * (double)truth->scene->vertices[index[2]].position[i]);
			s->normal[i] = n[i];
		}
		s->area = total / (double)count;
		if (clear_around(truth, s->position, n, margin))
			found++;
	}
	return found;
}

/* One path's estimate of the indirect irradiance. */
static void trace_path(const struct truth *truth, const struct truth_sample *s, struct bench_random *random,
		       double out[3])
{
	float position[3], normal[3];
	double weight[3] = { PI, PI, PI };

	memcpy(position, s->position, sizeof position);
	memcpy(normal, s->normal, sizeof normal);
	memset(out, 0, 3 * sizeof *out);
	for (int bounce = 0; bounce < MAX_BOUNCES; bounce++) {
		double r = sqrt(uniform(random)), phi = 2 * PI * uniform(random);
		float u[3], v[3], to[3], from[3], e[3];
		struct ray_hit hit;
		struct surface_point at;

		frame_of(normal, u, v);
		for (int i = 0; i < 3; i++) {
			to[i] = (float)(r * cos(phi)) * u[i] + (float)(r * sin(phi)) * v[i] +
				(float)sqrt(1 - r * r) * normal[i];
			from[i] = position[i] + 1e-4f * normal[i];
		}
		if (!rays_nearest(truth->rays, from, to, INFINITY, &hit))
			return;
		surface_at(truth->lookup, &hit, to, no_override, &at);
		for (int i = 0; i < 3; i++) {
			position[i] = from[i] + hit.distance * to[i];
			normal[i] = at.facing[i];
		}
		truth_direct(truth, position, normal, e);
		double most = 0;
		for (int c = 0; c < 3; c++) {
			weight[c] *= (double)at.albedo[c];
			out[c] += weight[c] / PI * (double)e[c];
			most = fmax(most, weight[c] / PI);
		}
		if (bounce >= 3) {
			double keep = fmin(most, 0.95);

			if (uniform(random) >= keep)
				return;
			for (int c = 0; c < 3; c++)
				weight[c] /= keep;
		}
	}
}

void truth_trace(const struct truth *truth, uint64_t seed, int paths,
		 struct truth_sample *samples, size_t count)
{
	for (size_t k = 0; k < count; k++) {
		struct bench_random random = bench_random_start(seed + k);
		double square = 0, mean = 0;

		for (int p = 0; p < paths; p++) {
			double e[3];

			trace_path(truth, &samples[k], &random, e);
			for (int c = 0; c < 3; c++)
				samples[k].irradiance[c] += e[c] / paths;
			double m = (e[0] + e[1] + e[2]) / 3;
			mean += m / paths;
			square += m * m / paths;
		}
		samples[k].standard_error = sqrt(fmax(square - mean * mean, 0) / paths);
	}
}

struct truth_error truth_compare(const struct truth_sample *samples, const float *found,
				 size_t count)
{
	double area = 0, tt = 0, ft = 0, ff = 0, t = 0, f = 0, noise = 0;
	struct truth_error e;

	for (size_t k = 0; k < count; k++) {
		for (int c = 0; c < 3; c++) {
			double a = samples[k].irradiance[c], b = (double)found[3 * k + (size_t)c];
			double w = samples[k].area;

			area += w;
			t += w * a;
			f += w * b;
			tt += w * a * a;
			ft += w * a * b;
			ff += w * b * b;
		}
		noise += 3 * samples[k].area * samples[k].standard_error * samples[k].standard_error;
	}
	double mean = t / area;
	double factor = ft / ff;
	e.bias = f / t - 1;
	e.nrmse = sqrt((ff - 2 * ft + tt) / area) / mean;
	e.shape = sqrt(fmax(factor * factor * ff - 2 * factor * ft + tt, 0) / area) / mean;
	e.noise = sqrt(noise / area) / mean;
	return e;
}
