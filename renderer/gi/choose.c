#include "renderer/gi/choose.h"

struct gi_choice gi_choose(const struct scene_file *file, const struct scene *scene, bool near)
{
	switch (file->gi.method) {
	case SCENE_GI_NONE:
		return (struct gi_choice){ SCENE_GI_NONE, "the scene file asks for none" };
	case SCENE_GI_LPV:
		if (!near)
			return (struct gi_choice){ SCENE_GI_NONE, "there is no lamp and nothing emits" };
		return (struct gi_choice){ SCENE_GI_LPV, "the scene file asks for it" };
	case SCENE_GI_SURFELS:
	case SCENE_GI_PROBES:
		if (!near && !scene->environment)
			return (struct gi_choice){ SCENE_GI_NONE, "nothing lights the scene" };
		return (struct gi_choice){ file->gi.method, "the scene file asks for it" };
	case SCENE_GI_AUTO:
		break; /* a plan has put a method in its place */
	}
	return (struct gi_choice){ SCENE_GI_NONE, "no method was chosen" };
}
