#include "config/layout_check.h"

#include <math.h>
#include <string.h>

/* Parts that meet within this share of the wall do not overlap. */
#define PART_SLACK 1e-5f

enum { SEES_LEFT = 1, SEES_RIGHT = 2 };

/* A mono picture is for both eyes. */
static int eyes_seen(enum layout_eyes eyes)
{
	return eyes == LAYOUT_EYES_LEFT ? SEES_LEFT :
	       eyes == LAYOUT_EYES_RIGHT ? SEES_RIGHT : SEES_LEFT | SEES_RIGHT;
}

static void resolve_eyes(struct options_reader *reader, const struct layout_file_wall *wall,
			 struct layout_file_node *entry)
{
	bool per_node = wall->eyes == LAYOUT_FILE_EYE_PER_NODE;

	entry->node.eyes = per_node ? LAYOUT_EYES_MONO : (enum layout_eyes)wall->eyes;
	if (entry->eye != OPTION_ABSENT && entry->eyes != OPTION_ABSENT)
		options_fault(reader, GR_DIAG_ERROR, entry->at, "eye",
			      "given beside eyes; keep one of the two");
	else if (entry->eyes != OPTION_ABSENT)
		entry->node.eyes = (enum layout_eyes)entry->eyes;
	else if (entry->eye != OPTION_ABSENT && !per_node)
		options_fault(reader, GR_DIAG_ERROR, entry->at, "eye",
			      "only where the wall says eyes = \"eye-per-node\"; say so, or leave it out");
	else if (entry->eye != OPTION_ABSENT)
		entry->node.eyes = entry->eye ? LAYOUT_EYES_RIGHT : LAYOUT_EYES_LEFT;
	else if (per_node && !options_given(entry->at, "eye"))
		options_fault(reader, GR_DIAG_ERROR, entry->at, "eye",
			      "missing; the wall says eyes = \"eye-per-node\", so say \"left\" or \"right\"");
}

static void check_part(struct options_reader *reader, const struct layout_file_wall *wall,
		       const struct layout_file_node *entry)
{
	const float *part = entry->node.part;

	for (int i = 0; i < 2; i++) {
		double first = (double)part[i] * wall->pixels[i];
		double last = (double)part[i + 2] * wall->pixels[i];

		if (part[i] >= part[i + 2]) {
			options_fault(reader, GR_DIAG_ERROR, entry->at, "part",
				      "%c runs from %g to %g; the first must be the smaller one",
				      i ? 'y' : 'x', part[i], part[i + 2]);
		} else if (wall->pixels[i] && lround(last) - lround(first) < 1) {
			options_fault(reader, GR_DIAG_ERROR, entry->at, "part",
				      "not one pixel %s; the wall has %d", i ? "high" : "wide",
				      wall->pixels[i]);
		} else if (fabs(first - round(first)) > 0.01 || fabs(last - round(last)) > 0.01) {
			options_fault(reader, GR_DIAG_WARNING, entry->at, "part",
				      "an edge falls inside a pixel (%s %.2f to %.2f of %d); the picture is "
				      "stretched by less than one",
				      i ? "rows" : "columns", first, last, wall->pixels[i]);
		}
	}
}

static void check_projector(struct options_reader *reader, const struct layout_file_node *entry)
{
	static const char *const unused[] = { "black", "gain", "gamma" };
	const struct layout_projector *p = &entry->projector.projector;
	const config_setting_t *at = entry->projector.at;

	for (int i = 0; i < 3; i++) {
		if (p->table && options_given(at, unused[i]))
			options_fault(reader, GR_DIAG_WARNING, at, unused[i], "not used: the table says it");
		if (p->gain[i] <= p->black[i]) {
			options_fault(reader, GR_DIAG_ERROR, at, "gain",
				      "%g is no more than black, which is %g; it is the light at the brightest",
				      (double)p->gain[i], (double)p->black[i]);
			break;
		}
	}
	if (p->depth == LAYOUT_DEPTH_FLOAT && entry->node.target != LAYOUT_TARGET_HEADLESS)
		options_fault(reader, GR_DIAG_ERROR, at, "depth",
			      "\"float\" is for target = \"headless\"; a display takes \"8\" or \"10\"");
}

static bool parts_overlap(const float a[4], const float b[4])
{
	for (int i = 0; i < 2; i++)
		if (a[i] >= b[i + 2] - PART_SLACK || b[i] >= a[i + 2] - PART_SLACK)
			return false;
	return true;
}

static void check_overlap(struct options_reader *reader, const struct layout_file_wall *wall)
{
	for (size_t i = 0; i < wall->node_count; i++) {
		const struct layout_file_node *entry = &wall->nodes[i];

		for (size_t j = 0; entry->at && j < i; j++) {
			const struct layout_file_node *other = &wall->nodes[j];

			if (!other->at || !(eyes_seen(entry->node.eyes) & eyes_seen(other->node.eyes)) ||
			    !parts_overlap(entry->node.part, other->node.part))
				continue;
			options_fault(reader, GR_DIAG_ERROR, entry->at, "part",
				      "overlaps the part of node \"%s\"; each spot of a wall is drawn once "
				      "for each eye",
				      other->node.name);
		}
	}
}

/* What no node draws stays dark: works, is hardly meant. */
static void check_covered(struct options_reader *reader, const struct layout_file_wall *wall)
{
	double area[2] = { 0, 0 };

	for (size_t i = 0; i < wall->node_count; i++) {
		const float *part = wall->nodes[i].node.part;

		for (int eye = 0; wall->nodes[i].at && eye < 2; eye++)
			if (eyes_seen(wall->nodes[i].node.eyes) & (1 << eye))
				area[eye] += ((double)part[2] - part[0]) * ((double)part[3] - part[1]);
	}
	for (int eye = 0; eye < 2; eye++)
		if (area[eye] < 1 - 1e-4) {
			options_fault(reader, GR_DIAG_WARNING, wall->at, "nodes",
				      "%.1f %% of the wall is drawn for the %s eye; the rest stays dark",
				      area[eye] * 100, eye ? "right" : "left");
			return;
		}
}

static void check_wall_nodes(struct options_reader *reader, struct layout_file_wall *wall)
{
	for (size_t n = 0; n < wall->node_count; n++) {
		struct layout_file_node *entry = &wall->nodes[n];

		if (!entry->at)
			continue;
		if (!entry->node.name[0] && !options_given(entry->at, "name"))
			memcpy(entry->node.name, wall->name, sizeof entry->node.name);
		resolve_eyes(reader, wall, entry);
		check_part(reader, wall, entry);
		check_projector(reader, entry);
	}
	if (!wall->node_count && options_given(wall->at, "nodes"))
		options_fault(reader, GR_DIAG_ERROR, wall->at, "nodes",
			      "no node draws this wall; give one, or leave the wall out");
	check_overlap(reader, wall);
	if (wall->node_count)
		check_covered(reader, wall);
}

static void check_node_names(struct options_reader *reader, const struct layout_file *file)
{
	const struct layout_file_node *seen[LAYOUT_MAX_NODES];
	size_t count = 0;

	for (size_t w = 0; w < file->wall_count; w++)
		for (size_t n = 0; n < file->walls[w].node_count; n++) {
			const struct layout_file_node *entry = &file->walls[w].nodes[n];

			if (!entry->at || !entry->node.name[0])
				continue;
			for (size_t i = 0; i < count; i++)
				if (!strcmp(seen[i]->node.name, entry->node.name)) {
					options_fault(reader, GR_DIAG_ERROR, entry->at, "name",
						      "node \"%s\" is there twice (line %u); give each a "
						      "name of its own",
						      entry->node.name,
						      config_setting_source_line(seen[i]->at));
					break;
				}
			if (count == LAYOUT_MAX_NODES) {
				options_fault(reader, GR_DIAG_ERROR, entry->at, NULL,
					      "more than %d nodes in the room", LAYOUT_MAX_NODES);
				return;
			}
			seen[count++] = entry;
		}
}

void layout_check_nodes(struct options_reader *reader, struct layout_file *file)
{
	for (size_t w = 0; w < file->wall_count; w++)
		if (file->walls[w].at)
			check_wall_nodes(reader, &file->walls[w]);
	check_node_names(reader, file);
}
