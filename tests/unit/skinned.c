#include "skinned.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <math.h>
#include <string.h>

/* Rows of an affine transform. */
struct affine {
	double m[3][4];
};

void skinned_load(struct skinned *s, const char *path)
{
	memset(s, 0, sizeof *s);
	s->scene = aiImportFile(path, 0);
	if (!s->scene)
		return;
	s->mesh = s->scene->mMeshes[0];
	s->animation = s->scene->mAnimations[0];
	for (unsigned i = 0; i < s->animation->mNumChannels && s->count < FDP_JOINTS_MAX; i++)
		s->channels[s->count++] = s->animation->mChannels[i];
}

void skinned_free(struct skinned *s)
{
	aiReleaseImport(s->scene);
	memset(s, 0, sizeof *s);
}

static const struct aiNode *find(const struct aiNode *node, const char *name)
{
	const struct aiNode *found = strcmp(node->mName.data, name) ? NULL : node;

	for (unsigned i = 0; i < node->mNumChildren && !found; i++)
		found = find(node->mChildren[i], name);
	return found;
}

/* The key before and how far it is to the next, 0 to 1. */
static double between(double time, unsigned count, double (*time_of)(const void *, unsigned),
		      const void *keys, unsigned *out_first)
{
	unsigned k = 0;
	double first, next;

	while (k + 1 < count && time_of(keys, k + 1) <= time)
		k++;
	*out_first = k;
	first = time_of(keys, k);
	if (k + 1 == count || time <= first)
		return 0;
	next = time_of(keys, k + 1);
	return (time - first) / (next - first);
}

static double vector_time(const void *keys, unsigned k)
{
	return ((const struct aiVectorKey *)keys)[k].mTime;
}

static double turn_time(const void *keys, unsigned k)
{
	return ((const struct aiQuatKey *)keys)[k].mTime;
}

static void turn_at(const struct aiNodeAnim *c, double time, float out[4])
{
	unsigned k;
	const double t = between(time, c->mNumRotationKeys, turn_time, c->mRotationKeys, &k);
	const struct aiQuaternion *a = &c->mRotationKeys[k].mValue,
				  *b = &c->mRotationKeys[t > 0 ? k + 1 : k].mValue;
	const double from[4] = { a->x, a->y, a->z, a->w };
	double to[4] = { b->x, b->y, b->z, b->w }, dot = 0, length = 0, u = 1 - t, v = t, q[4];

	for (int i = 0; i < 4; i++)
		dot += from[i] * to[i];
	for (int i = 0; i < 4 && dot < 0; i++)
		to[i] = -to[i];
	dot = fabs(dot);
	if (dot < 1 - 1e-9) {
		const double angle = acos(dot);

		u = sin(u * angle) / sin(angle);
		v = sin(v * angle) / sin(angle);
	}
	for (int i = 0; i < 4; i++) {
		q[i] = u * from[i] + v * to[i];
		length += q[i] * q[i];
	}
	for (int i = 0; i < 4; i++)
		out[i] = (float)(q[i] / sqrt(length));
}

void skinned_pose(const struct skinned *s, double seconds, struct fdp_joint joints[FDP_JOINTS_MAX])
{
	const double ticks =
		s->animation->mTicksPerSecond > 0 ? s->animation->mTicksPerSecond : 1000;

	for (unsigned i = 0; i < s->count; i++) {
		const struct aiNodeAnim *c = s->channels[i];
		const struct aiVectorKey *keys = c->mPositionKeys;
		unsigned k;
		const double t =
			between(seconds * ticks, c->mNumPositionKeys, vector_time, keys, &k);
		const struct aiVector3D *a = &keys[k].mValue, *b = &keys[t > 0 ? k + 1 : k].mValue;
		const struct aiNode *node = find(s->scene->mRootNode, c->mNodeName.data);
		const float rest[3] = { node->mTransformation.a4, node->mTransformation.b4,
					node->mTransformation.c4 };
		const double at[3] = { a->x + t * (b->x - a->x), a->y + t * (b->y - a->y),
				       a->z + t * (b->z - a->z) };

		joints[i] = (struct fdp_joint){ .moved = false };
		turn_at(c, seconds * ticks, joints[i].rotation);
		/* A micrometre is not seen; exporters' roundings are less. */
		for (int n = 0; n < 3; n++)
			joints[i].moved |= fabs(at[n] - (double)rest[n]) > 1e-6;
		for (int n = 0; joints[i].moved && n < 3; n++)
			joints[i].position[n] = (float)at[n];
	}
}

static struct affine product(const struct affine *a, const struct affine *b)
{
	struct affine out;

	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 4; c++)
			out.m[r][c] = a->m[r][0] * b->m[0][c] + a->m[r][1] * b->m[1][c] +
				      a->m[r][2] * b->m[2][c] + (c == 3 ? a->m[r][3] : 0);
	return out;
}

static struct affine of_matrix(const struct aiMatrix4x4 *m)
{
	return (struct affine){ { { m->a1, m->a2, m->a3, m->a4 },
				  { m->b1, m->b2, m->b3, m->b4 },
				  { m->c1, m->c2, m->c3, m->c4 } } };
}

static struct affine of_joint(const struct fdp_joint *j, const struct aiNode *node)
{
	struct affine out = of_matrix(&node->mTransformation); /* its place at rest */
	const double x = (double)j->rotation[0], y = (double)j->rotation[1],
		     z = (double)j->rotation[2], w = (double)j->rotation[3];
	const double turn[3][3] = {
		{ 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w) },
		{ 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w) },
		{ 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y) }
	};

	for (int r = 0; r < 3; r++) {
		for (int c = 0; c < 3; c++)
			out.m[r][c] = turn[r][c];
		if (j->moved)
			out.m[r][3] = (double)j->position[r];
	}
	return out;
}

static struct affine world_of(const struct skinned *s, const struct fdp_joint *joints,
			      const struct aiNode *node)
{
	struct affine local = of_matrix(&node->mTransformation), parent;

	for (unsigned i = 0; i < s->count; i++)
		if (!strcmp(s->channels[i]->mNodeName.data, node->mName.data))
			local = of_joint(&joints[i], node);
	if (!node->mParent)
		return local;
	parent = world_of(s, joints, node->mParent);
	return product(&parent, &local);
}

void skinned_vertices(const struct skinned *s, const struct fdp_joint *joints, double (*out)[3])
{
	memset(out, 0, s->mesh->mNumVertices * sizeof *out);
	for (unsigned b = 0; b < s->mesh->mNumBones; b++) {
		const struct aiBone *bone = s->mesh->mBones[b];
		const struct aiNode *node = find(s->scene->mRootNode, bone->mName.data);
		const struct affine world = world_of(s, joints, node),
				    rest = of_matrix(&bone->mOffsetMatrix);
		const struct affine m = product(&world, &rest);

		for (unsigned i = 0; i < bone->mNumWeights; i++) {
			const unsigned v = bone->mWeights[i].mVertexId;
			const struct aiVector3D *p = &s->mesh->mVertices[v];
			const double weight = (double)bone->mWeights[i].mWeight;

			for (int r = 0; r < 3; r++)
				out[v][r] += weight *
					     (m.m[r][0] * (double)p->x + m.m[r][1] * (double)p->y +
					      m.m[r][2] * (double)p->z + m.m[r][3]);
		}
	}
}
