#include "tools/bench/hand.h"

#include "tools/bench/random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define REST_MOST_S 1.0
#define REACH_LEAST_M 0.05
#define REACH_MOST_M 0.6
#define TURN_MOST (M_PI / 2)
#define BEND_MOST 0.2 /* to the side, of the distance */
#define ROOM_M 0.8    /* from the origin */

struct reach {
	double begin, seconds; /* the rest after it is until the next begins */
	double from[3], by[3], bend[3];
	struct rotation q;
	double turn[3]; /* rotation vector in the hand's frame */
};

struct hand {
	size_t count;
	struct reach reach[];
};

static void direction(struct bench_random *r, double out[3])
{
	const double z = bench_random_range(r, -1, 1), a = bench_random_range(r, -M_PI, M_PI);
	const double s = sqrt(1 - z * z);

	out[0] = s * cos(a);
	out[1] = s * sin(a);
	out[2] = z;
}

static struct hand_pose ended(const struct reach *r)
{
	struct hand_pose pose = { .q = rotation_by(&r->q, r->turn) };

	for (int i = 0; i < 3; i++)
		pose.p[i] = r->from[i] + r->by[i];
	return pose;
}

static struct reach reach_from(struct bench_random *random, const struct hand_pose *at, double begin)
{
	struct reach r = { .begin = begin, .q = at->q };
	double way[3], side[3], along = 0, far = 0;
	const double distance = bench_random_range(random, REACH_LEAST_M, REACH_MOST_M);
	const double angle = bench_random_range(random, 0, TURN_MOST);
	const double bend = bench_random_range(random, 0, BEND_MOST) * distance;

	memcpy(r.from, at->p, sizeof r.from);
	direction(random, way);
	for (int i = 0; i < 3; i++)
		far += (at->p[i] + way[i] * distance) * (at->p[i] + way[i] * distance);
	direction(random, side);
	for (int i = 0; i < 3; i++)
		along += side[i] * way[i];
	direction(random, r.turn);
	for (int i = 0; i < 3; i++) {
		r.by[i] = (far > ROOM_M * ROOM_M ? -way[i] : way[i]) * distance;
		r.bend[i] = (side[i] - along * way[i]) * bend;
		r.turn[i] *= angle;
	}
	/* far reaches last longer: 0.3 s for 5 cm, 1 s for 60 cm, and as it comes */
	r.seconds = (0.24 + 1.27 * distance) * bench_random_range(random, 0.85, 1.25);
	return r;
}

struct hand *hand_create(double seconds, uint64_t seed)
{
	const size_t most = (size_t)(seconds / 0.2) + 2;
	struct hand *hand = calloc(1, sizeof *hand + most * sizeof *hand->reach);
	struct bench_random random = bench_random_start(seed);
	struct hand_pose at = { .q = ROTATION_NONE };
	double t = 0.5;

	while (hand && hand->count < most && t < seconds) {
		struct reach *r = &hand->reach[hand->count++];

		*r = reach_from(&random, &at, t);
		at = ended(r);
		t += r->seconds;
		if (bench_random_range(&random, 0, 1) < 0.5)
			t += bench_random_range(&random, 0, REST_MOST_S);
	}
	return hand;
}

void hand_destroy(struct hand *hand)
{
	free(hand);
}

struct hand_pose hand_at(const struct hand *hand, double t)
{
	size_t low = 0, high = hand->count;
	struct hand_pose pose = { .q = ROTATION_NONE };
	const struct reach *r;
	double u, s, turn[3];

	while (low < high) {
		const size_t middle = (low + high) / 2;

		if (hand->reach[middle].begin <= t)
			low = middle + 1;
		else
			high = middle;
	}
	if (low == 0)
		return pose;
	r = &hand->reach[low - 1];
	u = fmin((t - r->begin) / r->seconds, 1);
	s = u * u * u * (10 + u * (6 * u - 15));
	for (int i = 0; i < 3; i++) {
		/* the bend has a quarter of itself at half way, and rises and falls as softly */
		pose.p[i] = r->from[i] + s * r->by[i] + 4 * s * (1 - s) * r->bend[i];
		turn[i] = s * r->turn[i];
	}
	pose.q = rotation_by(&r->q, turn);
	return pose;
}
