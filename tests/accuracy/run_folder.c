/*
 * run-folder DIR: foreign pictures of a scene beside ours of the same scene, by
 * the reference and by every method that suits it. tests/accuracy/folder/folder.h
 * says what DIR holds.
 */
#include "base/log.h"
#include "base/result.h"
#include "tests/accuracy/folder/agreement.h"
#include "tests/accuracy/folder/folder.h"
#include "tests/accuracy/folder/methods.h"
#include "tests/accuracy/folder/work.h"

#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct options {
	int samples, threads;
	const char *method; /* NULL: all */
	const char *keep, *out;
	bool verbose;
};

static const char usage[] =
	"run-folder [OPTIONS] DIR\n"
	"Builds the scene of DIR/scene.json and compares our pictures of it with DIR/CAMERA.exr.\n"
	"  --samples N   of the reference, a pixel (1024)\n"
	"  --threads N   of the reference (all cores)\n"
	"  --method NAME reference, lpv, surfels or probes alone\n"
	"  --keep FOLDER writes the scene file, model and sky there, and keeps them\n"
	"  --out FOLDER  writes our pictures there, as CAMERA-METHOD.exr and -indirect.exr\n"
	"  --verbose     with the renderer's log\n"
	"Exit status 2 when DIR is refused.\n";

static void print_diag(struct gr_diag *diag)
{
	for (size_t i = 0; i < diag->count; i++)
		fprintf(stderr, "%s%s\n", diag->items[i].severity == GR_DIAG_ERROR ? "error: " : "",
			diag->items[i].text);
	gr_diag_finish(diag);
}

static void print_share(double share)
{
	if (isnan(share))
		printf("      -");
	else
		printf(" %6.1f", 100 * share);
}

static int print_row(const char *camera, const char *part, const char *method,
		     const struct image *ours, const struct image *error,
		     const struct folder_pictures *pictures, const struct image *theirs,
		     const struct made *made)
{
	/* The indirect part has no standard errors of its own. */
	static const struct image none;
	const struct image *their_error = theirs == &pictures->picture ? &pictures->error : &none;
	struct agreement a;
	int result = agreement_of(ours, error, theirs, their_error, 8, &a);

	if (result != GR_OK)
		return result;
	printf("%-8.8s %-9s%-10s %8.4f %+8.2f %8.3f %8.2f %8.2f", camera, part, method, a.ratio,
	       100 * (a.ratio - 1), 100 * a.ratio_error, 100 * a.nrmse, 100 * a.blocks);
	if (their_error->data)
		printf(" %7.2f %7.2f", 100 * a.noise, 100 * a.their_noise);
	else
		printf("       -       -");
	print_share(their_error->data ? a.within_pixels : NAN);
	print_share(their_error->data ? a.within_blocks : NAN);
	printf(" %7.1f", made->seconds);
	if (a.nonfinite || made->nonfinite)
		printf("  NOT FINITE: %zu pixels, %llu samples", a.nonfinite,
		       (unsigned long long)made->nonfinite);
	printf("\n");
	fflush(stdout);
	return GR_OK;
}

static int keep_pictures(const struct options *o, const char *camera, const char *method,
			 const struct made *made)
{
	char path[2048];
	int result;

	if (!o->out)
		return GR_OK;
	snprintf(path, sizeof path, "%s/%s-%s.exr", o->out, camera, method);
	result = image_write_exr(path, &made->picture, NULL);
	if (result != GR_OK)
		return result;
	snprintf(path, sizeof path, "%s/%s-%s-indirect.exr", o->out, camera, method);
	return image_write_exr(path, &made->indirect, NULL);
}

static int print_made(const struct options *o, const struct folder *folder, size_t camera,
		      const char *method, const struct folder_pictures *pictures,
		      const struct made *made)
{
	const char *name = folder->cameras[camera];
	bool traced = made->error.data != NULL;
	int result = print_row(name, "total", method, &made->picture, &made->error, pictures,
			       &pictures->picture, made);

	/* What methods call indirect has the environment's light in it; their pictures' has not. */
	if (result == GR_OK && pictures->indirect.data && (traced || !folder->surrounded))
		result = print_row(name, "indirect", method, &made->indirect, &made->indirect_error,
				   pictures, &pictures->indirect, made);
	if (result == GR_OK)
		result = keep_pictures(o, name, method, made);
	return result;
}

static bool wanted(const struct options *o, const char *method)
{
	return !o->method || strcmp(o->method, method) == 0;
}

static int run_camera(const struct options *o, struct folder *folder, size_t camera,
		      struct target *target)
{
	struct folder_pictures pictures;
	struct gr_diag diag = { 0 };
	struct made made;
	int result = folder_pictures_read(folder, camera, &pictures, &diag);

	print_diag(&diag);
	if (result == GR_OK && wanted(o, "reference")) {
		result = reference_make(folder, camera, 1, o->samples, o->threads, &made);
		if (result == GR_OK) {
			result = print_made(o, folder, camera, "reference", &pictures, &made);
			made_finish(&made);
		}
	}
	for (const struct method *m = methods; m->name && result == GR_OK && target; m++) {
		const char *why = method_unsuited(folder, m->method);

		if (!wanted(o, m->name))
			continue;
		if (why) {
			printf("%-8.8s %-9s%-10s %s\n", folder->cameras[camera], "", m->name, why);
			continue;
		}
		result = method_make(folder, camera, m->method, target, &made);
		if (result == GR_OK) {
			result = print_made(o, folder, camera, m->name, &pictures, &made);
			made_finish(&made);
		}
	}
	folder_pictures_finish(&pictures);
	return result;
}

static void print_head(const struct folder *folder)
{
	printf("%s: %zu triangles, %zu lamp%s%s%s, %s, %d bounces, %d x %d pixels\n", folder->name,
	       folder->scene->index_count / 3, folder->file->lamp_count,
	       folder->file->lamp_count == 1 ? "" : "s",
	       folder->scene->emissive ? ", emissive surfaces" : "",
	       folder->surrounded ? ", environment" : "",
	       folder->diffuse ? "all diffuse" : "not all diffuse (methods show highlights alone)",
	       folder->max_bounces, folder->width, folder->height);
	printf("image means: ours over theirs, %% off, %% standard error. pixels: nRMSE %%. blocks of "
	       "8 x 8: mean relative\ndifference %%, what the noise of both makes of it, of theirs "
	       "alone. %% of pixels and blocks within 3 standard errors.\n");
	printf("%-8s %-9s%-10s %8s %8s %8s %8s %8s %7s %7s %6s %6s %7s\n", "camera", "part", "method",
	       "mean", "off", "+-", "nRMSE", "blocks", "noise", "theirs", "pixels", "blocks", "s");
}

static int run(const struct options *o, const char *path, const char *work)
{
	struct target *target = NULL;
	struct gr_diag diag = { 0 };
	struct folder folder;
	int result = folder_open(&folder, path, work, &diag);

	print_diag(&diag);
	if (result != GR_OK)
		return result;
	print_head(&folder);
	if (!wanted(o, "reference") || !o->method) {
		struct target_params params = { .kind = TARGET_HEADLESS, .gpu = -1,
						.width = method_target_side(&folder),
						.height = method_target_side(&folder) };

		if (target_create(&target, &params) != GR_OK)
			printf("no OpenGL 4.5 here: the reference alone\n");
	}
	for (size_t i = 0; i < folder.file->camera_count && result == GR_OK; i++)
		result = run_camera(o, &folder, i, target);
	target_destroy(&target);
	folder_close(&folder);
	return result;
}

static bool parse(int argc, char **argv, struct options *o)
{
	static const struct option longs[] = {
		{ "samples", required_argument, NULL, 's' }, { "threads", required_argument, NULL, 't' },
		{ "method", required_argument, NULL, 'm' },  { "keep", required_argument, NULL, 'k' },
		{ "out", required_argument, NULL, 'o' },     { "verbose", no_argument, NULL, 'v' },
		{ NULL, 0, NULL, 0 },
	};
	int option;

	*o = (struct options){ .samples = 1024 };
	while ((option = getopt_long(argc, argv, "", longs, NULL)) != -1) {
		switch (option) {
		case 's': o->samples = atoi(optarg); break;
		case 't': o->threads = atoi(optarg); break;
		case 'm': o->method = optarg; break;
		case 'k': o->keep = optarg; break;
		case 'o': o->out = optarg; break;
		case 'v': o->verbose = true; break;
		default: return false;
		}
	}
	return optind + 1 == argc && o->samples >= 2 && o->samples <= 1 << 24 && o->threads >= 0 &&
	       o->threads <= 1024;
}

int main(int argc, char **argv)
{
	struct options options;
	char work[1024];
	int result;

	if (!parse(argc, argv, &options)) {
		fputs(usage, stderr);
		return GR_EXIT_CONFIG;
	}
	gr_log_init("run-folder", options.verbose ? GR_LOG_INFO : GR_LOG_ERROR);
	if (options.keep) {
		snprintf(work, sizeof work, "%s", options.keep);
	} else if (!work_make(work)) {
		perror("run-folder: no folder for temporary files");
		return GR_EXIT_RUNTIME;
	}
	result = run(&options, argv[optind], work);
	if (!options.keep)
		work_remove(work);
	if (result == GR_OK)
		return GR_EXIT_OK;
	fprintf(stderr, "run-folder: %s: %s\n", argv[optind], gr_result_name(result));
	return result == GR_ERR_CONFIG ? GR_EXIT_CONFIG : GR_EXIT_RUNTIME;
}
