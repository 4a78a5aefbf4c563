/*
 * A character's pose on the wire: of each joint its turn against its parent, and where
 * it is there only when that is not as the skeleton has it at rest. A turn is the three
 * smaller components of its unit quaternion, each in 15 bits: 6 bytes a joint instead of
 * the 48 of a 3x4 matrix, off by at most FDP_JOINT_ERROR. The identity goes exactly. Pure.
 *
 * Bytes: number of joints (u8), a bit for each joint that has a position, then for
 * each joint its turn (48 bits: place of the largest component in the top two of them
 * but one, zero, three times 15), then the positions (3 x f32). Little-endian.
 */
#ifndef GROTTO_PROTOCOL_JOINTS_H
#define GROTTO_PROTOCOL_JOINTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FDP_JOINTS_MAX 255
#define FDP_JOINT_BYTES 6
#define FDP_JOINT_REACH 1e5f	/* m; no position is further from its parent in x, y or z */
#define FDP_JOINT_ERROR 1.5e-4f /* rad */

/* In the frame of the joint's parent, of the character for one that has none. */
struct fdp_joint {
	float rotation[4]; /* unit quaternion x y z w */
	float position[3]; /* metres; of one that has not moved: 0 */
	bool moved;	   /* is elsewhere than at rest */
};

/*
 * Bytes written. 0: the room is too small, there are too many, a quaternion is not of
 * length 1 within 1e-3, or something is not finite or out of reach.
 */
size_t fdp_joints_encode(const struct fdp_joint *joints, size_t count, uint8_t *bytes, size_t size);
/* GR_OK; GR_ERR_FORMAT: no pose, or more than `most` joints, and *out_count is 0. */
int fdp_joints_decode(const uint8_t *bytes, size_t len, struct fdp_joint *joints, size_t most,
		      size_t *out_count);

#endif
