/* grotto reference SCENE: what the renderer should show, by path tracing. */
#include "tools/reference.h"

#include "base/result.h"
#include "renderer/frame.h"
#include "tools/cli.h"
#include "tools/command.h"
#include "tools/load.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void run_finish(struct reference_run *run)
{
	reference_destroy(&run->reference);
	scene_destroy(&run->scene);
	scene_file_destroy(&run->file);
}

static bool show(void *ctx, double done, double seconds_left, double error)
{
	struct reference_run *run = ctx;
	char note[64];

	snprintf(note, sizeof note, "standard error %.2f %%", 100 * error);
	progress_show(&run->progress, done, seconds_left, error >= 0 ? note : NULL);
	run->stopped = run->stopped || progress_asked_to_end();
	return !run->stopped;
}

static int trace(struct reference_run *run, const char *path)
{
	const struct reference_options *o = run->options;
	int result = load_scene(path, &run->file, &run->scene);

	if (result != GR_OK)
		return result;
	render_frame_init(&run->frame, run->file);
	run->params = (struct reference_params){
		.seed = (uint64_t)o->seed,
		.samples = o->samples,
		.until_error = (double)o->until_percent / 100,
		.max_bounces = o->bounces,
		.threads = o->threads,
		.soft_lamps = o->soft_lamps,
		.progress = show,
		.ctx = run,
	};
	progress_hold_signals();
	result = reference_create(&run->reference, run->scene, run->file, &run->frame);
	if (result == GR_OK)
		printf("seed %d, up to %d samples, %d bounces\n", o->seed, o->samples, o->bounces);
	if (result == GR_OK && (o->points || o->surfels))
		result = reference_points(run);
	if (result == GR_OK && (o->out || o->png))
		result = reference_picture(run);
	return result;
}

/* Before hours of tracing, not after them. false: said on stderr. */
static bool can_write(const char *path)
{
	struct stat status;
	bool is_there = path && stat(path, &status) == 0;
	FILE *file;

	/* what is no plain file is opened once only: a pipe's reader would take it for the end */
	if (!path || (is_there && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)))
		return true;
	file = fopen(path, "a");
	if (!file) {
		fprintf(stderr, "grotto reference: %s: cannot be written: %s\n", path, strerror(errno));
		return false;
	}
	fclose(file);
	if (!is_there)
		remove(path);
	return true;
}

/* The sums are written beside and renamed, so it is the folder that counts. false: said on stderr. */
static bool can_keep(const char *path)
{
	char *copy, *slash;
	bool good;

	if (!path)
		return true;
	copy = strdup(path);
	if (!copy)
		return false;
	slash = strrchr(copy, '/');
	if (slash)
		slash[slash == copy] = '\0';
	good = access(slash ? copy : ".", W_OK | X_OK) == 0;
	if (!good)
		fprintf(stderr, "grotto reference: --resume %s: its folder cannot be written: %s\n", path,
			strerror(errno));
	free(copy);
	return good;
}

/* false: said on stderr. */
static bool sound(const struct reference_options *o, int words)
{
	const char *fault = NULL;

	if (words != 1)
		fault = "needs one SCENE";
	else if (!o->out && !o->png && !o->points_out)
		fault = "needs --out FILE.exr, --png FILE, or --points-out FILE.csv";
	else if ((o->points || o->surfels) != (o->points_out != NULL) || (o->points && o->surfels))
		fault = "--points-out FILE.csv goes with one of --points FILE.csv and --surfels";
	else if (!o->layout != !o->wall || (o->layout && o->camera))
		fault = "--layout FILE goes with --wall NAME, and without --camera";
	else if (!o->layout && (o->head || o->eye))
		fault = "--head and --eye go with --layout and --wall";
	else if (o->eye && strcmp(o->eye, "left") != 0 && strcmp(o->eye, "right") != 0)
		fault = "--eye is left or right";
	else if (o->resume && !o->out && !o->png)
		fault = "--resume goes with a picture: --out or --png";
	else if (cli_same_file(o->resume, o->out) || cli_same_file(o->resume, o->png) ||
		 cli_same_file(o->out, o->png))
		fault = "--resume, --out and --png are files of their own";
	if (fault)
		fprintf(stderr, "grotto reference: %s\n", fault);
	return !fault;
}

int command_reference(int argc, char **argv)
{
	struct reference_options o = { .samples = 256, .seed = 1, .bounces = 64,
				       .keep_every_s = 60 };
	const struct cli_option options[] = {
		{ "camera", 'c', CLI_TEXT, &o.camera, 0, 0, "NAME",
		  "a camera of the scene file (the first)" },
		{ "layout", 'l', CLI_TEXT, &o.layout, 0, 0, "FILE", "what a wall of this room shows" },
		{ "wall", 'w', CLI_TEXT, &o.wall, 0, 0, "NAME", "which wall" },
		{ "head", 0, CLI_TEXT, &o.head, 0, 0, "X,Y,Z",
		  "where the head is, metres in the room (the layout's start)" },
		{ "eye", 0, CLI_TEXT, &o.eye, 0, 0, "SIDE", "left or right (between the eyes)" },
		{ "size", 's', CLI_SIZE, o.size, 1, 16384, "WxH",
		  "pixels (the camera's or the wall's)" },
		{ "samples", 'n', CLI_INT, &o.samples, 1, 1 << 30, "N",
		  "a pixel or point, rounded up to sets of 16, 2 at least (256)" },
		{ "until-error", 'u', CLI_REAL, &o.until_percent, 0, 100, "PERCENT",
		  "stop when the standard error is below, rms over mean" },
		{ "seed", 0, CLI_INT, &o.seed, 0, INT32_MAX, "N", "of the samples (1)" },
		{ "threads", 'j', CLI_INT, &o.threads, 0, 256, "N", "0: one a core (0)" },
		{ "bounces", 0, CLI_INT, &o.bounces, 0, 1024, "N",
		  "most reflections before the surface that is seen (64)" },
		{ "soft-lamps", 0, CLI_FLAG, &o.soft_lamps, 0, 0, NULL,
		  "lamps are spheres of their radius, not points" },
		{ "resume", 'r', CLI_TEXT, &o.resume, 0, 0, "FILE",
		  "go on from this file if it is there, and keep the sums in it" },
		{ "keep-every", 0, CLI_INT, &o.keep_every_s, 1, 86400, "SECONDS",
		  "how often the sums are written while it traces (60)" },
		{ "out", 'o', CLI_TEXT, &o.out, 0, 0, "FILE.exr",
		  "radiance, standard errors, indirect light" },
		{ "png", 0, CLI_TEXT, &o.png, 0, 0, "FILE", "as the scene's tone curve shows it" },
		{ "points", 0, CLI_TEXT, &o.points, 0, 0, "FILE.csv",
		  "irradiance at points: lines x,y,z,nx,ny,nz" },
		{ "surfels", 0, CLI_FLAG, &o.surfels, 0, 0, NULL,
		  "irradiance at the places of the scene's surfels" },
		{ "points-out", 0, CLI_TEXT, &o.points_out, 0, 0, "FILE.csv",
		  "where irradiance goes" },
	};
	const struct cli_table table = {
		"grotto reference SCENE [OPTION...] --out FILE.exr",
		"Path-traces what the renderer should show, with a standard error for every value.\n"
		"Ctrl-C ends it early with what there is. Equal seeds give equal pictures.",
		options, sizeof options / sizeof options[0]
	};
	struct reference_run run = { .options = &o };
	int words, result;

	switch (cli_parse(&table, argc, argv, &words)) {
	case CLI_HELP: return GR_EXIT_OK;
	case CLI_WRONG: return GR_EXIT_CONFIG;
	case CLI_RUN: break;
	}
	if (!sound(&o, words))
		return GR_EXIT_CONFIG;
	if (!can_write(o.out) || !can_write(o.png) || !can_write(o.points_out) ||
	    !can_keep(o.resume))
		return GR_EXIT_RUNTIME;
	result = trace(&run, argv[1]);
	run_finish(&run);
	if (result == GR_OK)
		return GR_EXIT_OK;
	fprintf(stderr, "grotto reference: %s: %s\n", argv[1], gr_result_name(result));
	return result == GR_ERR_CONFIG ? GR_EXIT_CONFIG : GR_EXIT_RUNTIME;
}
