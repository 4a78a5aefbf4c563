#include "renderer/gi/lpv_private.h"

#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <stdio.h>

#define LEGS 3

static size_t bordered(const struct lpv *lpv)
{
	const int *size = lpv->lattice.size;

	return (size_t)(size[0] + 2) * (size_t)(size[1] + 2) * (size_t)(size[2] + 2) * 3;
}

int lpv_start_init(struct lpv *lpv)
{
	struct lpv_start *start = &lpv->start;
	int result = dispatch_plan(bordered(lpv), 64, &start->all);

	for (int i = 0; i < 3 && result == GR_OK; i++) {
		char define[32];

		snprintf(define, sizeof define, "#define STAGE %d\n", i);
		result = program_create_compute(&start->programs[i], "lpv_leap.comp", define);
		if (result == GR_OK)
			glProgramUniform1i(start->programs[i], 0, (int)bordered(lpv));
	}
	if (result != GR_OK)
		return result;
	glCreateBuffers(1, &start->oldest);
	glNamedBufferStorage(start->oldest, (GLsizeiptr)(bordered(lpv) * 4 * sizeof(float)), NULL, 0);
	glCreateBuffers(1, &start->sums);
	glNamedBufferStorage(start->sums, 2 * 1026 * sizeof(float), NULL, 0);
	return GR_OK;
}

void lpv_start_finish(struct lpv *lpv)
{
	for (int i = 0; i < 3; i++)
		program_destroy(&lpv->start.programs[i]);
	glDeleteBuffers(1, &lpv->start.oldest);
	glDeleteBuffers(1, &lpv->start.sums);
}

/* Two steps, and from what they change to where the steps after them would lead. */
static void leap(struct lpv *lpv)
{
	const struct lpv_start *start = &lpv->start;
	const unsigned groups[3][2] = { { 16, 1 }, { 1, 1 }, { start->all.x, start->all.y } };

	glCopyNamedBufferSubData(lpv->sent[lpv->sending].buffer, start->oldest, 0, 0,
				 (GLsizeiptr)(bordered(lpv) * 4 * sizeof(float)));
	lpv_propagate(lpv, 2, 0);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, LPV_BINDING_LEAP, start->oldest);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, LPV_BINDING_LEAP + 1,
			 lpv->sent[!lpv->sending].buffer);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, LPV_BINDING_LEAP + 2,
			 lpv->sent[lpv->sending].buffer);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, LPV_BINDING_LEAP + 3, start->sums);
	for (int i = 0; i < 3; i++) {
		glUseProgram(start->programs[i]);
		glDispatchCompute(groups[i][0], groups[i][1], 1);
		glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
				GL_BUFFER_UPDATE_BARRIER_BIT);
	}
}

int lpv_start_steps(const struct lpv *lpv)
{
	return LEGS * (lpv->settle_steps / 6 + 3);
}

void lpv_start(struct lpv *lpv)
{
	int leg = lpv_start_steps(lpv) / LEGS;

	for (int i = 0; i + 1 < LEGS; i++) {
		lpv_propagate(lpv, leg - 2, 0);
		leap(lpv);
	}
	/* the check compares the lights of the last two */
	lpv_propagate(lpv, leg, 2);
}
