/*
 * What a wall's projector makes of a code, measured, and what it must be sent
 * so that all walls of a room show the same: `projector` of a node in the layout.
 *
 * Light is linear, per band, 1 the white that the room has in common. A
 * projector shows black + (gain - black) x^gamma of code x, or what its table
 * says, linear between rows. Light below its black gets code 0, above its
 * brightest code 1.
 *
 * A table is text: a line a row of code, red, green, blue, separated by commas
 * or blanks, `#` comments; 2 to PROJECTOR_ROWS_MAX rows, codes rising from 0 to
 * 1, light that never falls and rises somewhere.
 *
 * Pure but for projector_load; any thread.
 */
#ifndef GROTTO_RENDERER_TONE_PROJECTOR_H
#define GROTTO_RENDERER_TONE_PROJECTOR_H

#include "base/diag.h"
#include "config/layout.h"
#include "config/scene_file.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PROJECTOR_ROWS_MAX 1024
#define PROJECTOR_TABLE_BYTES_MAX ((size_t)1 << 18)
/* Entries of the map from what the scene's display would take to what this one takes. */
#define PROJECTOR_MAP 4096

struct projector {
	double black[3], gain[3], gamma[3];
	size_t rows; /* 0: no table */
	double code[PROJECTOR_ROWS_MAX], light[PROJECTOR_ROWS_MAX][3];
};

/* GR_ERR_CONFIG names in diag the line that is not such a table. */
int projector_parse(const uint8_t *text, size_t len, const char *name, struct projector *out,
		    struct gr_diag *diag);
/*
 * As the layout says; a gamma that it does not give is the scene's display's.
 * Reads the table beside the layout file. GR_NOTHING: nothing differs from the
 * scene's display, no map is needed. GR_ERR_CONFIG, GR_ERR_NOMEM.
 */
int projector_load(const struct layout *layout, const struct layout_projector *said,
		   const struct scene_tone *tone, struct projector *out, struct gr_diag *diag);

/* Light that it shows; x 0..1. */
double projector_light(const struct projector *projector, int band, double x);
/* The code that shows that light, 0..1. */
double projector_code(const struct projector *projector, int band, double light);
/* For the shader: entry i of what the scene encodes as i / (PROJECTOR_MAP - 1). */
void projector_map(const struct projector *projector, const struct scene_tone *tone,
		   float out[PROJECTOR_MAP][3]);

#endif
