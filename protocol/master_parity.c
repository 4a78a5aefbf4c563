/*
 * How many parity fragments a DELTA gets. One datagram may go to all, so there is one
 * number for the room: that of the node that loses most. While losses are seen there
 * is at least one, which costs no more than sending the last fragment twice, as is
 * done without, and stands for any.
 */
#include "protocol/master_private.h"
#include "protocol/parity.h"

void fdp_master_measure_loss(struct fdp_master *m)
{
	for (size_t i = 0; i < m->params.node_count; i++) {
		struct fdp_peer *peer = &m->peers[i];

		/* When nothing was lost for so long, what was is no guide any more. */
		if (!m->loss || !fdp_peer_counts(peer->state))
			peer->loss = (struct fdp_loss){ 0 };
		else if (m->delta.number)
			fdp_loss_take(&peer->loss, m->delta.count, peer->lost_now);
		peer->status.loss = fdp_loss_share(&peer->loss);
		peer->lost_now = 0;
	}
}

unsigned fdp_master_parity(const struct fdp_master *m, unsigned count)
{
	const bool on = m->params.parity == FDP_PARITY_ON;
	const unsigned most = fdp_parity_most(count);
	unsigned parity = 0;

	if (m->params.parity == FDP_PARITY_OFF || !most || (!on && !m->loss))
		return 0;
	for (size_t i = 0; i < m->params.node_count; i++) {
		const struct fdp_peer *peer = &m->peers[i];
		const unsigned of_peer = !fdp_peer_counts(peer->state) ? 0 :
			fdp_loss_parity(&peer->loss, count, on ? FDP_LOSS_ASSUMED : 0, most);

		parity = of_peer > parity ? of_peer : parity;
	}
	return parity ? parity : 1;
}

void fdp_master_fragments(const struct fdp_master *m, unsigned *out_count, unsigned *out_parity)
{
	*out_count = m->delta.number ? m->delta.count : 0;
	*out_parity = m->delta.parity;
}
