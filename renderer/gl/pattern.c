#include "renderer/gl/pattern.h"

#include <epoxy/gl.h>
#include <stddef.h>

#define PARTS 8 /* of the grid, each way */

static void fill(int x, int y, int width, int height, const float color[4])
{
	if (width < 1 || height < 1)
		return;
	glScissor(x, y, width, height);
	glClearBufferfv(GL_COLOR, 0, color);
}

static void draw_grid(int width, int height)
{
	static const float grey[4] = { 0.25f, 0.25f, 0.25f, 1 };

	for (int i = 1; i < PARTS; i++) {
		fill(i * width / PARTS, 0, 1, height, grey);
		fill(0, i * height / PARTS, width, 1, grey);
	}
}

static void draw_frame(int width, int height)
{
	static const float white[4] = { 1, 1, 1, 1 };

	fill(0, 0, width, 1, white);
	fill(0, height - 1, width, 1, white);
	fill(0, 0, 1, height, white);
	fill(width - 1, 0, 1, height, white);
}

static void draw_bars(int width, int height)
{
	static const float bars[][4] = {
		{ 1, 1, 1, 1 }, { 1, 1, 0, 1 }, { 0, 1, 1, 1 }, { 0, 1, 0, 1 },
		{ 1, 0, 1, 1 }, { 1, 0, 0, 1 }, { 0, 0, 1, 1 }, { 0, 0, 0, 1 },
	};
	const int count = sizeof bars / sizeof *bars, left = width / 4, all = width / 2;

	for (int i = 0; i < count; i++)
		fill(left + i * all / count, height * 3 / 8, (i + 1) * all / count - i * all / count,
		     height / 4, bars[i]);
}

static void draw_eye(int eye, int width, int height)
{
	static const float red[4] = { 1, 0, 0, 1 }, cyan[4] = { 0, 1, 1, 1 };
	const int side = (width < height ? width : height) / PARTS;

	draw_grid(width, height);
	draw_bars(width, height);
	fill(side / 2, side / 2, side, side, eye == 1 ? cyan : red);
	draw_frame(width, height);
}

void pattern_draw(const struct target *target, enum pattern pattern)
{
	static const float black[4] = { 0, 0, 0, 1 };
	int width, height;

	target_size(target, &width, &height);
	glEnable(GL_SCISSOR_TEST);
	for (int eye = 0; eye < target_eyes(target); eye++) {
		target_bind(target, eye, false);
		fill(0, 0, width, height, black);
		if (pattern == PATTERN_TEST)
			draw_eye(eye, width, height);
	}
	glDisable(GL_SCISSOR_TEST); /* as the renderer has it */
}
