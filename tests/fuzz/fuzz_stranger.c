/*
 * Bytes from who holds no key, at a master and at a node in operation: no answer
 * is longer than what asked for it, and nothing that matters changes. (The MAC
 * keeps all out that is signed; this looks at what comes before it.)
 */
#include "fuzz_pair.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static uint64_t state_of(const struct fuzz_pair *p)
{
	return param_state_hash(p->master->state, 0) ^ fdp_node_hash(p->nodes[0]) ^
	       p->master->frame << 40 ^ p->nodes[0]->applied << 48 ^
	       fdp_master_live(p->master) << 8 ^ (uint64_t)fdp_node_status(p->nodes[0]);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static struct fuzz_pair pair;
	static bool started;
	struct fdp_counters before, after;
	uint8_t *exact = malloc(size ? size : 1);
	uint64_t was;

	if (!started)
		fuzz_pair_start(&pair, FDP_DATAGRAM_MIN);
	started = true;
	if (!exact)
		abort();
	if (size)
		memcpy(exact, data, size);
	was = state_of(&pair);
	pair.count = 0;
	fdp_master_counters(pair.master, &before);
	if (fdp_master_receive(pair.master, exact, size, pair.now_ns, NULL) >= 0 || pair.count)
		abort(); /* signed by chance, or a hole */
	fdp_master_counters(pair.master, &after);
	if (after.datagrams_in != before.datagrams_in + 1 || after.bytes_out != before.bytes_out)
		abort();
	if (!fdp_node_receive(pair.nodes[0], exact, size, pair.now_ns) || pair.count)
		abort();
	if (state_of(&pair) != was)
		abort();
	free(exact);
	return 0;
}
