#include "tracking/still.h"

#include <math.h>
#include <string.h>

void still_add(struct still *s, const double p[3], const struct rotation *q, const double at[3])
{
	double along = 0;

	/* Welford (1962) */
	s->count++;
	for (int i = 0; i < 3; i++) {
		const double before = at[i] - s->at[i];

		s->p[i] += (p[i] - s->p[i]) / (double)s->count;
		s->at[i] += before / (double)s->count;
		s->squares += before * (at[i] - s->at[i]);
	}
	if (s->count == 1)
		memcpy(s->first, q->q, sizeof s->first);
	for (int i = 0; i < 4; i++)
		along += s->first[i] * q->q[i];
	/* q and -q are the same turn */
	for (int i = 0; i < 4; i++)
		s->q[i] += along < 0 ? -q->q[i] : q->q[i];
}

double still_spread_m(const struct still *s)
{
	return s->count ? sqrt(s->squares / (double)s->count) : 0;
}

struct rotation still_turn(const struct still *s)
{
	const double n = sqrt(s->q[0] * s->q[0] + s->q[1] * s->q[1] + s->q[2] * s->q[2] +
			      s->q[3] * s->q[3]);
	struct rotation out = ROTATION_NONE;

	if (n > 0)
		for (int i = 0; i < 4; i++)
			out.q[i] = s->q[i] / n;
	return out;
}
