/* Made set-ups of a calibration: a device somewhere in a room, points that a wand touched. */
#ifndef GROTTO_TESTS_UNIT_ALIGN_ROOM_H
#define GROTTO_TESTS_UNIT_ALIGN_ROOM_H

#include "tests/unit/unit.h"
#include "tracking/align.h"

/* Of mean 0 and standard deviation 1 (Box and Muller 1958). */
static inline double align_normal(struct unit_random *r)
{
	const double u = unit_random_range(r, 1e-12, 1), a = unit_random_range(r, 0, 2 * M_PI);

	return sqrt(-2 * log(u)) * cos(a);
}

/* Any turn, each as likely. */
static inline struct rotation align_turn(struct unit_random *r)
{
	struct rotation q;
	double n = 0;

	for (int i = 0; i < 4; i++) {
		q.q[i] = align_normal(r);
		n += q.q[i] * q.q[i];
	}
	for (int i = 0; i < 4; i++)
		q.q[i] /= sqrt(n);
	return q;
}

struct align_room {
	struct dmat3 R; /* the truth */
	double t[3], scale;
	size_t count;
	struct align_point points[ALIGN_POINTS];
	struct rotation sensor[ALIGN_POINTS];
	double arm[3];
};

/* What the device says where the body is at points[k].room, with its noise in true metres. */
static inline void align_room_measure(struct align_room *room, size_t k, struct unit_random *r, double noise_m)
{
	const struct dmat3 turned = dmat3_from_rotation(&room->sensor[k]);
	struct align_point *p = &room->points[k];
	double at[3];

	dmat3_apply(&turned, room->arm, p->arm);
	for (int i = 0; i < 3; i++)
		at[i] = p->room[i] - room->t[i];
	dmat3_apply_transposed(&room->R, at, at);
	for (int i = 0; i < 3; i++)
		p->base[i] = (at[i] + noise_m * align_normal(r) - p->arm[i]) / room->scale;
}

/* A device turned anyhow within 3 m, points anywhere between the walls and within reach. */
static inline struct align_room align_room_make(struct unit_random *r, size_t count, double noise_m)
{
	static const double low[3] = { -1.5, 0, -1.5 }, high[3] = { 1.5, 2, 1.5 };
	struct align_room room = { .scale = 1, .count = count };
	const struct rotation turn = align_turn(r);

	room.R = dmat3_from_rotation(&turn);
	for (int i = 0; i < 3; i++) {
		room.t[i] = unit_random_range(r, -3, 3);
		room.arm[i] = unit_random_range(r, -0.1, 0.1);
	}
	for (size_t k = 0; k < count; k++) {
		room.sensor[k] = align_turn(r);
		for (int i = 0; i < 3; i++)
			room.points[k].room[i] = unit_random_range(r, low[i], high[i]);
		align_room_measure(&room, k, r, noise_m);
	}
	return room;
}

/* Angle of the turn between the fit and the truth. */
static inline double align_turn_error(const struct align_room *room, const struct align_fit *fit)
{
	const struct dmat3 back = dmat3_transposed(&room->R), d = dmat3_mul(&fit->R, &back);
	const double sine = sqrt((d.m[2][1] - d.m[1][2]) * (d.m[2][1] - d.m[1][2]) +
				 (d.m[0][2] - d.m[2][0]) * (d.m[0][2] - d.m[2][0]) +
				 (d.m[1][0] - d.m[0][1]) * (d.m[1][0] - d.m[0][1]));

	return atan2(sine, d.m[0][0] + d.m[1][1] + d.m[2][2] - 1);
}

/* How far the fit puts from its place what is at a place of the room. */
static inline double align_place_error(const struct align_room *room, const struct align_fit *fit,
				       const double at[3])
{
	const double none[3] = { 0 };
	double base[3], found[3], square = 0;

	for (int i = 0; i < 3; i++)
		base[i] = at[i] - room->t[i];
	dmat3_apply_transposed(&room->R, base, base);
	for (int i = 0; i < 3; i++)
		base[i] /= room->scale;
	align_apply(fit, base, none, found);
	for (int i = 0; i < 3; i++)
		square += (found[i] - at[i]) * (found[i] - at[i]);
	return sqrt(square);
}

#endif
