/* grotto bake SCENE: computes a scene's surfels before the room starts. */
#include "base/plain.h"
#include "base/result.h"
#include "renderer/gi/surfel_store.h"
#include "renderer/scene/scene.h"
#include "tools/cli.h"
#include "tools/command.h"
#include "tools/load.h"
#include "tools/plan.h"
#include "tools/progress.h"
#include "tools/say.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

struct bake_options {
	const char *out;
	int threads;
	int gpu;
	bool force;
};

struct bake_run {
	const struct bake_options *options;
	struct scene_file *file;
	struct scene *scene;
	struct surfel_store store;
	struct surfel_set *set;
	struct surfel_store_done done;
	struct progress progress;
	bool planned; /* file->gi is what a node chooses */
};

static void run_finish(struct bake_run *run)
{
	surfel_set_destroy(&run->set);
	surfel_store_finish(&run->store);
	scene_destroy(&run->scene);
	scene_file_destroy(&run->file);
}

static bool show(void *ctx, const char *stage, double done, double seconds_left)
{
	struct bake_run *run = ctx;

	progress_show(&run->progress, done, seconds_left, stage);
	return !progress_asked_to_end();
}

/* A file that is there and none of baked surfels, such as the scene itself. */
static bool is_something_else(const char *path)
{
	static const char magic[8] = { 'G', 'R', 'S', 'U', 'R', 'F', 'E', 'L' };
	char bytes[sizeof magic];
	struct stat status;
	FILE *file;
	size_t n;

	if (stat(path, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0)
		return false;
	file = fopen(path, "rb");
	if (!file)
		return false;
	n = fread(bytes, 1, sizeof bytes, file);
	fclose(file);
	return n != sizeof magic || memcmp(bytes, magic, sizeof magic) != 0;
}

/* gi.method = "auto": as a node of this machine, so that it finds what it needs. */
static int plan(struct bake_run *run)
{
	int result = plan_as_node(&run->file->gi, run->file, run->scene, run->options->gpu);

	run->planned = result == GR_OK;
	return result == GR_NOTHING ? GR_OK : result;
}

/* Of what a plan chose, surfels and probes alone are baked. */
static bool needs_none(const struct bake_run *run)
{
	enum scene_gi_method method = run->file->gi.method;

	return run->planned && method != SCENE_GI_SURFELS && method != SCENE_GI_PROBES;
}

static int get(struct bake_run *run)
{
	struct surfel_bake_params params;
	struct gr_diag diag = { 0 };
	int result = run->options->out ? surfel_store_at(&run->store, run->options->out)
				       : surfel_store_init(&run->store, run->file);

	if (result != GR_OK)
		return result;
	run->store.force = run->options->force;
	surfel_bake_params_of(run->file, &params);
	params.threads = run->options->threads;
	params.progress = show;
	params.ctx = run;
	progress_hold_signals();
	progress_start(&run->progress, "baking");
	result = surfel_store_get(&run->store, &run->set, run->scene, run->file, &params, &diag,
				  &run->done);
	progress_end(&run->progress);
	say_diag(&diag);
	gr_diag_finish(&diag);
	return result == GR_ERR_RANGE ? GR_ERR_CONFIG : result;
}

static void report(const struct bake_run *run)
{
	const struct surfel_set *set = run->set;
	size_t alive = 0;

	for (size_t i = 0; i < set->probes.count; i++)
		alive += set->probes.alive[i];
	printf("%zu triangles: %zu surfels %s m apart, %u links and %u taps each\n",
	       run->scene->index_count / 3, set->count, gr_plain((double)set->spacing_m, 3).text, set->links_each,
	       set->taps_each);
	if (set->probes.count > 0)
		printf("%zu probes, %zu of them alive, %s m apart\n", set->probes.count, alive,
		       gr_plain((double)set->probes.cell_m, 3).text);
	printf("%s%.2f s on %d thread%s, %s rays", run->done.baked ? "" : "baked before in ",
	       set->seconds, set->threads, set->threads == 1 ? "" : "s",
	       gr_plain((double)set->rays, 3).text);
	if (set->ray_seconds > 0)
		printf(", links at %.2f million rays/s",
		       (double)set->count * set->links_each / set->ray_seconds * 1e-6);
	printf("\n");
	if (run->done.path)
		printf("%s: %s, %.1f MB\n", run->done.path, run->done.baked ? "written" : "is up to date",
		       (double)surfel_set_bytes(set) * 1e-6);
}

int command_bake(int argc, char **argv)
{
	struct bake_options o = { .gpu = -1 };
	const struct cli_option options[] = {
		{ "force", 'f', CLI_FLAG, &o.force, 0, 0, NULL, "even if there is a file that fits" },
		{ "gpu", 0, CLI_INT, &o.gpu, -1, 64, "N",
		  "that chooses where gi.method is \"auto\": EGL device, -1: the first that works (-1)" },
		{ "threads", 'j', CLI_INT, &o.threads, 0, 256, "N", "0: one a core (0)" },
		{ "out", 'o', CLI_TEXT, &o.out, 0, 0, "FILE",
		  "this file, instead of SCENE.surfels beside the scene" },
	};
	const struct cli_table table = {
		"grotto bake SCENE [--force] [--threads N] [--gpu N] [--out FILE]",
		"Computes what relit surfels need of a scene, so that the room need not wait for it at\n"
		"its start. The file is kept beside the scene, or else in the cache; nodes look there,\n"
		"and bake by themselves what they do not find. Equal for any number of threads. With\n"
		"gi.method = \"auto\" spacing and links are those that a node on this GPU chooses.",
		options, sizeof options / sizeof options[0]
	};
	struct bake_run run = { .options = &o };
	int words, result;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	if (words != 1) {
		fprintf(stderr, "grotto bake: needs one SCENE\n");
		return GR_EXIT_CONFIG;
	}
	if (o.out && is_something_else(o.out)) {
		fprintf(stderr, "grotto bake: %s is not a file of baked surfels, and is not replaced by one\n",
			o.out);
		return GR_EXIT_CONFIG;
	}
	result = load_scene(argv[1], &run.file, &run.scene);
	if (result == GR_OK && run.file->gi.method == SCENE_GI_AUTO)
		result = plan(&run);
	if (result == GR_OK && needs_none(&run)) {
		printf("nothing to bake\n");
		run_finish(&run);
		return GR_EXIT_OK;
	}
	if (result == GR_OK)
		result = get(&run);
	if (result == GR_OK)
		report(&run);
	else
		fprintf(stderr, "grotto bake: %s: %s\n", argv[1],
			result == GR_NOTHING ? "stopped; nothing is written" : gr_result_name(result));
	/* what was baked and cannot be kept has not done its work */
	if (result == GR_OK && !run.done.path)
		result = GR_ERR_IO;
	run_finish(&run);
	if (result == GR_OK)
		return GR_EXIT_OK;
	return result == GR_ERR_CONFIG ? GR_EXIT_CONFIG : GR_EXIT_RUNTIME;
}
