/*
 * Scenes made in memory for the accuracy tests and the lattice benchmark: a
 * Cornell-like room of 4 m with two boxes (own measures), and rooms with
 * walls for the tests on leaks.
 */
#ifndef GROTTO_TOOLS_BENCH_ROOM_H
#define GROTTO_TOOLS_BENCH_ROOM_H

#include "renderer/scene/scene.h"

struct room_builder {
	struct scene *scene;
	size_t vertex_room, index_room, draw_room, material_room;
};

/* Aborts when out of memory: tests only. */
void room_begin(struct room_builder *b);
uint32_t room_material(struct room_builder *b, float r, float g, float bl);
/* Quad p, p+u, p+u+v, p+v; its front is u x v. */
void room_quad(struct room_builder *b, uint32_t material, const float p[3], const float u[3],
	       const float v[3]);
/* Box about the middle, half sizes, turned by angle (radians) about +Y; outside is the front. */
void room_box(struct room_builder *b, uint32_t material, const float middle[3],
	      const float half[3], float angle);
/* The inside of a box: six walls with materials -x +x -y +y -z +z; inside is the front. */
void room_inside(struct room_builder *b, const uint32_t materials[6], const float min[3],
		 const float max[3]);
/* Computes the bounds and hands the scene over; scene_free_own frees it. */
struct scene *room_end(struct room_builder *b);
void room_free(struct scene **scene);

/* 4 x 4 x 4 m from 0: white, left red, right green, two white boxes. */
struct scene *room_cornell(void);

#endif
