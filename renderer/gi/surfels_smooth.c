/*
 * A surfel's light is a mean over few hundred links, and off by some percent.
 * Shading would show that as blotches. So what it reads is a plane fitted to the
 * light of all surfels that are heard at a surfel (moving least squares,
 * Lancaster and Salkauskas 1981), at its place: a weighted sum, whose weights
 * depend on places alone. A linear course of light comes out as it is. It is done
 * twice: once leaves blotches two spacings wide that an eye finds, twice those that
 * are half as strong. Gathers read the light as it was found.
 */
#include "renderer/gi/surfels_private.h"

#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <stdlib.h>
#include <string.h>

#define AROUND_MOST 64 /* surfels in one sum; of more, the last are left out */
/* Slopes are held back as if the surfels' spread were larger by this, in squares of the radius. */
#define STIFF 0.01

struct around {
	uint32_t surfel;
	float weight;
};

static double dot3(const float a[3], const float b[3])
{
	return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

/* Fills `out` with those heard at surfel i and their weights, whose sum is 1. */
static size_t fit(const struct surfel_set *set, size_t i, struct around out[AROUND_MOST])
{
	const struct surfel *here = &set->surfels[i];
	const uint32_t *members;
	size_t near = surfel_set_cell(set, here->position, &members), count = 0;
	double x[AROUND_MOST], y[AROUND_MOST], w[AROUND_MOST];
	double sum = 0, mx = 0, my = 0, xx = STIFF, xy = 0, yy = STIFF;
	float normal[3], u[3], v[3];

	surfel_normal_unpack(here->normal, normal);
	surfel_frame(normal, u, v);
	for (size_t k = 0; k < near && count < AROUND_MOST; k++) {
		const float *there = set->surfels[members[k]].position;
		float d[3];

		w[count] = (double)surfel_weight(set, members[k], here->position, normal);
		if (!(w[count] > 0))
			continue;
		for (int c = 0; c < 3; c++)
			d[c] = (there[c] - here->position[c]) / set->radius_m;
		x[count] = dot3(d, u);
		y[count] = dot3(d, v);
		sum += w[count];
		out[count++].surfel = members[k];
	}
	if (count == 0) {
		out[0] = (struct around){ (uint32_t)i, 1 };
		return 1;
	}
	for (size_t k = 0; k < count; k++) {
		w[k] /= sum;
		mx += w[k] * x[k];
		my += w[k] * y[k];
	}
	for (size_t k = 0; k < count; k++) {
		xx += w[k] * (x[k] - mx) * (x[k] - mx);
		xy += w[k] * (x[k] - mx) * (y[k] - my);
		yy += w[k] * (y[k] - my) * (y[k] - my);
	}
	double inverse = 1 / (xx * yy - xy * xy);
	double a = (mx * yy - my * xy) * inverse, b = (my * xx - mx * xy) * inverse;

	for (size_t k = 0; k < count; k++)
		out[k].weight = (float)(w[k] * (1 - a * (x[k] - mx) - b * (y[k] - my)));
	return count;
}

int surfels_smooth_init(struct surfels *s, const struct surfel_set *set)
{
	uint32_t *first = calloc(set->count + 1, sizeof *first);
	size_t room = 16 * (set->count + AROUND_MOST);
	struct around *all = malloc(room * sizeof *all), one[AROUND_MOST];
	int result = program_create_compute(&s->smooth, "surfel_smooth.comp", NULL);

	if (!first || !all)
		result = result == GR_OK ? GR_ERR_NOMEM : result;
	for (size_t i = 0; i < set->count && result == GR_OK; i++) {
		size_t count = fit(set, i, one);

		if (first[i] + count > room) {
			struct around *more;

			room *= 2;
			more = realloc(all, room * sizeof *all);
			if (!more) {
				result = GR_ERR_NOMEM;
				break;
			}
			all = more;
		}
		memcpy(all + first[i], one, count * sizeof *one);
		first[i + 1] = first[i] + (uint32_t)count;
	}
	if (result == GR_OK)
		result = surfels_storage(s, &s->around_first, "surfels around", GL_R32UI,
					 (set->count + 1) * sizeof *first, first);
	if (result == GR_OK)
		result = surfels_storage(s, &s->around, "surfels around", GL_RG32UI,
					 first[set->count] * sizeof *all, all);
	free(first);
	free(all);
	return result;
}

void surfels_smooth_finish(struct surfels *s)
{
	program_destroy(&s->smooth);
	surfels_storage_finish(&s->around_first);
	surfels_storage_finish(&s->around);
}

static void pass(const struct surfels *s, const struct surfels_buffer *from,
		 const struct surfels_buffer *to)
{
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFELS_BINDING_FOUND, to->buffer);
	glBindTextureUnit(SURFELS_UNIT_RADIOSITY, from->texture);
	surfels_dispatch(s->smooth, (struct surfels_run){ 0, (uint32_t)s->count });
	surfels_barrier();
}

void surfels_smooth(struct surfels *s)
{
	glBindTextureUnit(SURFELS_UNIT_BEFORE, s->around_first.texture);
	glBindTextureUnit(SURFELS_UNIT_PARTS, s->around.texture);
	glBindBufferBase(GL_UNIFORM_BUFFER, SURFELS_BINDING_BLOCK, s->block);
	pass(s, &s->found, &s->half);
	pass(s, &s->half, &s->shown);
}
