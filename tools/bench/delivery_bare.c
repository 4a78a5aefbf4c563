/*
 * The floor: an update's bytes in datagrams by the daemons' sockets, and the same with
 * the protocol's MAC, which says what authentication alone costs.
 */
#include "tools/bench/delivery.h"

#include "base/clock.h"
#include "base/cursor.h"
#include "protocol/wire.h"

#include <string.h>

#define BARE_HEAD 16

static const uint8_t magic[DELIVERY_FDP][4] = {
	[DELIVERY_BARE] = { 'B', 'A', 'R', 'E' }, [DELIVERY_SIGNED] = { 'S', 'I', 'G', 'N' },
};
static const uint8_t key[FDP_KEY_BYTES] = { 1 };

void delivery_send_bare(const struct delivery_room *room, struct net *net, enum delivery_way way,
			uint32_t update)
{
	static uint8_t bytes[FDP_DATAGRAM_MAX];
	const struct layout_network *network = &room->cluster.layout.network;
	const size_t head = way == DELIVERY_SIGNED ? FDP_HEADER_BYTES : BARE_HEAD;
	const size_t most = net_datagram_max(network) - head;
	const size_t count = (room->update_bytes + most - 1) / most;

	room->sent_ns[way][update] = gr_clock_now(&gr_clock_monotonic);
	for (size_t i = 0; i < count; i++) {
		const size_t left = room->update_bytes - i * most, len = head + (left < most ? left : most);
		struct gr_writer w = gr_writer(bytes, sizeof bytes);

		gr_write_bytes(&w, magic[way], sizeof magic[way]);
		gr_write_u32(&w, FDP_DELTA << 8); /* where a kind stands: it says how to sign */
		gr_write_u32(&w, update);
		gr_write_u32(&w, (uint32_t)count);
		if (way == DELIVERY_SIGNED)
			fdp_wire_sign(key, bytes, len);
		net_send(net, network->cast == LAYOUT_MULTICAST ? NET_TO_GROUP : NET_TO_ALL, bytes, len);
	}
	net_flush(net);
}

bool delivery_take_bare(struct delivery_room *room, unsigned node,
			struct delivery_bare bare[DELIVERY_FDP], const uint8_t *bytes, size_t len)
{
	struct gr_reader r = gr_reader(bytes + sizeof magic[0], len - sizeof magic[0]);
	struct delivery_bare *b;
	uint32_t update, count;
	unsigned way = 0;

	while (way < DELIVERY_FDP && memcmp(bytes, magic[way], sizeof magic[way]) != 0)
		way++;
	if (way == DELIVERY_FDP)
		return false;
	if (way == DELIVERY_SIGNED && !fdp_wire_authentic(key, bytes, len))
		return true;
	gr_read_u32(&r);
	update = gr_read_u32(&r);
	count = gr_read_u32(&r);
	b = &bare[way];
	if (update != b->update || !b->have)
		*b = (struct delivery_bare){ .update = update };
	if (++b->have == count) {
		delivery_note(room, way, node, update);
		b->have = 0;
	}
	return true;
}
