/*
 * Frames out of a stream of bytes that knows no boundaries: a frame may be
 * split over packets anywhere, several come in one, and a stream is joined in
 * the middle where the program before was killed. Pure; fixed size.
 *
 * VIPER: a frame is one when its checksum is right; after what is not, the
 * next one is looked for from the byte after its first.
 * LIBERTY: there is no checksum. A head is believed when its letters, station
 * and size can be, and what has come after the frame can be another's head or
 * text. Text between frames (answers, errors) is passed over.
 */
#ifndef GROTTO_TRACKING_POLHEMUS_STREAM_H
#define GROTTO_TRACKING_POLHEMUS_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum track_polhemus_style { TRACK_POLHEMUS_VIPER, TRACK_POLHEMUS_LIBERTY };

#define TRACK_POLHEMUS_STREAM 2048 /* twice the longest frame */

struct track_polhemus_stream {
	enum track_polhemus_style style;
	size_t from, to;
	bool lost; /* since something that was no frame */
	uint8_t bytes[TRACK_POLHEMUS_STREAM];
};

/* A stream that may begin anywhere: what comes before the first frame is no fault. */
void track_polhemus_stream_begin(struct track_polhemus_stream *stream,
				 enum track_polhemus_style style);
/*
 * Appends what there is room for, and returns how much that was: all of up to
 * 1024 bytes once track_polhemus_stream_next has said that there is nothing.
 */
size_t track_polhemus_stream_push(struct track_polhemus_stream *stream, const uint8_t *bytes,
				  size_t len);
/*
 * GR_OK: a whole frame, there until the next push. GR_NOTHING: more bytes are
 * needed. -TRACK_FAULT_CHECKSUM, -TRACK_FAULT_FORMAT: something was passed over
 * that was no frame, told once until a frame is found; call again.
 */
int track_polhemus_stream_next(struct track_polhemus_stream *stream, const uint8_t **frame,
			       size_t *len);

#endif
