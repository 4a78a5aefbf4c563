#include "renderer/calibrate_room.h"

#include "base/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SIDE 4.0f
#define BOXES 2
#define VERTICES (BOXES * 24)
#define INDICES (BOXES * 36)

/* Six faces of four corners; inwards: seen from within. */
static void put_box(struct scene *scene, const float low[3], const float high[3], bool inwards)
{
	for (int face = 0; face < 6; face++) {
		int axis = face / 2, side = face % 2;
		uint32_t first = (uint32_t)scene->vertex_count;
		/* a and b turn from the axis to the right on the high side */
		int a = (axis + 1) % 3, b = (axis + 2) % 3;
		bool turned = side == inwards;
		static const uint32_t order[2][6] = { { 0, 1, 2, 0, 2, 3 }, { 0, 2, 1, 0, 3, 2 } };

		for (int corner = 0; corner < 4; corner++) {
			struct scene_vertex *v = &scene->vertices[scene->vertex_count++];

			v->position[axis] = side ? high[axis] : low[axis];
			v->position[a] = corner == 1 || corner == 2 ? high[a] : low[a];
			v->position[b] = corner >= 2 ? high[b] : low[b];
			v->normal[axis] = turned ? -1.0f : 1.0f;
		}
		for (int i = 0; i < 6; i++)
			scene->indices[scene->index_count++] = first + order[turned][i];
	}
}

int calibrate_room(struct scene **out)
{
	static const float low[3], high[3] = { SIDE, SIDE, SIDE };
	static const float block_low[3] = { 1.2f, 0, 1.1f }, block_high[3] = { 2.3f, 1.3f, 2.1f };
	struct scene *scene = calloc(1, sizeof *scene);

	*out = NULL;
	if (!scene)
		return GR_ERR_NOMEM;
	scene->vertices = calloc(VERTICES, sizeof *scene->vertices);
	scene->indices = calloc(INDICES, sizeof *scene->indices);
	scene->materials = calloc(1, sizeof *scene->materials);
	scene->draws = calloc(1, sizeof *scene->draws);
	if (!scene->vertices || !scene->indices || !scene->materials || !scene->draws) {
		scene_destroy(&scene);
		return GR_ERR_NOMEM;
	}
	put_box(scene, low, high, true);
	put_box(scene, block_low, block_high, false);
	memcpy(scene->max, high, sizeof high);
	scene->material_count = scene->draw_count = 1;
	scene->draws[0].index_count = (uint32_t)scene->index_count;
	for (int c = 0; c < 3; c++)
		scene->materials[0].diffuse[c] = 0.6f;
	scene->materials[0].diffuse_image = scene->materials[0].emission_image = -1;
	scene->materials[0].table = -1;
	*out = scene;
	return GR_OK;
}

void calibrate_room_file(struct scene_file *out, struct scene_lamp *lamp)
{
	*lamp = (struct scene_lamp){
		.kind = SCENE_LAMP_SPOT,
		.position = { 2, 3.9f, 2 },
		.direction = { 0, -1, 0 },
		.intensity = { 40, 40, 40 },
		.cone_rad = 1.4f,
		.penumbra_rad = 0.2f,
		.radius_m = 0.02f,
		.on = true,
	};
	*out = (struct scene_file){
		.lamps = lamp,
		.lamp_count = 1,
		.model_scale = 1,
		.emission_scale = 1,
		.shadow_pixels = 256,
		.near_m = 0.05f,
		.far_m = 50,
		.room = GR_POSE_IDENTITY,
		.tone = { .exposure = 1, .adaptation = 100, .luminance_max = 1e4f, .bias = 0.85f,
			  .gamma_display = 2.2f, .gamma_end_to_end = 1, .srgb = true },
		.gi = { .lattice = 8, .steps = 8, .rsm_pixels = 64, .link_rays = 4,
			.albedo_override = { -1, -1, -1 }, .spacing_m = 0.3f, .links = 256, .gathers = 1,
			.taps = 16, .probes = 1 },
	};
}
