/* Datagrams of a node that holds the key and means no good, at the master. */
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
	sequence = pair.nodes[0]->out.sequence;
	while ((len = fuzz_next(&pair, &r, bytes, sizeof bytes, 0, &sequence))) {
		fuzz_queue(&pair, -1, bytes, len);
		fuzz_deliver(&pair);
		if (bytes[FDP_HEADER_BYTES - 1] & 1)
			fuzz_tick(&pair, 10000000);
		fuzz_begin(&pair);
		fuzz_deliver(&pair);
	}
	fuzz_pair_stop(&pair);
	return 0;
}
