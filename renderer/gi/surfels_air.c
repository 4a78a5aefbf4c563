/* Light that was fixed at baking, in the air that there is now. */
#include "renderer/gi/surfels_private.h"

#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool any_light(const float (*light)[3], size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (light[i][0] > 0 || light[i][1] > 0 || light[i][2] > 0)
			return true;
	return false;
}

float surfels_extinction(const struct surfels *s)
{
	const float sigma = s->absorption + s->scattering;

	return sigma <= 0 ? 0 : sigma < 1 ? -log1pf(-sigma) : 693147.0f;
}

static int keep(struct surfels *s, struct surfels_buffer *out, const struct surfels_buffer *of)
{
	const size_t bytes = (s->count + 1) * 4 * sizeof(float);
	int result = surfels_storage(s, out, "fixed light as baked", GL_RGBA32F, bytes, NULL);

	if (result == GR_OK)
		glCopyNamedBufferSubData(of->buffer, out->buffer, 0, 0, (GLsizeiptr)bytes);
	return result;
}

int surfels_air_init(struct surfels *s, const struct surfel_set *set)
{
	struct surfels_air *a = &s->air;
	float *rows;
	int result;

	a->baked_in = set->extinction;
	if (!any_light((const float(*)[3])set->fixed_emissive, set->count) &&
	    !any_light((const float(*)[3])set->fixed_other, set->count))
		return GR_OK;
	rows = calloc(set->count + 1, 4 * sizeof *rows);
	if (!rows)
		return GR_ERR_NOMEM;
	memcpy(rows, set->fixed_way, set->count * 4 * sizeof *rows);
	result = surfels_storage(s, &a->ways, "ways of fixed light", GL_RGBA32F,
				 (set->count + 1) * 4 * sizeof *rows, rows);
	free(rows);
	if (result == GR_OK)
		result = program_create_compute(&a->program, "surfel_thin.comp", NULL);
	if (result == GR_OK)
		result = keep(s, &a->emissive, &s->emissive);
	if (result == GR_OK)
		result = keep(s, &a->other, &s->other);
	return result;
}

void surfels_air_finish(struct surfels *s)
{
	struct surfels_air *a = &s->air;

	program_destroy(&a->program);
	surfels_storage_finish(&a->ways);
	surfels_storage_finish(&a->emissive);
	surfels_storage_finish(&a->other);
}

void surfels_air_apply(struct surfels *s)
{
	struct surfels_air *a = &s->air;
	const float more = surfels_extinction(s) - a->baked_in;

	if (!(more < a->more || more > a->more))
		return;
	a->more = more;
	if (!a->program)
		return;
	glBindBufferBase(GL_UNIFORM_BUFFER, SURFELS_BINDING_BLOCK, s->block);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFELS_BINDING_FOUND, s->emissive.buffer);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, SURFELS_BINDING_RADIOSITY, s->other.buffer);
	glBindTextureUnit(SURFELS_UNIT_PARTS, a->ways.texture);
	glBindTextureUnit(SURFELS_UNIT_ALBEDO, a->emissive.texture);
	glBindTextureUnit(SURFELS_UNIT_EMISSIVE, a->other.texture);
	glProgramUniform1f(a->program, 1, more);
	surfels_barrier();
	surfels_dispatch(a->program, (struct surfels_run){ 0, (uint32_t)s->count });
	surfels_barrier();
}
