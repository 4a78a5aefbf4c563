#include "daemon/pictures.h"

#include "base/log.h"
#include "base/result.h"

#include <errno.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct pictures {
	char *dir, *name;
	int width, height, radiance_eyes;

	pthread_t thread;
	pthread_mutex_t mutex;
	pthread_cond_t changed;
	/* Under the mutex; the pictures belong to whom `full` says. */
	bool full, stop;
	int result;
	uint64_t saved;

	uint64_t frame;
	uint8_t *rgb;
	struct image radiance[PICTURES_EYES];
};

static int write_all(const struct pictures *p)
{
	char path[4096];
	int n = snprintf(path, sizeof path, "%s/%s-%06" PRIu64 ".png", p->dir, p->name, p->frame);
	int r;

	if (n < 0 || (size_t)n + 16 >= sizeof path) {
		gr_error("pictures: the path %s is too long", p->dir);
		return GR_ERR_RANGE;
	}
	r = image_write_png(path, p->width, p->height, p->rgb);
	for (int eye = 0; r >= 0 && eye < p->radiance_eyes; eye++) {
		snprintf(path, sizeof path, "%s/%s-%06" PRIu64 "%s.exr", p->dir, p->name, p->frame,
			 eye ? "-right" : "");
		r = image_write_exr(path, &p->radiance[eye], NULL);
	}
	if (r < 0)
		gr_error("%s: cannot be written: %s", path, gr_result_name(r));
	return r;
}

static void *write_thread(void *ctx)
{
	struct pictures *p = ctx;

	pthread_mutex_lock(&p->mutex);
	for (;;) {
		while (!p->full && !p->stop)
			pthread_cond_wait(&p->changed, &p->mutex);
		if (!p->full)
			break;
		pthread_mutex_unlock(&p->mutex);
		int r = write_all(p);
		pthread_mutex_lock(&p->mutex);
		if (r < 0 && p->result == GR_OK)
			p->result = r;
		if (r >= 0)
			p->saved++;
		p->full = false;
		pthread_cond_broadcast(&p->changed);
	}
	pthread_mutex_unlock(&p->mutex);
	return NULL;
}

static void free_all(struct pictures *p)
{
	for (int eye = 0; eye < PICTURES_EYES; eye++)
		image_finish(&p->radiance[eye]);
	free(p->rgb);
	free(p->dir);
	free(p->name);
	free(p);
}

int pictures_create(struct pictures **out, const struct pictures_params *params)
{
	struct pictures *p = calloc(1, sizeof *p);
	int r = GR_ERR_NOMEM;

	*out = NULL;
	if (!p)
		return r;
	p->dir = strdup(params->dir);
	p->name = strdup(params->name);
	p->width = params->width;
	p->height = params->height;
	p->radiance_eyes = params->radiance_eyes;
	p->rgb = malloc((size_t)p->width * (size_t)p->height * 3);
	if (!p->dir || !p->name || !p->rgb)
		goto fail;
	r = GR_ERR_IO;
	if (mkdir(p->dir, 0777) < 0 && errno != EEXIST) {
		gr_error("pictures: %s: %s", p->dir, strerror(errno));
		goto fail;
	}
	pthread_mutex_init(&p->mutex, NULL);
	pthread_cond_init(&p->changed, NULL);
	if (pthread_create(&p->thread, NULL, write_thread, p) != 0)
		goto fail;
	*out = p;
	return GR_OK;
fail:
	free_all(p);
	return r;
}

static void wait_empty(struct pictures *p)
{
	pthread_mutex_lock(&p->mutex);
	while (p->full)
		pthread_cond_wait(&p->changed, &p->mutex);
	pthread_mutex_unlock(&p->mutex);
}

int pictures_save(struct pictures *pictures, struct renderer *renderer, uint64_t frame)
{
	int r;

	wait_empty(pictures);
	r = renderer_read_rgb(renderer, pictures->rgb);
	for (int eye = 0; r >= 0 && eye < pictures->radiance_eyes; eye++) {
		image_finish(&pictures->radiance[eye]);
		r = renderer_read_radiance(renderer, eye, &pictures->radiance[eye]);
	}
	pictures->frame = frame;
	pthread_mutex_lock(&pictures->mutex);
	if (r < 0 && pictures->result == GR_OK)
		pictures->result = r;
	pictures->full = r >= 0;
	pthread_cond_broadcast(&pictures->changed);
	pthread_mutex_unlock(&pictures->mutex);
	if (r < 0)
		gr_error("picture of frame %" PRIu64 ": cannot be read back: %s", frame, gr_result_name(r));
	return r;
}

int pictures_finish(struct pictures *pictures, uint64_t *out_saved)
{
	wait_empty(pictures);
	*out_saved = pictures->saved;
	return pictures->result;
}

void pictures_destroy(struct pictures **pictures)
{
	struct pictures *p = *pictures;

	if (!p)
		return;
	pthread_mutex_lock(&p->mutex);
	p->stop = true;
	pthread_cond_broadcast(&p->changed);
	pthread_mutex_unlock(&p->mutex);
	pthread_join(p->thread, NULL);
	pthread_cond_destroy(&p->changed);
	pthread_mutex_destroy(&p->mutex);
	free_all(p);
	*pictures = NULL;
}
