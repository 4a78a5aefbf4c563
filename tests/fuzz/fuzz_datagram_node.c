/* Datagrams of a master that holds the key and means no good, at a node. */
#include "fuzz_pair.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct fuzz_pair pair;
	struct gr_reader r = gr_reader(data, size);
	uint64_t sequence;
	uint8_t bytes[1472];
	size_t len;

	fuzz_pair_start(&pair, FDP_DATAGRAM_MIN);
	sequence = pair.master->out.sequence;
	while ((len = fuzz_next(&pair, &r, bytes, sizeof bytes, FDP_SENDER_MASTER, &sequence))) {
		fuzz_queue(&pair, 0, bytes, len);
		fuzz_deliver(&pair);
		if (bytes[FDP_HEADER_BYTES - 1] & 1)
			fuzz_tick(&pair, 10000000);
		fuzz_deliver(&pair);
		/* Whatever came, the state makes sense. */
		for (int i = 0; i < PARAM_COUNT; i++)
			if (!param_valid((enum param_id)i,
					 param_get(fdp_node_params_state(pair.nodes[0]), (enum param_id)i)))
				abort();
	}
	fuzz_pair_stop(&pair);
	return 0;
}
