/* Irradiance of `grotto reference` at points: of a CSV, or of the scene's surfels. */
#include "tools/reference.h"

#include "base/result.h"
#include "renderer/gi/surfel_bake.h"
#include "renderer/gi/surfel_store.h"
#include "renderer/trace/rays.h"
#include "tools/plan.h"
#include "tools/say.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* More would be a mistake: 224 bytes each. */
#define POINTS_MOST ((size_t)1 << 22)
#define LINE_MOST 512

struct points {
	struct reference_point *at;
	size_t count, size;
};

static struct reference_point *grow(struct points *points)
{
	if (points->count == points->size) {
		size_t size = points->size ? 2 * points->size : 1024;
		struct reference_point *at = realloc(points->at, size * sizeof *at);

		if (!at)
			return NULL;
		points->at = at;
		points->size = size;
	}
	memset(&points->at[points->count], 0, sizeof *points->at);
	return &points->at[points->count++];
}

/* Six numbers, and nothing after them but further columns. false: not a point. */
static bool parse_point(const char *line, struct reference_point *out)
{
	float length = 0;
	char after = ',';
	int n = sscanf(line, " %f , %f , %f , %f , %f , %f %c", &out->position[0],
		       &out->position[1], &out->position[2], &out->normal[0], &out->normal[1],
		       &out->normal[2], &after);

	if (n < 6 || after != ',')
		return false;
	for (int i = 0; i < 3; i++) {
		/* NaN is not less either */
		if (!(fabsf(out->position[i]) <= RAYS_MOST) || !isfinite(out->normal[i]))
			return false;
		length += out->normal[i] * out->normal[i];
	}
	length = sqrtf(length);
	if (!isfinite(length) || !(length > 1e-6f))
		return false;
	for (int i = 0; i < 3; i++)
		out->normal[i] /= length;
	return true;
}

/* "x,y,z,..." and not a number, NaN and infinity included. */
static bool names_columns(const char *line)
{
	char *end;

	strtod(line, &end);
	return end == line && isalpha((unsigned char)line[0]);
}

static int read_lines(FILE *file, const char *path, struct points *points)
{
	char line[LINE_MOST];

	for (int number = 1; fgets(line, sizeof line, file); number++) {
		struct reference_point point = { 0 }, *place;
		bool whole = strchr(line, '\n') || feof(file);

		/* the first line may name the columns; NUL bytes do not make an empty one */
		if (whole && (line[0] == '#' || line[strspn(line, " \t\r\n")] == '\0'))
			continue;
		if (!whole || !parse_point(line, &point)) {
			if (whole && number == 1 && names_columns(line))
				continue;
			fprintf(stderr, "%s:%d: not a point: x,y,z,nx,ny,nz are wanted, finite, within "
					"%.0e m, the normal not zero\n",
				path, number, (double)RAYS_MOST);
			return GR_ERR_CONFIG;
		}
		if (points->count >= POINTS_MOST) {
			fprintf(stderr, "%s: more than %zu points\n", path, POINTS_MOST);
			return GR_ERR_CONFIG;
		}
		place = grow(points);
		if (!place)
			return GR_ERR_NOMEM;
		*place = point;
	}
	if (points->count == 0) {
		fprintf(stderr, "%s: has no points\n", path);
		return GR_ERR_CONFIG;
	}
	return ferror(file) ? GR_ERR_IO : GR_OK;
}

static int read_points(const char *path, struct points *points)
{
	FILE *file = fopen(path, "r");
	int result;

	if (!file) {
		fprintf(stderr, "%s: cannot be opened: %s\n", path, strerror(errno));
		return GR_ERR_CONFIG;
	}
	result = read_lines(file, path, points);
	fclose(file);
	return result;
}

static bool show_bake(void *ctx, const char *stage, double done, double seconds_left)
{
	struct reference_run *run = ctx;

	progress_show(&run->progress, done, seconds_left, stage);
	run->stopped = run->stopped || progress_asked_to_end();
	return !run->stopped;
}

/* Those that are baked already. GR_NOTHING: none, or of another scene. */
static int read_surfels(struct reference_run *run, const struct scene_file *file, struct surfel_set **out)
{
	struct surfel_bake_params params;
	struct surfel_store_done done;
	struct surfel_store store;
	struct gr_diag diag = { 0 };
	int result = surfel_store_init(&store, file);

	surfel_bake_params_of(file, &params);
	if (result == GR_OK)
		result = surfel_store_read(&store, out, run->scene, &params, &diag, &done);
	say_diag(&diag);
	gr_diag_finish(&diag);
	if (result == GR_OK)
		printf("%s: %zu surfels\n", done.path, (*out)->count);
	surfel_store_finish(&store);
	return result;
}

/* The places alone: what surfels are baked for beside is as little as may be. */
static int bake_surfels(struct reference_run *run, const struct scene_file *file, struct surfel_set **out)
{
	struct surfel_bake_params params;
	struct gr_diag diag = { 0 };
	int result;

	surfel_bake_params_of(file, &params);
	params.links = 16;
	params.taps = 1;
	params.probes = 0;
	params.threads = run->options->threads;
	params.progress = show_bake;
	params.ctx = run;
	progress_start(&run->progress, "surfels");
	result = surfel_bake(out, run->scene, file, &params, &diag);
	progress_end(&run->progress);
	say_diag(&diag);
	gr_diag_finish(&diag);
	return result;
}

static int place_surfels(struct reference_run *run, struct points *points)
{
	struct scene_file file = *run->file; /* all but gi is borrowed */
	struct surfel_set *set = NULL;
	int result;

	if (file.gi.method == SCENE_GI_AUTO)
		plan_as_node(&file.gi, run->file, run->scene, -1);
	result = read_surfels(run, &file, &set);
	if (result == GR_NOTHING)
		result = bake_surfels(run, &file, &set);
	for (size_t i = 0; result == GR_OK && i < set->count; i++) {
		struct reference_point *point = grow(points);

		if (!point) {
			result = GR_ERR_NOMEM;
			break;
		}
		memcpy(point->position, set->surfels[i].position, sizeof point->position);
		surfel_normal_unpack(set->surfels[i].normal, point->normal);
	}
	surfel_set_destroy(&set);
	return result;
}

static int write_points(const char *path, const struct points *points)
{
	FILE *file = fopen(path, "w");
	bool good = file != NULL;

	if (file) {
		fprintf(file, "x,y,z,nx,ny,nz,total_r,total_g,total_b,indirect_r,indirect_g,indirect_b,"
			      "total_stderr_r,total_stderr_g,total_stderr_b,"
			      "indirect_stderr_r,indirect_stderr_g,indirect_stderr_b\n");
		for (size_t i = 0; i < points->count; i++) {
			const struct reference_point *p = &points->at[i];
			const double *columns[] = { p->total, p->indirect, p->total_error,
						    p->indirect_error };

			fprintf(file, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", (double)p->position[0],
				(double)p->position[1], (double)p->position[2],
				(double)p->normal[0], (double)p->normal[1], (double)p->normal[2]);
			for (int k = 0; k < 4; k++)
				fprintf(file, ",%.7g,%.7g,%.7g", columns[k][0], columns[k][1],
					columns[k][2]);
			fputc('\n', file);
		}
		good = !ferror(file);
		good = fclose(file) == 0 && good;
	}
	if (!good)
		fprintf(stderr, "%s: cannot be written: %s\n", path, strerror(errno));
	return good ? GR_OK : GR_ERR_IO;
}

int reference_points(struct reference_run *run)
{
	const struct reference_options *o = run->options;
	struct points points = { 0 };
	uint64_t nonfinite = 0;
	int result = o->points ? read_points(o->points, &points) : place_surfels(run, &points);

	if (result == GR_OK) {
		progress_start(&run->progress, "points");
		result = reference_irradiance(run->reference, &run->params, points.at,
					      points.count, &nonfinite);
		progress_end(&run->progress);
	}
	if (result == GR_NOTHING && (points.count == 0 || isnan(points.at[0].total[0])))
		fprintf(stderr, "grotto reference: ended before every point had its first samples; "
				"nothing is written\n");
	else if (result == GR_NOTHING)
		fprintf(stderr, "grotto reference: ended early; %s has what there is\n", o->points_out);
	if (result == GR_OK || (result == GR_NOTHING && points.count > 0 && !isnan(points.at[0].total[0])))
		result = write_points(o->points_out, &points);
	if (result == GR_OK)
		printf("%s: %zu points\n", o->points_out, points.count);
	if (nonfinite)
		fprintf(stderr, "warning: %llu samples were not finite and are left out\n",
			(unsigned long long)nonfinite);
	free(points.at);
	return result;
}
