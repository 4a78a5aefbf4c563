/* Inside of the reference: the scene as traced, and what identifies it. */
#ifndef GROTTO_RENDERER_TRACE_REFERENCE_PRIVATE_H
#define GROTTO_RENDERER_TRACE_REFERENCE_PRIVATE_H

#include "renderer/trace/path.h"
#include "renderer/trace/reference.h"

#define REFERENCE_MOST_BOUNCES 1024
/* Sets that must be there before until_error may stop. */
#define REFERENCE_LEAST_SETS 4

struct reference {
	struct path_scene scene; /* lamps and max_bounces are set anew for every call */
	struct scene_file file;  /* only its lamps are used, which are copied */
	struct scene_lamp lamps[SCENE_MAX_LAMPS];
	struct render_frame frame;
	uint8_t hash[32]; /* of all that light depends on but the parameters */
	uint64_t rays;    /* of the last call */
};

/* BLAKE2b-256 of geometry, materials, textures, environment, lamps and medium. */
void reference_hash(const struct reference *reference, uint8_t out[32]);
void reference_key(const struct reference *reference, const struct reference_view *view,
		   const struct reference_params *params, uint8_t out[32]);

#endif
