#include "tools/bench/surfel_rig.h"

#include "base/result.h"
#include "renderer/view/blocks.h"

#include <epoxy/gl.h>
#include <math.h>
#include <string.h>

static void spot_of(struct scene_lamp *lamp, struct frame_lamp *frame, const struct truth_spot *spot)
{
	memset(lamp, 0, sizeof *lamp);
	strcpy(lamp->name, "spot");
	lamp->kind = spot->half_angle > 0 ? SCENE_LAMP_SPOT : SCENE_LAMP_DIRECTIONAL;
	lamp->cone_rad = 2 * spot->half_angle;
	lamp->on = true;
	memcpy(lamp->position, spot->position, sizeof lamp->position);
	memcpy(lamp->direction, spot->direction, sizeof lamp->direction);
	memcpy(lamp->intensity, spot->intensity, sizeof lamp->intensity);
	frame->on = true;
	memcpy(frame->position, lamp->position, sizeof frame->position);
	memcpy(frame->direction, lamp->direction, sizeof frame->direction);
	memcpy(frame->intensity, lamp->intensity, sizeof frame->intensity);
}

int surfel_rig_init(struct surfel_rig *rig, const struct scene *scene, const struct truth_spot *spot,
		    int lamps, int shadow_pixels)
{
	int result;

	memset(rig, 0, sizeof *rig);
	rig->scene = scene;
	rig->file.lamps = rig->lamps;
	rig->file.lamp_count = (size_t)lamps;
	rig->file.shadow_pixels = shadow_pixels;
	rig->frame.gi_on = true;
	rig->fresh = true;
	for (int i = 0; i < lamps; i++)
		spot_of(&rig->lamps[i], &rig->frame.lamps[i], spot);
	result = gl_mesh_create(&rig->mesh, scene);
	if (result == GR_OK && lamps > 0)
		result = shadow_create(&rig->shadow, &rig->file, scene, rig->mesh, NULL);
	glCreateBuffers(1, &rig->block);
	glNamedBufferStorage(rig->block, sizeof(struct frame_block), NULL, GL_DYNAMIC_STORAGE_BIT);
	return result;
}

void surfel_rig_finish(struct surfel_rig *rig)
{
	shadow_destroy(&rig->shadow);
	gl_mesh_destroy(&rig->mesh);
	glDeleteBuffers(1, &rig->block);
}

struct gi_light surfel_rig_light(struct surfel_rig *rig)
{
	float sigma = rig->frame.absorption_per_m + rig->frame.scattering_per_m;
	struct frame_block block = { .medium = { log2f(1 - sigma), log2f(1 - rig->frame.absorption_per_m) } };
	int change = rig->shadow ? shadow_take(rig->shadow, &rig->frame) : SHADOW_SAME;

	memcpy(block.bounds_min, rig->scene->min, sizeof rig->scene->min);
	memcpy(block.bounds_max, rig->scene->max, sizeof rig->scene->max);
	glNamedBufferSubData(rig->block, 0, sizeof block, &block);
	glBindBufferBase(GL_UNIFORM_BUFFER, VIEW_BINDING_FRAME, rig->block);
	if (change != SHADOW_SAME || rig->fresh)
		rig->version++;
	rig->fresh = false;
	if (change != SHADOW_SAME)
		shadow_draw(rig->shadow, false);
	if (rig->shadow)
		shadow_bind(rig->shadow);
	return (struct gi_light){ .lamps = rig->shadow != NULL, .version = rig->version };
}

int surfel_rig_frame(struct surfel_rig *rig, struct gi_method *method)
{
	const struct gi_light light = surfel_rig_light(rig);

	rig->frame.frame++;
	return method->ops->update(method, &rig->frame, &light);
}
