#include "renderer/gi/surfels_private.h"

#include "base/log.h"
#include "base/result.h"
#include "renderer/gl/program.h"

#include <epoxy/gl.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct surfels *surfels_of(struct gi_method *method)
{
	return (struct surfels *)method;
}

static const struct surfels *surfels_of_const(const struct gi_method *method)
{
	return (const struct surfels *)method;
}

/* Buffers are written as storage and read as textures, copied, uploaded and read back. */
void surfels_barrier(void)
{
	glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
			GL_BUFFER_UPDATE_BARRIER_BIT);
}

static void bind_storage(enum surfels_binding at, const struct surfels_buffer *b)
{
	glBindBufferBase(GL_SHADER_STORAGE_BUFFER, at, b->buffer);
}

void surfels_dispatch(unsigned program, struct surfels_run run)
{
	struct dispatch groups;

	if (run.first >= run.last ||
	    dispatch_plan(run.last - run.first, SURFELS_GROUP, &groups) != GR_OK)
		return;
	glUseProgram(program);
	glProgramUniform2ui(program, 0, run.first, run.last);
	glDispatchCompute(groups.x, groups.y, 1);
}

/* The same where a program sees `part` surfels' entries of a buffer at once; uniform 1: their first. */
static void dispatch_parts(unsigned program, struct surfels_run run, const struct surfels_buffer *entries,
			   size_t bytes_each, uint32_t part, size_t count)
{
	glBindTextureUnit(SURFELS_UNIT_PARTS, entries->texture);
	for (uint32_t base = run.first / part * part; base < run.last; base += part) {
		struct surfels_run now = { run.first > base ? run.first : base,
					   run.last - base > part ? base + part : run.last };
		size_t padded = (count + SURFELS_GROUP - 1) / SURFELS_GROUP * SURFELS_GROUP;
		size_t here = padded - base < part ? padded - base : part;

		if (part < padded)
			glTextureBufferRange(entries->texture, GL_RGBA32UI, entries->buffer,
					     (GLintptr)(base * bytes_each), (GLsizeiptr)(here * bytes_each));
		glProgramUniform1ui(program, 1, base);
		surfels_dispatch(program, now);
	}
}

static void bind_passes(struct surfels *s)
{
	glBindBufferBase(GL_UNIFORM_BUFFER, SURFELS_BINDING_BLOCK, s->block);
	bind_storage(SURFELS_BINDING_FOUND, &s->found);
	bind_storage(SURFELS_BINDING_DIRECT, &s->direct);
	glBindTextureUnit(SURFELS_UNIT_ALBEDO, s->albedo.texture);
	glBindTextureUnit(SURFELS_UNIT_EMISSIVE, s->emissive.texture);
}

void surfels_relight(struct surfels *s, struct surfels_run run, bool lamps)
{
	bind_passes(s);
	bind_storage(SURFELS_BINDING_RADIOSITY, &s->radiosity[s->current]);
	glBindTextureUnit(SURFELS_UNIT_FOUND, s->found.texture);
	surfels_barrier();
	if (lamps && s->light)
		dispatch_parts(s->light, run, &s->taps, s->taps_each * sizeof(struct surfel_tap),
			       s->taps_part, s->count);
	else
		surfels_dispatch(s->dark_light, run);
	surfels_barrier();
}

void surfels_gather(struct surfels *s, struct surfels_run run)
{
	float sigma = s->absorption + s->scattering;
	unsigned program = sigma > 0 ? s->gather_medium : s->gather;

	bind_passes(s);
	glBindTextureUnit(SURFELS_UNIT_RADIOSITY, s->radiosity[s->current].texture);
	glBindTextureUnit(SURFELS_UNIT_TEXELS, s->texels.texture);
	glBindTextureUnit(SURFELS_UNIT_DIRECT, s->direct.texture);
	glBindTextureUnit(SURFELS_UNIT_OTHER, s->other.texture);
	bind_storage(SURFELS_BINDING_RADIOSITY, &s->radiosity[!s->current]);
	if (sigma > 0)
		/* what nothing gets through is a number that stays finite times any distance */
		glProgramUniform1f(program, 2, sigma < 1 ? log2f(1 - sigma) : -1e6f);
	dispatch_parts(program, run, &s->links, surfels_link_texels(s->links_each) * 16, s->links_part,
		       s->count);
	surfels_barrier();
	s->current = !s->current;
}

/* From darkness to the steady state, all surfels. */
static void restart(struct surfels *s, bool lamps)
{
	const struct surfels_run all = { 0, (uint32_t)s->count };

	glCopyNamedBufferSubData(s->other.buffer, s->found.buffer, 0, 0,
				 (GLsizeiptr)(s->count * 4 * sizeof(float)));
	surfels_relight(s, all, lamps);
	for (int i = 0; i < s->settle_gathers; i++)
		surfels_gather(s, all);
	s->lit = true;
	s->since_change = s->settle_gathers;
	s->stats.steps = s->settle_gathers;
}

static int gathers(const struct surfels *s, const struct render_frame *frame)
{
	return frame->gi_gathers > 0 ? frame->gi_gathers : s->params.gathers;
}

/* This node does it all: as many gathers as asked for, until the change has settled. */
static bool update_all(struct surfels *s, int count, bool changed, bool lamps)
{
	const struct surfels_run all = { 0, (uint32_t)s->count };

	if (changed || !s->lit) {
		surfels_relight(s, all, lamps);
		s->since_change = 0;
	} else if (s->since_change >= s->settle_gathers) {
		return false;
	}
	s->lit = true;
	for (int i = 0; i < count; i++)
		surfels_gather(s, all);
	s->since_change += count;
	s->stats.steps = count;
	surfels_smooth(s);
	surfels_check_begin(s, all);
	surfels_probes_gather(s);
	surfels_check_end(s);
	return true;
}

/*
 * This node does its slice. A bounce crosses to another slice once a frame, so
 * frames are counted here and not gathers.
 */
static bool update_slice(struct surfels *s, int count, bool changed, bool lamps)
{
	const struct surfels_run own = surfels_share_run(s, s->share.index);
	bool arrived = surfels_share_apply(s);

	if (changed || !s->lit)
		s->since_change = 0;
	/* also a slice that comes late is gathered: what it changes here decides when work ends */
	bool works = arrived || s->since_change < s->settle_gathers;

	if (!works)
		return false;
	if (arrived) {
		surfels_smooth(s);
		surfels_probes_gather(s);
	} else {
		/* the last frame's gathers have written over this node's slice */
		surfels_share_restore(s);
	}
	if (changed || !s->lit)
		surfels_relight(s, own, lamps);
	s->lit = true;
	for (int i = 0; i < count; i++)
		surfels_gather(s, own);
	surfels_check_begin(s, own);
	surfels_check_end(s);
	surfels_share_pack(s);
	s->since_change++;
	s->stats.steps = count;
	return true;
}

static int update(struct gi_method *method, const struct render_frame *frame,
		  const struct gi_light *light)
{
	struct surfels *s = surfels_of(method);
	bool again = !s->started || frame->gi_epoch != s->epoch;
	bool changed = again || light->version != s->version ||
		       frame->absorption_per_m != s->absorption ||
		       frame->scattering_per_m != s->scattering;
	bool ran = true;

	surfels_check_collect(s);
	s->stats.ran = false;
	s->stats.steps = 0;
	if (!frame->gi_on)
		return GR_NOTHING;
	s->absorption = frame->absorption_per_m;
	s->scattering = frame->scattering_per_m;
	s->epoch = frame->gi_epoch;
	s->version = light->version;
	surfels_air_apply(s);
	if (again) {
		restart(s, light->lamps);
		surfels_check_begin(s, (struct surfels_run){ 0, (uint32_t)s->count });
		if (s->share.count > 1 || s->share.other_slices)
			surfels_share_recut(s);
		surfels_smooth(s);
		surfels_probes_gather(s);
		surfels_check_end(s);
	} else {
		if (s->share.other_slices) {
			surfels_share_recut(s);
			surfels_smooth(s);
		}
		ran = s->share.count > 1 ?
			      update_slice(s, gathers(s, frame), changed, light->lamps) :
			      update_all(s, gathers(s, frame), changed, light->lamps);
	}
	s->started = true;
	s->stats.ran = ran;
	s->stats.steady = s->since_change >= s->settle_gathers;
	return ran ? GR_OK : GR_NOTHING;
}

static void bind(const struct gi_method *method)
{
	const struct surfels *s = surfels_of_const(method);

	if (s->params.probes) {
		surfels_probes_bind(s);
		return;
	}
	glBindBufferBase(GL_UNIFORM_BUFFER, SURFELS_BINDING_BLOCK, s->block);
	glBindTextureUnit(SURFELS_UNIT_SURFELS, s->texels.texture);
	glBindTextureUnit(SURFELS_UNIT_LIGHT, s->shown.texture);
	glBindTextureUnit(SURFELS_UNIT_FIRST, s->first.texture);
	glBindTextureUnit(SURFELS_UNIT_MEMBERS, s->members.texture);
	glBindTextureUnit(SURFELS_UNIT_KEYS, s->keys.texture);
}

static const char *describe(const struct gi_method *method)
{
	return surfels_of_const(method)->description;
}

static void stats(const struct gi_method *method, struct gi_stats *out)
{
	*out = surfels_of_const(method)->stats;
}

uint64_t surfels_hash_buffer(unsigned buffer, size_t bytes, uint64_t before)
{
	unsigned char key[crypto_shorthash_KEYBYTES] = "surfels", digest[crypto_shorthash_BYTES];
	unsigned char *data = malloc(bytes ? bytes : 1);
	uint64_t value = 0;

	if (!data)
		return 0;
	memcpy(key + 8, &before, sizeof before);
	glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	glGetNamedBufferSubData(buffer, 0, (GLsizeiptr)bytes, data);
	crypto_shorthash(digest, data, bytes, key);
	for (int i = 0; i < 8; i++)
		value |= (uint64_t)digest[i] << (8 * i);
	free(data);
	return value;
}

/* What shading reads and what the next gather reads; shared: the bytes that both come from. */
static uint64_t hash(const struct gi_method *method)
{
	const struct surfels *s = surfels_of_const(method);
	size_t bytes = s->count * 4 * sizeof(float);

	if (s->share.count > 1)
		return surfels_share_hash(s);
	return surfels_hash_buffer(s->radiosity[s->current].buffer, bytes,
				   surfels_hash_buffer(s->found.buffer, bytes, 0));
}

static void destroy(struct gi_method *method)
{
	struct surfels *s = surfels_of(method);

	surfels_probes_finish(s);
	surfels_share_finish(s);
	surfels_check_finish(s);
	surfels_air_finish(s);
	surfels_smooth_finish(s);
	surfels_upload_finish(s);
	program_destroy(&s->light);
	program_destroy(&s->dark_light);
	program_destroy(&s->gather);
	program_destroy(&s->gather_medium);
	free(s);
}

static const struct gi_method_ops surfels_ops = {
	.name = "surfels",
	.needs = GI_NEEDS_LAMPS,
	.share = &surfels_share_ops,
	.describe = describe,
	.update = update,
	.bind = bind,
	.shader_name = "gi_surfels.glsl",
	.stats = stats,
	.hash = hash,
	.destroy = destroy,
};

static const struct gi_method_ops probes_ops = {
	.name = "probes",
	.needs = GI_NEEDS_LAMPS,
	.share = &surfels_share_ops,
	.describe = describe,
	.update = update,
	.bind = bind,
	.shader_name = "gi_probes.glsl",
	.stats = stats,
	.hash = hash,
	.destroy = destroy,
};

static int create_programs(struct surfels *s)
{
	int result = program_create_compute(&s->dark_light, "surfel_light.comp", NULL);

	if (result == GR_OK && s->params.lamps)
		result = program_create_compute(&s->light, "surfel_light.comp", "#define LAMPS\n");
	if (result == GR_OK)
		result = program_create_compute(&s->gather, "surfel_gather.comp", NULL);
	if (result == GR_OK)
		result = program_create_compute(&s->gather_medium, "surfel_gather.comp",
						"#define MEDIUM\n");
	return result;
}

static void say(struct surfels *s, const struct surfel_set *set)
{
	int at = snprintf(s->description, sizeof s->description,
			  "%zu surfels %.3g m apart, %u links and %u taps of direct light each, %d "
			  "gather%s a frame, %d until a change has settled; %.1f MiB on the GPU",
			  set->count, (double)set->spacing_m, set->links_each, set->taps_each,
			  s->params.gathers, s->params.gathers == 1 ? "" : "s", s->settle_gathers,
			  (double)s->bytes / (1 << 20));

	if (at < 0 || (size_t)at >= sizeof s->description)
		return;
	if (s->params.probes)
		snprintf(s->description + at, sizeof s->description - (size_t)at,
			 "; %d x %d x %d probes %.3g m apart, %u links each, light all surfaces",
			 set->probes.size[0], set->probes.size[1], set->probes.size[2],
			 (double)set->probes.cell_m, set->probes.links_each);
	else
		snprintf(s->description + at, sizeof s->description - (size_t)at,
			 "; no probes are fed, nothing moves that they would light");
}

int gi_surfels_create(struct gi_method **out, const struct surfel_set *set,
		      const struct surfels_params *params)
{
	struct surfels *s;
	int result;

	*out = NULL;
	if (set->count == 0 || set->count > INT32_MAX / 4 || set->links_each == 0 ||
	    set->taps_each == 0 || params->gathers < 1 || (params->probes && set->probes.count == 0)) {
		gr_error("surfels: %zu surfels of %u links and %u taps, %d gathers, %zu probes cannot be used",
			 set->count, set->links_each, set->taps_each, params->gathers,
			 set->probes.count);
		return GR_ERR_RANGE;
	}
	s = calloc(1, sizeof *s);
	if (!s)
		return GR_ERR_NOMEM;
	s->base.ops = params->probes ? &probes_ops : &surfels_ops;
	s->params = *params;
	s->count = set->count;
	s->links_each = set->links_each;
	s->taps_each = set->taps_each;
	s->share.count = 1;
	result = surfels_upload(s, set);
	if (result == GR_OK)
		result = create_programs(s);
	if (result == GR_OK)
		result = surfels_air_init(s, set);
	if (result == GR_OK)
		result = surfels_smooth_init(s, set);
	if (result == GR_OK)
		result = surfels_check_init(s);
	if (result == GR_OK)
		result = surfels_share_init(s, set);
	if (result == GR_OK && params->probes)
		result = surfels_probes_init(s, set);
	if (result == GR_OK && glGetError() != GL_NO_ERROR) {
		gr_error("surfels: the GPU's memory does not hold %zu surfels (%zu bytes)", s->count,
			 s->bytes);
		result = GR_ERR_GL;
	}
	if (result != GR_OK) {
		destroy(&s->base);
		return result;
	}
	say(s, set);
	*out = &s->base;
	return GR_OK;
}
