/* grotto check FILE...: layouts and scenes, with everything that can be said about them. */
#include "base/result.h"
#include "config/layout.h"
#include "config/scene_file.h"
#include "daemon/tracker_devices.h"
#include "protocol/key.h"
#include "renderer/scene/brdf_table.h"
#include "renderer/scene/environment.h"
#include "renderer/scene/scene.h"
#include "tools/command.h"
#include "tools/cli.h"
#include "tools/say.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum file_kind { FILE_LAYOUT, FILE_SCENE, FILE_UNKNOWN };

/* Does a line of the file set `key` at its start? */
static bool text_sets(const char *text, const char *key)
{
	size_t n = strlen(key);

	for (const char *line = text; line; line = strchr(line, '\n')) {
		line += strspn(line, "\n\r\t ");
		if (strncmp(line, key, n) == 0) {
			const char *next = line + n + strspn(line + n, " \t\r\n");

			if (*next == ':' || *next == '=')
				return true;
		}
	}
	return false;
}

/* By its name, and where that does not say, by what it sets. */
static enum file_kind file_kind(const char *path)
{
	const char *dot = strrchr(path, '.');
	char head[16384];
	size_t n;
	FILE *file;

	if (dot && strcmp(dot, ".cave") == 0)
		return FILE_LAYOUT;
	if (dot && strcmp(dot, ".scene") == 0)
		return FILE_SCENE;
	file = fopen(path, "re");
	if (!file)
		return FILE_UNKNOWN;
	n = fread(head, 1, sizeof head - 1, file);
	fclose(file);
	head[n] = '\0';
	if (text_sets(head, "walls"))
		return FILE_LAYOUT;
	if (text_sets(head, "model"))
		return FILE_SCENE;
	return FILE_UNKNOWN;
}

static void check_key(const struct layout *layout, struct gr_diag *diag)
{
	char *path = layout_key_path(layout);
	uint8_t key[FDP_KEY_BYTES];

	if (layout->network.key_file && !path)
		gr_diag_add(diag, GR_DIAG_ERROR, layout->path, 0, "network.key_file",
			    "out of memory");
	/* A layout may be checked where its key does not belong; the daemons insist on it. */
	if (path && access(path, F_OK) != 0 && errno == ENOENT)
		gr_diag_add(diag, GR_DIAG_WARNING, layout->path, layout->network.key_file_line,
			    "network.key_file",
			    "%s is not on this machine, and no daemon starts without it; make one "
			    "with grotto key, or copy the cluster's", path);
	else if (path)
		fdp_key_load(path, key, diag);
	explicit_bzero(key, sizeof key);
	free(path);
}

static void check_layout(const char *path, struct gr_diag *diag)
{
	struct layout *layout = NULL;

	if (layout_load(path, &layout, diag) != GR_OK)
		return;
	check_key(layout, diag);
	tracker_devices_check(layout, diag);
	layout_report_geometry(layout, diag);
	gr_diag_add(diag, GR_DIAG_NOTE, path, 0, NULL, "layout \"%s\": %zu wall%s, %zu node%s",
		    layout->name, layout->wall_count, layout->wall_count == 1 ? "" : "s",
		    layout->node_count, layout->node_count == 1 ? "" : "s");
	layout_destroy(&layout);
}

/* Tables and environment: what is in them, so that a wrong file is seen. */
static void report_surfaces(const char *path, const struct scene *scene, struct gr_diag *diag)
{
	char text[256];

	for (size_t i = 0; i < scene->material_count; i++) {
		const struct scene_material *m = &scene->materials[i];
		const struct brdf_table_facts *f;

		if (m->kind != MATERIAL_MEASURED)
			continue;
		f = brdf_table_facts(scene->tables[m->table]);
		gr_diag_add(diag, GR_DIAG_NOTE, path, 0, m->name,
			    "measured: %zu samples of %zu wavelengths, reflectance %.3f %.3f %.3f, "
			    "along the normal %.3f %.3f %.3f; %zu values below 0, %zu colours cut at 0, "
			    "the samples met within %.0f %% (rms)", f->samples, f->wavelengths,
			    (double)f->reflectance[0], (double)f->reflectance[1],
			    (double)f->reflectance[2], (double)f->normal[0], (double)f->normal[1],
			    (double)f->normal[2], f->below_zero, f->cut, 100 * (double)f->misfit);
	}
	if (scene->environment) {
		environment_describe(scene->environment, text, sizeof text);
		gr_diag_add(diag, GR_DIAG_NOTE, path, 0, "environment", "%s", text);
	}
}

static void report_scene(const char *path, const struct scene_file *file,
			 const struct scene *scene, struct gr_diag *diag)
{
	size_t dropped = scene->dropped_nonfinite + scene->dropped_degenerate +
			 scene->dropped_index;

	gr_diag_add(diag, GR_DIAG_NOTE, path, 0, NULL,
		    "scene \"%s\": %zu triangle%s, %zu material%s, %zu image%s, %zu lamp%s, "
		    "%zu camera%s%s", file->name, scene->index_count / 3,
		    scene->index_count == 3 ? "" : "s", scene->material_count,
		    scene->material_count == 1 ? "" : "s", scene->image_count,
		    scene->image_count == 1 ? "" : "s", file->lamp_count, file->lamp_count == 1 ? "" : "s",
		    file->camera_count, file->camera_count == 1 ? "" : "s",
		    scene->emissive ? ", emissive surfaces" : ", nothing emits");
	gr_diag_add(diag, GR_DIAG_NOTE, path, 0, NULL,
		    "bounds %.3f %.3f %.3f to %.3f %.3f %.3f m", (double)scene->min[0],
		    (double)scene->min[1], (double)scene->min[2], (double)scene->max[0],
		    (double)scene->max[1], (double)scene->max[2]);
	report_surfaces(path, scene, diag);
	if (dropped > 0)
		gr_diag_add(diag, GR_DIAG_WARNING, path, 0, "model",
			    "%zu triangles dropped: %zu not finite, %zu without area, "
			    "%zu with an index out of range", dropped, scene->dropped_nonfinite,
			    scene->dropped_degenerate, scene->dropped_index);
}

static void check_scene(const char *path, struct gr_diag *diag)
{
	struct scene_file *file = NULL;
	struct scene *scene = NULL;

	if (scene_file_load(path, &file, diag) != GR_OK)
		return;
	if (scene_import(file, &scene, diag) == GR_OK)
		report_scene(path, file, scene, diag);
	scene_destroy(&scene);
	scene_file_destroy(&file);
}

/* True when the file is right. */
static bool check_file(const char *path)
{
	struct gr_diag diag = { 0 };
	struct stat status;
	bool right;

	/* Asked before it is opened: a FIFO would wait for a writer. */
	if (stat(path, &status) < 0) {
		gr_diag_add(&diag, GR_DIAG_ERROR, path, 0, NULL, "%s", strerror(errno));
	} else if (!S_ISREG(status.st_mode)) {
		gr_diag_add(&diag, GR_DIAG_ERROR, path, 0, NULL, "is not a regular file");
	} else {
		switch (file_kind(path)) {
		case FILE_LAYOUT: check_layout(path, &diag); break;
		case FILE_SCENE: check_scene(path, &diag); break;
		case FILE_UNKNOWN:
			gr_diag_add(&diag, GR_DIAG_ERROR, path, 0, NULL,
				    "neither a layout (it would set walls) nor a scene (it would "
				    "set model); name it .cave or .scene");
			break;
		}
	}
	right = diag.errors == 0;
	say_diag(&diag);
	printf("%s: %s\n", path, right ? "ok" : "refused");
	gr_diag_finish(&diag);
	return right;
}

int command_check(int argc, char **argv)
{
	static const struct cli_table table = {
		"grotto check FILE...",
		"Loads cave layouts (.cave) and scenes (.scene) with every check that the daemons\n"
		"make, and says what is wrong, where, and what would be right. For a layout it also\n"
		"reads the key file (one that is not there is a warning) and reports the gaps and\n"
		"overlaps of neighbouring walls in millimetres; for a scene it imports the model\n"
		"and counts what is in it.\n"
		"Exit status 2 when a file is refused.",
		NULL, 0
	};
	int words;
	int refused = 0;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	if (words == 0) {
		fprintf(stderr, "grotto check: needs a FILE\n");
		return GR_EXIT_CONFIG;
	}
	for (int i = 1; i <= words; i++)
		refused += !check_file(argv[i]);
	return refused ? GR_EXIT_CONFIG : GR_EXIT_OK;
}
