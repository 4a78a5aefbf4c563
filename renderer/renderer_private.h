/* What renderer.c (frames) and create.c and read.c (beginning and results) share. */
#ifndef GROTTO_RENDERER_RENDERER_PRIVATE_H
#define GROTTO_RENDERER_RENDERER_PRIVATE_H

#include "base/log.h"
#include "renderer/gi/choose.h"
#include "renderer/gi/gi.h"
#include "renderer/gl/program.h"
#include "renderer/plan_light.h"
#include "renderer/renderer.h"
#include "renderer/tone/gaze.h"
#include "renderer/tone/tone.h"
#include "renderer/view/backdrop.h"
#include "renderer/view/emissive.h"
#include "renderer/view/eyes.h"
#include "renderer/view/gbuffer.h"
#include "renderer/view/hud.h"
#include "renderer/view/shade.h"
#include "renderer/view/shadow.h"

#include <epoxy/gl.h>

enum renderer_stage { STAGE_SHADOW, STAGE_GI, STAGE_GBUFFER, STAGE_SHADE, STAGE_TONE, STAGE_HUD, STAGE_GAZE };

/* One eye's picture and what it was drawn from. */
struct renderer_eye {
	struct gbuffer gbuffer;
	struct shade_picture picture;
	mat4 view_projection;
	vec3 position; /* scene */
	vec3 position_room;
	bool drawn;    /* at least once */
};

struct renderer {
	struct target *target;
	const struct scene_file *file; /* as given, or `planned` */
	const struct scene *scene;
	struct renderer_params params;
	bool is_planned;             /* gi.method = "auto" */
	struct light_plan light;     /* of it; else the facts alone */
	size_t surfels;              /* 0: none */
	struct scene_file planned;   /* the file with the plan's gi; all else borrowed */
	int file_steps, file_gathers; /* a frame, that the file says */
	struct gl_mesh *mesh;
	struct rsm *rsm;                 /* NULL: no global illumination, or no light for it */
	struct shadow_stage *shadow;     /* NULL: no lamps */
	struct emissive_stage *emissive; /* NULL: nothing emits */
	struct gi_method *gi;            /* NULL: none */
	struct gi_choice choice;
	struct backdrop backdrop;
	struct tone_stage *tone;
	struct hud_stage *hud; /* NULL: no wall, no hand before it */
	struct gaze_stage *gaze; /* NULL: the eye stays as the scene file says */
	struct timers *timers;
	unsigned gbuffer_program, shade_program;
	unsigned irradiance_program; /* 0: nobody has asked yet */
	unsigned frame_buffer; /* struct frame_block */
	int eye_count;
	struct renderer_eye eyes[EYES_MAX];
	GLsync fence; /* of the last frame; NULL: none, or seen to be finished */

	/* What the pictures show. */
	bool fresh; /* nothing drawn yet */
	float absorption, scattering;
	bool gi_on;
	uint64_t light_version; /* grows when lamps or medium changed */
	struct tone_values tone_values;
	struct gaze_view gaze_view; /* that was measured last */
	bool gazed;		    /* and the picture is still that */

	struct renderer_stats stats;
	struct gr_log_limit nonfinite_limit, error_limit;
};

#endif
