#include "renderer/gi/lpv_private.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <string.h>

#define SLOT_BYTES 256 /* the largest alignment that GL allows a driver to ask for */
#define LOG_EVERY 60   /* checked frames with faults between two log lines */

int lpv_check_init(struct lpv *lpv)
{
	const GLbitfield flags = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
	int result = program_create_compute(&lpv->check, "lpv_check.comp", NULL);

	if (result != GR_OK)
		return result;
	glCreateBuffers(1, &lpv->checks);
	glNamedBufferStorage(lpv->checks, LPV_RING * SLOT_BYTES, NULL, flags);
	lpv->check_map = glMapNamedBufferRange(lpv->checks, 0, LPV_RING * SLOT_BYTES, flags);
	lpv->stats.residual = -1;
	return lpv->check_map ? GR_OK : GR_ERR_GL;
}

void lpv_check_finish(struct lpv *lpv)
{
	for (int i = 0; i < LPV_RING; i++)
		if (lpv->fences[i])
			glDeleteSync(lpv->fences[i]);
	if (lpv->check_map)
		glUnmapNamedBuffer(lpv->checks);
	lpv->check_map = NULL;
	program_destroy(&lpv->check);
	glDeleteBuffers(1, &lpv->checks);
}

static float float_of(uint32_t bits)
{
	float value;

	memcpy(&value, &bits, sizeof value);
	return value;
}

static void take(struct lpv *lpv, unsigned slot)
{
	const volatile char *at = (const volatile char *)lpv->check_map + slot * SLOT_BYTES;
	const volatile struct lpv_check *check = (const volatile struct lpv_check *)at;
	float change = float_of(check->change), largest = float_of(check->largest);
	uint32_t nonfinite = check->nonfinite, texels = check->bad_texels;

	lpv->stats.residual = largest > 0 ? (double)(change / largest) : 0;
	lpv->stats.nonfinite += nonfinite + texels;
	if (!nonfinite && !texels)
		return;
	if (lpv->nonfinite_frames++ % LOG_EVERY == 0)
		gr_error("light lattice: %u cells and %u texels of the lamps' maps are NaN or infinite",
			 nonfinite, texels);
}

void lpv_check_collect(struct lpv *lpv)
{
	for (unsigned k = 0; k < LPV_RING; k++) {
		unsigned slot = (lpv->ring + k) % LPV_RING; /* oldest first */
		GLenum done;

		if (!lpv->fences[slot])
			continue;
		done = glClientWaitSync(lpv->fences[slot], 0, 0);
		if (done != GL_ALREADY_SIGNALED && done != GL_CONDITION_SATISFIED)
			return;
		glDeleteSync(lpv->fences[slot]);
		lpv->fences[slot] = NULL;
		take(lpv, slot);
	}
}

void lpv_check_submit(struct lpv *lpv)
{
	unsigned slot = lpv->ring;

	if (lpv->fences[slot])
		return; /* the GPU is that far behind: skip a look rather than wait */
	lpv->ring = (slot + 1) % LPV_RING;
	glClearNamedBufferSubData(lpv->checks, GL_R32UI, slot * SLOT_BYTES,
				  sizeof(struct lpv_check), GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
	/* the maps' count of bad texels travels with it: second word of the splat buffer */
	glCopyNamedBufferSubData(lpv->splat, lpv->checks, sizeof(uint32_t),
				 (GLintptr)(slot * SLOT_BYTES + 3 * sizeof(uint32_t)),
				 sizeof(uint32_t));
	glClearNamedBufferSubData(lpv->splat, GL_R32UI, sizeof(uint32_t), sizeof(uint32_t),
				  GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
	glBindTextureUnit(LPV_UNIT_LIGHT, lpv->light[lpv->current].texture);
	glBindTextureUnit(LPV_UNIT_BEFORE, lpv->light[!lpv->current].texture);
	glBindBufferRange(GL_SHADER_STORAGE_BUFFER, LPV_BINDING_CHECK, lpv->checks,
			  slot * SLOT_BYTES, sizeof(struct lpv_check));
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
			GL_BUFFER_UPDATE_BARRIER_BIT);
	glUseProgram(lpv->check);
	glDispatchCompute(lpv->per_cell.x, lpv->per_cell.y, 1);
	glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
	lpv->fences[slot] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}
