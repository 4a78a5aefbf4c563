#include "base/result.h"
#include "config/layout_options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * Turns a layout back into the form of its file. Strings are borrowed: the
 * form is never given to options_free.
 */
static void fill_wall(const struct layout *layout, size_t index, struct layout_file_wall *to,
		      struct layout_file_node *nodes)
{
	const struct layout_wall *from = &layout->walls[index];

	memcpy(to->name, from->name, sizeof to->name);
	glm_vec3_copy((float *)from->lower_left, to->lower_left);
	glm_vec3_copy((float *)from->lower_right, to->lower_right);
	glm_vec3_copy((float *)from->upper_left, to->upper_left);
	memcpy(to->pixels, from->pixels, sizeof to->pixels);
	to->center[0] = to->size[0] = to->heading = to->pitch = to->roll = NAN;
	to->eyes = LAYOUT_EYES_MONO;
	to->nodes = nodes;
	for (size_t i = 0; i < layout->node_count; i++) {
		const struct layout_node *node = &layout->nodes[i];
		struct layout_file_node *entry = &nodes[to->node_count];
		bool one_eye = node->eyes == LAYOUT_EYES_LEFT || node->eyes == LAYOUT_EYES_RIGHT;

		if (node->wall != index)
			continue;
		entry->node = *node;
		entry->projector.projector = node->projector;
		if (node->projector.table) /* the reader would warn about what it does not use */
			entry->projector.projector.black[0] = entry->projector.projector.gain[0] =
				entry->projector.projector.gamma[0] = NAN;
		entry->eye = one_eye ? node->eyes == LAYOUT_EYES_RIGHT : OPTION_ABSENT;
		entry->eyes = one_eye ? OPTION_ABSENT : (int)node->eyes;
		if (one_eye)
			to->eyes = LAYOUT_FILE_EYE_PER_NODE;
		to->node_count++;
	}
}

int layout_write(FILE *file, const struct layout *layout)
{
	struct layout_file form = { 0 };
	struct layout_file_wall *walls = calloc(layout->wall_count + 1, sizeof *walls);
	struct layout_file_node *nodes = calloc(layout->node_count + 1, sizeof *nodes);
	struct layout_file_tracker *trackers = calloc(layout->tracker_count + 1, sizeof *trackers);
	struct layout_file_binding *bindings =
		calloc(layout->tracker_count * LAYOUT_MAX_BINDINGS + 1, sizeof *bindings);
	struct layout_file_standby *standby = calloc(layout->standby_count + 1, sizeof *standby);
	int result = GR_ERR_NOMEM;

	if (!walls || !nodes || !trackers || !bindings || !standby)
		goto out;
	memcpy(form.name, layout->name, sizeof form.name);
	form.eye_separation_m = layout->eye_separation_m;
	form.control_socket = layout->control_socket;
	form.walls = walls;
	form.wall_count = layout->wall_count;
	for (size_t i = 0, used = 0; i < layout->wall_count; used += walls[i++].node_count)
		fill_wall(layout, i, &walls[i], nodes + used);
	form.network.network = layout->network;
	form.standby = standby;
	form.standby_count = layout->standby_count;
	for (size_t i = 0; i < layout->standby_count; i++)
		standby[i].standby = layout->standby[i];
	form.rates.rates = layout->rates;
	form.swap.swap = layout->swap;
	form.slow.slow = layout->slow;
	form.test.test = layout->test;
	form.hand.hand = layout->hand;
	glm_vec3_copy((float *)layout->start_head.p, form.start.head);
	glm_vec3_copy((float *)layout->start_wand.p, form.start.wand);
	glm_vec3_copy((float *)layout->start_head_angles, form.start.head_angles);
	glm_vec3_copy((float *)layout->start_wand_angles, form.start.wand_angles);
	glm_vec3_copy((float *)layout->room_min, form.room.min);
	glm_vec3_copy((float *)layout->room_max, form.room.max);
	if (!layout->room_given)
		form.room.min[0] = NAN;
	form.trackers = trackers;
	form.tracker_count = layout->tracker_count;
	for (size_t i = 0; i < layout->tracker_count; i++)
		layout_tracker_fill(&trackers[i], &layout->trackers[i], bindings + i * LAYOUT_MAX_BINDINGS);
	options_write(file, layout_options, &form);
	result = fflush(file) || ferror(file) ? GR_ERR_IO : GR_OK;
out:
	free(walls);
	free(nodes);
	free(trackers);
	free(bindings);
	free(standby);
	return result;
}
