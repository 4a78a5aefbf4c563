/* ENet: reliable packets in one channel to each. */
#include <config.h>

#include "tools/bench/peer.h"

#ifdef HAVE_ENET

#include "base/clock.h"

#include <enet/enet.h>
#include <stdio.h>
#include <stdlib.h>

#define TICK_NS GR_NS_PER_MS /* the unit of its own times */

struct end {
	ENetHost *host;
	bool sender;
};

static void *open_end(const struct peer_place *place)
{
	const char *sender = place->cluster->addresses[place->cluster->node_count];
	ENetAddress at = { .port = place->port };
	struct end *e = calloc(1, sizeof *e);

	if (!e)
		return NULL;
	e->sender = place->sender;
	if (enet_initialize() == 0 && enet_address_set_host_ip(&at, sender) == 0)
		e->host = enet_host_create(place->sender ? &at : NULL, place->sender ? place->node : 1, 1, 0, 0);
	if (!e->host || (!place->sender && !enet_host_connect(e->host, &at, 1, 0))) {
		fprintf(stderr, "ENet: no host at %s:%u\n", sender, place->port);
		if (e->host)
			enet_host_destroy(e->host);
		free(e);
		return NULL;
	}
	return e;
}

static void close_end(void *end)
{
	struct end *e = end;

	enet_host_destroy(e->host);
	enet_deinitialize();
	free(e);
}

static bool send_update(void *end, const uint8_t *bytes, size_t len)
{
	struct end *e = end;
	ENetPacket *packet = enet_packet_create(bytes, len, ENET_PACKET_FLAG_RELIABLE);

	if (!packet)
		return false;
	enet_host_broadcast(e->host, 0, packet);
	enet_host_flush(e->host);
	return true;
}

static void serve(void *end, int64_t until_ns, peer_take_fn *take, void *ctx)
{
	const int64_t tick_ns = gr_clock_now(&gr_clock_monotonic) + TICK_NS;
	struct end *e = end;
	ENetEvent event;

	peer_wait(&e->host->socket, 1, until_ns < tick_ns ? until_ns : tick_ns);
	while (enet_host_service(e->host, &event, 0) > 0) {
		if (event.type != ENET_EVENT_TYPE_RECEIVE)
			continue;
		take(ctx, event.packet->data, event.packet->dataLength);
		enet_packet_destroy(event.packet);
	}
}

#else
#define open_end NULL
#define close_end NULL
#define send_update NULL
#define serve NULL
#endif

const struct peer peer_enet = { "ENet, reliable", open_end, close_end, send_update, serve };
