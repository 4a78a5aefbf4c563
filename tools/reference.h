/* Inside of `grotto reference`: what was asked for, and the scene that is traced. */
#ifndef GROTTO_TOOLS_REFERENCE_H
#define GROTTO_TOOLS_REFERENCE_H

#include "config/scene_file.h"
#include "renderer/scene/scene.h"
#include "renderer/trace/reference.h"
#include "tools/progress.h"

struct reference_options {
	const char *camera, *layout, *wall, *head, *eye;
	const char *resume, *out, *png;
	const char *points, *points_out;
	bool surfels, soft_lamps;
	int size[2]; /* 0: the camera's or the wall's */
	int samples, seed, threads, bounces, keep_every_s;
	float until_percent; /* 0: all samples */
};

struct reference_run {
	const struct reference_options *options;
	struct scene_file *file;
	struct scene *scene;
	struct render_frame frame;
	struct reference *reference;
	struct reference_params params;
	struct progress progress;
	bool stopped; /* somebody asked for the end */
	int64_t keep_ns;  /* when the sums are to be written next */
};

/* The view that the options choose. GR_ERR_CONFIG, told on stderr. */
int reference_choose_view(struct reference_run *run, struct reference_view *out);
/* Traces the picture and writes its files. */
int reference_picture(struct reference_run *run);
/* Irradiance at points of a file, or at surfels, to a CSV. */
int reference_points(struct reference_run *run);

#endif
