/*
 * How much of what is sent to a peer gets lost, and how unevenly: per fragment the
 * share and the variance, over the last FDP_LOSS_MEMORY messages with weights that
 * fade. Losses in bursts have a greater variance than single ones of the same
 * share, so the two say how many of a message's fragments may be missing without
 * anything being assumed of how they fall.
 */
#ifndef GROTTO_PROTOCOL_LOSS_H
#define GROTTO_PROTOCOL_LOSS_H

#include <math.h>

#define FDP_LOSS_MEMORY 128
/* Deviations that parity stands for: of a normal distribution one message in 740 loses more. */
#define FDP_LOSS_DEVIATIONS 3.0
/* What is taken for lost before anything is, where parity is wanted all the same. */
#define FDP_LOSS_ASSUMED 0.02

struct fdp_loss {
	double sent, lost, squares; /* fragments; squares: of what a message lost more or less than its share */
};

static inline double fdp_loss_share(const struct fdp_loss *l)
{
	const double share = l->sent > 0 ? l->lost / l->sent : 0;

	return share < 1 ? share : 1;
}

/* A message of `sent` fragments lost so many. Reports may come a message late: lost may be greater. */
static inline void fdp_loss_take(struct fdp_loss *l, unsigned sent, unsigned lost)
{
	const double fade = 1 - 1.0 / FDP_LOSS_MEMORY;
	double off;

	l->sent = l->sent * fade + sent;
	l->lost = l->lost * fade + lost;
	off = lost - fdp_loss_share(l) * sent;
	l->squares = l->squares * fade + off * off;
}

/* What is lost of `sent` fragments at a share: mean, and FDP_LOSS_DEVIATIONS more. */
static inline double fdp_loss_bound(double share, double variance, double sent)
{
	return sent * share + FDP_LOSS_DEVIATIONS * sqrt(sent * variance);
}

/*
 * So many parity fragments that a message of `count`, parity itself included, seldom
 * loses more of them; at most `most`. least: a share below which none is believed.
 */
static inline unsigned fdp_loss_parity(const struct fdp_loss *l, unsigned count, double least,
				       unsigned most)
{
	const double measured = fdp_loss_share(l), share = measured > least ? measured : least;
	const double single = share * (1 - share), seen = l->sent > 0 ? l->squares / l->sent : 0;
	const double variance = seen > single ? seen : single;
	unsigned parity = 0;

	while (parity < most && parity < fdp_loss_bound(share, variance, count + parity))
		parity++;
	return parity;
}

#endif
