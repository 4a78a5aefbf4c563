#include "renderer/trace/path.h"

#include "renderer/scene/environment.h"

/* Pairs of sample dimensions of one vertex; the first pair of all is the pixel's. */
enum path_pair {
	PAIR_CHOOSE,
	PAIR_LAMP,
	PAIR_EMITTER,
	PAIR_SKY,
	PAIR_LOBE,
	PAIR_SURFACE,
	PAIR_WAY,
	PAIRS,
};

#define ROULETTE_FROM 3    /* vertices that a path has before it may end early */
#define ROULETTE_MOST 0.95f
/* A lamp that lies in a surface shines off it: so much of the way to it is not looked at. */
#define LAMP_CLEARANCE 1e-5f

/* Where a path is: on a surface, or in the medium. */
struct vertex {
	struct v3 position;
	struct v3 start;    /* of rays: lifted off the surface */
	struct v3 viewer;   /* unit, back along the path */
	bool in_medium;
	struct bsdf bsdf;   /* of a surface */
};

struct path {
	const struct path_scene *scene;
	const struct sampler *sampler;
	struct vertex at;
	struct v3 throughput;
	int depth;           /* vertices before this one */
	bool from_medium;    /* the first vertex was in the medium */
	struct path_light light;
};

static void pair_of(const struct path *path, enum path_pair pair, float out[2])
{
	sampler_pair(path->sampler, 1 + (uint32_t)path->depth * PAIRS + pair, out);
}

static void gain(struct path *path, struct v3 light)
{
	path->light.total = v3_add(path->light.total, light);
	if (path->depth >= 1 && !path->from_medium)
		path->light.indirect = v3_add(path->light.indirect, light);
}

/* Light of an emitter, which has come so many metres. */
static void gain_from(struct path *path, struct v3 light, float metres)
{
	const float mean = v3_mean(light);

	gain(path, light);
	if (path->depth == 0 && !path->from_medium) {
		path->light.way += mean * metres;
		path->light.way2 += mean * metres * metres;
	}
}

static float power_heuristic(float mine, float other)
{
	/* by the ratio: squares of large densities leave float's range */
	float ratio = other / mine;

	return 1.0f / (1.0f + ratio * ratio);
}

/* What the vertex sends back of light from a direction, with its density. */
static struct v3 scatter(const struct vertex *at, struct v3 light, float *out_pdf)
{
	if (at->in_medium) {
		*out_pdf = 1.0f / (4.0f * TRACE_PI);
		return v3_all(*out_pdf);
	}
	return bsdf_eval(&at->bsdf, at->viewer, light, out_pdf);
}

/* A ray that is none makes the sample one that is not finite, which is counted. */
static bool is_ray(struct path *path, const float from[3], const float along[3])
{
	path->light.rays++;
	if (rays_valid(from, along))
		return true;
	path->light.total.x = NAN;
	return false;
}

static bool open_along(struct path *path, struct v3 direction, float metres)
{
	float from[3], along[3];

	v3_put(path->at.start, from);
	v3_put(direction, along);
	return is_ray(path, from, along) &&
	       !rays_blocked_along(path->scene->world.rays, from, along, metres);
}

static bool open_to(struct path *path, struct v3 target)
{
	return open_along(path, v3_sub(target, path->at.start), 1.0f);
}

/* --- light drawn at a vertex --- */

struct lamp_offer {
	struct lamp_light light;
	struct v3 sent; /* back along the path, unblocked */
	float pdf;      /* with which the surface draws that direction */
};

static struct lamp_offer offer_of(const struct path *path, const struct trace_lamp *lamp,
				  const float u[2])
{
	struct lamp_offer offer = { .light = lamp_light(lamp, path->at.position, u) };

	if (!v3_black(offer.light.irradiance))
		offer.sent = v3_mul(scatter(&path->at, offer.light.direction, &offer.pdf),
				    offer.light.irradiance);
	return offer;
}

static void take_lamp(struct path *path, const struct lamp_offer *offer, float probability)
{
	const struct lamp_light *l = &offer->light;
	float weight = 1.0f / probability;

	if (v3_black(offer->sent))
		return;
	if (l->pdf > 0.0f)
		weight *= power_heuristic(l->pdf * probability, offer->pdf);
	if (!open_along(path, l->direction,
			isfinite(l->distance) ? l->distance * (1.0f - LAMP_CLEARANCE) : INFINITY))
		return;
	weight *= medium_passes(&path->scene->medium, path->at.position, l->direction, l->distance);
	gain(path, v3_scale(v3_mul(path->throughput, offer->sent), weight));
}

/* Of the points one by what it would send, unblocked; of those with an extent any. */
static void from_lamps(struct path *path, float choose)
{
	const struct lamps *lamps = &path->scene->lamps;
	struct lamp_offer offers[SCENE_MAX_LAMPS];
	float sum = 0.0f, weights[SCENE_MAX_LAMPS], u[2];

	if (lamps->extended > 0) {
		float place = choose * (float)lamps->extended;
		int index = (int)place < lamps->extended ? (int)place : lamps->extended - 1;
		struct lamp_offer offer;

		pair_of(path, PAIR_LAMP, u);
		offer = offer_of(path, &lamps->lamps[index], u);
		take_lamp(path, &offer, 1.0f / (float)lamps->extended);
	}
	for (int i = lamps->extended; i < lamps->count; i++) {
		offers[i] = offer_of(path, &lamps->lamps[i], NULL);
		weights[i] = v3_mean(offers[i].sent);
		sum += weights[i];
	}
	choose *= sum;
	for (int i = lamps->extended; i < lamps->count && sum > 0.0f; i++) {
		choose -= weights[i];
		if (weights[i] > 0.0f && (choose < 0.0f || i == lamps->count - 1)) {
			take_lamp(path, &offers[i], weights[i] / sum);
			return;
		}
	}
}

static void from_emitters(struct path *path, float choose)
{
	const struct path_scene *scene = path->scene;
	struct emitter_light light;
	struct v3 sent;
	float u[2], pdf;

	pair_of(path, PAIR_EMITTER, u);
	if (!emitters_sample(&scene->emitters, &scene->world, path->at.position, choose, u, &light))
		return;
	sent = scatter(&path->at, light.direction, &pdf);
	if (v3_black(sent) || !open_to(path, light.target))
		return;
	sent = v3_mul(v3_mul(path->throughput, sent), light.radiance);
	sent = v3_scale(sent, power_heuristic(light.pdf, pdf) / light.pdf *
				      medium_passes(&scene->medium, path->at.position, light.direction,
						    light.distance));
	gain_from(path, sent, light.distance);
}

static void from_sky(struct path *path)
{
	const struct path_scene *scene = path->scene;
	const struct environment *sky = scene->world.scene->environment;
	float u[2], along[3], radiance[3], pdf, sky_pdf;
	struct v3 direction, sent;

	pair_of(path, PAIR_SKY, u);
	sky_pdf = environment_sample(sky, (double)u[0], (double)u[1], along, radiance);
	direction = v3_of(along);
	sent = v3_mul(scatter(&path->at, direction, &pdf), v3_of(radiance));
	if (v3_black(sent) || !open_along(path, direction, INFINITY))
		return;
	gain(path, v3_scale(v3_mul(path->throughput, sent),
			    power_heuristic(sky_pdf, pdf) / sky_pdf *
				    medium_passes(&scene->medium, path->at.position, direction,
						  INFINITY)));
}

static void draw_lights(struct path *path)
{
	float choose[2];

	if (!path->at.in_medium && bsdf_is_mirror(&path->at.bsdf))
		return;
	pair_of(path, PAIR_CHOOSE, choose);
	if (path->scene->lamps.count > 0)
		from_lamps(path, choose[0]);
	if (path->scene->emitters.count > 0)
		from_emitters(path, choose[1]);
	if (path->scene->world.scene->environment)
		from_sky(path);
}

/* --- light met by a direction that the surface drew --- */

/* pdf: of that direction; 0 where nothing else finds it. */
static float met_weight(float pdf, float light_pdf)
{
	return pdf > 0.0f && light_pdf > 0.0f ? power_heuristic(pdf, light_pdf) : 1.0f;
}

static void meet_lamps(struct path *path, struct v3 direction, float distance, float pdf)
{
	const struct lamps *lamps = &path->scene->lamps;

	for (int i = 0; i < lamps->extended; i++) {
		struct v3 radiance;
		float light_pdf;

		if (lamp_met(&lamps->lamps[i], path->at.position, direction, distance, &radiance,
			     &light_pdf))
			gain(path, v3_scale(v3_mul(path->throughput, radiance),
					    met_weight(pdf, light_pdf / (float)lamps->extended)));
	}
}

static void meet_emitter(struct path *path, const struct surface_hit *hit, float distance,
			 struct v3 direction, float pdf)
{
	float cosine = -v3_dot(hit->facing, direction);

	if (v3_black(hit->emission))
		return;
	gain_from(path, v3_scale(v3_mul(path->throughput, hit->emission),
				 met_weight(pdf, emitters_pdf(&path->scene->emitters, hit->triangle,
							      distance, cosine))),
		  distance);
}

static struct v3 sky_radiance(const struct environment *sky, struct v3 direction)
{
	float along[3], radiance[3];

	v3_put(direction, along);
	environment_radiance(sky, along, radiance);
	return v3_of(radiance);
}

static void meet_sky(struct path *path, struct v3 direction, float pdf)
{
	const struct environment *sky = path->scene->world.scene->environment;
	float along[3];

	if (!sky)
		return;
	v3_put(direction, along);
	gain(path, v3_scale(v3_mul(path->throughput, sky_radiance(sky, direction)),
			    met_weight(pdf, environment_pdf(sky, along))));
}

/* --- the way from vertex to vertex --- */

/* Where the medium scatters a ray, or INFINITY; what it absorbs is taken from the path. */
static float scattered_at(struct path *path, float u, float metres)
{
	const struct medium *m = &path->scene->medium;
	float t;

	if (m->extinction == 0.0f)
		return INFINITY;
	if (m->albedo == 0.0f) { /* nothing to be drawn */
		path->throughput = v3_scale(path->throughput, expf(-m->extinction * metres));
		return INFINITY;
	}
	t = -log1pf(-u) / m->extinction;
	if (t >= metres)
		return INFINITY;
	path->throughput = v3_scale(path->throughput, m->albedo);
	return t;
}

static void enter_medium(struct path *path, struct v3 direction, float way)
{
	path->at.in_medium = true;
	path->at.position = path->at.start = v3_ahead(path->at.start, direction, way);
	path->at.viewer = v3_scale(direction, -1.0f);
}

static bool reaches(const struct path *path, struct v3 point)
{
	float from[3], to[3];

	v3_put(path->at.start, from);
	v3_put(point, to);
	return !rays_blocked(path->scene->world.rays, from, to);
}

/*
 * Where rays from a hit start. At the edge where two walls meet rounding may put a
 * point of the one beyond the other, and rays from there would be outside. What
 * came here passed no wall, so neither may the way to where they start: a little
 * back on it when need be. false: there is no such place.
 */
static bool lift_off(const struct path *path, const struct surface_hit *hit, struct v3 direction,
		     struct v3 *out_start)
{
	*out_start = v3_ahead(hit->position, hit->facing, hit->lift);
	if (!world_at_edge(&path->scene->world, hit) || reaches(path, *out_start))
		return true;
	*out_start = v3_ahead(hit->position, direction, -4.0f * hit->lift);
	return reaches(path, *out_start);
}

static bool enter_surface(struct path *path, const struct surface_hit *hit, struct v3 direction)
{
	struct v3 start;

	if (hit->dark || !lift_off(path, hit, direction, &start))
		return false;
	path->at.in_medium = false;
	path->at.position = hit->position;
	path->at.start = start;
	path->at.viewer = v3_scale(direction, -1.0f);
	world_bsdf(&path->scene->world, hit, path->at.viewer, &path->at.bsdf);
	return true;
}

/* Whether the medium scatters the ray before it has gone so many metres, or through; then it is there. */
static bool scattered(struct path *path, struct v3 direction, float metres, float u, float *out_way)
{
	const struct medium *medium = &path->scene->medium;

	*out_way = metres;
	if (medium->extinction == 0.0f)
		return false;
	if (!isfinite(metres))
		metres = medium_exit(medium, path->at.position, direction);
	*out_way = scattered_at(path, u, metres);
	return isfinite(*out_way);
}

/*
 * Follows a ray to the next vertex and takes the light that it meets.
 * pdf: as met_weight. false: the path ends.
 */
static bool travel(struct path *path, struct v3 direction, float pdf)
{
	const struct path_scene *scene = path->scene;
	struct surface_hit at;
	struct ray_hit hit;
	float from[3], along[3], u[2] = { 0.0f, 0.0f }, distance, way;
	bool met;

	v3_put(path->at.start, from);
	v3_put(direction, along);
	if (!is_ray(path, from, along))
		return false;
	met = rays_nearest_front(scene->world.rays, from, along, INFINITY, &hit);
	distance = met ? hit.distance : INFINITY;
	if (scene->medium.extinction > 0.0f)
		pair_of(path, PAIR_WAY, u);
	if (scattered(path, direction, distance, u[0], &way)) {
		meet_lamps(path, direction, way, pdf);
		enter_medium(path, direction, way);
		return true;
	}
	meet_lamps(path, direction, distance, pdf);
	if (!met) {
		meet_sky(path, direction, pdf);
		return false;
	}
	world_hit(&scene->world, &hit, direction, &at);
	meet_emitter(path, &at, distance, direction, pdf);
	return enter_surface(path, &at, direction);
}

/* A direction from the vertex; false: the path ends. */
static bool turn(struct path *path, struct v3 *out_direction, float *out_pdf)
{
	struct v3 weight;
	float u[2], choose[2];

	pair_of(path, PAIR_SURFACE, u);
	if (path->at.in_medium) {
		float z = 1.0f - 2.0f * u[0], r = sqrtf(larger_of(1.0f - z * z, 0.0f));
		float phi = 2.0f * TRACE_PI * u[1];

		*out_direction = (struct v3){ r * cosf(phi), r * sinf(phi), z };
		*out_pdf = 1.0f / (4.0f * TRACE_PI);
		return true;
	}
	choose[0] = 0.0f;
	if (path->at.bsdf.lambert > 0.0f && path->at.bsdf.lambert < 1.0f)
		pair_of(path, PAIR_LOBE, choose);
	if (!bsdf_sample(&path->at.bsdf, path->at.viewer, choose[0], u, out_direction, &weight, out_pdf))
		return false;
	path->throughput = v3_mul(path->throughput, weight);
	return true;
}

static bool survives(struct path *path)
{
	float keep = smaller_of(v3_most(path->throughput), ROULETTE_MOST), u[2];

	if (path->depth < ROULETTE_FROM)
		return true;
	pair_of(path, PAIR_WAY, u);
	if (u[1] >= keep)
		return false;
	path->throughput = v3_scale(path->throughput, 1.0f / keep);
	return true;
}

static void follow(struct path *path)
{
	for (;;) {
		struct v3 direction;
		float pdf;

		draw_lights(path);
		if (!turn(path, &direction, &pdf) || !survives(path))
			return;
		if (!travel(path, direction, pdf) || path->depth >= path->scene->max_bounces)
			return;
		path->depth++;
	}
}

/* What the eye sees where nothing is. The background is a backdrop: the medium does not dim it. */
static struct v3 backdrop(const struct path *path, struct v3 direction)
{
	const struct environment *sky = path->scene->world.scene->environment;

	return sky ? v3_mul(path->throughput, sky_radiance(sky, direction)) : path->scene->background;
}

/* What the eye meets first is no bounce: emission counts in full. */
static bool leave_eye(struct path *path, struct v3 direction)
{
	const struct path_scene *scene = path->scene;
	struct surface_hit at;
	struct ray_hit hit;
	float from[3], along[3], u[2] = { 0.0f, 0.0f }, way;
	bool met;

	v3_put(path->at.start, from);
	v3_put(direction, along);
	if (!is_ray(path, from, along))
		return false;
	met = rays_nearest_drawn(scene->world.rays, from, along, INFINITY, &hit);
	if (scene->medium.extinction > 0.0f)
		pair_of(path, PAIR_WAY, u);
	path->from_medium = scattered(path, direction, met ? hit.distance : INFINITY, u[1], &way);
	if (!met && (!path->from_medium || !scene->world.scene->environment))
		path->light.total = v3_add(path->light.total, backdrop(path, direction));
	if (path->from_medium) {
		enter_medium(path, direction, way);
		return true;
	}
	if (!met)
		return false;
	world_hit(&scene->world, &hit, direction, &at);
	path->light.total = v3_add(path->light.total, v3_mul(path->throughput, at.emission));
	return enter_surface(path, &at, direction);
}

struct path_light path_from_eye(const struct path_scene *scene, const struct sampler *sampler,
				struct v3 eye, struct v3 direction)
{
	struct path path = { .scene = scene, .sampler = sampler, .throughput = { 1, 1, 1 } };

	path.at.position = path.at.start = eye;
	if (leave_eye(&path, direction))
		follow(&path);
	return path.light;
}

struct path_light path_irradiance(const struct path_scene *scene, const struct sampler *sampler,
				  struct v3 position, struct v3 normal)
{
	struct path path = { .scene = scene, .sampler = sampler, .throughput = { 1, 1, 1 } };

	/* A white Lambert surface sends E/pi back. */
	path.at.position = position;
	path.at.start = v3_ahead(position, normal, scene->world.lift);
	path.at.viewer = normal;
	bsdf_lambert(&path.at.bsdf, v3_all(1.0f), normal);
	follow(&path);
	path.light.total = v3_scale(path.light.total, TRACE_PI);
	path.light.indirect = v3_scale(path.light.indirect, TRACE_PI);
	path.light.way *= TRACE_PI;
	path.light.way2 *= TRACE_PI;
	return path.light;
}
