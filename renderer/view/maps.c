#include "renderer/view/maps.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <math.h>
#include <string.h>

static void cross3(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static void unit3(double v[3])
{
	double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);

	for (int i = 0; i < 3; i++)
		v[i] /= length;
}

double map_least_length(const float min[3], const float max[3])
{
	double sum = 0;

	for (int i = 0; i < 3; i++)
		sum += pow((double)max[i] - (double)min[i], 2);
	return fmin(1e-3, 1e-3 * sqrt(sum));
}

void map_basis_look(const float direction[3], struct map_basis *out)
{
	double up[3] = { 0, 1, 0 };

	for (int i = 0; i < 3; i++)
		out->back[i] = -(double)direction[i];
	unit3(out->back);
	if (fabs(out->back[1]) > 0.9) {
		up[0] = 1;
		up[1] = 0;
	}
	cross3(up, out->back, out->right);
	unit3(out->right);
	cross3(out->back, out->right, out->up);
}

void map_basis_face(const struct map_basis *frame, int face, struct map_basis *out)
{
	const double *axes[3] = { frame->right, frame->up, frame->back };
	double sign = face % 2 ? -1 : 1;

	for (int i = 0; i < 3; i++) {
		out->back[i] = -sign * axes[face / 2][i];
		out->up[i] = axes[(face / 2 + 1) % 3][i];
	}
	cross3(out->up, out->back, out->right);
}

/* clip = rows of the projection times the rigid view. */
static void fill_clip(struct map_layer *out, const struct map_basis *basis, const float origin[3],
		      const double x_scale, const double z[2], bool perspective)
{
	double view[3][4]; /* rows */
	const double *axes[3] = { basis->right, basis->up, basis->back };

	for (int row = 0; row < 3; row++) {
		view[row][3] = 0;
		for (int col = 0; col < 3; col++) {
			view[row][col] = axes[row][col];
			view[row][3] -= axes[row][col] * (double)origin[col];
		}
	}
	for (int col = 0; col < 4; col++) {
		double last = col == 3 ? 1 : 0;

		out->clip[4 * col + 0] = (float)(x_scale * view[0][col]);
		out->clip[4 * col + 1] = (float)(x_scale * view[1][col]);
		out->clip[4 * col + 2] = (float)(z[0] * view[2][col] + z[1] * last);
		out->clip[4 * col + 3] = (float)(perspective ? -view[2][col] : last);
	}
}

void map_layer_perspective(struct map_layer *out, const struct map_basis *basis,
			   const float origin[3], double half, double near_m, double far_m,
			   double lift_m, int pixels)
{
	const double z[2] = { near_m / (far_m - near_m), far_m * near_m / (far_m - near_m) };

	*out = (struct map_layer){
		.extent = { (float)half, (float)pixels, 1, (float)z[1] },
		.range = { (float)near_m, (float)far_m, (float)lift_m, 0 },
	};
	fill_clip(out, basis, origin, 1 / half, z, true);
}

void map_layer_ortho(struct map_layer *out, const struct map_basis *basis, const float origin[3],
		     double half, double near_m, double far_m, double lift_m, int pixels)
{
	const double z[2] = { 1 / (far_m - near_m), far_m / (far_m - near_m) };

	*out = (struct map_layer){
		.extent = { (float)half, (float)pixels, 0, (float)z[0] },
		.range = { (float)near_m, (float)far_m, (float)lift_m, 0 },
	};
	fill_clip(out, basis, origin, 1 / half, z, false);
}

int depth_maps_init(struct depth_maps *maps, int pixels, int layers)
{
	int result;

	memset(maps, 0, sizeof(*maps));
	maps->pixels = pixels;
	maps->layers = layers;
	result = program_create_graphics(&maps->program, "depth.vert", NULL, NULL, NULL);
	if (result != GR_OK)
		return result;
	glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &maps->texture);
	glTextureStorage3D(maps->texture, 1, GL_DEPTH_COMPONENT32F, pixels, pixels, layers);
	glTextureParameteri(maps->texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTextureParameteri(maps->texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glCreateSamplers(1, &maps->compare);
	glSamplerParameteri(maps->compare, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
	glSamplerParameteri(maps->compare, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
	glSamplerParameteri(maps->compare, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glSamplerParameteri(maps->compare, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glSamplerParameteri(maps->compare, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
	glSamplerParameteri(maps->compare, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
	glCreateBuffers(1, &maps->buffer);
	glNamedBufferStorage(maps->buffer, (GLsizeiptr)(sizeof(struct map_layer) * VIEW_LAYERS_MAX),
			     NULL, GL_DYNAMIC_STORAGE_BIT);
	glCreateFramebuffers(1, &maps->framebuffer);
	glNamedFramebufferTextureLayer(maps->framebuffer, GL_DEPTH_ATTACHMENT, maps->texture, 0, 0);
	if (glCheckNamedFramebufferStatus(maps->framebuffer, GL_FRAMEBUFFER) !=
	    GL_FRAMEBUFFER_COMPLETE) {
		gr_error("no framebuffer for %d shadow maps of %d x %d", layers, pixels, pixels);
		return GR_ERR_GL;
	}
	return GR_OK;
}

void depth_maps_finish(struct depth_maps *maps)
{
	glDeleteFramebuffers(1, &maps->framebuffer);
	glDeleteBuffers(1, &maps->buffer);
	glDeleteSamplers(1, &maps->compare);
	glDeleteTextures(1, &maps->texture);
	program_destroy(&maps->program);
	memset(maps, 0, sizeof(*maps));
}

void map_pass_begin(int pixels)
{
	glViewport(0, 0, pixels, pixels);
	glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
	glEnable(GL_DEPTH_TEST);
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_GREATER);
	glDisable(GL_CULL_FACE);
	glDisable(GL_BLEND);
}

void map_pass_end(void)
{
	glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
	glDepthFunc(GL_LESS);
	glDisable(GL_DEPTH_TEST);
}

void depth_maps_draw(struct depth_maps *maps, int index, const struct map_layer *layer,
		     const struct gl_mesh *mesh)
{
	const GLfloat far = 0;

	glNamedBufferSubData(maps->buffer, (GLintptr)(sizeof(*layer) * (size_t)index),
			     sizeof(*layer), layer);
	glNamedFramebufferTextureLayer(maps->framebuffer, GL_DEPTH_ATTACHMENT, maps->texture, 0,
				       index);
	map_pass_begin(maps->pixels);
	glBindFramebuffer(GL_FRAMEBUFFER, maps->framebuffer);
	glClearNamedFramebufferfv(maps->framebuffer, GL_DEPTH, 0, &far);
	glUseProgram(maps->program);
	glUniformMatrix4fv(1, 1, GL_FALSE, layer->clip);
	gl_mesh_draw_depth(mesh, GL_MESH_ALL);
	map_pass_end();
}
