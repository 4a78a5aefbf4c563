#include "renderer/tone/gaze.h"

#include "base/log.h"
#include "base/photometry.h"
#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>

#define SLOTS 4 /* frames that may be in flight */
#define GROUP 16
#define GROUPS (GAZE_CELLS / GROUP)
#define BINDING 8 /* the first that is not the view's (blocks.h) */

/* As shaders/gaze.comp writes it. */
struct sum {
	float log_sum, solid_angle, most;
	uint32_t nonfinite;
};

struct gaze_stage {
	unsigned program;
	unsigned buffer; /* SLOTS times a sum of each work group, mapped for as long as the stage lives */
	const struct sum *mapped;
	struct slot {
		GLsync fence; /* NULL: free */
		uint64_t frame;
		int groups;
	} slots[SLOTS];
	size_t stride; /* bytes from slot to slot, as bindings must be aligned */
	int next;
	struct adapt_sample newest;
	uint64_t newest_frame;
	bool any;
};

int gaze_create(struct gaze_stage **out)
{
	const GLbitfield access = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
	struct gaze_stage *s = calloc(1, sizeof *s);
	GLint align = 1;
	int result;

	*out = NULL;
	if (!s)
		return GR_ERR_NOMEM;
	result = program_create_compute(&s->program, "gaze.comp", NULL);
	glGetIntegerv(GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT, &align);
	s->stride = (GROUPS * GROUPS * sizeof(struct sum) + (size_t)align - 1) / (size_t)align * (size_t)align;
	glCreateBuffers(1, &s->buffer);
	glNamedBufferStorage(s->buffer, (GLsizeiptr)(SLOTS * s->stride), NULL, access);
	s->mapped = glMapNamedBufferRange(s->buffer, 0, (GLsizeiptr)(SLOTS * s->stride), access);
	if (result == GR_OK && !s->mapped) {
		gr_error("the sums of what is looked at cannot be mapped");
		result = GR_ERR_GL;
	}
	if (result != GR_OK)
		gaze_destroy(&s);
	*out = s;
	return result;
}

void gaze_destroy(struct gaze_stage **stage)
{
	struct gaze_stage *s = *stage;

	*stage = NULL;
	if (!s)
		return;
	for (int i = 0; i < SLOTS; i++)
		glDeleteSync(s->slots[i].fence);
	if (s->mapped)
		glUnmapNamedBuffer(s->buffer);
	glDeleteBuffers(1, &s->buffer);
	program_destroy(&s->program);
	free(s);
}

static void set_view(const struct gaze_view *v)
{
	const struct projection_wall *w = &v->wall;
	float corner[3], right[3], up[3];

	for (int i = 0; i < 3; i++) {
		corner[i] = w->lower_left[i] - v->eye[i];
		right[i] = w->lower_right[i] - w->lower_left[i];
		up[i] = w->upper_left[i] - w->lower_left[i];
	}
	glUniform3fv(1, 1, corner);
	glUniform3fv(2, 1, right);
	glUniform3fv(3, 1, up);
	glUniform4f(4, v->direction[0], v->direction[1], v->direction[2], cosf(GAZE_CONE_RAD / 2));
	glUniform3f(5, (float)GR_LUMENS_PER_WATT, (float)ADAPT_LEVEL_MIN, (float)ADAPT_LEVEL_MAX);
}

static bool is_view(const struct gaze_view *v)
{
	const struct projection_wall *w = &v->wall;
	double across[3], up[3], normal[3], from[3], length = 0, before = 0, size = 0;

	for (int i = 0; i < 3; i++) {
		across[i] = (double)w->lower_right[i] - (double)w->lower_left[i];
		up[i] = (double)w->upper_left[i] - (double)w->lower_left[i];
		from[i] = (double)v->eye[i] - (double)w->lower_left[i];
		length += (double)v->direction[i] * (double)v->direction[i];
	}
	for (int i = 0; i < 3; i++) {
		normal[i] = across[(i + 1) % 3] * up[(i + 2) % 3] - across[(i + 2) % 3] * up[(i + 1) % 3];
		before += normal[i] * from[i];
		size += normal[i] * normal[i];
	}
	/* NaN is neither. */
	return fabs(length - 1) < 1e-3 && before > 1e-6 * sqrt(size) && isfinite(before);
}

static int cells_of(int pixels)
{
	return pixels < GAZE_CELLS ? pixels : GAZE_CELLS;
}

static void collect(struct gaze_stage *s, struct slot *slot)
{
	const struct sum *sums = (const struct sum *)((const char *)s->mapped + (size_t)(slot - s->slots) * s->stride);
	struct adapt_sample sample = { 0 };
	GLenum state;

	if (!slot->fence)
		return;
	state = glClientWaitSync(slot->fence, 0, 0);
	if (state != GL_ALREADY_SIGNALED && state != GL_CONDITION_SATISFIED)
		return;
	glDeleteSync(slot->fence);
	slot->fence = NULL;
	for (int i = 0; i < slot->groups; i++) {
		sample.log_sum += (double)sums[i].log_sum;
		sample.solid_angle += (double)sums[i].solid_angle;
		sample.max = fmax(sample.max, (double)sums[i].most);
	}
	if (s->any && slot->frame <= s->newest_frame)
		return;
	s->newest = sample;
	s->newest_frame = slot->frame;
	s->any = true;
}

int gaze_measure(struct gaze_stage *stage, const struct gaze_view *view, unsigned radiance,
		 int width, int height, uint64_t frame)
{
	const int columns = cells_of(width), rows = cells_of(height);
	const int across = (columns + GROUP - 1) / GROUP, down = (rows + GROUP - 1) / GROUP;
	struct slot *slot = &stage->slots[stage->next];

	if (width < 1 || height < 1 || !is_view(view))
		return GR_ERR_RANGE;
	collect(stage, slot);
	if (slot->fence)
		return GR_NOTHING;
	glUseProgram(stage->program);
	glBindTextureUnit(0, radiance);
	glBindBufferRange(GL_SHADER_STORAGE_BUFFER, BINDING, stage->buffer,
			  (GLintptr)((size_t)stage->next * stage->stride), (GLsizeiptr)stage->stride);
	glUniform2i(0, columns, rows);
	set_view(view);
	glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
	glDispatchCompute((GLuint)across, (GLuint)down, 1);
	glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
	slot->fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
	slot->frame = frame;
	slot->groups = across * down;
	stage->next = (stage->next + 1) % SLOTS;
	return GR_OK;
}

int gaze_newest(struct gaze_stage *stage, struct adapt_sample *out, uint64_t *out_frame)
{
	/* From the oldest on. */
	for (int i = 0; i < SLOTS; i++)
		collect(stage, &stage->slots[(stage->next + i) % SLOTS]);
	if (!stage->any)
		return GR_NOTHING;
	*out = stage->newest;
	*out_frame = stage->newest_frame;
	return GR_OK;
}
