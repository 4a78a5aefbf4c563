#include "renderer/view/env_sh.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PARTS 16    /* of a row: env_sh.glsl */
#define ROW_GROUP 4 /* rows of a work group: env_sh_rows.comp */

/* Bindings of env_sh.glsl, in its order, from the first that is not the view's (blocks.h). */
#define FIRST_BINDING 8
enum { SUMS, COLUMNS, WEIGHTS, UNTURNED, TURN, COEFFICIENTS, BUFFERS };

struct env_sh {
	int order, width, height;
	double heading;
	double rotation[9];
	bool turned; /* since create */
	unsigned rows, bands, turn; /* programs */
	unsigned buffers[BUFFERS];
};

/*
 * The passes work about the picture's axis, +Y, with +X where its middle is: x, -z, y. This
 * takes their coefficients into the scene's axes.
 */
static const double from_picture[9] = { 1, 0, 0, 0, 0, 1, 0, -1, 0 };

/* What a pixel of a row gives to each coefficient, but for its part in the series. */
static void row_weights(const struct environment_pixels *pixels, int order, int row, float *out)
{
	double top = cos(M_PI * row / pixels->height), bottom = cos(M_PI * (row + 1) / pixels->height);
	double y = cos(M_PI * (row + 0.5) / pixels->height), weight, basis[SH_COUNT_MAX];

	if (pixels->upper_only && bottom < 1e-12) {
		top = top < 1e-12 ? 0 : top;
		if (bottom < -1e-12)
			y = top / 2;
		bottom = 0;
	}
	weight = (top - bottom) * 2 * M_PI / pixels->width;
	for (int l = 0; l < order; l++)
		for (int m = -l; m <= l; m++) {
			/* where the series' term is 1, or -1: sin of m phi is -sin of m p */
			const double p = m < 0 ? M_PI / (2 * m) : 0, r = sqrt(1 - y * y);
			const double d[3] = { r * cos(p), -r * sin(p), y };

			sh_basis(l + 1, d, basis);
			out[l * l + l + m] = (float)(weight * basis[l * l + l + m] * (m < 0 ? -1 : 1));
		}
}

static unsigned create_buffer(size_t count, const float *values)
{
	unsigned buffer;

	glCreateBuffers(1, &buffer);
	glNamedBufferStorage(buffer, (GLsizeiptr)(count * sizeof *values), values,
			     values ? 0 : GL_DYNAMIC_STORAGE_BIT);
	return buffer;
}

static int create_tables(struct env_sh *e, const struct environment_pixels *pixels)
{
	const size_t width = (size_t)e->width, height = (size_t)e->height;
	const size_t order = (size_t)e->order, count = order * order, series = 2 * order - 1;
	float *columns = malloc(2 * width * sizeof *columns);
	float *weights = malloc(height * count * sizeof *weights);

	if (columns && weights) {
		for (size_t x = 0; x < width; x++) {
			double p = 2 * M_PI * (((double)x + 0.5) / e->width - 0.5);

			columns[2 * x] = (float)cos(p);
			columns[2 * x + 1] = (float)sin(p);
		}
		for (int row = 0; row < e->height; row++)
			row_weights(pixels, e->order, row, weights + (size_t)row * count);
		e->buffers[SUMS] = create_buffer(4 * height * PARTS * series, NULL);
		e->buffers[COLUMNS] = create_buffer(2 * width, columns);
		e->buffers[WEIGHTS] = create_buffer(height * count, weights);
		e->buffers[UNTURNED] = create_buffer(4 * count, NULL);
		e->buffers[TURN] = create_buffer(SH_ROTATION_MAX, NULL);
		e->buffers[COEFFICIENTS] = create_buffer(4 * count, NULL);
	}
	free(columns);
	free(weights);
	if (!e->buffers[SUMS])
		return GR_ERR_NOMEM;
	if (glGetError() == GL_OUT_OF_MEMORY) {
		gr_error("the GPU's memory does not hold the sums of the environment");
		return GR_ERR_GL;
	}
	return GR_OK;
}

int env_sh_create(struct env_sh **out, const struct environment_pixels *pixels, int order)
{
	static const double unturned[9] = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
	struct env_sh *e;
	char defines[32];
	int result;

	*out = NULL;
	if (!pixels->width || order < 2 || order > SH_ORDER_MAX)
		return GR_ERR_RANGE;
	e = calloc(1, sizeof *e);
	if (!e)
		return GR_ERR_NOMEM;
	e->order = order;
	e->width = pixels->width;
	e->height = pixels->height;
	e->heading = (double)pixels->heading_rad;
	snprintf(defines, sizeof defines, "#define ORDER %d\n", order);
	result = program_create_compute(&e->rows, "env_sh_rows.comp", defines);
	if (result == GR_OK)
		result = program_create_compute(&e->bands, "env_sh_bands.comp", defines);
	if (result == GR_OK)
		result = program_create_compute(&e->turn, "env_sh_turn.comp", defines);
	if (result == GR_OK)
		result = create_tables(e, pixels);
	if (result != GR_OK) {
		env_sh_destroy(&e);
		return result;
	}
	env_sh_turn(e, unturned);
	*out = e;
	return GR_OK;
}

void env_sh_destroy(struct env_sh **env_sh)
{
	struct env_sh *e = *env_sh;

	if (!e)
		return;
	glDeleteBuffers(BUFFERS, e->buffers);
	program_destroy(&e->rows);
	program_destroy(&e->bands);
	program_destroy(&e->turn);
	free(e);
	*env_sh = NULL;
}

static void multiply(const double a[9], const double b[9], double out[9])
{
	for (int i = 0; i < 9; i++)
		out[i] = a[i / 3 * 3] * b[i % 3] + a[i / 3 * 3 + 1] * b[3 + i % 3] +
			 a[i / 3 * 3 + 2] * b[6 + i % 3];
}

static void bind(const struct env_sh *e)
{
	for (unsigned i = 0; i < BUFFERS; i++)
		glBindBufferBase(GL_SHADER_STORAGE_BUFFER, FIRST_BINDING + i, e->buffers[i]);
}

/* The last pass, from what the others have left. */
static void turn(const struct env_sh *e)
{
	glUseProgram(e->turn);
	glDispatchCompute(1, 1, 1);
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

void env_sh_turn(struct env_sh *env_sh, const double rotation[9])
{
	const double c = cos(env_sh->heading), s = sin(env_sh->heading);
	const double heading[9] = { c, 0, s, 0, 1, 0, -s, 0, c };
	double whole[9], scene[9], matrix[SH_ROTATION_MAX];
	float values[SH_ROTATION_MAX];

	if (env_sh->turned && !memcmp(rotation, env_sh->rotation, sizeof env_sh->rotation))
		return;
	memcpy(env_sh->rotation, rotation, sizeof env_sh->rotation);
	env_sh->turned = true;
	multiply(heading, from_picture, scene);
	multiply(rotation, scene, whole);
	sh_rotation(env_sh->order, whole, matrix);
	for (int i = 0; i < SH_ROTATION_MAX; i++)
		values[i] = (float)matrix[i];
	glNamedBufferSubData(env_sh->buffers[TURN], 0, sizeof values, values);
	bind(env_sh);
	turn(env_sh);
}

void env_sh_project(struct env_sh *env_sh, unsigned texture)
{
	const struct env_sh *e = env_sh;

	bind(e);
	glBindTextureUnit(0, texture);
	glUseProgram(e->rows);
	glDispatchCompute(1, (unsigned)(e->height + ROW_GROUP - 1) / ROW_GROUP, 1);
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
	glUseProgram(e->bands);
	glUniform1i(0, e->height);
	glDispatchCompute((unsigned)(e->order * e->order), 1, 1);
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
	turn(e);
}

unsigned env_sh_buffer(const struct env_sh *env_sh)
{
	return env_sh->buffers[COEFFICIENTS];
}

void env_sh_read(const struct env_sh *env_sh, double (*out)[3])
{
	float values[SH_COUNT_MAX][4];
	const int count = env_sh->order * env_sh->order;

	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glGetNamedBufferSubData(env_sh->buffers[COEFFICIENTS], 0,
				(GLsizeiptr)((size_t)count * sizeof *values), values);
	for (int i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			out[i][k] = (double)values[i][k];
}
