#include "renderer/view/shade.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <stdio.h>
#include <string.h>

static unsigned create_image(int width, int height)
{
	static const GLfloat black[4] = { 0, 0, 0, 1 };
	GLuint image;

	glCreateTextures(GL_TEXTURE_2D, 1, &image);
	glTextureStorage2D(image, 1, GL_RGBA32F, width, height);
	glTextureParameteri(image, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTextureParameteri(image, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glClearTexImage(image, 0, GL_RGBA, GL_FLOAT, black);
	return image;
}

int shade_picture_init(struct shade_picture *picture, int width, int height, bool keep_indirect)
{
	static const GLenum buffers[2] = { GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1 };

	memset(picture, 0, sizeof(*picture));
	picture->width = width;
	picture->height = height;
	picture->radiance = create_image(width, height);
	glCreateVertexArrays(1, &picture->empty_vao);
	glCreateFramebuffers(1, &picture->framebuffer);
	glNamedFramebufferTexture(picture->framebuffer, buffers[0], picture->radiance, 0);
	if (keep_indirect) {
		picture->indirect = create_image(width, height);
		glNamedFramebufferTexture(picture->framebuffer, buffers[1], picture->indirect, 0);
	}
	glNamedFramebufferDrawBuffers(picture->framebuffer, keep_indirect ? 2 : 1, buffers);
	if (glCheckNamedFramebufferStatus(picture->framebuffer, GL_FRAMEBUFFER) !=
	    GL_FRAMEBUFFER_COMPLETE) {
		gr_error("no framebuffer for a radiance picture of %d x %d", width, height);
		return GR_ERR_GL;
	}
	return GR_OK;
}

void shade_picture_finish(struct shade_picture *picture)
{
	glDeleteFramebuffers(1, &picture->framebuffer);
	glDeleteVertexArrays(1, &picture->empty_vao);
	glDeleteTextures(1, &picture->radiance);
	glDeleteTextures(1, &picture->indirect);
	memset(picture, 0, sizeof(*picture));
}

int shade_program(unsigned *out_program, const struct shade_parts *parts, bool keep_indirect)
{
	char defines[512];

	snprintf(defines, sizeof(defines), "%s%s%s%s#define GI_SHADER \"%s\"\n",
		 parts->shadow ? "#define LAMPS\n" : "", parts->emissive ? "#define EMISSIVE\n" : "",
		 keep_indirect ? "#define KEEP_INDIRECT\n" : "", backdrop_defines(parts->backdrop),
		 parts->gi ? parts->gi->ops->shader_name : "gi_none.glsl");
	return program_create_graphics(out_program, "screen.vert", NULL, "shade.frag", defines);
}

void shade_draw(const struct shade_picture *picture, unsigned program,
		const struct shade_parts *parts, const struct gbuffer *gbuffer,
		const mat4 view_projection, const float eye[3], bool indirect)
{
	glBindFramebuffer(GL_FRAMEBUFFER, picture->framebuffer);
	glViewport(0, 0, picture->width, picture->height);
	glDisable(GL_DEPTH_TEST);
	glDisable(GL_CULL_FACE);
	glDisable(GL_BLEND);
	glBindVertexArray(picture->empty_vao);
	gbuffer_bind(gbuffer);
	if (parts->shadow)
		shadow_bind(parts->shadow);
	if (parts->emissive)
		emissive_bind(parts->emissive);
	if (parts->gi)
		parts->gi->ops->bind(parts->gi);
	glUseProgram(program);
	glUniform3f(1, eye[0], eye[1], eye[2]);
	glUniform1i(2, indirect && parts->gi);
	backdrop_bind(parts->backdrop, view_projection, eye);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	/* a sampler stays with its unit: the next pass may use that */
	glBindSampler(VIEW_UNIT_LAMP_COMPARE, 0);
}
