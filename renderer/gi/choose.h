/*
 * Which global illumination a scene gets. Pure, any thread.
 */
#ifndef GROTTO_RENDERER_GI_CHOOSE_H
#define GROTTO_RENDERER_GI_CHOOSE_H

#include "renderer/scene/scene.h"

struct gi_choice {
	enum scene_gi_method method; /* not SCENE_GI_AUTO */
	const char *why;	     /* for the log */
};

/*
 * The file's method, or SCENE_GI_NONE where nothing lights the scene that the
 * method knows. The file is one that a plan was made for (plan.h): its method
 * is not SCENE_GI_AUTO any more. near: there are lamps or
 * emissive surfaces.
 */
struct gi_choice gi_choose(const struct scene_file *file, const struct scene *scene, bool near);

#endif
