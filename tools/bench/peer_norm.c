/*
 * NORM (RFC 5740): an object an update, to a group; repaired when asked for (NACK), or
 * with 8 parity segments sent with each at once. Its thread is the library's own.
 */
#include <config.h>

#include "tools/bench/peer.h"

#ifdef HAVE_NORM

#include "norm_api.h" /* normApi.h, made C by configure */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define KEPT 256 /* updates that may be asked for */
#define SEGMENT 1400
#define BLOCK 64 /* segments, and parity for each */
#define PARITY 8
#define SPACE (64u << 20)
#define SOCKET_BYTES (4u << 20)
#define RATE_BITS_S 1e9
#define TRIP_S 0.0002 /* its waits are counted in these */

struct end {
	NormInstanceHandle instance;
	NormSessionHandle session;
	size_t update_bytes;
	unsigned next;
	char *kept; /* KEPT updates: what was given to the library stays where it is */
};

static void begin_sender(struct end *e, unsigned parity)
{
	NormSetGrttEstimate(e->session, TRIP_S);
	NormSetGrttMax(e->session, TRIP_S);
	NormSetGrttProbingMode(e->session, NORM_PROBE_NONE);
	NormSetTxRate(e->session, RATE_BITS_S);
	NormSetCongestionControl(e->session, false, false);
	NormSetBackoffFactor(e->session, 0);
	NormSetFlowControl(e->session, 0);
	NormSetTxCacheBounds(e->session, SPACE, 1, KEPT - 8);
	NormStartSender(e->session, 1, SPACE, SEGMENT, BLOCK, PARITY, 0);
	NormSetTxSocketBuffer(e->session, SOCKET_BYTES);
	NormSetAutoParity(e->session, (unsigned char)parity);
}

static void *open_end(const struct peer_place *place, unsigned parity)
{
	struct end *e = calloc(1, sizeof *e);

	if (!e)
		return NULL;
	e->update_bytes = place->update_bytes;
	e->kept = place->sender ? malloc(KEPT * place->update_bytes) : NULL;
	e->instance = NormCreateInstance(true);
	e->session = NormCreateSession(e->instance, place->cluster->bench->group, place->port, place->node + 1);
	if (e->session == NORM_SESSION_INVALID || (place->sender && !e->kept)) {
		fprintf(stderr, "NORM: no session on %s:%u\n", place->cluster->bench->group, place->port);
		NormDestroyInstance(e->instance);
		free(e->kept);
		free(e);
		return NULL;
	}
	NormSetRxPortReuse(e->session, true, NULL, NULL, 0);
	NormSetMulticastInterface(e->session, place->cluster->interface);
	if (place->sender) {
		begin_sender(e, parity);
	} else {
		NormSetDefaultUnicastNack(e->session, true);
		NormStartReceiver(e->session, SPACE);
		NormSetRxSocketBuffer(e->session, SOCKET_BYTES);
		NormSetRxCacheLimit(e->session, KEPT);
	}
	return e;
}

static void *open_plain(const struct peer_place *place)
{
	return open_end(place, 0);
}

static void *open_parity(const struct peer_place *place)
{
	return open_end(place, PARITY);
}

static void close_end(void *end)
{
	struct end *e = end;

	NormDestroySession(e->session);
	NormDestroyInstance(e->instance);
	free(e->kept);
	free(e);
}

static bool send_update(void *end, const uint8_t *bytes, size_t len)
{
	struct end *e = end;
	char *own = e->kept + e->next % KEPT * e->update_bytes;

	memcpy(own, bytes, len);
	if (NormDataEnqueue(e->session, own, (UINT32)len, NULL, 0) == NORM_OBJECT_INVALID)
		return false;
	e->next++;
	return true;
}

static void serve(void *end, int64_t until_ns, peer_take_fn *take, void *ctx)
{
	struct end *e = end;
	const int fd = NormGetDescriptor(e->instance);
	NormEvent event;

	peer_wait(&fd, 1, until_ns);
	while (NormGetNextEvent(e->instance, &event, false)) {
		if (event.type == NORM_RX_OBJECT_COMPLETED)
			take(ctx, (const uint8_t *)NormDataAccessData(event.object),
			     (size_t)NormObjectGetSize(event.object));
	}
}

#else
#define open_plain NULL
#define open_parity NULL
#define close_end NULL
#define send_update NULL
#define serve NULL
#endif

const struct peer peer_norm = { "NORM, NACK", open_plain, close_end, send_update, serve };
const struct peer peer_norm_parity = { "NORM, 8 parity", open_parity, close_end, send_update, serve };
