/*
 * What the surfels' GL tests and measurements share: lamps with their shadow
 * maps in front of any number of methods, without a picture.
 *
 * GL thread only. Aborts when out of memory: tests only.
 */
#ifndef GROTTO_TOOLS_BENCH_SURFEL_RIG_H
#define GROTTO_TOOLS_BENCH_SURFEL_RIG_H

#include "renderer/gi/gi.h"
#include "renderer/gl/mesh.h"
#include "renderer/view/shadow.h"
#include "tools/bench/truth.h"

struct surfel_rig {
	struct scene_file file; /* with room for all lamps; those after lamp_count are not there */
	struct scene_lamp lamps[SCENE_MAX_LAMPS];
	struct render_frame frame;
	struct gl_mesh *mesh;
	struct shadow_stage *shadow;
	unsigned block; /* struct frame_block */
	const struct scene *scene;
	uint64_t version;
	bool fresh;
};

/*
 * `lamps` spots like the given one, hard-edged, all on; half_angle 0: parallel light
 * of that intensity, W/m^2. Change rig->frame before the first light.
 */
int surfel_rig_init(struct surfel_rig *rig, const struct scene *scene, const struct truth_spot *spot,
		    int lamps, int shadow_pixels);
void surfel_rig_finish(struct surfel_rig *rig);
/* Draws the maps of what changed in rig->frame, and binds them; what update() is to be given. */
struct gi_light surfel_rig_light(struct surfel_rig *rig);
/* One frame of one method. */
int surfel_rig_frame(struct surfel_rig *rig, struct gi_method *method);

#endif
