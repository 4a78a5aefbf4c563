#include "renderer/view/hud.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gi/gi.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define SIDES 24 /* of a cone */
#define BOX_VERTICES 36
#define CONE_VERTICES (6 * SIDES)
#define MOST (2 * HUD_PARTS_MOST) /* rims, parts */
#define RING 16 /* pictures whose parts the GPU may still be reading: two eyes, eight frames */
#define RIM_M 0.0012f /* at scale 1 */
#define NEAR_M 0.01f
#define FAR_M 1e4f

struct hud_vertex {
	float position[3], normal[3];
};

/* A part on the GPU: an instance's attributes. */
struct hud_instance {
	float T_room_part[16];
	float color[4];
};

#define INSTANCE_BYTES ((GLsizeiptr)(RING * MOST * sizeof(struct hud_instance)))

struct hud_stage {
	unsigned program, vao, vertices, instances;
	struct hud_instance *mapped; /* instances, for as long as the stage lives: no copy waits for the GPU */
	unsigned slot; /* of the ring */
	bool shown;
	struct hud_view view; /* while it is shown */
};

static struct hud_vertex vertex(const float p[3], const float n[3])
{
	return (struct hud_vertex){ { p[0], p[1], p[2] }, { n[0], n[1], n[2] } };
}

static void make_box(struct hud_vertex out[BOX_VERTICES])
{
	static const float corners[6][2] = { { -0.5f, -0.5f }, { 0.5f, -0.5f }, { 0.5f, 0.5f },
					     { -0.5f, -0.5f }, { 0.5f, 0.5f },	{ -0.5f, 0.5f } };

	for (int face = 0; face < 6; face++) {
		const int k = face % 3;
		const float side = face < 3 ? 1 : -1;

		for (int i = 0; i < 6; i++) {
			float p[3], n[3] = { 0, 0, 0 };

			n[k] = side;
			p[k] = 0.5f * side;
			/* seen from outside counter-clockwise: on the far side one axis turns round */
			p[(k + 1) % 3] = side * corners[i][0];
			p[(k + 2) % 3] = corners[i][1];
			out[6 * face + i] = vertex(p, n);
		}
	}
}

static void make_cone(struct hud_vertex out[CONE_VERTICES])
{
	static const float tip[3], centre[3] = { 0, 0, -1 }, down[3] = { 0, 0, -1 };
	const float slope = sqrtf(0.5f);

	for (int i = 0; i < SIDES; i++) {
		float p[2][3], n[2][3], between[3] = { 0, 0, slope };

		for (int k = 0; k < 2; k++) {
			const float angle = 2 * (float)M_PI * (float)(i + k) / SIDES;

			p[k][0] = n[k][0] = cosf(angle);
			p[k][1] = n[k][1] = sinf(angle);
			p[k][2] = -1;
			n[k][2] = 1;
			glm_vec3_scale(n[k], slope, n[k]);
			between[0] += 0.5f * n[k][0];
			between[1] += 0.5f * n[k][1];
		}
		out[6 * i] = vertex(tip, between);
		out[6 * i + 1] = vertex(p[0], n[0]);
		out[6 * i + 2] = vertex(p[1], n[1]);
		out[6 * i + 3] = vertex(centre, down);
		out[6 * i + 4] = vertex(p[1], down);
		out[6 * i + 5] = vertex(p[0], down);
	}
}

static void attribute(unsigned vao, unsigned index, int size, size_t offset, unsigned binding)
{
	glEnableVertexArrayAttrib(vao, index);
	glVertexArrayAttribFormat(vao, index, size, GL_FLOAT, GL_FALSE, (GLuint)offset);
	glVertexArrayAttribBinding(vao, index, binding);
}

static void create_buffers(struct hud_stage *s)
{
	const GLbitfield access = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
	struct hud_vertex all[BOX_VERTICES + CONE_VERTICES];

	make_box(all);
	make_cone(all + BOX_VERTICES);
	glCreateBuffers(1, &s->vertices);
	glNamedBufferStorage(s->vertices, sizeof all, all, 0);
	glCreateBuffers(1, &s->instances);
	glNamedBufferStorage(s->instances, INSTANCE_BYTES, NULL, access);
	s->mapped = glMapNamedBufferRange(s->instances, 0, INSTANCE_BYTES, access);
	glCreateVertexArrays(1, &s->vao);
	glVertexArrayVertexBuffer(s->vao, 0, s->vertices, 0, sizeof(struct hud_vertex));
	attribute(s->vao, 0, 3, offsetof(struct hud_vertex, position), 0);
	attribute(s->vao, 1, 3, offsetof(struct hud_vertex, normal), 0);
	for (unsigned i = 0; i < 4; i++)
		attribute(s->vao, 2 + i, 4, 16 * (size_t)i, 1);
	attribute(s->vao, 6, 4, offsetof(struct hud_instance, color), 1);
	glVertexArrayBindingDivisor(s->vao, 1, 1);
}

int hud_create(struct hud_stage **out)
{
	struct hud_stage *s = calloc(1, sizeof *s);
	int result;

	*out = NULL;
	if (!s)
		return GR_ERR_NOMEM;
	result = program_create_graphics(&s->program, "hud.vert", NULL, "hud.frag", NULL);
	if (result == GR_OK)
		create_buffers(s);
	if (result == GR_OK && !s->mapped) {
		gr_error("the HUD's parts cannot be mapped");
		result = GR_ERR_GL;
	}
	if (result != GR_OK)
		hud_destroy(&s);
	*out = s;
	return result;
}

void hud_destroy(struct hud_stage **stage)
{
	struct hud_stage *s = *stage;

	if (!s)
		return;
	if (s->mapped)
		glUnmapNamedBuffer(s->instances);
	glDeleteVertexArrays(1, &s->vao);
	glDeleteBuffers(1, &s->vertices);
	glDeleteBuffers(1, &s->instances);
	program_destroy(&s->program);
	free(s);
	*stage = NULL;
}

static void take_torch(struct hud_view *v, const struct render_frame *frame, const struct scene_file *file)
{
	const struct scene_lamp *of = &file->lamps[frame->hand.torch];
	const struct frame_lamp *lamp = &frame->lamps[frame->hand.torch];

	v->has_torch = true;
	v->torch_on = lamp->on;
	v->torch_half_angle = of->kind == SCENE_LAMP_SPOT ? 0.5f * of->cone_rad : 0;
	v->torch_hue = frame->hand.torch_hue;
	memcpy(v->torch_intensity, lamp->intensity, sizeof v->torch_intensity);
	if (v->mode != FRAME_HAND_LIGHTING)
		return;
	gr_pose_inverse(&frame->T_scene_room, &v->T_room_scene);
	memcpy(v->torch_position, lamp->position, sizeof v->torch_position);
	memcpy(v->torch_direction, lamp->direction, sizeof v->torch_direction);
}

/* What settings are about; of it only what their bars show. */
static void take_settings(struct hud_view *v, const struct render_frame *frame, const struct scene_file *file)
{
	v->quality = frame->hand.quality;
	v->refines = frame->gi_refine > 1;
	v->absorption_per_m = frame->absorption_per_m;
	v->scattering_per_m = frame->scattering_per_m;
	v->incremental = -1;
	switch (file->gi.method) {
	case SCENE_GI_LPV: /* normalised by the lattice, as in the thesis */
		v->work = 'P';
		v->work_share = (float)frame->gi_steps / (float)file->gi.lattice;
		if (file->gi.lpv_mode == SCENE_LPV_THESIS)
			v->incremental = frame->gi_incremental;
		break;
	case SCENE_GI_SURFELS:
	case SCENE_GI_PROBES:
		v->work = 'G';
		v->work_share = (float)frame->gi_gathers / GI_GATHERS_MOST;
		break;
	case SCENE_GI_NONE:
	case SCENE_GI_AUTO: break;
	}
}

bool hud_take(struct hud_stage *s, const struct render_frame *frame, const struct scene_file *file)
{
	struct hud_view view;
	bool changed = s->shown;

	s->shown = frame && frame->hand.shown;
	if (!s->shown)
		return changed;
	memset(&view, 0, sizeof view);
	view.T_room_wand = frame->hand.T_room_wand;
	view.scale = frame->hand.scale;
	view.mode = frame->hand.mode;
	if (frame->hand.torch >= 0)
		take_torch(&view, frame, file);
	if (view.mode == FRAME_HAND_SETTINGS)
		take_settings(&view, frame, file);
	changed = !changed || memcmp(&view, &s->view, sizeof view) != 0;
	s->view = view;
	return changed;
}

bool hud_shown(const struct hud_stage *s)
{
	return s->shown;
}

/* Runs of one shape, in the order of the parts: what is drawn later is in front. */
static void draw_runs(const struct hud_part *parts, size_t count)
{
	for (size_t first = 0, end; first < count; first = end) {
		const bool cone = parts[first].shape == HUD_CONE;

		for (end = first + 1; end < count && parts[end].shape == parts[first].shape;)
			end++;
		glDrawArraysInstancedBaseInstance(GL_TRIANGLES, cone ? BOX_VERTICES : 0,
						  cone ? CONE_VERTICES : BOX_VERTICES,
						  (GLsizei)(end - first), (GLuint)first);
	}
}

/* All rims, in any order, then the parts, farthest first. */
static size_t arrange(const struct hud_view *view, const vec3 eye, struct hud_part all[MOST])
{
	struct hud_part parts[HUD_PARTS_MOST];
	const size_t count = hud_parts(view, parts);
	size_t rims = 0;

	hud_parts_sort(parts, count, eye);
	for (size_t i = 0; i < count; i++)
		rims += hud_part_rim(&parts[i], RIM_M * view->scale, &all[rims]);
	memcpy(all + rims, parts, count * sizeof *parts);
	return rims + count;
}

static size_t upload(struct hud_stage *s, const vec3 eye, struct hud_part parts[MOST])
{
	const size_t count = arrange(&s->view, eye, parts), first = (size_t)s->slot * MOST;
	struct hud_instance *instances = s->mapped + first;

	for (size_t i = 0; i < count; i++) {
		memcpy(instances[i].T_room_part, parts[i].T_room_part, sizeof instances[i].T_room_part);
		memcpy(instances[i].color, parts[i].color, sizeof instances[i].color);
	}
	glVertexArrayVertexBuffer(s->vao, 1, s->instances, (GLintptr)(first * sizeof *instances), sizeof *instances);
	s->slot = (s->slot + 1) % RING;
	return count;
}

void hud_draw(struct hud_stage *s, const struct hud_eye *eye)
{
	struct hud_part parts[MOST];
	struct projection p;
	size_t count;

	if (projection_off_axis(eye->wall, eye->position, NEAR_M, FAR_M, &p) != GR_OK)
		return;
	count = upload(s, eye->position, parts);
	glUseProgram(s->program);
	glUniformMatrix4fv(1, 1, GL_FALSE, (const GLfloat *)p.view_projection);
	glUniform3fv(2, 1, eye->position);
	glUniform3fv(3, 1, eye->position_scene);
	glUniform2i(4, eye->x, eye->y);
	glBindTextureUnit(0, eye->gbuffer->images[0]);
	glBindVertexArray(s->vao);
	glDisable(GL_DEPTH_TEST);
	glEnable(GL_CULL_FACE);
	glCullFace(GL_BACK);
	glFrontFace(GL_CCW);
	glEnable(GL_BLEND);
	glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
	draw_runs(parts, count);
	glDisable(GL_BLEND);
	glDisable(GL_CULL_FACE);
}
