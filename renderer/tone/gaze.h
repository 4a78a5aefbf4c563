/*
 * What the eye looks at, of one wall: the light in the cone about the gaze that
 * the eye gets used to (seed 003 section 5.2: 10 degrees, spread over as many walls
 * as it meets), and the brightest of the whole wall.
 *
 * A wall's radiance is averaged in up to GAZE_CELLS x GAZE_CELLS cells, so that every
 * pixel counts; a cell counts with the solid angle that it takes of the eye's view,
 * so that walls of unlike pixels, or seen askew, can be added up. Cells whose
 * middle is in the cone are in it. Pixels that are not finite are left out.
 *
 * Nothing waits for the GPU: what is said is of a frame some frames ago.
 *
 * GL thread only.
 */
#ifndef GROTTO_RENDERER_TONE_GAZE_H
#define GROTTO_RENDERER_TONE_GAZE_H

#include "renderer/tone/adapt.h"
#include "renderer/view/projection.h"

#include <stdint.h>

#define GAZE_CELLS 128
#define GAZE_CONE_RAD 0.174532925f /* the whole cone, 10 degrees */

/* Room frame. */
struct gaze_view {
	struct projection_wall wall;
	float eye[3];
	float direction[3]; /* unit */
};

struct gaze_stage;
int gaze_create(struct gaze_stage **out);
void gaze_destroy(struct gaze_stage **stage);
/*
 * Measures a picture of radiance, W/(m^2 sr) per band, row 0 at the bottom, for the
 * frame of that number. GR_NOTHING: too many frames are in flight, this one is left out;
 * GR_ERR_RANGE: the eye is in the wall's plane or behind it, or a number is not finite.
 */
int gaze_measure(struct gaze_stage *stage, const struct gaze_view *view, unsigned radiance,
		 int width, int height, uint64_t frame);
/* The newest that the GPU has finished, and its frame. GR_NOTHING: none yet. Never waits. */
int gaze_newest(struct gaze_stage *stage, struct adapt_sample *out, uint64_t *out_frame);

#endif
