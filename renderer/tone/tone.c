#include "renderer/tone/tone.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"
#include "renderer/tone/projector.h"
#include "renderer/view/blocks.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Frames that may be in flight; a count whose frame is not finished is not looked at. */
#define SLOTS 4

struct tone_stage {
	unsigned program;
	unsigned empty_vao;
	unsigned map;     /* of the projector, 0: none */
	float dither;     /* a step of the target, 0: none */
	unsigned counter;         /* on the GPU, grows only */
	unsigned copies;          /* SLOTS counts, mapped for as long as the stage lives */
	const uint32_t *mapped;
	GLsync fences[SLOTS];
	int slot;
	uint32_t last;
	uint64_t total;
};

static void create_map(struct tone_stage *stage, const float (*map)[3])
{
	glCreateTextures(GL_TEXTURE_1D, 1, &stage->map);
	glTextureStorage1D(stage->map, 1, GL_RGBA32F, PROJECTOR_MAP);
	glTextureSubImage1D(stage->map, 0, 0, PROJECTOR_MAP, GL_RGB, GL_FLOAT, map);
	glTextureParameteri(stage->map, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTextureParameteri(stage->map, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glTextureParameteri(stage->map, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
}

int tone_create(struct tone_stage **out, const float (*map)[3], int dither_bits)
{
	const GLbitfield access = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
	const uint32_t zero[SLOTS] = { 0 };
	struct tone_stage *stage = calloc(1, sizeof(*stage));
	int result;

	*out = NULL;
	if (!stage)
		return GR_ERR_NOMEM;
	result = program_create_graphics(&stage->program, "screen.vert", NULL, "tone.frag", NULL);
	if (map)
		create_map(stage, map);
	stage->dither = dither_bits > 0 ? 1 / (exp2f((float)dither_bits) - 1) : 0;
	glCreateVertexArrays(1, &stage->empty_vao);
	glCreateBuffers(1, &stage->counter);
	glNamedBufferStorage(stage->counter, sizeof(zero[0]), zero, 0);
	glCreateBuffers(1, &stage->copies);
	glNamedBufferStorage(stage->copies, sizeof(zero), zero, access);
	stage->mapped = glMapNamedBufferRange(stage->copies, 0, sizeof(zero), access);
	if (result == GR_OK && !stage->mapped) {
		gr_error("the counter of the tone pass cannot be mapped");
		result = GR_ERR_GL;
	}
	if (result != GR_OK)
		tone_destroy(&stage);
	*out = stage;
	return result;
}

void tone_destroy(struct tone_stage **stage)
{
	struct tone_stage *s = *stage;

	if (!s)
		return;
	for (int i = 0; i < SLOTS; i++)
		glDeleteSync(s->fences[i]);
	if (s->mapped)
		glUnmapNamedBuffer(s->copies);
	glDeleteTextures(1, &s->map);
	glDeleteBuffers(1, &s->copies);
	glDeleteBuffers(1, &s->counter);
	glDeleteVertexArrays(1, &s->empty_vao);
	program_destroy(&s->program);
	free(s);
	*stage = NULL;
}

bool tone_values_same(const struct tone_values *a, const struct tone_values *b)
{
	bool same = a->factors.curve == b->factors.curve &&
		    a->factors.exposure == b->factors.exposure &&
		    a->gamma_encode == b->gamma_encode && a->srgb == b->srgb;

	for (int i = 0; i < 4; i++)
		same = same && a->factors.a[i] == b->factors.a[i] &&
		       a->factors.b[i] == b->factors.b[i];
	return same;
}

static void set_vec4(int location, const double v[4])
{
	glUniform4f(location, (float)v[0], (float)v[1], (float)v[2], (float)v[3]);
}

void tone_draw(struct tone_stage *stage, const struct tone_values *values, unsigned radiance,
	       unsigned framebuffer, int x, int y, int width, int height)
{
	const struct tone_factors *f = &values->factors;

	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	glViewport(x, y, width, height);
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_CULL_FACE);
	glDisable(GL_BLEND);
	glBindVertexArray(stage->empty_vao);
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, VIEW_BINDING_COUNTERS, stage->counter);
	glBindTextureUnit(0, radiance);
	glUseProgram(stage->program);
	glUniform2i(1, x, y);
	glUniform4f(2, (float)f->exposure, values->gamma_encode, values->srgb ? 1 : 0, 0);
	glUniform2f(6, stage->map ? PROJECTOR_MAP - 1 : 0, stage->dither);
	if (stage->map)
		glBindTextureUnit(1, stage->map);
	glUniform1ui(3, f->curve);
	set_vec4(4, f->a);
	set_vec4(5, f->b);
	glDrawArrays(GL_TRIANGLES, 0, 3);
}

/* Takes over the count of a slot whose frame the GPU has finished. */
static void collect(struct tone_stage *stage, int slot)
{
	GLenum state;

	if (!stage->fences[slot])
		return;
	state = glClientWaitSync(stage->fences[slot], 0, 0);
	if (state != GL_ALREADY_SIGNALED && state != GL_CONDITION_SATISFIED)
		return;
	glDeleteSync(stage->fences[slot]);
	stage->fences[slot] = NULL;
	/* 32 bit on the GPU, so by differences; a slot older than the last one looked at adds none */
	const int32_t more = (int32_t)(stage->mapped[slot] - stage->last);

	if (more > 0) {
		stage->total += (uint32_t)more;
		stage->last += (uint32_t)more;
	}
}

void tone_frame(struct tone_stage *stage)
{
	collect(stage, stage->slot);
	if (stage->fences[stage->slot])
		return; /* the GPU is four frames behind: this count goes with a later one */
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glCopyNamedBufferSubData(stage->counter, stage->copies, 0,
				 (GLintptr)sizeof(uint32_t) * stage->slot, sizeof(uint32_t));
	glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
	stage->fences[stage->slot] = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
	stage->slot = (stage->slot + 1) % SLOTS;
}

uint64_t tone_nonfinite(struct tone_stage *stage)
{
	/* from the oldest on */
	for (int i = 0; i < SLOTS; i++)
		collect(stage, (stage->slot + i) % SLOTS);
	return stage->total;
}
