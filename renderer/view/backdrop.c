#include "renderer/view/backdrop.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/scene/environment.h"
#include "renderer/view/blocks.h"

#include <epoxy/gl.h>
#include <string.h>

/* Uniform locations in shade.frag. */
enum { LOCATION_RAYS = 3, LOCATION_HEADING = 4 };

static int create_image(struct backdrop *backdrop, const struct environment_pixels *pixels)
{
	GLint most = 0;

	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	if (pixels->width > most || pixels->height > most) {
		gr_error("environment: %d x %d pixels, this OpenGL takes %d a side", pixels->width,
			 pixels->height, most);
		return GR_ERR_UNSUPPORTED;
	}
	glCreateTextures(GL_TEXTURE_2D, 1, &backdrop->image);
	glTextureStorage2D(backdrop->image, 1, GL_RGBA32F, pixels->width, pixels->height);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
	glTextureSubImage2D(backdrop->image, 0, 0, 0, pixels->width, pixels->height, GL_RGB,
			    GL_FLOAT, pixels->rgb);
	glTextureParameteri(backdrop->image, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTextureParameteri(backdrop->image, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTextureParameteri(backdrop->image, GL_TEXTURE_WRAP_S, GL_REPEAT);
	glTextureParameteri(backdrop->image, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	if (glGetError() == GL_OUT_OF_MEMORY) {
		gr_error("the GPU's memory does not hold the environment");
		return GR_ERR_GL;
	}
	return GR_OK;
}

int backdrop_init(struct backdrop *backdrop, const struct scene *scene,
		  const struct scene_file *file)
{
	struct environment_pixels pixels;

	memset(backdrop, 0, sizeof(*backdrop));
	if (!scene->environment) {
		memcpy(backdrop->radiance, file->background, sizeof(file->background));
		return GR_OK;
	}
	environment_pixels(scene->environment, &pixels);
	memcpy(backdrop->radiance, pixels.constant, sizeof(pixels.constant));
	backdrop->radiance[3] = pixels.upper_only ? 1 : 0;
	backdrop->heading_rad = pixels.heading_rad;
	return pixels.rgb ? create_image(backdrop, &pixels) : GR_OK;
}

void backdrop_finish(struct backdrop *backdrop)
{
	glDeleteTextures(1, &backdrop->image);
	backdrop->image = 0;
}

bool backdrop_is_directed(const struct backdrop *backdrop)
{
	return backdrop->image || backdrop->radiance[3] > 0;
}

const char *backdrop_defines(const struct backdrop *backdrop)
{
	if (backdrop->image)
		return "#define BACKDROP\n#define BACKDROP_IMAGE\n";
	return backdrop_is_directed(backdrop) ? "#define BACKDROP\n" : "";
}

void backdrop_bind(const struct backdrop *backdrop, const mat4 view_projection, const float eye[3])
{
	mat4 to_eye, rays;

	if (!backdrop_is_directed(backdrop))
		return;
	/* From clip space to directions from the eye: the eye becomes the origin first. */
	glm_translate_make(to_eye, (float *)eye);
	glm_mat4_mul((vec4 *)view_projection, to_eye, rays);
	glm_mat4_inv(rays, rays);
	glUniformMatrix4fv(LOCATION_RAYS, 1, GL_FALSE, (const float *)rays);
	if (backdrop->image) {
		glUniform1f(LOCATION_HEADING, backdrop->heading_rad);
		glBindTextureUnit(VIEW_UNIT_BACKDROP, backdrop->image);
	}
}
