#include "renderer/gi/surfels_private.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <string.h>

#define SLOT_BYTES 256 /* the largest alignment that GL allows a driver to ask for */
#define LOG_EVERY 60   /* checked frames with faults between two log lines */

int surfels_check_init(struct surfels *s)
{
	const GLbitfield flags = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
	int result = program_create_compute(&s->check, "surfel_check.comp", NULL);

	if (result != GR_OK)
		return result;
	glCreateBuffers(1, &s->checks);
	glNamedBufferStorage(s->checks, SURFELS_RING * SLOT_BYTES, NULL, flags);
	s->check_map = glMapNamedBufferRange(s->checks, 0, SURFELS_RING * SLOT_BYTES, flags);
	s->stats.residual = -1;
	return s->check_map ? GR_OK : GR_ERR_GL;
}

void surfels_check_finish(struct surfels *s)
{
	for (int i = 0; i < SURFELS_RING; i++)
		if (s->fences[i])
			glDeleteSync(s->fences[i]);
	if (s->check_map)
		glUnmapNamedBuffer(s->checks);
	s->check_map = NULL;
	program_destroy(&s->check);
	glDeleteBuffers(1, &s->checks);
}

static float float_of(uint32_t bits)
{
	float value;

	memcpy(&value, &bits, sizeof value);
	return value;
}

static void take(struct surfels *s, unsigned slot)
{
	const volatile char *at = (const volatile char *)s->check_map + slot * SLOT_BYTES;
	const volatile struct surfels_check *check = (const volatile struct surfels_check *)at;
	float change = float_of(check->change), largest = float_of(check->largest);
	uint32_t surfels = check->nonfinite, probes = check->probes_nonfinite;

	s->stats.residual = largest > 0 ? (double)(change / largest) : 0;
	s->stats.nonfinite += (uint64_t)surfels + probes;
	if ((surfels || probes) && s->nonfinite_frames++ % LOG_EVERY == 0)
		gr_error("surfels: the light of %u surfels and %u probes is NaN or infinite", surfels, probes);
}

void surfels_check_collect(struct surfels *s)
{
	for (unsigned k = 0; k < SURFELS_RING; k++) {
		unsigned slot = (s->ring + k) % SURFELS_RING; /* oldest first */
		GLenum done;

		if (!s->fences[slot])
			continue;
		done = glClientWaitSync(s->fences[slot], 0, 0);
		if (done != GL_ALREADY_SIGNALED && done != GL_CONDITION_SATISFIED)
			return;
		glDeleteSync(s->fences[slot]);
		s->fences[slot] = NULL;
		take(s, slot);
	}
}

static void bind_slot(const struct surfels *s, unsigned slot)
{
	glBindBufferRange(GL_SHADER_STORAGE_BUFFER, SURFELS_BINDING_OTHER, s->checks,
			  slot * SLOT_BYTES, sizeof(struct surfels_check));
}

void surfels_check_begin(struct surfels *s, struct surfels_run run)
{
	unsigned slot = s->ring;

	/* the GPU may be that far behind: skip a look rather than wait */
	s->checking = !s->fences[slot];
	if (!s->checking)
		return;
	glClearNamedBufferSubData(s->checks, GL_R32UI, slot * SLOT_BYTES,
				  sizeof(struct surfels_check), GL_RED_INTEGER, GL_UNSIGNED_INT,
				  NULL);
	glBindTextureUnit(SURFELS_UNIT_RADIOSITY, s->radiosity[s->current].texture);
	glBindTextureUnit(SURFELS_UNIT_BEFORE, s->radiosity[!s->current].texture);
	glBindTextureUnit(SURFELS_UNIT_PARTS, s->found.texture);
	bind_slot(s, slot);
	surfels_barrier();
	surfels_dispatch(s->check, run);
}

void surfels_check_end(struct surfels *s)
{
	unsigned slot = s->ring;

	if (!s->checking)
		return;
	s->checking = false;
	s->ring = (slot + 1) % SURFELS_RING;
	bind_slot(s, slot);
	surfels_probes_check(s);
	glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
	s->fences[slot] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}
