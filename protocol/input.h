/*
 * What a person does at the window of a node: keys, mouse. A state and no
 * event: what a lost datagram held the next one holds, too. It goes to the
 * master soon after it has changed, at most every FDP_INPUT_LEAST_NS; then a few times
 * more, and for as long as something is held down, every FDP_INPUT_AGAIN_NS.
 */
#ifndef GROTTO_PROTOCOL_INPUT_H
#define GROTTO_PROTOCOL_INPUT_H

#include <stddef.h>
#include <stdint.h>

#define FDP_INPUT_BYTES 24
#define FDP_INPUT_LEAST_NS INT64_C(8000000)
#define FDP_INPUT_AGAIN_NS INT64_C(100000000)
#define FDP_INPUT_TIMES 5 /* that a state is said in which nothing is held */
#define FDP_INPUT_WHEEL_MOST 1000.0f

struct fdp_input {
	uint32_t buttons;
	float axes[2];    /* -1..1, right and up + */
	float pointer[2]; /* in the window: -1 left, below; 1 right, above */
	float wheel;      /* turned so far, notches, away from the person + */
};

/* Bytes written, 0 when the room is too small. */
size_t fdp_input_encode(const struct fdp_input *input, uint8_t *bytes, size_t size);
/* GR_OK or GR_ERR_FORMAT: another length, or a number outside its range. */
int fdp_input_decode(const uint8_t *bytes, size_t len, struct fdp_input *out);

#endif
