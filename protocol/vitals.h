/*
 * What a node tells of itself once a second, besides the frames: how much its
 * socket holds, and where its time goes.
 */
#ifndef GROTTO_PROTOCOL_VITALS_H
#define GROTTO_PROTOCOL_VITALS_H

#include <stddef.h>
#include <stdint.h>

#define FDP_VITALS_STAGES 8
#define FDP_VITALS_NAME 16 /* with the final NUL */
#define FDP_VITALS_NS INT64_C(1000000000)

struct fdp_vitals {
	uint32_t receive_bytes; /* of its socket's buffer, as the kernel counts; 0: not known */
	unsigned count;
	struct fdp_vitals_stage {
		char name[FDP_VITALS_NAME]; /* printable ASCII */
		uint32_t us;		    /* of late, a frame */
	} stages[FDP_VITALS_STAGES];
};

/* Bytes written, 0 when the room is too small or a name is none. */
size_t fdp_vitals_encode(const struct fdp_vitals *v, uint8_t *bytes, size_t size);
/* GR_OK or GR_ERR_FORMAT. */
int fdp_vitals_decode(const uint8_t *bytes, size_t len, struct fdp_vitals *out);
/* The stage that takes longest; NULL: none is known. */
const struct fdp_vitals_stage *fdp_vitals_longest(const struct fdp_vitals *v);

#endif
