#include "renderer/gi/lpv_private.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>

#define HEADER_BYTES 16
#define RUN 4

int lpv_splat_init(struct lpv *lpv)
{
	size_t bytes = HEADER_BYTES + lattice_cells(&lpv->lattice) * 24 * sizeof(uint32_t);
	int result = program_create_compute(&lpv->splat_peak, "lpv_splat_peak.comp", NULL);

	if (result == GR_OK)
		result = program_create_compute(&lpv->splat_sum, "lpv_splat_sum.comp", NULL);
	if (result == GR_OK)
		result = program_create_compute(&lpv->splat_resolve, "lpv_splat_resolve.comp", NULL);
	if (result != GR_OK)
		return result;
	glCreateBuffers(1, &lpv->splat);
	glNamedBufferStorage(lpv->splat, (GLsizeiptr)bytes, NULL, 0);
	glClearNamedBufferData(lpv->splat, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
	return GR_OK;
}

void lpv_splat_finish(struct lpv *lpv)
{
	program_destroy(&lpv->splat_peak);
	program_destroy(&lpv->splat_sum);
	program_destroy(&lpv->splat_resolve);
	glDeleteBuffers(1, &lpv->splat);
}

void lpv_splat(struct lpv *lpv, const struct rsm_set *rsm)
{
	int side = (rsm->pixels + RUN - 1) / RUN;
	struct dispatch runs;
	const unsigned programs[2] = { lpv->splat_peak, lpv->splat_sum };

	glClearNamedBufferSubData(lpv->splat, GL_R32UI, 0, HEADER_BYTES, GL_RED_INTEGER,
				  GL_UNSIGNED_INT, NULL);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, LPV_BINDING_SPLAT, lpv->splat);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, LPV_BINDING_INJECT, lpv->inject.buffer);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, LPV_BINDING_EMITTED, lpv->emitted.buffer);
	if (rsm->layers > 0 && rsm->pixels > 0 &&
	    dispatch_plan((uint64_t)side * (uint64_t)side * (uint64_t)rsm->layers, 64, &runs) == GR_OK) {
		glBindTextureUnit(LPV_UNIT_MAPS, rsm->position_area);
		glBindTextureUnit(LPV_UNIT_MAPS + 1, rsm->normal);
		glBindTextureUnit(LPV_UNIT_MAPS + 2, rsm->exitance);
		for (int i = 0; i < 2; i++) {
			glUseProgram(programs[i]);
			glProgramUniform3i(programs[i], 0, rsm->pixels, rsm->layers, side);
			glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT |
					GL_TEXTURE_FETCH_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
			glDispatchCompute(runs.x, runs.y, 1);
		}
	}
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
			GL_BUFFER_UPDATE_BARRIER_BIT);
	glUseProgram(lpv->splat_resolve);
	glDispatchCompute(lpv->per_cell.x, lpv->per_cell.y, 1);
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
			GL_BUFFER_UPDATE_BARRIER_BIT);
}
