/* Which picture `grotto reference` traces: a camera's, or what an eye sees on a wall. */
#include "tools/reference.h"

#include "base/result.h"
#include "config/layout.h"
#include "renderer/view/eyes.h"
#include "tools/say.h"

#include <stdio.h>
#include <string.h>

static int choose_camera(struct reference_run *run, struct reference_view *out)
{
	const char *name = run->options->camera;
	const struct scene_file *file = run->file;
	struct scene_camera camera;
	int index = name ? scene_file_find_camera(file, name) : 0;

	if (file->camera_count == 0) {
		fprintf(stderr, "%s: has no camera: add one to its cameras, or give --layout and --wall\n",
			file->path);
		return GR_ERR_CONFIG;
	}
	if (index < 0) {
		fprintf(stderr, "%s: has no camera '%s'; it has", file->path, name);
		for (size_t i = 0; i < file->camera_count; i++)
			fprintf(stderr, " '%s'", file->cameras[i].name);
		fprintf(stderr, "\n");
		return GR_ERR_CONFIG;
	}
	camera = file->cameras[index];
	if (run->options->size[0] > 0)
		memcpy(camera.pixels, run->options->size, sizeof camera.pixels);
	return reference_view_camera(&camera, out);
}

static const struct layout_wall *find_wall(const struct layout *layout, const char *name)
{
	for (size_t i = 0; i < layout->wall_count; i++)
		if (strcmp(layout->walls[i].name, name) == 0)
			return &layout->walls[i];
	fprintf(stderr, "%s: has no wall '%s'; it has", layout->path, name);
	for (size_t i = 0; i < layout->wall_count; i++)
		fprintf(stderr, " '%s'", layout->walls[i].name);
	fprintf(stderr, "\n");
	return NULL;
}

static bool parse_head(const char *text, vec3 out)
{
	char end;

	return sscanf(text, "%f,%f,%f%c", &out[0], &out[1], &out[2], &end) == 3;
}

static int view_of_wall(struct reference_run *run, const struct layout *layout,
			const struct layout_wall *wall, struct reference_view *out)
{
	const struct reference_options *o = run->options;
	const int *pixels = o->size[0] > 0 ? o->size : wall->pixels;
	struct projection_wall corners;
	struct render_frame frame = run->frame;
	vec3 eye;
	int result;

	glm_vec3_copy((float *)wall->lower_left, corners.lower_left);
	glm_vec3_copy((float *)wall->lower_right, corners.lower_right);
	glm_vec3_copy((float *)wall->upper_left, corners.upper_left);
	frame.T_room_head = layout->start_head;
	frame.eye_separation_m = layout->eye_separation_m;
	if (o->head && !parse_head(o->head, frame.T_room_head.p)) {
		fprintf(stderr, "grotto reference: --head '%s' is not X,Y,Z in metres\n", o->head);
		return GR_ERR_CONFIG;
	}
	eyes_position(!o->eye			       ? RENDERER_MONO
		      : strcmp(o->eye, "left") == 0 ? RENDERER_LEFT
						       : RENDERER_RIGHT,
		      0, &frame, eye);
	result = reference_view_wall(&corners, &frame.T_scene_room, eye, pixels[0], pixels[1], out);
	if (result == GR_ERR_RANGE) {
		fprintf(stderr, "grotto reference: the eye at %g,%g,%g is not in front of wall '%s'\n",
			(double)eye[0], (double)eye[1], (double)eye[2], wall->name);
		result = GR_ERR_CONFIG;
	}
	return result;
}

int reference_choose_view(struct reference_run *run, struct reference_view *out)
{
	const struct reference_options *o = run->options;
	const struct layout_wall *wall = NULL;
	struct layout *layout = NULL;
	struct gr_diag diag = { 0 };
	int result;

	if (!o->layout)
		return choose_camera(run, out);
	result = layout_load(o->layout, &layout, &diag);
	say_diag(&diag);
	gr_diag_finish(&diag);
	if (result == GR_OK)
		wall = find_wall(layout, o->wall);
	if (wall)
		result = view_of_wall(run, layout, wall, out);
	else if (result != GR_ERR_NOMEM)
		result = GR_ERR_CONFIG;
	layout_destroy(&layout);
	return result;
}
