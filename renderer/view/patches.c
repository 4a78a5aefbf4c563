#include "renderer/view/patches.h"

#include "base/result.h"
#include "renderer/tone/srgb.h"
#include "renderer/view/maps.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Pieces that large triangles are cut into, so that clusters can be of one size. */
#define PIECES_WANTED 512
/* Edge directions tried for a cluster's rectangle. */
#define DIRECTIONS_TRIED 96

struct piece {
	double corner[3][3];
	double uv[3][2];
	double centroid[3], normal[3];
	double area;
	double emission[3]; /* radiance */
	double power;       /* area times mean radiance */
	int material;
	bool back; /* the back of a two-sided triangle */
};

struct pieces {
	struct piece *at;
	size_t count, size;
	double lift_m; /* off its surface, of the point from where a patch looks */
};

struct cluster {
	size_t first, count; /* pieces */
	bool whole;          /* cannot be split */
};

static double dot3(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross3(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Emission of a piece: the texture's texel at its middle. */
static void sample_emission(const struct scene *scene, struct piece *p)
{
	const struct scene_material *m = &scene->materials[p->material];
	const struct scene_image *image =
		m->emission_image >= 0 ? &scene->images[m->emission_image] : NULL;
	double uv[2] = { 0, 0 };

	for (int i = 0; i < 3; i++)
		p->emission[i] = (double)m->emission[i];
	if (!image)
		return;
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 2; i++)
			uv[i] += p->uv[k][i] / 3;
	if (!isfinite(uv[0]) || !isfinite(uv[1]))
		return;
	int x = (int)((uv[0] - floor(uv[0])) * image->width);
	int y = (int)((uv[1] - floor(uv[1])) * image->height);

	x = x < image->width ? x : image->width - 1;
	y = y < image->height ? y : image->height - 1;
	for (int i = 0; i < 3; i++) {
		double c = image->rgba[4 * ((size_t)y * (size_t)image->width + (size_t)x) +
				       (size_t)i] / 255.0;

		p->emission[i] *= image->srgb ? srgb_decode(c) : c;
	}
}

static void measure(const struct scene *scene, struct piece *p)
{
	double a[3], b[3], n[3], length;

	for (int i = 0; i < 3; i++) {
		a[i] = p->corner[1][i] - p->corner[0][i];
		b[i] = p->corner[2][i] - p->corner[0][i];
		p->centroid[i] = (p->corner[0][i] + p->corner[1][i] + p->corner[2][i]) / 3;
	}
	cross3(a, b, n);
	length = sqrt(dot3(n, n));
	p->area = 0.5 * length;
	for (int i = 0; i < 3; i++)
		p->normal[i] = length > 0 ? (p->back ? -n[i] : n[i]) / length : 0;
	sample_emission(scene, p);
	p->power = p->area * (p->emission[0] + p->emission[1] + p->emission[2]) / 3;
}

static int add(struct pieces *pieces, const struct piece *p)
{
	if (pieces->count == pieces->size) {
		size_t size = pieces->size ? pieces->size * 2 : 256;
		struct piece *at = realloc(pieces->at, size * sizeof(*at));

		if (!at)
			return GR_ERR_NOMEM;
		pieces->at = at;
		pieces->size = size;
	}
	pieces->at[pieces->count++] = *p;
	return GR_OK;
}

static int add_triangle(struct pieces *pieces, const struct scene *scene, size_t index,
			uint32_t material)
{
	struct piece p = { .material = (int)material };
	int result;

	for (int k = 0; k < 3; k++) {
		const struct scene_vertex *v = &scene->vertices[scene->indices[index + (size_t)k]];

		for (int i = 0; i < 3; i++)
			p.corner[k][i] = (double)v->position[i];
		for (int i = 0; i < 2; i++)
			p.uv[k][i] = (double)v->uv[i];
	}
	measure(scene, &p);
	if (!(p.area > 0))
		return GR_OK;
	result = add(pieces, &p);
	if (result == GR_OK && scene->materials[material].two_sided) {
		p.back = true;
		measure(scene, &p);
		result = add(pieces, &p);
	}
	return result;
}

static int gather(struct pieces *pieces, const struct scene *scene, size_t *triangles)
{
	*triangles = 0;
	for (size_t d = 0; d < scene->draw_count; d++) {
		const struct scene_draw *draw = &scene->draws[d];
		const float *e = scene->materials[draw->material].emission;

		if (!(e[0] > 0 || e[1] > 0 || e[2] > 0))
			continue;
		*triangles += draw->index_count / 3;
		for (size_t i = 0; i + 2 < draw->index_count; i += 3) {
			int result = add_triangle(pieces, scene, draw->first_index + i,
						  draw->material);

			if (result != GR_OK)
				return result;
		}
	}
	return GR_OK;
}

/* Corner, or middle of the edge to the next corner. */
static void cut_point(const struct piece *p, int which, double at[3], double uv[2])
{
	int a = which % 3, b = which < 3 ? a : (a + 1) % 3;

	for (int i = 0; i < 3; i++)
		at[i] = 0.5 * (p->corner[a][i] + p->corner[b][i]);
	for (int i = 0; i < 2; i++)
		uv[i] = 0.5 * (p->uv[a][i] + p->uv[b][i]);
}

/* Cuts every piece larger than `most` into four at its edges' middles, in rounds. */
static int cut_large(struct pieces *pieces, const struct scene *scene, double most)
{
	static const int quarters[4][3] = { { 0, 3, 5 }, { 3, 1, 4 }, { 5, 4, 2 }, { 3, 4, 5 } };

	for (size_t i = 0; i < pieces->count; i++) {
		while (pieces->at[i].area > most) {
			struct piece whole = pieces->at[i];

			for (int q = 0; q < 4; q++) {
				struct piece part = whole;
				int result;

				for (int k = 0; k < 3; k++)
					cut_point(&whole, quarters[q][k], part.corner[k],
						  part.uv[k]);
				measure(scene, &part);
				if (q == 0)
					pieces->at[i] = part;
				else if ((result = add(pieces, &part)) != GR_OK)
					return result;
			}
		}
	}
	return GR_OK;
}

/* Place, then direction in metres of the emitters' extent, so that it is told apart first. */
static double feature(const struct piece *p, int which, double extent)
{
	return which < 3 ? p->centroid[which] : 2 * extent * p->normal[which - 3];
}

/* The feature that varies most, and its mean. */
static double spread(const struct pieces *pieces, const struct cluster *c, double extent,
		     int *out_which, double *out_mean)
{
	double best = -1;

	for (int which = 0; which < 6; which++) {
		double weight = 0, sum = 0, variance = 0;

		for (size_t i = c->first; i < c->first + c->count; i++) {
			weight += pieces->at[i].power;
			sum += pieces->at[i].power * feature(&pieces->at[i], which, extent);
		}
		if (!(weight > 0))
			continue;
		for (size_t i = c->first; i < c->first + c->count; i++) {
			double d = feature(&pieces->at[i], which, extent) - sum / weight;

			variance += pieces->at[i].power * d * d;
		}
		if (variance > best) {
			best = variance;
			*out_which = which;
			*out_mean = sum / weight;
		}
	}
	return best;
}

/* Splits c in place at the mean of its widest feature; the rest is *other. */
static bool split(struct pieces *pieces, struct cluster *c, struct cluster *other, double extent)
{
	size_t low = c->first, high = c->first + c->count;
	double mean = 0;
	int which = 0;

	if (spread(pieces, c, extent, &which, &mean) <= 0)
		return false;
	while (low < high) {
		if (feature(&pieces->at[low], which, extent) < mean) {
			low++;
		} else {
			struct piece swap = pieces->at[low];

			pieces->at[low] = pieces->at[--high];
			pieces->at[high] = swap;
		}
	}
	if (low == c->first || low == c->first + c->count)
		return false;
	*other = (struct cluster){ low, c->first + c->count - low, false };
	c->count = low - c->first;
	return true;
}

/* Splits the clusters of the widest spread until there are `wanted`; keeps them in order. */
static int split_all(struct pieces *pieces, struct cluster *clusters, int count, int wanted,
		     double extent)
{
	while (count < wanted) {
		double best = -1, mean;
		int widest = -1, which;
		struct cluster other;

		for (int i = 0; i < count; i++) {
			double s = clusters[i].whole
					   ? -1
					   : spread(pieces, &clusters[i], extent, &which, &mean);

			if (s > best) {
				best = s;
				widest = i;
			}
		}
		if (widest < 0)
			break;
		if (!split(pieces, &clusters[widest], &other, extent)) {
			clusters[widest].whole = true;
			continue;
		}
		memmove(&clusters[widest + 2], &clusters[widest + 1],
			(size_t)(count - widest - 1) * sizeof(*clusters));
		clusters[widest + 1] = other;
		count++;
	}
	return count;
}

struct fit {
	double vector[3]; /* area vector */
	double normal[3];
	double area; /* of the area vector */
	double centroid[3];
	double u[3], v[3]; /* unit axes in the plane */
	double low[2], high[2];
};

static void bounds_in_plane(const struct pieces *pieces, const struct cluster *c, struct fit *f)
{
	for (int i = 0; i < 2; i++) {
		f->low[i] = INFINITY;
		f->high[i] = -INFINITY;
	}
	for (size_t i = c->first; i < c->first + c->count; i++)
		for (int k = 0; k < 3; k++) {
			double at[2] = { dot3(f->u, pieces->at[i].corner[k]),
					 dot3(f->v, pieces->at[i].corner[k]) };

			for (int a = 0; a < 2; a++) {
				f->low[a] = fmin(f->low[a], at[a]);
				f->high[a] = fmax(f->high[a], at[a]);
			}
		}
}

/* The edge direction with the smallest rectangle round the cluster. */
static void choose_axes(const struct pieces *pieces, const struct cluster *c, struct fit *f)
{
	struct fit best = *f;
	double smallest = INFINITY;
	size_t step = 1 + 3 * c->count / DIRECTIONS_TRIED;

	for (size_t e = 0; e < 3 * c->count; e += step) {
		const struct piece *p = &pieces->at[c->first + e / 3];
		const double *a = p->corner[e % 3], *b = p->corner[(e + 1) % 3];
		double along, length;

		for (int i = 0; i < 3; i++)
			f->u[i] = b[i] - a[i];
		along = dot3(f->u, f->normal);
		for (int i = 0; i < 3; i++)
			f->u[i] -= along * f->normal[i];
		length = sqrt(dot3(f->u, f->u));
		if (!(length > 1e-12))
			continue;
		for (int i = 0; i < 3; i++)
			f->u[i] /= length;
		cross3(f->normal, f->u, f->v);
		bounds_in_plane(pieces, c, f);
		double size = (f->high[0] - f->low[0]) * (f->high[1] - f->low[1]);

		if (size < smallest) {
			smallest = size;
			best = *f;
		}
	}
	*f = best;
}

/* Variance of the projected area along a unit axis about the centroid. */
static double variance_along(const struct pieces *pieces, const struct cluster *c,
			     const struct fit *f, const double axis[3])
{
	double sum = 0, weight = 0, middle = dot3(axis, f->centroid);

	for (size_t i = c->first; i < c->first + c->count; i++) {
		const struct piece *p = &pieces->at[i];
		double a = p->area * fmax(dot3(p->normal, f->normal), 0), s = 0, squares = 0;

		for (int k = 0; k < 3; k++) {
			double d = dot3(axis, p->corner[k]) - middle;

			s += d;
			squares += d * d;
		}
		sum += a * (squares + s * s) / 12; /* exact for a triangle */
		weight += a;
	}
	return weight > 0 ? sum / weight : 0;
}

static void closest_piece(const struct pieces *pieces, const struct cluster *c,
			  const double to[3], float origin[3], float normal[3])
{
	const struct piece *best = &pieces->at[c->first];
	double nearest = INFINITY, along;

	for (size_t i = c->first; i < c->first + c->count; i++) {
		double d[3];

		for (int k = 0; k < 3; k++)
			d[k] = pieces->at[i].centroid[k] - to[k];
		if (dot3(d, d) < nearest) {
			nearest = dot3(d, d);
			best = &pieces->at[i];
		}
	}
	/* the point itself when it lies in the piece's plane, as it does on a flat lamp */
	along = dot3(best->normal, best->centroid) - dot3(best->normal, to);
	bool flat = fabs(along) < 1e-6 + 1e-3 * sqrt(nearest);

	for (int i = 0; i < 3; i++) {
		double at = flat ? to[i] + along * best->normal[i] : best->centroid[i];

		origin[i] = (float)(at + pieces->lift_m * best->normal[i]);
		normal[i] = (float)best->normal[i];
	}
}

static void sums(const struct pieces *pieces, const struct cluster *c, struct fit *f,
		 double flux[3])
{
	double weight = 0, length;

	memset(f, 0, sizeof(*f));
	for (int i = 0; i < 3; i++)
		flux[i] = 0;
	for (size_t k = c->first; k < c->first + c->count; k++) {
		const struct piece *p = &pieces->at[k];

		for (int i = 0; i < 3; i++) {
			f->vector[i] += p->area * p->normal[i];
			f->centroid[i] += p->area * p->centroid[i];
			flux[i] += p->area * p->emission[i];
		}
		weight += p->area;
	}
	for (int i = 0; i < 3; i++)
		f->centroid[i] /= weight;
	length = sqrt(dot3(f->vector, f->vector));
	f->area = length;
	if (length < 0.05 * weight) { /* closed: no side to speak of; take the first one's */
		memcpy(f->normal, pieces->at[c->first].normal, sizeof(f->normal));
		f->area = 0.25 * weight;
		return;
	}
	for (int i = 0; i < 3; i++)
		f->normal[i] = f->vector[i] / length;
}

static void fit_patch(const struct pieces *pieces, const struct cluster *c,
		      struct emissive_patch *out)
{
	struct fit f;
	double flux[3], half[2], centre[3], box;
	float ignored[3];

	sums(pieces, c, &f, flux);
	choose_axes(pieces, c, &f);
	box = (f.high[0] - f.low[0]) * (f.high[1] - f.low[1]);
	if (box <= 1.01 * f.area) {
		double depth = dot3(f.normal, f.centroid);

		for (int i = 0; i < 3; i++)
			centre[i] = 0.5 * (f.low[0] + f.high[0]) * f.u[i] +
				    0.5 * (f.low[1] + f.high[1]) * f.v[i] + depth * f.normal[i];
		for (int a = 0; a < 2; a++)
			half[a] = 0.5 * (f.high[a] - f.low[a]);
	} else {
		double scale;

		memcpy(centre, f.centroid, sizeof(centre));
		half[0] = sqrt(3 * variance_along(pieces, c, &f, f.u));
		half[1] = sqrt(3 * variance_along(pieces, c, &f, f.v));
		half[0] = fmax(half[0], 1e-6);
		half[1] = fmax(half[1], 1e-6);
		scale = sqrt(f.area / (4 * half[0] * half[1]));
		half[0] *= scale;
		half[1] *= scale;
	}
	for (int i = 0; i < 3; i++) {
		out->centre[i] = (float)centre[i];
		out->u[i] = (float)(half[0] * f.u[i]);
		out->v[i] = (float)(half[1] * f.v[i]);
		out->normal[i] = (float)f.normal[i];
		out->radiance[i] = (float)(flux[i] / (4 * half[0] * half[1]));
	}
	closest_piece(pieces, c, centre, out->origin, ignored);
}

static void fit_group(const struct pieces *pieces, const struct cluster *c,
		      struct emissive_group *out)
{
	struct fit f;
	double flux[3];

	sums(pieces, c, &f, flux);
	closest_piece(pieces, c, f.centroid, out->origin, out->normal);
}

static double extent_of(const struct pieces *pieces)
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, sum = 0;
	double high[3] = { -INFINITY, -INFINITY, -INFINITY };

	for (size_t i = 0; i < pieces->count; i++)
		for (int k = 0; k < 3; k++) {
			low[k] = fmin(low[k], pieces->at[i].centroid[k]);
			high[k] = fmax(high[k], pieces->at[i].centroid[k]);
		}
	for (int k = 0; k < 3; k++)
		sum += (high[k] - low[k]) * (high[k] - low[k]);
	return sqrt(sum);
}

/* Groups first, then each group's share of the patches. */
static void cluster_all(struct pieces *pieces, struct emissive_patches *out)
{
	struct cluster groups[PATCH_GROUPS_MAX] = { { 0, pieces->count, false } };
	struct cluster patches[PATCHES_MAX];
	double extent = extent_of(pieces);

	out->group_count = split_all(pieces, groups, 1, PATCH_GROUPS_MAX, extent);
	for (int g = 0; g < out->group_count; g++) {
		struct emissive_group *group = &out->groups[g];

		fit_group(pieces, &groups[g], group);
		patches[0] = groups[g];
		patches[0].whole = false;
		group->first = out->count;
		group->count = split_all(pieces, patches, 1, PATCHES_MAX / out->group_count, extent);
		for (int i = 0; i < group->count; i++)
			fit_patch(pieces, &patches[i], &out->patches[out->count++]);
	}
}

int emissive_patches(const struct scene *scene, struct emissive_patches *out)
{
	struct pieces pieces = { .lift_m = map_least_length(scene->min, scene->max) };
	double area = 0;
	int result;

	memset(out, 0, sizeof(*out));
	result = gather(&pieces, scene, &out->triangles);
	for (size_t i = 0; i < pieces.count; i++)
		area += pieces.at[i].area;
	if (result == GR_OK && pieces.count > 0)
		result = cut_large(&pieces, scene, area / (PIECES_WANTED / 2));
	for (size_t i = 0; i < pieces.count; i++)
		for (int k = 0; k < 3; k++)
			out->flux[k] += M_PI * pieces.at[i].area * pieces.at[i].emission[k];
	if (result == GR_OK && pieces.count > 0)
		cluster_all(&pieces, out);
	free(pieces.at);
	return result;
}
