#include "renderer/view/gbuffer.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"
#include "renderer/view/blocks.h"

#include <epoxy/gl.h>
#include <string.h>

int gbuffer_program(unsigned *out_program, bool emissive)
{
	return program_create_graphics(out_program, "surface.vert", NULL, "gbuffer.frag",
				       emissive ? "#define EMISSIVE\n" : NULL);
}

int gbuffer_init(struct gbuffer *gbuffer, int width, int height, bool emissive)
{
	/* Position and emission need the range and the precision; reflectances are 0..1. */
	static const GLenum formats[GBUFFER_IMAGES] = { GL_RGBA32F, GL_RGBA16F, GL_RGBA16F,
							GL_RGBA16F, GL_RGBA32F };
	static const GLenum buffers[GBUFFER_IMAGES] = {
		GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2,
		GL_COLOR_ATTACHMENT3, GL_COLOR_ATTACHMENT4,
	};

	memset(gbuffer, 0, sizeof(*gbuffer));
	gbuffer->width = width;
	gbuffer->height = height;
	gbuffer->count = emissive ? GBUFFER_IMAGES : GBUFFER_IMAGES - 1;
	glCreateFramebuffers(1, &gbuffer->framebuffer);
	for (int i = 0; i < gbuffer->count; i++) {
		glCreateTextures(GL_TEXTURE_2D, 1, &gbuffer->images[i]);
		glTextureStorage2D(gbuffer->images[i], 1, formats[i], width, height);
		glTextureParameteri(gbuffer->images[i], GL_TEXTURE_MIN_FILTER, GL_NEAREST);
		glTextureParameteri(gbuffer->images[i], GL_TEXTURE_MAG_FILTER, GL_NEAREST);
		glNamedFramebufferTexture(gbuffer->framebuffer, buffers[i], gbuffer->images[i], 0);
	}
	glCreateRenderbuffers(1, &gbuffer->depth);
	glNamedRenderbufferStorage(gbuffer->depth, GL_DEPTH_COMPONENT32F, width, height);
	glNamedFramebufferRenderbuffer(gbuffer->framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
				       gbuffer->depth);
	glNamedFramebufferDrawBuffers(gbuffer->framebuffer, gbuffer->count, buffers);
	if (glCheckNamedFramebufferStatus(gbuffer->framebuffer, GL_FRAMEBUFFER) !=
	    GL_FRAMEBUFFER_COMPLETE) {
		gr_error("no framebuffer for a G-buffer of %d x %d", width, height);
		return GR_ERR_GL;
	}
	return GR_OK;
}

void gbuffer_finish(struct gbuffer *gbuffer)
{
	glDeleteFramebuffers(1, &gbuffer->framebuffer);
	glDeleteRenderbuffers(1, &gbuffer->depth);
	glDeleteTextures(GBUFFER_IMAGES, gbuffer->images);
	memset(gbuffer, 0, sizeof(*gbuffer));
}

void gbuffer_draw(const struct gbuffer *gbuffer, unsigned program, const struct gl_mesh *mesh,
		  mat4 view_projection)
{
	static const GLfloat nothing[4] = { 0, 0, 0, -1 };
	const GLfloat far = 1;

	glBindFramebuffer(GL_FRAMEBUFFER, gbuffer->framebuffer);
	glViewport(0, 0, gbuffer->width, gbuffer->height);
	glDisable(GL_BLEND);
	glEnable(GL_DEPTH_TEST);
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_LESS);
	glClearNamedFramebufferfv(gbuffer->framebuffer, GL_COLOR, 0, nothing);
	glClearNamedFramebufferfv(gbuffer->framebuffer, GL_DEPTH, 0, &far);
	glUseProgram(program);
	glUniformMatrix4fv(1, 1, GL_FALSE, (const GLfloat *)view_projection);
	glEnable(GL_CULL_FACE);
	glCullFace(GL_BACK);
	glFrontFace(GL_CCW);
	gl_mesh_draw(mesh, GL_MESH_ONE_SIDED);
	glDisable(GL_CULL_FACE);
	gl_mesh_draw(mesh, GL_MESH_TWO_SIDED);
	glDisable(GL_DEPTH_TEST);
}

void gbuffer_bind(const struct gbuffer *gbuffer)
{
	glBindTextures(VIEW_UNIT_GBUFFER, gbuffer->count, gbuffer->images);
}
