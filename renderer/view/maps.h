/*
 * Depth maps in the layers of one array texture: what a lamp or an emissive
 * patch sees. Depth is reversed (1 near, 0 far) in 32 bit float.
 *
 * GL thread only, but for the map_layer functions, which are pure.
 */
#ifndef GROTTO_RENDERER_VIEW_MAPS_H
#define GROTTO_RENDERER_VIEW_MAPS_H

#include "renderer/gl/mesh.h"
#include "renderer/view/blocks.h"

/* Right handed, unit, right x up = back; the map looks along -back. */
struct map_basis {
	double right[3], up[3], back[3];
};

/* A basis that looks along a direction (need not be unit, must not be 0). */
void map_basis_look(const float direction[3], struct map_basis *out);
/* Face 0..5 of a cube: +x -x +y -y +z -z of the given axes (columns of a frame). */
void map_basis_face(const struct map_basis *frame, int face, struct map_basis *out);

/*
 * A length that is nothing beside a scene of these bounds, metres: 1 mm; a
 * thousandth of the diagonal in one that is smaller than a metre. Shadows need
 * not be finer, and what is nearer to a lamp is taken for the lamp.
 */
double map_least_length(const float min[3], const float max[3]);

/* half: tangent of half the angle of view. lift: see struct map_layer. */
void map_layer_perspective(struct map_layer *out, const struct map_basis *basis,
			   const float origin[3], double half, double near_m, double far_m,
			   double lift_m, int pixels);
/* half: half the width, metres; near and far along the axis from origin. */
void map_layer_ortho(struct map_layer *out, const struct map_basis *basis, const float origin[3],
		     double half, double near_m, double far_m, double lift_m, int pixels);

struct depth_maps {
	unsigned texture; /* GL_TEXTURE_2D_ARRAY, DEPTH_COMPONENT32F */
	unsigned compare; /* sampler: share of the 2 x 2 texels that let light through */
	unsigned framebuffer;
	unsigned program;
	unsigned buffer; /* of struct map_layer, one a layer */
	int pixels, layers;
};

/* GR_OK or GR_ERR_GL. Zeroed first; finish also after a failure. */
int depth_maps_init(struct depth_maps *maps, int pixels, int layers);
void depth_maps_finish(struct depth_maps *maps);
/* Stores the layer's record and draws everything into it. */
void depth_maps_draw(struct depth_maps *maps, int index, const struct map_layer *layer,
		     const struct gl_mesh *mesh);

/* State of passes that look from a lamp: reversed depth, nothing culled. */
void map_pass_begin(int pixels);
void map_pass_end(void);

#endif
