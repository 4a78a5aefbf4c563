/* What the light field is at points of surfaces, for what measures it. */
#include "renderer/renderer_private.h"

#include "base/result.h"

#include <stdlib.h>
#include <string.h>

#define GROUP 64u /* gi_probe.comp */
_Static_assert(RENDERER_POINTS_MAX / GROUP < 65535, "groups on one axis");

/* Around the method's own look-up. */
static int create_program(struct renderer *r)
{
	char defines[128];

	if (r->irradiance_program)
		return GR_OK;
	snprintf(defines, sizeof defines, "#define GI_SHADER \"%s\"\n", r->gi->ops->shader_name);
	return program_create_compute(&r->irradiance_program, "gi_probe.comp", defines);
}

static void look(struct renderer *r, size_t count, const float *rows, float *found)
{
	unsigned buffers[2];

	glCreateBuffers(2, buffers);
	glNamedBufferStorage(buffers[0], (GLsizeiptr)(count * 8 * sizeof *rows), rows, 0);
	glNamedBufferStorage(buffers[1], (GLsizeiptr)(count * 4 * sizeof *found), NULL, 0);
	r->gi->ops->bind(r->gi);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers[0]);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffers[1]);
	glUseProgram(r->irradiance_program);
	glProgramUniform1i(r->irradiance_program, 0, (int)count);
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
	glDispatchCompute(((unsigned)count + GROUP - 1) / GROUP, 1, 1);
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glGetNamedBufferSubData(buffers[1], 0, (GLsizeiptr)(count * 4 * sizeof *found), found);
	glDeleteBuffers(2, buffers);
}

int renderer_read_irradiance(struct renderer *renderer, const struct renderer_point *points,
			     size_t count, float (*out)[3])
{
	float *rows, *found;
	int result;

	memset(out, 0, count * sizeof *out);
	if (!renderer->gi || !count)
		return GR_OK;
	if (count > RENDERER_POINTS_MAX)
		return GR_ERR_RANGE;
	result = create_program(renderer);
	if (result != GR_OK)
		return result;
	rows = calloc(count, 8 * sizeof *rows);
	found = calloc(count, 4 * sizeof *found);
	if (!rows || !found) {
		result = GR_ERR_NOMEM;
		goto out;
	}
	for (size_t k = 0; k < count; k++) {
		memcpy(rows + 8 * k, points[k].position, sizeof points[k].position);
		memcpy(rows + 8 * k + 4, points[k].normal, sizeof points[k].normal);
	}
	look(renderer, count, rows, found);
	for (size_t k = 0; k < count; k++)
		memcpy(out[k], found + 4 * k, sizeof out[k]);
	result = glGetError() == GL_NO_ERROR ? GR_OK : GR_ERR_GL;
out:
	free(rows);
	free(found);
	return result;
}
