/* The picture of `grotto reference`: tracing, resuming, files. */
#include "tools/reference.h"

#include "base/clock.h"
#include "base/result.h"
#include "renderer/tone/encode.h"
#include "renderer/trace/sampler.h"
#include "tools/say.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CHANNELS 12

static const char *const channel_names[CHANNELS] = {
	"R", "G", "B", "stderr.R", "stderr.G", "stderr.B",
	"indirect.R", "indirect.G", "indirect.B",
	"indirect_stderr.R", "indirect_stderr.G", "indirect_stderr.B",
};

static int write_exr(const struct reference_film *film, const char *path)
{
	struct image layers[4] = { { 0 } };
	struct image all = { .width = film->width, .height = film->height, .channels = CHANNELS };
	size_t pixels = (size_t)film->width * (size_t)film->height;
	int result = reference_film_images(film, &layers[0], &layers[1], &layers[2]);

	if (result == GR_OK)
		result = reference_film_indirect_error(film, &layers[3]);
	if (result == GR_OK) {
		all.data = malloc(pixels * CHANNELS * sizeof *all.data);
		result = all.data ? GR_OK : GR_ERR_NOMEM;
	}
	if (result == GR_OK) {
		for (size_t i = 0; i < pixels; i++)
			for (size_t layer = 0; layer < 4; layer++)
				memcpy(all.data + CHANNELS * i + 3 * layer,
				       layers[layer].data + 3 * i, 3 * sizeof *all.data);
		result = image_write_exr(path, &all, channel_names);
	}
	free(all.data);
	for (int i = 0; i < 4; i++)
		image_finish(&layers[i]);
	return result;
}

static int write_png(const struct reference_film *film, const struct scene_tone *tone,
		     const char *path)
{
	size_t pixels = (size_t)film->width * (size_t)film->height;
	uint8_t *rgb = malloc(3 * pixels);
	struct image radiance = { 0 };
	int result = rgb ? reference_film_images(film, &radiance, NULL, NULL) : GR_ERR_NOMEM;

	if (result == GR_OK) {
		tone_encode_bytes(tone, radiance.data, pixels, rgb);
		result = image_write_png(path, film->width, film->height, rgb);
	}
	image_finish(&radiance);
	free(rgb);
	return result;
}

static int load_film(const char *path, struct reference_film *film)
{
	struct gr_diag diag = { 0 };
	int result;

	if (!path || (access(path, F_OK) != 0 && errno == ENOENT))
		return GR_OK;
	result = reference_film_load(film, path, &diag);
	say_diag(&diag);
	gr_diag_finish(&diag);
	if (result == GR_OK)
		printf("%s: goes on from %d samples\n", path, film->samples);
	return result == GR_OK || result == GR_ERR_NOMEM ? result : GR_ERR_CONFIG;
}

static int write_files(struct reference_run *run, const struct reference_film *film)
{
	const struct reference_options *o = run->options;
	int result = o->resume ? reference_film_save(film, o->resume) : GR_OK;

	if (result == GR_OK && o->out)
		result = write_exr(film, o->out);
	if (result == GR_OK && o->png)
		result = write_png(film, &run->file->tone, o->png);
	return result;
}

/* So that a crash costs little. A failure has been logged, and is one only if it lasts to the end. */
static void keep(void *ctx, const struct reference_film *film)
{
	struct reference_run *run = ctx;
	int64_t now = gr_clock_now(&gr_clock_monotonic);

	if (now < run->keep_ns)
		return;
	reference_film_save(film, run->options->resume);
	run->keep_ns = gr_clock_now(&gr_clock_monotonic) +
		       run->options->keep_every_s * GR_NS_PER_S;
}

static void print_figures(const struct reference_run *run, const struct reference_film *film,
			  double seconds)
{
	double error = reference_film_error(film);
	char time[32], known[32] = "not known";

	if (error >= 0)
		snprintf(known, sizeof known, "%.3f %%", 100 * error);
	printf("%s: %dx%d, %d samples a pixel, standard error %s, %s, %.2f million rays/s\n",
	       run->options->out ? run->options->out : run->options->png, film->width, film->height,
	       film->samples, known, progress_time(seconds, time, sizeof time),
	       seconds > 0 ? (double)reference_rays(run->reference) / seconds * 1e-6 : 0);
	if (run->stopped)
		printf("ended early%s\n", run->options->resume ? "; the same command goes on" : "");
	if (film->nonfinite)
		fprintf(stderr, "warning: %llu samples were not finite and are left out\n",
			(unsigned long long)film->nonfinite);
}

int reference_picture(struct reference_run *run)
{
	const struct reference_options *o = run->options;
	struct reference_film film = { 0 };
	struct reference_view view;
	int64_t start;
	int result = reference_choose_view(run, &view);

	if (result == GR_OK)
		result = load_film(o->resume, &film);
	if (result != GR_OK)
		goto out;
	start = gr_clock_now(&gr_clock_monotonic);
	run->keep_ns = start + o->keep_every_s * GR_NS_PER_S;
	run->params.keep = o->resume ? keep : NULL;
	progress_start(&run->progress, "picture");
	result = reference_render(run->reference, &view, &run->params, &film);
	progress_end(&run->progress);
	if (result == GR_ERR_MISMATCH) {
		fprintf(stderr, "%s: belongs to another scene, view, size, seed, or other settings; "
				"give it with those, or another file\n",
			o->resume);
		result = GR_ERR_CONFIG;
	}
	/* one set has no standard error, and the file would say 0 */
	if (result == GR_NOTHING && film.samples < 2 * SAMPLER_SET) {
		fprintf(stderr, "grotto reference: ended before every pixel had its first samples; "
				"nothing is written\n");
		if (o->resume && film.samples > 0)
			reference_film_save(&film, o->resume);
	}
	else if (result == GR_OK || result == GR_NOTHING)
		result = write_files(run, &film);
	if (result == GR_OK)
		print_figures(run, &film,
			      (double)(gr_clock_now(&gr_clock_monotonic) - start) * 1e-9);
out:
	reference_film_finish(&film);
	return result;
}
