#include "renderer/trace/rays.h"

#include "base/log.h"
#include "base/result.h"

#include <embree3/rtcore.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct rays {
	RTCDevice device;
	RTCScene scene;
	uint8_t *one_sided; /* per triangle */
};

/* What a query's filter is handed: Embree passes on the pointer to its first member. */
struct query {
	struct RTCIntersectContext context;
	const struct rays *rays;
};

static void on_error(void *user, enum RTCError code, const char *text)
{
	(void)user;
	gr_error("embree: error %d: %s", (int)code, text ? text : "");
}

/* Copies positions and triangles into buffers that Embree owns. */
static int add_mesh(struct rays *rays, const struct scene *scene)
{
	RTCGeometry mesh = rtcNewGeometry(rays->device, RTC_GEOMETRY_TYPE_TRIANGLE);
	size_t triangles = scene->index_count / 3;
	float *positions = NULL;
	uint32_t *indices = NULL;

	if (!mesh)
		return GR_ERR_NOMEM;
	positions = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
					    3 * sizeof(float), scene->vertex_count);
	indices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
					  3 * sizeof(uint32_t), triangles);
	if (!positions || !indices) {
		rtcReleaseGeometry(mesh);
		return GR_ERR_NOMEM;
	}
	for (size_t i = 0; i < scene->vertex_count; i++)
		memcpy(positions + 3 * i, scene->vertices[i].position, 3 * sizeof(float));
	memcpy(indices, scene->indices, 3 * triangles * sizeof(uint32_t));
	rtcCommitGeometry(mesh);
	rtcAttachGeometry(rays->scene, mesh);
	rtcReleaseGeometry(mesh);
	return GR_OK;
}

static int note_sides(struct rays *rays, const struct scene *scene)
{
	size_t triangles = scene->index_count / 3;

	rays->one_sided = calloc(triangles ? triangles : 1, 1);
	if (!rays->one_sided)
		return GR_ERR_NOMEM;
	for (size_t d = 0; d < scene->draw_count; d++) {
		const struct scene_draw *draw = &scene->draws[d];

		if (!scene->materials[draw->material].two_sided)
			memset(rays->one_sided + draw->first_index / 3, 1, draw->index_count / 3);
	}
	return GR_OK;
}

int rays_create(struct rays **out, const struct scene *scene)
{
	/* One thread: nodes share a machine in the demo, and builds are short. */
	return rays_create_threads(out, scene, 1);
}

int rays_create_threads(struct rays **out, const struct scene *scene, int threads)
{
	struct rays *rays = calloc(1, sizeof *rays);
	int result = GR_ERR_NOMEM;
	char settings[64];

	*out = NULL;
	if (!rays)
		return result;
	if (note_sides(rays, scene) != GR_OK)
		goto fail;
	snprintf(settings, sizeof settings, "threads=%d,set_affinity=0", threads);
	rays->device = rtcNewDevice(settings);
	if (!rays->device) {
		gr_error("embree: no device (error %d)", (int)rtcGetDeviceError(NULL));
		result = GR_ERR_UNSUPPORTED;
		goto fail;
	}
	rtcSetDeviceErrorFunction(rays->device, on_error, NULL);
	rays->scene = rtcNewScene(rays->device);
	if (!rays->scene)
		goto fail;
	/* Watertight: a ray may not slip between two triangles that share an edge. */
	rtcSetSceneFlags(rays->scene,
			 RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
	if (scene->index_count >= 3) {
		result = add_mesh(rays, scene);
		if (result != GR_OK)
			goto fail;
	}
	rtcCommitScene(rays->scene);
	if (rtcGetDeviceError(rays->device) != RTC_ERROR_NONE) {
		result = GR_ERR_NOMEM;
		goto fail;
	}
	*out = rays;
	return GR_OK;
fail:
	rays_destroy(&rays);
	return result;
}

void rays_destroy(struct rays **rays)
{
	if (!*rays)
		return;
	if ((*rays)->scene)
		rtcReleaseScene((*rays)->scene);
	if ((*rays)->device)
		rtcReleaseDevice((*rays)->device);
	free((*rays)->one_sided);
	free(*rays);
	*rays = NULL;
}

/* false: not a ray that Embree may be given; builds of it with assertions end the process. */
static bool start(struct RTCRay *ray, const float origin[3], const float direction[3],
		  float max_distance)
{
	if (!rays_valid(origin, direction) || !(max_distance >= 0.0f))
		return false;
	*ray = (struct RTCRay){
		.org_x = origin[0],
		.org_y = origin[1],
		.org_z = origin[2],
		.dir_x = direction[0],
		.dir_y = direction[1],
		.dir_z = direction[2],
		.tfar = max_distance,
		.mask = ~0u,
	};
	return true;
}

static bool nearest(const struct rays *rays, struct RTCIntersectContext *context,
		    const float origin[3], const float direction[3], float max_distance,
		    struct ray_hit *out)
{
	struct RTCRayHit q;
	float scale, length, n[3];

	if (!start(&q.ray, origin, direction, max_distance))
		return false;
	q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
	q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
	rtcIntersect1(rays->scene, context, &q);
	if (q.hit.geomID == RTC_INVALID_GEOMETRY_ID)
		return false;
	out->distance = q.ray.tfar;
	out->triangle = q.hit.primID;
	out->u = q.hit.u;
	out->v = q.hit.v;
	/* Embree 3: Ng = (v1-v0) x (v2-v0), which is the front of a counter-clockwise triangle.
	 * Scaled first: the square of a small triangle's normal is below what a float holds. */
	scale = 1.0f / fmaxf(fabsf(q.hit.Ng_x), fmaxf(fabsf(q.hit.Ng_y), fabsf(q.hit.Ng_z)));
	n[0] = q.hit.Ng_x * scale;
	n[1] = q.hit.Ng_y * scale;
	n[2] = q.hit.Ng_z * scale;
	length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	for (int i = 0; i < 3; i++)
		out->normal[i] = n[i] / length;
	return true;
}

bool rays_nearest(const struct rays *rays, const float origin[3], const float direction[3],
		  float max_distance, struct ray_hit *out)
{
	struct RTCIntersectContext context;

	rtcInitIntersectContext(&context);
	return nearest(rays, &context, origin, direction, max_distance, out);
}

/* Takes back a hit on the back of a one-sided triangle. */
static void only_drawn(const struct RTCFilterFunctionNArguments *arguments)
{
	const struct query *query = (const struct query *)arguments->context;
	const struct RTCRay *ray = (const struct RTCRay *)arguments->ray;
	const struct RTCHit *hit = (const struct RTCHit *)arguments->hit;
	float along = hit->Ng_x * ray->dir_x + hit->Ng_y * ray->dir_y + hit->Ng_z * ray->dir_z;

	if (along > 0.0f && query->rays->one_sided[hit->primID])
		arguments->valid[0] = 0;
}

bool rays_nearest_drawn(const struct rays *rays, const float origin[3], const float direction[3],
			float max_distance, struct ray_hit *out)
{
	struct query query = { .rays = rays };

	rtcInitIntersectContext(&query.context);
	query.context.filter = only_drawn;
	return nearest(rays, &query.context, origin, direction, max_distance, out);
}

/* How far behind the back of a face one that coincides with it may be found. */
static float slack(const float origin[3], const float direction[3], float distance)
{
	float widest = 0.0f;

	for (int i = 0; i < 3; i++)
		widest = fmaxf(widest, fmaxf(fabsf(origin[i]),
					     fabsf(origin[i] + distance * direction[i])));
	return RAYS_ROUNDINGS * FLT_EPSILON * widest;
}

bool rays_nearest_front(const struct rays *rays, const float origin[3], const float direction[3],
			float max_distance, struct ray_hit *out)
{
	struct ray_hit other;
	float along = 0.0f;

	if (!rays_nearest(rays, origin, direction, max_distance, out))
		return false;
	for (int i = 0; i < 3; i++)
		along += out->normal[i] * direction[i];
	if (along > 0.0f && rays->one_sided[out->triangle] &&
	    rays_nearest_drawn(rays, origin, direction,
			       out->distance + slack(origin, direction, out->distance), &other))
		*out = other;
	return true;
}

static void look_behind(const struct rays *rays, const struct ray_start *start, struct ray_met *met)
{
	struct ray_hit other;
	float along = 0.0f;

	if (!rays_nearest_drawn(rays, start->origin, start->direction,
				met->distance + slack(start->origin, start->direction, met->distance),
				&other))
		return;
	for (int i = 0; i < 3; i++)
		along += other.normal[i] * start->direction[i];
	*met = (struct ray_met){ other.distance, other.triangle, other.u, other.v, along > 0.0f };
}

static bool shows_back(const struct RTCRayHit *q)
{
	return q->hit.Ng_x * q->ray.dir_x + q->hit.Ng_y * q->ray.dir_y +
		       q->hit.Ng_z * q->ray.dir_z >
	       0;
}

#define AT_ONCE 64

/*
 * All are written before the first is traced: Embree reads four floats at a time,
 * and waits for a ray whose floats have only just been written one by one.
 */
static void nearest_some(const struct rays *rays, size_t count, const struct ray_start *starts,
			 struct ray_met *out)
{
	struct RTCRayHit q[AT_ONCE];
	struct RTCIntersectContext context;

	rtcInitIntersectContext(&context);
	for (size_t k = 0; k < count; k++) {
		if (!start(&q[k].ray, starts[k].origin, starts[k].direction, INFINITY))
			q[k].ray = (struct RTCRay){ .tfar = -1 };
		q[k].hit.geomID = RTC_INVALID_GEOMETRY_ID;
		q[k].hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
	}
	for (size_t k = 0; k < count; k++)
		if (q[k].ray.tfar >= 0)
			rtcIntersect1(rays->scene, &context, &q[k]);
	for (size_t k = 0; k < count; k++) {
		const struct RTCRayHit *r = &q[k];
		bool met = r->hit.geomID != RTC_INVALID_GEOMETRY_ID;

		out[k].distance = met ? r->ray.tfar : INFINITY;
		out[k].triangle = met ? r->hit.primID : RAYS_NONE;
		out[k].u = r->hit.u;
		out[k].v = r->hit.v;
		out[k].back = met && shows_back(r);
	}
	for (size_t k = 0; k < count; k++)
		if (out[k].back && rays->one_sided[out[k].triangle])
			look_behind(rays, &starts[k], &out[k]);
}

void rays_nearest_many(const struct rays *rays, size_t count, const struct ray_start *starts,
		       struct ray_met *out)
{
	for (size_t k = 0; k < count; k += AT_ONCE)
		nearest_some(rays, count - k < AT_ONCE ? count - k : AT_ONCE, starts + k, out + k);
}

bool rays_blocked_along(const struct rays *rays, const float origin[3], const float direction[3],
			float max_distance)
{
	struct RTCIntersectContext context;
	struct RTCRay ray;

	if (!start(&ray, origin, direction, max_distance))
		return false;
	rtcInitIntersectContext(&context);
	rtcOccluded1(rays->scene, &context, &ray);
	return ray.tfar < 0.0f;
}

bool rays_blocked(const struct rays *rays, const float a[3], const float b[3])
{
	const float whole[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] };

	return rays_blocked_along(rays, a, whole, 1.0f);
}
