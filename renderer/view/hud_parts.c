#include "renderer/view/hud_private.h"

#include <math.h>
#include <string.h>

#define SYMBOL 0.03f
#define SYMBOLS_X (-0.1f)
#define SYMBOLS_APART 0.05f
#define MARK_X (-0.13f)
#define LEAN 0.6f /* back, radians: hands are held low, and looked down at */
#define TORCH_LENGTH 0.12f

static const vec4 grey = HUD_GREY, dark = HUD_DARK, white = HUD_WHITE;

void hud_add(struct hud_list *l, enum hud_shape shape, mat4 T_wand_part, const vec4 color)
{
	struct hud_part *part;

	if (l->count == HUD_PARTS_MOST)
		return;
	part = &l->parts[l->count++];
	glm_mat4_mul(l->T_room_wand, T_wand_part, part->T_room_part);
	memcpy(part->color, color, sizeof part->color);
	part->shape = shape;
}

void hud_add_box(struct hud_list *l, float x, float y, const vec3 size, const vec4 color)
{
	mat4 m = { { size[0], 0, 0, 0 }, { 0, size[1], 0, 0 }, { 0, 0, size[2], 0 }, { x, y, 0, 1 } };

	hud_add(l, HUD_BOX, m, color);
}

/* A cone with its tip at `tip` that opens along `open`, unit. */
static void cone_matrix(const vec3 tip, const vec3 open, float length, float radius, mat4 out)
{
	vec3 back = { -open[0], -open[1], -open[2] }, side, up;

	glm_vec3_ortho(back, side);
	glm_vec3_normalize(side);
	glm_vec3_cross(back, side, up);
	for (int i = 0; i < 3; i++) {
		out[0][i] = radius * side[i];
		out[1][i] = radius * up[i];
		out[2][i] = length * back[i];
		out[3][i] = tip[i];
	}
	out[0][3] = out[1][3] = out[2][3] = 0;
	out[3][3] = 1;
}

static void add_cone(struct hud_list *l, const vec3 tip, const vec3 open, float length, float radius,
		     const vec4 color)
{
	mat4 m;

	cone_matrix(tip, open, length, radius, m);
	hud_add(l, HUD_CONE, m, color);
}

void hud_torch_color(const struct hud_view *v, vec4 out)
{
	const float *rgb = v->torch_intensity;
	const float most = fmaxf(fmaxf(rgb[0], rgb[1]), rgb[2]);

	for (int i = 0; i < 3; i++)
		out[i] = (most > 0 ? powf(rgb[i] / most, 1 / 2.2f) : 1) * (v->torch_on ? 1 : 0.3f);
	out[3] = 1;
}

/* The cone's radius for its length, as the torch opens; never a needle nor a plate. */
static float cone_radius(const struct hud_view *v, float length)
{
	const float half = v->torch_half_angle > 0 ? fminf(v->torch_half_angle, 1.2f) : 0.8f;

	return length * fminf(fmaxf(tanf(half), 0.15f), 1.0f);
}

/* A cross of four arrows. */
static void add_arrows(struct hud_list *l, float y, float size, const vec4 color)
{
	static const float ends[4][2] = { { 1, 0 }, { -1, 0 }, { 0, 1 }, { 0, -1 } };
	const vec3 across = { 0.6f * size, 0.14f * size, 0.14f * size };
	const vec3 along = { 0.14f * size, 0.6f * size, 0.14f * size };

	hud_add_box(l, SYMBOLS_X, y, across, color);
	hud_add_box(l, SYMBOLS_X, y, along, color);
	for (int i = 0; i < 4; i++) {
		const vec3 tip = { SYMBOLS_X + 0.5f * size * ends[i][0], y + 0.5f * size * ends[i][1], 0 };
		const vec3 open = { -ends[i][0], -ends[i][1], 0 };

		add_cone(l, tip, open, 0.26f * size, 0.17f * size, color);
	}
}

/* A cube on its corner: three faces are seen. */
static void add_cube(struct hud_list *l, float y, float size, const vec4 color)
{
	mat4 m = GLM_MAT4_IDENTITY_INIT;
	vec3 at = { SYMBOLS_X, y, 0 }, x = { 1, 0, 0 }, up = { 0, 1, 0 };
	const float side = 0.62f * size;

	glm_translate(m, at);
	glm_rotate(m, 0.6154797f, x); /* atan(1 / sqrt(2)) */
	glm_rotate(m, 0.7853982f, up);
	glm_scale_uni(m, side);
	hud_add(l, HUD_BOX, m, color);
}

static void add_symbols(struct hud_list *l, const struct hud_view *v)
{
	const vec3 mark = { 0.004f, 0.9f * SYMBOL, 0.004f };
	const vec3 open = { 0.35f, -0.87f, -0.35f };
	float y[FRAME_HAND_MODES], size[FRAME_HAND_MODES];
	vec4 torch;
	vec3 tip;

	for (int i = 0; i < FRAME_HAND_MODES; i++) {
		y[i] = SYMBOLS_APART * (float)(1 - i);
		size[i] = v->mode == (enum frame_hand_mode)i ? SYMBOL : 0.8f * SYMBOL;
	}
	hud_add_box(l, MARK_X, y[v->mode], mark, white);
	add_arrows(l, y[0], size[0], v->mode == FRAME_HAND_NAVIGATION ? white : grey);
	add_cube(l, y[2], size[2], v->mode == FRAME_HAND_SETTINGS ? white : grey);
	memcpy(torch, dark, sizeof torch);
	if (v->has_torch)
		hud_torch_color(v, torch);
	for (int i = 0; i < 3; i++)
		tip[i] = (i == 0 ? SYMBOLS_X : i == 1 ? y[1] : 0) - 0.5f * size[1] * open[i];
	add_cone(l, tip, open, size[1], cone_radius(v, size[1]), torch);
}

/* Where the torch is: at its place in the scene, not at the wand. */
static void add_torch(struct hud_list *l, const struct hud_view *v)
{
	const float length = TORCH_LENGTH * v->scale;
	struct hud_part *part;
	vec3 tip, open;

	if (!v->has_torch || v->torch_half_angle <= 0 || l->count == HUD_PARTS_MOST)
		return;
	gr_pose_point(&v->T_room_scene, v->torch_position, tip);
	gr_pose_direction(&v->T_room_scene, v->torch_direction, open);
	part = &l->parts[l->count++];
	cone_matrix(tip, open, length, cone_radius(v, length), part->T_room_part);
	hud_torch_color(v, part->color);
	part->color[3] = 0.5f; /* the light that it throws is what one wants to see */
	part->shape = HUD_CONE;
}

size_t hud_parts(const struct hud_view *view, struct hud_part parts[HUD_PARTS_MOST])
{
	struct hud_list l = { .parts = parts };
	vec3 right = { 1, 0, 0 };

	gr_pose_mat4(&view->T_room_wand, l.T_room_wand);
	glm_rotate(l.T_room_wand, -LEAN, right);
	glm_scale_uni(l.T_room_wand, view->scale);
	add_symbols(&l, view);
	hud_add_bars(&l, view);
	if (view->mode == FRAME_HAND_LIGHTING)
		add_torch(&l, view);
	return l.count;
}

bool hud_part_rim(const struct hud_part *part, float margin, struct hud_part *out)
{
	static const vec4 black = { 0.05f, 0.05f, 0.05f, 1 };
	const float half = part->shape == HUD_CONE ? 0.5f : 0; /* a cone grows about its middle, not its tip */

	if (part->color[3] < 1)
		return false;
	*out = *part;
	memcpy(out->color, black, sizeof black);
	for (int k = 0; k < 3; k++) {
		const float length = glm_vec3_norm((float *)part->T_room_part[k]);
		/* of a cone's radius one, of its length two: a tip is sharp */
		const float more = margin * (part->shape == HUD_CONE ? (k == 2 ? 4.0f : 1.0f) : 2.0f);

		if (length > 0)
			glm_vec4_scale(out->T_room_part[k], (length + more) / length, out->T_room_part[k]);
	}
	for (int i = 0; i < 3; i++)
		out->T_room_part[3][i] += half * (out->T_room_part[2][i] - part->T_room_part[2][i]);
	return true;
}

static float distance2(const struct hud_part *part, const vec3 eye)
{
	const float half = part->shape == HUD_CONE ? 0.5f : 0; /* a cone's middle is not its origin */
	float sum = 0;

	for (int i = 0; i < 3; i++) {
		const float d = part->T_room_part[3][i] - half * part->T_room_part[2][i] - eye[i];

		sum += d * d;
	}
	return sum;
}

void hud_parts_sort(struct hud_part *parts, size_t count, const vec3 eye)
{
	for (size_t i = 1; i < count; i++) {
		const struct hud_part part = parts[i];
		const float distance = distance2(&part, eye);
		size_t k = i;

		for (; k > 0 && distance2(&parts[k - 1], eye) < distance; k--)
			parts[k] = parts[k - 1];
		parts[k] = part;
	}
}
