#include "renderer/trace/rays.h"

#include "base/log.h"
#include "base/result.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct rays {
	RTCDevice device;
	RTCScene scene;
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

int rays_create(struct rays **out, const struct scene *scene)
{
	struct rays *rays = calloc(1, sizeof *rays);
	int result = GR_ERR_NOMEM;

	*out = NULL;
	if (!rays)
		return result;
	/* One thread: nodes share a machine in the demo, and builds are short. */
	rays->device = rtcNewDevice("threads=1,set_affinity=0");
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
	rtcSetSceneFlags(rays->scene, RTC_SCENE_FLAG_ROBUST);
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
	free(*rays);
	*rays = NULL;
}

bool rays_nearest(const struct rays *rays, const float origin[3], const float direction[3],
		  float max_distance, struct ray_hit *out)
{
	struct RTCIntersectContext context;
	struct RTCRayHit q = { 0 };
	float length;

	q.ray.org_x = origin[0];
	q.ray.org_y = origin[1];
	q.ray.org_z = origin[2];
	q.ray.dir_x = direction[0];
	q.ray.dir_y = direction[1];
	q.ray.dir_z = direction[2];
	q.ray.tfar = max_distance;
	q.ray.mask = ~0u;
	q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
	rtcInitIntersectContext(&context);
	rtcIntersect1(rays->scene, &context, &q);
	if (q.hit.geomID == RTC_INVALID_GEOMETRY_ID)
		return false;
	out->distance = q.ray.tfar;
	out->triangle = q.hit.primID;
	out->u = q.hit.u;
	out->v = q.hit.v;
	length = sqrtf(q.hit.Ng_x * q.hit.Ng_x + q.hit.Ng_y * q.hit.Ng_y +
		       q.hit.Ng_z * q.hit.Ng_z);
	/* Embree 3: Ng = (v1-v0) x (v2-v0), which is the front of a counter-clockwise triangle. */
	out->normal[0] = q.hit.Ng_x / length;
	out->normal[1] = q.hit.Ng_y / length;
	out->normal[2] = q.hit.Ng_z / length;
	return true;
}

bool rays_blocked(const struct rays *rays, const float a[3], const float b[3])
{
	struct RTCIntersectContext context;
	struct RTCRay ray = { 0 };

	ray.org_x = a[0];
	ray.org_y = a[1];
	ray.org_z = a[2];
	ray.dir_x = b[0] - a[0];
	ray.dir_y = b[1] - a[1];
	ray.dir_z = b[2] - a[2];
	ray.tfar = 1.0f;
	ray.mask = ~0u;
	rtcInitIntersectContext(&context);
	rtcOccluded1(rays->scene, &context, &ray);
	return ray.tfar < 0.0f;
}
