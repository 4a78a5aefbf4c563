/*
 * The colour of a lamp as hue, saturation and value (seed 004, "User
 * Interaction", layout 2): pastel colours are a turn and a push away, which
 * they are not with three bands. Pure.
 */
#ifndef GROTTO_DAEMON_HAND_COLOR_H
#define GROTTO_DAEMON_HAND_COLOR_H

struct hand_color {
	float hue;        /* turns, 0 <= hue < 1: 0 red, 1/3 green, 2/3 blue */
	float saturation; /* 0 grey .. 1 */
	float value;      /* of the strongest band, in the bands' unit, >= 0 */
};

/* rgb: finite and >= 0. A grey has no hue: it gets `hue`, so that none is lost on the way through grey. */
void hand_color_of(const float rgb[3], float hue, struct hand_color *out);
/* A hue of any size is taken as an angle; saturation in 0..1. */
void hand_color_rgb(const struct hand_color *color, float rgb[3]);

#endif
