/*
 * grotto trackers calibrate: its parts. One sensor of one tracker of a layout,
 * and the body that a binding says it is on.
 */
#ifndef GROTTO_TOOLS_CALIBRATE_H
#define GROTTO_TOOLS_CALIBRATE_H

#include "config/layout.h"
#include "tracking/survey.h"

#include <stdint.h>

enum calibrate_what {
	CALIBRATE_BASE,  /* where the device's frame is in the room */
	CALIBRATE_ARM,   /* from sensor to body, at known points, with a base that is known */
	CALIBRATE_PIVOT, /* the same, the body turned about a point that need not be known */
};

/* What is calibrated, and how. */
struct calibrate {
	enum calibrate_what what;
	const struct layout *layout;
	const struct layout_tracker *tracker;
	const struct layout_binding *binding;
	size_t tracker_index, binding_index;
	bool scale;      /* of the base: fit it, too */
	double most_m;   /* the largest rms residual that is a calibration */
	double still_m;  /* a body that moves by less is held still */
	double seconds;  /* of samples at a point, or of a pivot */
};

/* The body that a binding is of. */
const char *calibrate_body(const struct calibrate *c);
/* Where the body is by a sensor's pose, in the base's axes, true metres: with the arm of the layout. */
void calibrate_body_at(const struct calibrate *c, const double p[3], const struct rotation *q, double out[3]);

/* ---- calibrate_read.c: what the sensor says ---- */

struct calibrate_report {
	bool lost, placed, turned; /* placed: has a position; turned: an orientation */
	double p[3];
	struct rotation q;
	uint32_t buttons;
};

struct calibrate_reader;
/*
 * socket: of a master that has the device open; NULL: the device is opened here.
 * GR_OK; an error with lines in diag.
 */
int calibrate_reader_open(struct calibrate_reader **out, const struct calibrate *c, const char *socket,
			  struct gr_diag *diag);
void calibrate_reader_close(struct calibrate_reader **reader);
/*
 * What has come since, oldest first, at most `room`; returns how many. Of a master
 * the newest alone. Never waits longer than a master needs to answer. An error:
 * the master is gone, with a line on stderr.
 */
int calibrate_read(struct calibrate_reader *reader, struct calibrate_report *out, int room);
/* What the device does, when it says nothing: "absent: no Razer Hydra ...". */
void calibrate_reader_state(struct calibrate_reader *reader, char *text, size_t size);
/* How long to sleep between two reads. */
int64_t calibrate_reader_pause_ns(const struct calibrate_reader *reader);

/* ---- calibrate_ask.c: a person at the points ---- */

/*
 * Measures, one after the other, the points that are not yet: asks for each on
 * stderr, and waits for Enter or one of the device's buttons. Points that are
 * skipped stay as they are. GR_OK; GR_NOTHING: the person gave up; GR_ERR_IO:
 * nobody answers, or the master is gone.
 */
int calibrate_ask_points(const struct calibrate *c, struct calibrate_reader *reader,
			 struct survey_point *points, size_t count);
/* The samples of a pivot; *out is the caller's to free. As above, GR_ERR_NOMEM. */
int calibrate_ask_pivot(const struct calibrate *c, struct calibrate_reader *reader,
			struct survey_point **out, size_t *out_count);

/* ---- calibrate_solve.c: what comes of them ---- */

struct layout_edit;
#define CALIBRATE_NOTE 400
/*
 * Fits, prints on stdout what came of each point, and says what is to be written.
 * note: what edit->note points to. GR_OK, or the fit's error, which is said on
 * stderr.
 */
int calibrate_solve(const struct calibrate *c, const struct survey_point *points, size_t count,
		    struct layout_edit *edit, char note[CALIBRATE_NOTE]);

/* The command; argv[0] is "calibrate". Returns the exit status. */
int trackers_calibrate(int argc, char **argv);

#endif
