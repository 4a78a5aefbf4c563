/* From measurements to what is written into the layout, and a table of it for a person. */
#include "tools/calibrate.h"

#include "base/result.h"
#include "config/layout_edit.h"
#include "tracking/align.h"
#include "tracking/lever.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define DEG (180 / M_PI)

const char *calibrate_body(const struct calibrate *c)
{
	return c->binding->body == LAYOUT_HEAD ? "head" : "wand";
}

/* The arm of the layout, turned as the sensor is. */
static void arm_of(const struct calibrate *c, const struct rotation *q, double out[3])
{
	const struct dmat3 R = dmat3_from_rotation(q);

	for (int i = 0; i < 3; i++)
		out[i] = (double)c->binding->sensor_body.position[i];
	dmat3_apply(&R, out, out);
}

void calibrate_body_at(const struct calibrate *c, const double p[3], const struct rotation *q, double out[3])
{
	arm_of(c, q, out);
	for (int i = 0; i < 3; i++)
		out[i] += (double)c->tracker->scale * p[i];
}

static int refuse(int result, const char *why)
{
	fprintf(stderr, "grotto trackers: %s\n", why);
	return result;
}

/* "calibrated" is before it in the file. */
static size_t begin_note(char note[CALIBRATE_NOTE])
{
	const time_t now = time(NULL);
	struct tm utc;

	return gmtime_r(&now, &utc) ?
		       strftime(note, CALIBRATE_NOTE, "%Y-%m-%d %H:%M UTC by grotto trackers: ", &utc) :
		       0;
}

/* The points that were measured. */
static size_t measured(const struct survey_point *points, size_t count,
		       const struct survey_point *out[ALIGN_POINTS])
{
	size_t n = 0;

	for (size_t i = 0; i < count && n < ALIGN_POINTS; i++)
		if (points[i].measured && points[i].known)
			out[n++] = &points[i];
	return n;
}

static void print_point(const struct survey_point *point, double off_m, bool wrong)
{
	printf("%-*s %8.3f %8.3f %8.3f %9.1f%s", SURVEY_NAME_MAX - 1, point->name, point->room[0],
	       point->room[1], point->room[2], off_m * 1e3, wrong ? "  wrong, left out" : "");
}

static void print_head(void)
{
	printf("%-*s %8s %8s %8s %9s\n", SURVEY_NAME_MAX - 1, "point", "x", "y", "z m", "off mm");
}

/* "; without NAME NAME" */
static void note_wrong(char note[CALIBRATE_NOTE], const struct survey_point *const *points,
		       const bool *wrong, size_t count)
{
	bool any = false;

	for (size_t i = 0; i < count; i++) {
		const size_t len = strlen(note);

		if (!wrong[i])
			continue;
		snprintf(note + len, CALIBRATE_NOTE - len, "%s %s", any ? "" : "; without", points[i]->name);
		any = true;
	}
}

/* ---- base ---- */

static void print_base(const struct survey_point *const *points, const struct align_point *set, size_t count,
		       const struct calibrate *c, const struct align_fit *fit, const double deg[3])
{
	print_head();
	for (size_t i = 0; i < count; i++) {
		const int meant = fit->wrong[i] ? align_meant(set, count, fit, i) : -1;

		print_point(points[i], fit->residual_m[i], fit->wrong[i]);
		if (meant >= 0)
			printf(": it was measured at %s", points[meant]->name);
		printf("\n");
	}
	printf("base: position [%.5f, %.5f, %.5f], heading %.4f, pitch %.4f, roll %.4f deg", fit->t[0],
	       fit->t[1], fit->t[2], deg[0], deg[1], deg[2]);
	if (c->scale)
		printf(", scale %.6f +- %.6f", fit->scale, fit->scale_error);
	printf("\n%zu of %zu points agree to %.1f mm rms, %.1f at most\n", fit->used, count,
	       fit->rms_m * 1e3, fit->most_m * 1e3);
	printf("so the turn is known to %.2f degrees, the place to %.1f mm in the middle of the points (one "
	       "standard deviation)\n",
	       fit->turn_rad * DEG, fit->place_m * 1e3);
	if (count < 4)
		printf("with 3 points a wrong one is hardly seen: take more\n");
}

static int solve_base(const struct calibrate *c, const struct survey_point *const *points, size_t count,
		      struct layout_edit *edit, char note[CALIBRATE_NOTE])
{
	const struct align_params params = { .scale = c->scale, .most_m = c->most_m };
	struct align_point set[ALIGN_POINTS];
	struct align_fit fit;
	char why[ALIGN_WHY];
	double angles[3];
	size_t len;
	int r;

	for (size_t i = 0; i < count; i++) {
		memcpy(set[i].room, points[i]->room, sizeof set[i].room);
		/* Where the scale is given it goes in here, and none is fitted. */
		for (int k = 0; k < 3; k++)
			set[i].base[k] = (c->scale ? 1 : (double)c->tracker->scale) * points[i]->p[k];
		arm_of(c, &points[i]->q, set[i].arm);
	}
	r = align_fit(set, count, &params, &fit, why, sizeof why);
	if (r < 0)
		return refuse(r, why);
	dmat3_angles(&fit.R, angles);
	memcpy(edit->position, fit.t, sizeof edit->position);
	for (int i = 0; i < 3; i++)
		edit->angles_deg[i] = angles[i] * DEG;
	edit->scale = c->scale ? fit.scale : 0;
	print_base(points, set, count, c, &fit, edit->angles_deg);
	len = begin_note(note);
	snprintf(note + len, CALIBRATE_NOTE - len, "%s at %zu points, %.1f mm rms, %.1f at most",
		 calibrate_body(c), fit.used, fit.rms_m * 1e3, fit.most_m * 1e3);
	note_wrong(note, points, fit.wrong, count);
	return GR_OK;
}

/* ---- arm ---- */

static void take_arm(const struct calibrate *c, const struct lever_fit *fit, const char *how,
		     struct layout_edit *edit, char note[CALIBRATE_NOTE])
{
	const size_t len = begin_note(note);

	memcpy(edit->position, fit->arm, sizeof edit->position);
	printf("arm from sensor to %s: offset [%.5f, %.5f, %.5f]\n",
	       c->binding->body == LAYOUT_HEAD ? "the middle between the eyes" : "the wand's tip", fit->arm[0],
	       fit->arm[1], fit->arm[2]);
	printf("%zu %s agree to %.1f mm rms, %.1f at most; so the arm is known to %.2f mm (one standard "
	       "deviation)\n",
	       fit->used, how, fit->rms_m * 1e3, fit->most_m * 1e3, fit->error_m * 1e3);
	snprintf(note + len, CALIBRATE_NOTE - len, "offset by %zu %s, %.1f mm rms, %.1f at most", fit->used,
		 how, fit->rms_m * 1e3, fit->most_m * 1e3);
}

static struct lever_sample sample_of(const struct calibrate *c, const struct survey_point *point)
{
	struct lever_sample sample = { .q = point->q };

	for (int i = 0; i < 3; i++)
		sample.p[i] = (double)c->tracker->scale * point->p[i];
	return sample;
}

static int solve_arm(const struct calibrate *c, const struct survey_point *const *points, size_t count,
		     struct layout_edit *edit, char note[CALIBRATE_NOTE])
{
	const struct gr_pose *T = &c->tracker->room_base.pose;
	const struct rotation turn = rotation_from(T->q);
	const struct dmat3 R = dmat3_from_rotation(&turn);
	struct lever_sample samples[LEVER_POINTS];
	double body[LEVER_POINTS][3];
	struct lever_fit fit;
	char why[ALIGN_WHY];
	int r;

	for (size_t i = 0; i < count; i++) {
		samples[i] = sample_of(c, points[i]);
		for (int k = 0; k < 3; k++)
			body[i][k] = points[i]->room[k] - (double)T->p[k];
		dmat3_apply_transposed(&R, body[i], body[i]);
	}
	r = lever_points(samples, (const double(*)[3])body, count, c->most_m, &fit, why, sizeof why);
	if (r < 0)
		return refuse(r, why);
	print_head();
	for (size_t i = 0; i < count; i++) {
		print_point(points[i], fit.residual_m[i], fit.wrong[i]);
		printf("\n");
	}
	if (count < 3)
		printf("with %zu point%s a wrong one is not seen: take more, looking another way at each\n", count,
		       count == 1 ? "" : "s");
	take_arm(c, &fit, "points", edit, note);
	note_wrong(note, points, fit.wrong, count);
	return GR_OK;
}

static int solve_pivot(const struct calibrate *c, const struct survey_point *points, size_t count,
		       struct layout_edit *edit, char note[CALIBRATE_NOTE])
{
	struct lever_sample *samples = calloc(count + 1, sizeof *samples);
	struct lever_fit fit;
	char why[ALIGN_WHY];
	size_t n = 0;
	int r;

	if (!samples)
		return refuse(GR_ERR_NOMEM, "out of memory");
	for (size_t i = 0; i < count; i++)
		if (points[i].measured)
			samples[n++] = sample_of(c, &points[i]);
	r = lever_pivot(samples, n, &fit, why, sizeof why);
	free(samples);
	if (r < 0)
		return refuse(r, r == GR_ERR_NOMEM ? "out of memory" : why);
	printf("turned by %.0f, %.0f and %.0f degrees (rms) about its axes\n", fit.turned_rad[0] * DEG,
	       fit.turned_rad[1] * DEG, fit.turned_rad[2] * DEG);
	take_arm(c, &fit, "samples", edit, note);
	return GR_OK;
}

int calibrate_solve(const struct calibrate *c, const struct survey_point *points, size_t count,
		    struct layout_edit *edit, char note[CALIBRATE_NOTE])
{
	const struct survey_point *known[ALIGN_POINTS];
	const size_t n = measured(points, count, known);

	*edit = (struct layout_edit){
		.tracker = c->tracker_index,
		.what = c->what == CALIBRATE_BASE ? LAYOUT_EDIT_BASE : LAYOUT_EDIT_OFFSET,
		.binding = c->binding_index,
		.note = note,
	};
	switch (c->what) {
	case CALIBRATE_BASE: return solve_base(c, known, n, edit, note);
	case CALIBRATE_ARM: return solve_arm(c, known, n, edit, note);
	case CALIBRATE_PIVOT: break;
	}
	return solve_pivot(c, points, count, edit, note);
}
