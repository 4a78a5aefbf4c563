#include "renderer/view/shadow.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/view/maps.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A wider cone would waste most of one map's texels in its corners. */
#define WIDEST_SINGLE_MAP_RAD 2.0944f
/* Nearer to a lamp than so many least lengths nothing throws a shadow: the bulb and its socket. */
#define LAMP_NEAR 10
/* Texels round a map beyond the cone or the cube's face, for the filter to read. */
#define MARGIN_TEXELS 8
#define MAX_FACES 6

struct lamp_state {
	struct frame_lamp last;
	int first, count; /* layers */
	bool depth_old, rsm_old;
	bool refused; /* said so once */
};

struct shadow_stage {
	const struct scene_file *file;
	const struct gl_mesh *mesh;
	struct rsm *rsm;
	struct depth_maps maps;
	unsigned buffer;
	int lamp_count;
	bool fresh; /* nothing taken yet */
	struct lamp_state state[SCENE_MAX_LAMPS];
	struct {
		int32_t count[4];
		struct lamp_record lamps[SCENE_MAX_LAMPS];
	} block;
	float min[3], max[3];
	double least_m; /* map_least_length */
};

static int lamp_layers(const struct scene_lamp *lamp)
{
	bool cube = lamp->kind == SCENE_LAMP_POINT ||
		    (lamp->kind == SCENE_LAMP_SPOT && lamp->cone_rad > WIDEST_SINGLE_MAP_RAD);

	return cube ? MAX_FACES : 1;
}

int shadow_layers(const struct scene_file *file)
{
	int layers = 0;

	for (size_t i = 0; i < file->lamp_count && i < SCENE_MAX_LAMPS; i++)
		layers += lamp_layers(&file->lamps[i]);
	return layers;
}

int shadow_create(struct shadow_stage **out, const struct scene_file *file,
		  const struct scene *scene, const struct gl_mesh *mesh, struct rsm *rsm)
{
	struct shadow_stage *stage = calloc(1, sizeof(*stage));
	int first = 0, result;

	*out = NULL;
	if (!stage)
		return GR_ERR_NOMEM;
	stage->file = file;
	stage->mesh = mesh;
	stage->rsm = rsm;
	stage->fresh = true;
	stage->lamp_count = (int)(file->lamp_count < SCENE_MAX_LAMPS ? file->lamp_count
								     : SCENE_MAX_LAMPS);
	memcpy(stage->min, scene->min, sizeof(stage->min));
	memcpy(stage->max, scene->max, sizeof(stage->max));
	stage->least_m = map_least_length(scene->min, scene->max);
	for (int i = 0; i < stage->lamp_count; i++) {
		stage->state[i].first = first;
		stage->state[i].count = lamp_layers(&file->lamps[i]);
		first += stage->state[i].count;
	}
	result = depth_maps_init(&stage->maps, file->shadow_pixels, first);
	if (result != GR_OK) {
		shadow_destroy(&stage);
		return result;
	}
	glCreateBuffers(1, &stage->buffer);
	glNamedBufferStorage(stage->buffer, sizeof(stage->block), NULL, GL_DYNAMIC_STORAGE_BIT);
	*out = stage;
	return GR_OK;
}

void shadow_destroy(struct shadow_stage **stage)
{
	struct shadow_stage *s = *stage;

	if (!s)
		return;
	glDeleteBuffers(1, &s->buffer);
	depth_maps_finish(&s->maps);
	free(s);
	*stage = NULL;
}

static bool finite3(const vec3 v)
{
	return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* A lamp that cannot be computed with is dark, and named. */
static bool usable(const struct scene_lamp *file, const struct frame_lamp *lamp,
		   struct lamp_state *state)
{
	float length = sqrtf(lamp->direction[0] * lamp->direction[0] +
			     lamp->direction[1] * lamp->direction[1] +
			     lamp->direction[2] * lamp->direction[2]);
	bool good = finite3(lamp->position) && finite3(lamp->direction) &&
		    finite3(lamp->intensity) &&
		    (file->kind == SCENE_LAMP_POINT || fabsf(length - 1.0f) < 0.01f);

	if (!good && !state->refused)
		gr_error("lamp %s: position, direction or intensity is not finite, or the direction "
			 "is not a unit vector; it stays dark",
			 file->name);
	state->refused = !good;
	return good;
}

static void fill_record(struct lamp_record *r, const struct scene_lamp *file,
			const struct frame_lamp *lamp, const struct lamp_state *state,
			double least_m)
{
	float umbra = cosf(0.5f * file->cone_rad);
	float penumbra = cosf(fmaxf(0.5f * file->cone_rad - file->penumbra_rad, 0.0f));
	bool lit = lamp->on && !state->refused;

	memset(r, 0, sizeof(*r));
	for (int i = 0; i < 3; i++) {
		r->position[i] = state->refused ? 0 : lamp->position[i];
		r->direction[i] = state->refused ? (i == 1 ? -1.0f : 0.0f) : lamp->direction[i];
		r->intensity[i] = lit ? lamp->intensity[i] : 0;
	}
	/* metres, or for parallel light metres of blur per metre behind the blocker */
	r->position[3] = file->kind == SCENE_LAMP_DIRECTIONAL ? tanf(0.5f * file->angle_rad)
							       : file->radius_m;
	r->direction[3] = (float)file->kind;
	r->intensity[3] = (float)fmax((double)file->radius_m, least_m);
	r->cone[0] = umbra;
	r->cone[1] = penumbra;
	r->cone[2] = penumbra > umbra ? 1 / (penumbra - umbra) : 0;
	r->maps[0] = state->first;
	r->maps[1] = state->count;
}

int shadow_take(struct shadow_stage *stage, const struct render_frame *frame)
{
	int change = SHADOW_SAME;

	for (int i = 0; i < stage->lamp_count; i++) {
		const struct frame_lamp *now = &frame->lamps[i];
		struct lamp_state *state = &stage->state[i];
		const struct frame_lamp *last = &state->last;
		bool moved = stage->fresh ||
			     memcmp(now->position, last->position, sizeof(vec3)) != 0 ||
			     memcmp(now->direction, last->direction, sizeof(vec3)) != 0;
		bool other = moved || now->on != last->on ||
			     (now->on && memcmp(now->intensity, last->intensity, sizeof(vec3)) != 0);
		/* a lamp that moves while it is off changes nothing that is seen */
		bool seen = stage->fresh || (other && (now->on || last->on));

		if (other) {
			usable(&stage->file->lamps[i], now, state);
			fill_record(&stage->block.lamps[i], &stage->file->lamps[i], now, state,
				    stage->least_m);
			state->last = *now;
		}
		state->depth_old |= moved;
		state->rsm_old |= seen;
		change |= seen ? SHADOW_LIGHT : SHADOW_SAME;
		if ((now->on && state->depth_old) || (stage->rsm && state->rsm_old))
			change |= SHADOW_MAPS;
	}
	stage->fresh = false;
	return change;
}

static double farthest_corner(const struct shadow_stage *stage, const float from[3])
{
	double sum = 0;

	for (int i = 0; i < 3; i++) {
		double a = fabs((double)stage->min[i] - (double)from[i]);
		double b = fabs((double)stage->max[i] - (double)from[i]);

		sum += fmax(a, b) * fmax(a, b);
	}
	return sqrt(sum) * 1.001 + 2 * LAMP_NEAR * stage->least_m;
}

/*
 * Axes of a lamp's only map: turned about its way, for edges of buildings are level and
 * upright. One along a row of texels would jump by a whole texel at once as the lamp moves;
 * the golden ratio's square as slope is nowhere near along any.
 */
static void turned_basis(const float direction[3], struct map_basis *out)
{
	static const double c = 0.93417235896271570, s = 0.35682208977308993;
	struct map_basis straight;

	map_basis_look(direction, &straight);
	*out = straight;
	for (int i = 0; i < 3; i++) {
		out->right[i] = c * straight.right[i] + s * straight.up[i];
		out->up[i] = c * straight.up[i] - s * straight.right[i];
	}
}

/* A map that just holds the scene's bounds, seen along the lamp's direction. */
static void directional_view(const struct shadow_stage *stage, const struct lamp_record *lamp,
			     int pixels, int margin, struct rsm_view *view)
{
	struct map_basis basis;
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3], half;
	double room = LAMP_NEAR * stage->least_m;

	for (int i = 0; i < 3; i++)
		high[i] = -INFINITY;
	turned_basis(lamp->direction, &basis);
	const double *axes[3] = { basis.right, basis.up, basis.back };

	for (int corner = 0; corner < 8; corner++)
		for (int a = 0; a < 3; a++) {
			double at = 0;

			for (int i = 0; i < 3; i++)
				at += axes[a][i] *
				      (double)(corner >> i & 1 ? stage->max[i] : stage->min[i]);
			low[a] = fmin(low[a], at);
			high[a] = fmax(high[a], at);
		}
	for (int i = 0; i < 3; i++)
		view->origin[i] = (float)(0.5 * (low[0] + high[0]) * basis.right[i] +
					  0.5 * (low[1] + high[1]) * basis.up[i] +
					  high[2] * basis.back[i]);
	half = 0.5 * fmax(fmax(high[0] - low[0], high[1] - low[1]), stage->least_m);
	half *= (double)pixels / (pixels - 2 * margin);
	map_layer_ortho(&view->layer, &basis, view->origin, half, -room, high[2] - low[2] + room,
			stage->least_m, pixels);
	memcpy(view->axis, lamp->direction, sizeof(view->axis));
}

/* What layer `face` of a lamp looks at; margin in texels at each side. */
static void lamp_view(const struct shadow_stage *stage, int index, int face, int pixels,
		      int margin, struct rsm_view *view)
{
	static const struct map_basis world = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	const struct lamp_record *lamp = &stage->block.lamps[index];
	const struct scene_lamp *file = &stage->file->lamps[index];
	struct map_basis basis;
	double half = 1;

	if (file->kind == SCENE_LAMP_DIRECTIONAL) {
		directional_view(stage, lamp, pixels, margin, view);
		return;
	}
	if (stage->state[index].count == 1) {
		turned_basis(lamp->direction, &basis);
		half = tan(0.5 * (double)file->cone_rad);
	} else {
		map_basis_face(&world, face, &basis);
	}
	half *= (double)pixels / (pixels - 2 * margin);
	memcpy(view->origin, lamp->position, sizeof(view->origin));
	for (int i = 0; i < 3; i++)
		view->axis[i] = (float)-basis.back[i];
	map_layer_perspective(&view->layer, &basis, view->origin, half, LAMP_NEAR * stage->least_m,
			      farthest_corner(stage, view->origin), stage->least_m, pixels);
}

static void draw_lamp(struct shadow_stage *stage, int index)
{
	struct lamp_state *state = &stage->state[index];
	bool lit = state->last.on && !state->refused;

	for (int face = 0; face < state->count; face++) {
		int layer = state->first + face;
		struct rsm_view view;

		if (lit && state->depth_old) {
			lamp_view(stage, index, face, stage->maps.pixels, MARGIN_TEXELS, &view);
			depth_maps_draw(&stage->maps, layer, &view.layer, stage->mesh);
		}
		if (!stage->rsm || !state->rsm_old)
			continue;
		if (lit) {
			lamp_view(stage, index, face, rsm_pixels(stage->rsm), 0, &view);
			rsm_draw_lamp(stage->rsm, layer, &view, index, stage->mesh);
		} else {
			rsm_clear(stage->rsm, layer);
		}
	}
	if (lit)
		state->depth_old = false;
	state->rsm_old = false;
}

void shadow_draw(struct shadow_stage *stage, bool medium_changed)
{
	stage->block.count[0] = stage->lamp_count;
	glNamedBufferSubData(stage->buffer, 0, sizeof(stage->block), &stage->block);
	glBindBufferBase(GL_UNIFORM_BUFFER, VIEW_BINDING_LAMPS, stage->buffer);
	for (int i = 0; i < stage->lamp_count; i++) {
		if (medium_changed)
			stage->state[i].rsm_old = true;
		draw_lamp(stage, i);
	}
}

void shadow_bind(const struct shadow_stage *stage)
{
	glBindBufferBase(GL_UNIFORM_BUFFER, VIEW_BINDING_LAMPS, stage->buffer);
	glBindBufferBase(GL_UNIFORM_BUFFER, VIEW_BINDING_LAMP_LAYERS, stage->maps.buffer);
	glBindTextureUnit(VIEW_UNIT_LAMP_COMPARE, stage->maps.texture);
	glBindSampler(VIEW_UNIT_LAMP_COMPARE, stage->maps.compare);
	glBindTextureUnit(VIEW_UNIT_LAMP_DEPTH, stage->maps.texture);
	glBindSampler(VIEW_UNIT_LAMP_DEPTH, 0);
}
