#include "tools/bench/room.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void *grow(void *items, size_t count, size_t *room, size_t size)
{
	if (count < *room)
		return items;
	*room = *room ? *room * 2 : 64;
	items = realloc(items, *room * size);
	if (!items)
		abort();
	return items;
}

void room_begin(struct room_builder *b)
{
	memset(b, 0, sizeof *b);
	b->scene = calloc(1, sizeof *b->scene);
	if (!b->scene)
		abort();
}

uint32_t room_material(struct room_builder *b, float red, float green, float blue)
{
	struct scene *s = b->scene;
	struct scene_material *m;

	s->materials = grow(s->materials, s->material_count, &b->material_room, sizeof *m);
	m = &s->materials[s->material_count];
	memset(m, 0, sizeof *m);
	m->diffuse[0] = red;
	m->diffuse[1] = green;
	m->diffuse[2] = blue;
	m->diffuse_image = m->emission_image = -1;
	m->two_sided = true;
	return (uint32_t)s->material_count++;
}

static void cross(const float a[3], const float b[3], float out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

void room_quad(struct room_builder *b, uint32_t material, const float p[3], const float u[3],
	       const float v[3])
{
	static const uint32_t corners[6] = { 0, 1, 2, 0, 2, 3 };
	struct scene *s = b->scene;
	uint32_t first = (uint32_t)s->vertex_count;
	float n[3];

	cross(u, v, n);
	float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	for (int k = 0; k < 4; k++) {
		float a = (k == 1 || k == 2) ? 1.0f : 0.0f;
		float c = k >= 2 ? 1.0f : 0.0f;

		s->vertices = grow(s->vertices, s->vertex_count, &b->vertex_room,
				   sizeof *s->vertices);
		struct scene_vertex *vertex = &s->vertices[s->vertex_count++];
		for (int i = 0; i < 3; i++) {
			vertex->position[i] = p[i] + a * u[i] + c * v[i];
			vertex->normal[i] = n[i] / length;
		}
		vertex->uv[0] = a;
		vertex->uv[1] = c;
	}
	s->draws = grow(s->draws, s->draw_count, &b->draw_room, sizeof *s->draws);
	s->draws[s->draw_count++] =
		(struct scene_draw){ (uint32_t)s->index_count, 6, material };
	for (int k = 0; k < 6; k++) {
		s->indices = grow(s->indices, s->index_count, &b->index_room, sizeof *s->indices);
		s->indices[s->index_count++] = first + corners[k];
	}
}

void room_box(struct room_builder *b, uint32_t material, const float middle[3],
	      const float half[3], float angle)
{
	const float c = cosf(angle), s = sinf(angle);
	const float axes[3][3] = { { c, 0, -s }, { 0, 1, 0 }, { s, 0, c } };

	for (int axis = 0; axis < 3; axis++) {
		for (int side = -1; side <= 1; side += 2) {
			int ui = (axis + 1) % 3, vi = (axis + 2) % 3;
			float p[3], u[3], v[3];

			if (side < 0) {
				int t = ui;

				ui = vi;
				vi = t;
			}
			for (int i = 0; i < 3; i++) {
				u[i] = 2 * half[ui] * axes[ui][i];
				v[i] = 2 * half[vi] * axes[vi][i];
				p[i] = middle[i] + (float)side * half[axis] * axes[axis][i] -
				       0.5f * (u[i] + v[i]);
			}
			room_quad(b, material, p, u, v);
		}
	}
}

void room_inside(struct room_builder *b, const uint32_t materials[6], const float min[3],
		 const float max[3])
{
	for (int axis = 0; axis < 3; axis++) {
		for (int side = 0; side < 2; side++) {
			int ui = (axis + 1) % 3, vi = (axis + 2) % 3;
			float p[3], u[3] = { 0, 0, 0 }, v[3] = { 0, 0, 0 };

			if (side) {
				int t = ui;

				ui = vi;
				vi = t;
			}
			memcpy(p, min, sizeof p);
			p[axis] = side ? max[axis] : min[axis];
			u[ui] = max[ui] - min[ui];
			v[vi] = max[vi] - min[vi];
			room_quad(b, materials[2 * axis + side], p, u, v);
		}
	}
}

struct scene *room_end(struct room_builder *b)
{
	struct scene *s = b->scene;

	for (int i = 0; i < 3; i++) {
		s->min[i] = INFINITY;
		s->max[i] = -INFINITY;
		for (size_t k = 0; k < s->vertex_count; k++) {
			s->min[i] = fminf(s->min[i], s->vertices[k].position[i]);
			s->max[i] = fmaxf(s->max[i], s->vertices[k].position[i]);
		}
	}
	b->scene = NULL;
	return s;
}

void room_free(struct scene **scene)
{
	if (!*scene)
		return;
	free((*scene)->vertices);
	free((*scene)->indices);
	free((*scene)->draws);
	free((*scene)->materials);
	free(*scene);
	*scene = NULL;
}

struct scene *room_cornell(void)
{
	struct room_builder b;
	uint32_t white, red, green;

	room_begin(&b);
	white = room_material(&b, 0.73f, 0.72f, 0.68f);
	red = room_material(&b, 0.63f, 0.07f, 0.05f);
	green = room_material(&b, 0.14f, 0.45f, 0.09f);
	const uint32_t walls[6] = { red, green, white, white, white, white };
	room_inside(&b, walls, (float[3]){ 0, 0, 0 }, (float[3]){ 4, 4, 4 });
	room_box(&b, white, (float[3]){ 1.35f, 1.2f, 1.4f }, (float[3]){ 0.6f, 1.2f, 0.6f }, 0.3f);
	room_box(&b, white, (float[3]){ 2.7f, 0.6f, 2.6f }, (float[3]){ 0.6f, 0.6f, 0.6f }, -0.31f);
	return room_end(&b);
}
