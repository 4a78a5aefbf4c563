#include "config/layout.h"

#include "base/result.h"
#include "config/config_text.h"
#include "config/layout_check.h"
#include "config/layout_options.h"

#include <math.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

/* Moves an owned string out of the file's form. */
static char *take(char **from)
{
	char *text = *from;

	*from = NULL;
	return text;
}

static void build_walls(struct layout *layout, struct layout_file *file)
{
	for (size_t w = 0; w < file->wall_count; w++) {
		struct layout_file_wall *from = &file->walls[w];
		struct layout_wall *wall = &layout->walls[w];

		memcpy(wall->name, from->name, sizeof wall->name);
		glm_vec3_copy(from->lower_left, wall->lower_left);
		glm_vec3_copy(from->lower_right, wall->lower_right);
		glm_vec3_copy(from->upper_left, wall->upper_left);
		memcpy(wall->pixels, from->pixels, sizeof wall->pixels);
		wall->line = (int)config_setting_source_line(from->at);
		for (size_t n = 0; n < from->node_count; n++) {
			struct layout_node *node = &layout->nodes[layout->node_count++];

			*node = from->nodes[n].node;
			node->address = take(&from->nodes[n].node.address);
			node->display = take(&from->nodes[n].node.display);
			node->projector = from->nodes[n].projector.projector;
			node->projector.table = take(&from->nodes[n].projector.projector.table);
			node->wall = w;
			node->line = (int)config_setting_source_line(from->nodes[n].at);
		}
	}
	layout->wall_count = file->wall_count;
}

static int key_line(const config_setting_t *group, const char *key)
{
	const config_setting_t *at = config_setting_get_member(group, key);

	return at ? (int)config_setting_source_line(at) : 0;
}

static void build_rest(struct layout *layout, struct layout_file *file)
{
	struct layout_network *network = &file->network.network;

	memcpy(layout->name, file->name, sizeof layout->name);
	layout->network = *network;
	layout->network.interface = take(&network->interface);
	layout->network.master_address = take(&network->master_address);
	layout->network.group = take(&network->group);
	layout->network.key_file = take(&network->key_file);
	if (layout->network.key_file && file->network.at)
		layout->network.key_file_line = key_line(file->network.at, "key_file");
	for (size_t i = 0; i < file->standby_count; i++) {
		layout->standby[i] = file->standby[i].standby;
		layout->standby[i].address = take(&file->standby[i].standby.address);
		layout->standby[i].line = (int)config_setting_source_line(file->standby[i].at);
	}
	layout->standby_count = file->standby_count;
	layout->rates = file->rates.rates;
	layout->swap = file->swap.swap;
	layout->slow = file->slow.slow;
	layout->test = file->test.test;
	layout->hand = file->hand.hand;
	for (size_t i = 0; i < file->tracker_count; i++)
		layout_tracker_build(&layout->trackers[i], &file->trackers[i]);
	layout->tracker_count = file->tracker_count;
	glm_vec3_copy(file->start.head_angles, layout->start_head_angles);
	glm_vec3_copy(file->start.wand_angles, layout->start_wand_angles);
	layout_pose_from_angles(file->start.head, file->start.head_angles, &layout->start_head);
	layout_pose_from_angles(file->start.wand, file->start.wand_angles, &layout->start_wand);
	layout->eye_separation_m = file->eye_separation_m;
	glm_vec3_copy(file->room.min, layout->room_min);
	glm_vec3_copy(file->room.max, layout->room_max);
	layout->room_given = file->room.at != NULL;
	layout->control_socket = take(&file->control_socket);
}

/* From a file's form without faults; its strings move over. */
static struct layout *build(struct layout_file *file, const char *path)
{
	struct layout *layout = calloc(1, sizeof *layout);
	size_t nodes = 0;

	if (!layout)
		return NULL;
	for (size_t w = 0; w < file->wall_count; w++)
		nodes += file->walls[w].node_count;
	layout->path = strdup(path);
	layout->walls = calloc(file->wall_count, sizeof *layout->walls);
	layout->nodes = calloc(nodes + 1, sizeof *layout->nodes);
	layout->trackers = calloc(file->tracker_count + 1, sizeof *layout->trackers);
	layout->standby = calloc(file->standby_count + 1, sizeof *layout->standby);
	if (!layout->path || !layout->walls || !layout->nodes || !layout->trackers || !layout->standby) {
		layout_destroy(&layout);
		return NULL;
	}
	build_walls(layout, file);
	build_rest(layout, file);
	layout_items(layout, NULL, 0, layout->hash);
	return layout;
}

int layout_parse(const char *text, size_t len, const char *path, struct layout **out,
		 struct gr_diag *diag)
{
	struct options_reader reader = { .file = path, .diag = diag };
	struct layout_file file = { 0 };
	config_t config;
	int result;

	*out = NULL;
	if (sodium_init() < 0)
		return GR_ERR_UNSUPPORTED;
	result = config_text_parse(text, len, path, &config, diag);
	if (result < 0)
		return result;
	reader.root = config_root_setting(&config);
	options_read(&reader, layout_options, reader.root, &file);
	if (!reader.nomem)
		layout_check(&reader, &file);
	if (reader.nomem)
		result = GR_ERR_NOMEM;
	else if (reader.faults)
		result = GR_ERR_CONFIG;
	else if (!(*out = build(&file, path)))
		result = GR_ERR_NOMEM;
	options_free(layout_options, &file);
	config_destroy(&config);
	return result;
}

int layout_load(const char *path, struct layout **out, struct gr_diag *diag)
{
	char *text;
	size_t len;
	int result = config_text_load(path, &text, &len, diag);

	*out = NULL;
	if (result < 0)
		return result;
	result = layout_parse(text, len, path, out, diag);
	free(text);
	return result;
}

void layout_destroy(struct layout **layout)
{
	struct layout *l = *layout;

	if (!l)
		return;
	for (size_t i = 0; i < l->node_count; i++) {
		free(l->nodes[i].address);
		free(l->nodes[i].display);
		free(l->nodes[i].projector.table);
	}
	for (size_t i = 0; i < l->standby_count; i++)
		free(l->standby[i].address);
	free(l->standby);
	for (size_t i = 0; i < l->tracker_count; i++)
		layout_tracker_free(&l->trackers[i]);
	free(l->nodes);
	free(l->walls);
	free(l->trackers);
	free(l->network.interface);
	free(l->network.master_address);
	free(l->network.group);
	free(l->network.key_file);
	free(l->control_socket);
	free(l->path);
	free(l);
	*layout = NULL;
}

int layout_find_node(const struct layout *layout, const char *name)
{
	for (size_t i = 0; i < layout->node_count; i++)
		if (!strcmp(layout->nodes[i].name, name))
			return (int)i;
	return -1;
}

void layout_node_corners(const struct layout *layout, size_t node, vec3 lower_left,
			 vec3 lower_right, vec3 upper_left)
{
	const float *part = layout->nodes[node].part;
	const struct layout_wall *wall = &layout->walls[layout->nodes[node].wall];

	for (int i = 0; i < 3; i++) {
		double o = wall->lower_left[i];
		double x = wall->lower_right[i] - o, y = wall->upper_left[i] - o;

		lower_left[i] = (float)(o + part[0] * x + part[1] * y);
		lower_right[i] = (float)(o + part[2] * x + part[1] * y);
		upper_left[i] = (float)(o + part[0] * x + part[3] * y);
	}
}

void layout_node_pixels(const struct layout *layout, size_t node, int pixels[2])
{
	const float *part = layout->nodes[node].part;
	const struct layout_wall *wall = &layout->walls[layout->nodes[node].wall];

	/* Rounded edge by edge, so that the parts of a wall add up to the whole. */
	for (int i = 0; i < 2; i++)
		pixels[i] = (int)(lround((double)part[i + 2] * wall->pixels[i]) -
				  lround((double)part[i] * wall->pixels[i]));
}

char *layout_beside(const struct layout *layout, const char *name)
{
	return config_text_beside(layout->path, name);
}

char *layout_key_path(const struct layout *layout)
{
	if (!layout->network.key_file)
		return NULL;
	return layout_beside(layout, layout->network.key_file);
}
