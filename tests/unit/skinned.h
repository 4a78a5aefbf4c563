/*
 * Rigged characters of the reference data, in double precision: assimp's bones, weights and
 * keys, poses at a time (glTF 2.0: linear, rotations along the shorter arc), positions of the
 * vertices. Characters of one mesh, one skin and one animation.
 */
#ifndef GROTTO_TESTS_SKINNED_H
#define GROTTO_TESTS_SKINNED_H

#include "protocol/joints.h"

#include <assimp/scene.h>
#include <stdbool.h>

struct skinned {
	const struct aiScene *scene;
	const struct aiMesh *mesh;
	const struct aiAnimation *animation;
	unsigned count; /* joints: nodes with a channel */
	const struct aiNodeAnim *channels[FDP_JOINTS_MAX];
};

/* NULL in s->scene: could not be read. */
void skinned_load(struct skinned *s, const char *path);
void skinned_free(struct skinned *s);
/* Each joint's pose at that time of the animation, seconds. */
void skinned_pose(const struct skinned *s, double seconds, struct fdp_joint joints[FDP_JOINTS_MAX]);
/* World positions of the mesh's vertices, metres; joints as skinned_pose gives them. */
void skinned_vertices(const struct skinned *s, const struct fdp_joint *joints, double (*out)[3]);

#endif
