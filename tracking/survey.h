/*
 * The text file of a calibration: one point a line, '#' begins a comment.
 *
 *     NAME  x y z                        a point of the room, to be measured
 *     NAME  x y z  px py pz qx qy qz qw  the same, and what was measured there
 *     NAME         px py pz qx qy qz qw  a measurement of a pivot, at no known point
 *
 * x y z: the point in the room, metres. p, q: of the sensor by the device, in
 * its metres and its base's axes (tracking/report.h); q of unit length.
 */
#ifndef GROTTO_TRACKING_SURVEY_H
#define GROTTO_TRACKING_SURVEY_H

#include "base/diag.h"
#include "tracking/rotation.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#define SURVEY_NAME_MAX 32 /* with the final NUL; no blanks, no '#' */
#define SURVEY_POINTS_MAX 60000
#define SURVEY_BYTES_MAX (16l << 20)

struct survey_point {
	char name[SURVEY_NAME_MAX];
	bool known;    /* room is set */
	bool measured; /* p and q are */
	double room[3];
	double p[3];
	struct rotation q;
};

/*
 * The whole file, in its order; the names of known points are different ones.
 * *out is the caller's to free. GR_OK; GR_ERR_FORMAT (twenty faults with their lines
 * in diag), GR_ERR_IO, GR_ERR_NOMEM: *out is NULL then.
 */
int survey_load(const char *path, struct survey_point **out, size_t *out_count, struct gr_diag *diag);
/* The same from memory; no NUL is needed behind it. */
int survey_parse(const char *text, size_t len, const char *name, struct survey_point **out,
		 size_t *out_count, struct gr_diag *diag);
/* One line, to a nanometre. The caller looks at ferror(). */
void survey_write(FILE *file, const struct survey_point *point);

#endif
