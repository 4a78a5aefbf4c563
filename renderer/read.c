#include "renderer/renderer_private.h"

#include "base/result.h"

#include <stdlib.h>
#include <string.h>

int renderer_read_rgb(struct renderer *renderer, uint8_t *rgb)
{
	int width, height;
	size_t row;
	uint8_t *swap;

	renderer_target_size(&renderer->params, &width, &height);
	row = 3 * (size_t)width;
	swap = malloc(row);
	if (!swap)
		return GR_ERR_NOMEM;
	glBindFramebuffer(GL_READ_FRAMEBUFFER, target_framebuffer(renderer->target, 0));
	glPixelStorei(GL_PACK_ALIGNMENT, 1);
	glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, rgb);
	for (int y = 0; y < height / 2; y++) {
		uint8_t *low = rgb + row * (size_t)y, *high = rgb + row * (size_t)(height - 1 - y);

		memcpy(swap, low, row);
		memcpy(low, high, row);
		memcpy(high, swap, row);
	}
	free(swap);
	return glGetError() == GL_NO_ERROR ? GR_OK : GR_ERR_GL;
}

static int read_image(struct renderer *r, int eye, bool indirect, struct image *out)
{
	int width = r->params.width, height = r->params.height, result;
	size_t row = 4 * (size_t)width;
	float *rgba;

	if (!r->params.keep_radiance)
		return GR_ERR_STATE;
	if (eye < 0 || eye >= r->eye_count)
		return GR_ERR_RANGE;
	rgba = malloc(row * (size_t)height * sizeof(*rgba));
	result = rgba ? image_create(out, width, height, 3) : GR_ERR_NOMEM;
	if (result == GR_OK) {
		const struct shade_picture *p = &r->eyes[eye].picture;

		glGetTextureImage(indirect ? p->indirect : p->radiance, 0, GL_RGBA, GL_FLOAT,
				  (GLsizei)(row * (size_t)height * sizeof(*rgba)), rgba);
		for (int y = 0; y < height; y++)
			for (int x = 0; x < width; x++)
				memcpy(out->data + 3 * ((size_t)y * (size_t)width + (size_t)x),
				       rgba + row * (size_t)(height - 1 - y) + 4 * (size_t)x,
				       3 * sizeof(*rgba));
		if (glGetError() != GL_NO_ERROR) {
			image_finish(out);
			result = GR_ERR_GL;
		}
	}
	free(rgba);
	return result;
}

int renderer_read_radiance(struct renderer *renderer, int eye, struct image *out)
{
	return read_image(renderer, eye, false, out);
}

int renderer_read_indirect(struct renderer *renderer, int eye, struct image *out)
{
	return read_image(renderer, eye, true, out);
}

const struct gi_plan *renderer_plan(const struct renderer *renderer)
{
	return renderer->is_planned ? &renderer->light.plan : NULL;
}

const struct light_plan *renderer_light_plan(const struct renderer *renderer)
{
	return renderer->is_planned ? &renderer->light : NULL;
}

size_t renderer_surfels(const struct renderer *renderer)
{
	return renderer->surfels;
}

bool renderer_gi_stats(const struct renderer *renderer, struct gi_stats *out)
{
	if (!renderer->gi)
		return false;
	renderer->gi->ops->stats(renderer->gi, out);
	return true;
}

uint64_t renderer_light_hash(struct renderer *renderer)
{
	return renderer->gi ? renderer->gi->ops->hash(renderer->gi) : 0;
}

struct timers *renderer_timers(struct renderer *renderer)
{
	return renderer->timers;
}

void renderer_stats(const struct renderer *renderer, struct renderer_stats *out)
{
	*out = renderer->stats;
	out->nonfinite = tone_nonfinite(renderer->tone);
	if (renderer->gi) {
		struct gi_stats gi;

		renderer->gi->ops->stats(renderer->gi, &gi);
		out->nonfinite += gi.nonfinite;
	}
}
