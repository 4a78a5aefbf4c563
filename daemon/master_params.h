/* What a layout says, as the master's side of the protocol calls it. Pure functions. */
#ifndef GROTTO_DAEMON_MASTER_PARAMS_H
#define GROTTO_DAEMON_MASTER_PARAMS_H

#include "config/layout.h"
#include "protocol/master.h"

/* By the driver's barrier a node's word is as good as a time: it waits for the others itself. */
static inline enum fdp_swap master_swap(enum layout_swap_mode mode)
{
	switch (mode) {
	case LAYOUT_SWAP_AUTO: return FDP_SWAP_AUTO;
	case LAYOUT_SWAP_SCHEDULED: return FDP_SWAP_SCHEDULED;
	case LAYOUT_SWAP_MESSAGE:
	case LAYOUT_SWAP_HARDWARE: break;
	}
	return FDP_SWAP_MESSAGE;
}

static inline enum fdp_parity master_parity(enum layout_parity parity)
{
	switch (parity) {
	case LAYOUT_PARITY_OFF: return FDP_PARITY_OFF;
	case LAYOUT_PARITY_ON: return FDP_PARITY_ON;
	case LAYOUT_PARITY_AUTO: break;
	}
	return FDP_PARITY_AUTO;
}

#endif
