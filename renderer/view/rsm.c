#include "renderer/view/rsm.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <stdlib.h>

struct rsm {
	struct rsm_set set;
	unsigned depth; /* renderbuffer */
	unsigned framebuffer;
	unsigned lamp_program, patch_program;
	bool drawn; /* since the last rsm_frame */
};

static unsigned create_array(GLenum format, int pixels, int layers)
{
	GLuint texture;

	glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &texture);
	glTextureStorage3D(texture, 1, format, pixels, pixels, layers);
	glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	return texture;
}

static void attach(struct rsm *rsm, int index)
{
	const GLuint textures[3] = { rsm->set.position_area, rsm->set.normal, rsm->set.exitance };

	for (GLenum i = 0; i < 3; i++)
		glNamedFramebufferTextureLayer(rsm->framebuffer, GL_COLOR_ATTACHMENT0 + i,
					       textures[i], 0, index);
}

static int create_framebuffer(struct rsm *rsm)
{
	static const GLenum buffers[3] = { GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1,
					   GL_COLOR_ATTACHMENT2 };
	int pixels = rsm->set.pixels, layers = rsm->set.layers;

	rsm->set.position_area = create_array(GL_RGBA32F, pixels, layers);
	rsm->set.normal = create_array(GL_RGBA16F, pixels, layers);
	rsm->set.exitance = create_array(GL_RGBA32F, pixels, layers);
	glCreateRenderbuffers(1, &rsm->depth);
	glNamedRenderbufferStorage(rsm->depth, GL_DEPTH_COMPONENT32F, pixels, pixels);
	glCreateFramebuffers(1, &rsm->framebuffer);
	glNamedFramebufferRenderbuffer(rsm->framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
				       rsm->depth);
	attach(rsm, 0);
	glNamedFramebufferDrawBuffers(rsm->framebuffer, 3, buffers);
	if (glCheckNamedFramebufferStatus(rsm->framebuffer, GL_FRAMEBUFFER) !=
	    GL_FRAMEBUFFER_COMPLETE) {
		gr_error("no framebuffer for %d reflective shadow maps of %d x %d", layers, pixels,
			 pixels);
		return GR_ERR_GL;
	}
	return GR_OK;
}

int rsm_create(struct rsm **out, int pixels, int layers, bool lamps, bool patches)
{
	struct rsm *rsm = calloc(1, sizeof(*rsm));
	int result;

	*out = NULL;
	if (!rsm)
		return GR_ERR_NOMEM;
	rsm->set.pixels = pixels;
	rsm->set.layers = layers;
	result = create_framebuffer(rsm);
	if (result == GR_OK && lamps)
		result = program_create_graphics(&rsm->lamp_program, "surface.vert", NULL,
						 "rsm.frag", NULL);
	if (result == GR_OK && patches)
		result = program_create_graphics(&rsm->patch_program, "surface.vert", NULL,
						 "rsm.frag", "#define PATCHES\n");
	if (result != GR_OK) {
		rsm_destroy(&rsm);
		return result;
	}
	for (int i = 0; i < layers; i++)
		rsm_clear(rsm, i);
	*out = rsm;
	return GR_OK;
}

void rsm_destroy(struct rsm **rsm)
{
	struct rsm *r = *rsm;

	if (!r)
		return;
	program_destroy(&r->lamp_program);
	program_destroy(&r->patch_program);
	glDeleteFramebuffers(1, &r->framebuffer);
	glDeleteRenderbuffers(1, &r->depth);
	glDeleteTextures(1, &r->set.position_area);
	glDeleteTextures(1, &r->set.normal);
	glDeleteTextures(1, &r->set.exitance);
	free(r);
	*rsm = NULL;
}

void rsm_clear(struct rsm *rsm, int index)
{
	static const GLfloat nothing[4] = { 0, 0, 0, 0 };
	const GLfloat far = 0;

	attach(rsm, index);
	for (GLint i = 0; i < 3; i++)
		glClearNamedFramebufferfv(rsm->framebuffer, GL_COLOR, i, nothing);
	glClearNamedFramebufferfv(rsm->framebuffer, GL_DEPTH, 0, &far);
	rsm->drawn = true;
}

static void draw(struct rsm *rsm, int index, const struct rsm_view *view, unsigned program,
		 int first, int count, const struct gl_mesh *mesh)
{
	bool perspective = view->layer.extent[2] != 0;
	const float *at = perspective ? view->origin : view->axis;
	float texel = 2 * view->layer.extent[0] / (float)rsm->set.pixels;

	rsm_clear(rsm, index);
	map_pass_begin(rsm->set.pixels);
	glBindFramebuffer(GL_FRAMEBUFFER, rsm->framebuffer);
	glUseProgram(program);
	glUniformMatrix4fv(1, 1, GL_FALSE, view->layer.clip);
	glUniform4f(2, at[0], at[1], at[2], perspective ? 1 : 0);
	glUniform4f(3, texel, view->axis[0], view->axis[1], view->axis[2]);
	glUniform2i(4, first, count);
	gl_mesh_draw(mesh, GL_MESH_ALL);
	map_pass_end();
}

void rsm_draw_lamp(struct rsm *rsm, int index, const struct rsm_view *view, int lamp,
		   const struct gl_mesh *mesh)
{
	draw(rsm, index, view, rsm->lamp_program, lamp, 1, mesh);
}

void rsm_draw_patches(struct rsm *rsm, int index, const struct rsm_view *view, int first,
		      int count, const struct gl_mesh *mesh)
{
	draw(rsm, index, view, rsm->patch_program, first, count, mesh);
}

int rsm_pixels(const struct rsm *rsm)
{
	return rsm->set.pixels;
}

const struct rsm_set *rsm_frame(struct rsm *rsm)
{
	rsm->set.changed = rsm->drawn;
	if (rsm->drawn)
		rsm->set.version++;
	rsm->drawn = false;
	return &rsm->set;
}
