#include "tools/demo.h"

#include "base/diag.h"
#include "base/result.h"
#include "renderer/image/image.h"
#include "tools/room.h"
#include "tools/say.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Longer sides of room.png are scaled down to this. */
#define ROOM_SIDE_MAX 8192

/*
 * The frame of a node's picture by its file name, NODE-FRAME.SUFFIX; 0 when
 * it is another file. A node's name may have dashes and digits itself.
 */
static uint64_t picture_frame(const char *file, const char *node, const char *suffix)
{
	size_t n = strlen(node);
	char *end;
	uint64_t frame;

	if (strncmp(file, node, n) != 0 || file[n] != '-' || file[n + 1] < '0' ||
	    file[n + 1] > '9')
		return 0;
	errno = 0;
	frame = strtoull(file + n + 1, &end, 10);
	return errno == 0 && strcmp(end, suffix) == 0 ? frame : 0;
}

void demo_clear_pictures(const struct demo *demo)
{
	DIR *folder = opendir(demo->options.out);
	const struct dirent *entry;

	if (!folder)
		return;
	while ((entry = readdir(folder)))
		for (size_t i = 0; i < demo->layout->node_count; i++) {
			const char *node = demo->layout->nodes[i].name;

			if (picture_frame(entry->d_name, node, ".png") > 0 ||
			    picture_frame(entry->d_name, node, ".exr") > 0 ||
			    picture_frame(entry->d_name, node, "-right.exr") > 0) {
				unlinkat(dirfd(folder), entry->d_name, 0);
				break;
			}
		}
	closedir(folder);
}

/* Path of the node's picture with the highest frame, or NULL. Caller frees. */
static char *last_picture(const struct demo *demo, const char *node)
{
	DIR *folder = opendir(demo->options.out);
	const struct dirent *entry;
	uint64_t last = 0;
	char *path = NULL;

	if (!folder)
		return NULL;
	while ((entry = readdir(folder))) {
		uint64_t frame = picture_frame(entry->d_name, node, ".png");

		if (frame <= last)
			continue;
		last = frame;
		free(path);
		path = demo_path(demo, entry->d_name, "");
	}
	closedir(folder);
	return path;
}

static enum room_eye eye_of(enum layout_eyes eyes)
{
	if (eyes == LAYOUT_EYES_SIDE_BY_SIDE)
		return ROOM_LEFT_HALF;
	return eyes == LAYOUT_EYES_TOP_BOTTOM ? ROOM_TOP_HALF : ROOM_WHOLE;
}

static int add_node(const struct demo *demo, const struct layout_node *node,
		    struct room_picture *wall)
{
	struct gr_diag diag = { 0 };
	struct room_picture picture = { 0 };
	char *path = last_picture(demo, node->name);
	int result = GR_ERR_IO;

	if (!path) {
		fprintf(stderr, "%s: left no picture in %s\n", node->name, demo->options.out);
		return result;
	}
	result = image_read_png(path, &picture.width, &picture.height, &picture.rgb, &diag);
	say_diag(&diag);
	gr_diag_finish(&diag);
	if (result == GR_OK)
		room_add_part(wall, node->part, &picture, eye_of(node->eyes));
	room_picture_finish(&picture);
	free(path);
	return result;
}

/* Nodes of the right eye first, so that what is left is the left eye wherever there is one. */
static int compose_wall(const struct demo *demo, size_t index, struct room_picture *wall)
{
	const struct layout_wall *from = &demo->layout->walls[index];
	int result = room_picture_create(wall, from->pixels[0], from->pixels[1]);

	for (int pass = 0; pass < 2; pass++)
		for (size_t i = 0; i < demo->layout->node_count && result == GR_OK; i++) {
			const struct layout_node *node = &demo->layout->nodes[i];
			bool right = node->eyes == LAYOUT_EYES_RIGHT;

			if (node->wall == index && right == (pass == 0))
				result = add_node(demo, node, wall);
		}
	return result;
}

static int save(const struct demo *demo, const char *name, const struct room_picture *picture)
{
	char *path = demo_path(demo, name, ".png");
	int result = GR_ERR_NOMEM;

	if (path)
		result = image_write_png(path, picture->width, picture->height, picture->rgb);
	if (result != GR_OK)
		fprintf(stderr, "%s/%s.png: %s\n", demo->options.out, name,
			gr_result_name(result));
	free(path);
	return result;
}

static int save_wall(const struct demo *demo, const struct layout_wall *wall,
		     const struct room_picture *picture)
{
	char name[LAYOUT_NAME_MAX + 8];

	snprintf(name, sizeof name, "wall-%s", wall->name);
	return save(demo, name, picture);
}

static int save_room(const struct demo *demo, const struct room_picture *pictures)
{
	const struct layout *layout = demo->layout;
	struct unfold_wall *walls = calloc(layout->wall_count, sizeof *walls);
	struct unfold_place *places = calloc(layout->wall_count, sizeof *places);
	struct room_picture room = { 0 };
	double size[2];
	int result = GR_ERR_NOMEM;

	if (!walls || !places)
		goto out;
	for (size_t i = 0; i < layout->wall_count; i++) {
		memcpy(walls[i].lower_left, layout->walls[i].lower_left, sizeof(vec3));
		memcpy(walls[i].lower_right, layout->walls[i].lower_right, sizeof(vec3));
		memcpy(walls[i].upper_left, layout->walls[i].upper_left, sizeof(vec3));
	}
	result = unfold_room(walls, layout->wall_count, places, size);
	if (result == GR_OK)
		result = room_compose(places, size, pictures, layout->wall_count, ROOM_SIDE_MAX,
				      &room);
	if (result == GR_OK)
		result = save(demo, "room", &room);
	else
		fprintf(stderr, "room.png: %s\n", gr_result_name(result));
out:
	room_picture_finish(&room);
	free(walls);
	free(places);
	return result;
}

static bool any_picture(const struct demo *demo)
{
	bool any = false;

	for (size_t i = 0; i < demo->layout->node_count && !any; i++) {
		char *path = last_picture(demo, demo->layout->nodes[i].name);

		any = path != NULL;
		free(path);
	}
	return any;
}

int demo_room(const struct demo *demo)
{
	size_t count = demo->layout->wall_count;
	struct room_picture *pictures;
	int result;

	if (!any_picture(demo)) {
		fprintf(stderr, "no wall left a picture in %s: no room.png\n", demo->options.out);
		return GR_ERR_IO;
	}
	pictures = calloc(count, sizeof *pictures);
	result = pictures ? GR_OK : GR_ERR_NOMEM;
	/* A wall without a picture leaves its place grey: the others are still worth a look. */
	for (size_t i = 0; i < count && pictures; i++) {
		int wall_result = compose_wall(demo, i, &pictures[i]);

		if (wall_result == GR_OK)
			wall_result = save_wall(demo, &demo->layout->walls[i], &pictures[i]);
		else
			room_picture_finish(&pictures[i]);
		if (wall_result != GR_OK)
			result = wall_result;
	}
	if (pictures) {
		int room_result = save_room(demo, pictures);

		result = result == GR_OK ? room_result : result;
	}
	for (size_t i = 0; i < count && pictures; i++)
		room_picture_finish(&pictures[i]);
	free(pictures);
	return result;
}
