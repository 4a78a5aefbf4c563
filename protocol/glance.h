/*
 * What the eye looks at of a node's wall, told to the master: the light in the cone of
 * its gaze, and the wall's brightest. A state and no event: what a lost datagram held
 * the next one holds, too. Said when it has changed, at most once a frame, and every
 * FDP_GLANCE_AGAIN_NS.
 */
#ifndef GROTTO_PROTOCOL_GLANCE_H
#define GROTTO_PROTOCOL_GLANCE_H

#include <stddef.h>
#include <stdint.h>

#define FDP_GLANCE_BYTES 12
#define FDP_GLANCE_AGAIN_NS INT64_C(250000000)

struct fdp_glance {
	float log_sum;	   /* of log(cd/m^2), natural, times solid angle */
	float solid_angle; /* of what is in it, sr; 0: nothing of this wall is looked at */
	float max;	   /* cd/m^2, of the whole wall */
};

/* Bytes written, 0 when the room is too small. */
size_t fdp_glance_encode(const struct fdp_glance *glance, uint8_t *bytes, size_t size);
/* GR_OK or GR_ERR_FORMAT: another length, or a number that is not finite, or below 0 where none is. */
int fdp_glance_decode(const uint8_t *bytes, size_t len, struct fdp_glance *out);

#endif
