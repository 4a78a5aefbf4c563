/*
 * OpenPGM (RFC 3208), in UDP, to a group; NAKs after 100 us. The library sends at most 16
 * datagrams as one message: a long update goes as parts of one datagram each.
 */
#include <config.h>

#include "tools/bench/peer.h"

#ifdef HAVE_PGM

#include "base/clock.h"
#include "base/cursor.h"

#include <poll.h>
#include <pgm/pgm.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PART_HEAD 12       /* update, bytes of all of it, where this begins */
#define PART_BYTES 1388
#define WINDOW 8192        /* datagrams that may be asked for */
#define RATE_BYTES_S 500000000
#define FDS_MOST 8

struct end {
	pgm_sock_t *sock;
	size_t update_bytes;
	uint32_t update; /* sent last, or coming */
	size_t have;
	int64_t timer_ns; /* the library wants to be called then */
	/* Debian's 5.3.128 copies by aligned stores, and crashes where the bytes are not. */
	_Alignas(16) uint8_t part[PART_HEAD + PART_BYTES];
	uint8_t bytes[];
};

static bool set(pgm_sock_t *sock, int option, int value)
{
	return pgm_setsockopt(sock, IPPROTO_PGM, option, &value, sizeof value);
}

static bool set_sender(pgm_sock_t *sock)
{
	static const int heartbeats_us[] = { 500, 500, 1000, 4000, 16000, 65000, 250000, 1000000 };

	return set(sock, PGM_SEND_ONLY, 1) && set(sock, PGM_TXW_SQNS, WINDOW) &&
	       set(sock, PGM_TXW_MAX_RTE, RATE_BYTES_S) && set(sock, PGM_AMBIENT_SPM, 50000) &&
	       pgm_setsockopt(sock, IPPROTO_PGM, PGM_HEARTBEAT_SPM, heartbeats_us, sizeof heartbeats_us);
}

static bool set_receiver(pgm_sock_t *sock)
{
	return set(sock, PGM_RECV_ONLY, 1) && set(sock, PGM_RXW_SQNS, WINDOW) &&
	       set(sock, PGM_PEER_EXPIRY, 300 * 1000000) && set(sock, PGM_SPMR_EXPIRY, 250000) &&
	       set(sock, PGM_NAK_BO_IVL, 100) && set(sock, PGM_NAK_RPT_IVL, 2000) &&
	       set(sock, PGM_NAK_RDATA_IVL, 2000) && set(sock, PGM_NAK_DATA_RETRIES, 50) &&
	       set(sock, PGM_NAK_NCF_RETRIES, 50);
}

static bool join(pgm_sock_t *sock, const struct peer_place *place)
{
	char network[48];
	struct pgm_addrinfo_t *found = NULL;
	struct pgm_sockaddr_t at = { .sa_port = place->port, .sa_addr.sport = 0 };
	struct pgm_interface_req_t from = { 0 };
	bool ok;

	snprintf(network, sizeof network, "%s;%s",
		 place->cluster->addresses[place->sender ? place->cluster->node_count : place->node],
		 place->cluster->bench->group);
	if (!pgm_getaddrinfo(network, NULL, &found, NULL))
		return false;
	pgm_gsi_create_from_string(&at.sa_addr.gsi, network, -1);
	from.ir_interface = found->ai_recv_addrs[0].gsr_interface;
	memcpy(&from.ir_address, &found->ai_send_addrs[0].gsr_addr, sizeof(struct sockaddr_in));
	ok = pgm_bind3(sock, &at, sizeof at, &from, sizeof from, &from, sizeof from, NULL) &&
	     pgm_setsockopt(sock, IPPROTO_PGM, PGM_JOIN_GROUP, &found->ai_recv_addrs[0],
			    sizeof(struct pgm_group_source_req)) &&
	     pgm_setsockopt(sock, IPPROTO_PGM, PGM_SEND_GROUP, &found->ai_send_addrs[0],
			    sizeof(struct pgm_group_source_req)) &&
	     set(sock, PGM_MULTICAST_LOOP, 0) && set(sock, PGM_MULTICAST_HOPS, 1) &&
	     set(sock, PGM_NOBLOCK, 1) && pgm_connect(sock, NULL);
	pgm_freeaddrinfo(found);
	return ok;
}

static void close_end(void *end)
{
	struct end *e = end;

	if (e->sock)
		pgm_close(e->sock, false);
	pgm_shutdown();
	free(e);
}

static void *open_end(const struct peer_place *place)
{
	struct end *e = aligned_alloc(16, (sizeof *e + place->update_bytes + 15) & ~(size_t)15);

	if (!e)
		return NULL;
	memset(e, 0, sizeof *e);
	e->update_bytes = place->update_bytes;
	if (pgm_init(NULL) && pgm_socket(&e->sock, AF_INET, SOCK_SEQPACKET, IPPROTO_UDP, NULL) &&
	    set(e->sock, PGM_UDP_ENCAP_UCAST_PORT, place->port) &&
	    set(e->sock, PGM_UDP_ENCAP_MCAST_PORT, place->port) && set(e->sock, PGM_MTU, 1500) &&
	    set(e->sock, PGM_IP_ROUTER_ALERT, 0) &&
	    (place->sender ? set_sender(e->sock) : set_receiver(e->sock)) && join(e->sock, place))
		return e;
	fprintf(stderr, "OpenPGM: no socket on %s:%u\n", place->cluster->bench->group, place->port);
	close_end(e);
	return NULL;
}

static bool send_part(struct end *e, size_t len)
{
	int status;

	do
		status = pgm_send(e->sock, e->part, len, NULL);
	while (status == PGM_IO_STATUS_WOULD_BLOCK || status == PGM_IO_STATUS_RATE_LIMITED);
	return status == PGM_IO_STATUS_NORMAL;
}

static bool send_update(void *end, const uint8_t *bytes, size_t len)
{
	struct end *e = end;

	e->update++;
	for (size_t at = 0; at < len; at += PART_BYTES) {
		struct gr_writer w = gr_writer(e->part, sizeof e->part);

		gr_write_u32(&w, e->update);
		gr_write_u32(&w, (uint32_t)len);
		gr_write_u32(&w, (uint32_t)at);
		gr_write_bytes(&w, bytes + at, len - at < PART_BYTES ? len - at : PART_BYTES);
		if (!send_part(e, w.len))
			return false;
	}
	return true;
}

static void take_part(struct end *e, size_t got, peer_take_fn *take, void *ctx)
{
	struct gr_reader r = gr_reader(e->part, got);
	const uint32_t update = gr_read_u32(&r);
	const size_t len = gr_read_u32(&r), at = gr_read_u32(&r), part = gr_reader_left(&r);

	if (!r.ok || len > e->update_bytes || at > len || part > len - at)
		return;
	if (update != e->update) {
		e->update = update;
		e->have = 0;
	}
	memcpy(e->bytes + at, e->part + PART_HEAD, part);
	e->have += part;
	if (e->have == len)
		take(ctx, e->bytes, len);
}

/* Reads what there is; a sender, too, so that it hears NAKs. */
static void receive(struct end *e, peer_take_fn *take, void *ctx)
{
	struct timeval left = { 0, 0 };
	socklen_t size = sizeof left;
	size_t got;
	int status;

	e->timer_ns = INT64_MAX;
	for (;;) {
		status = pgm_recv(e->sock, e->part, sizeof e->part, MSG_DONTWAIT, &got, NULL);
		if (status == PGM_IO_STATUS_NORMAL)
			take_part(e, got, take, ctx);
		else if (status != PGM_IO_STATUS_RESET)
			break;
	}
	if ((status == PGM_IO_STATUS_TIMER_PENDING || status == PGM_IO_STATUS_RATE_LIMITED) &&
	    pgm_getsockopt(e->sock, IPPROTO_PGM,
			   status == PGM_IO_STATUS_TIMER_PENDING ? PGM_TIME_REMAIN : PGM_RATE_REMAIN, &left,
			   &size))
		e->timer_ns = gr_clock_now(&gr_clock_monotonic) + left.tv_sec * GR_NS_PER_S +
			      left.tv_usec * GR_NS_PER_US;
}

static void serve(void *end, int64_t until_ns, peer_take_fn *take, void *ctx)
{
	struct end *e = end;
	struct pollfd polled[FDS_MOST];
	int fds[FDS_MOST], count = FDS_MOST;

	receive(e, take, ctx);
	if (pgm_poll_info(e->sock, polled, &count, POLLIN) < 0)
		count = 0;
	for (int i = 0; i < count; i++)
		fds[i] = polled[i].fd;
	peer_wait(fds, (unsigned)count, e->timer_ns < until_ns ? e->timer_ns : until_ns);
	receive(e, take, ctx);
}

#else
#define open_end NULL
#define close_end NULL
#define send_update NULL
#define serve NULL
#endif

const struct peer peer_pgm = { "OpenPGM", open_end, close_end, send_update, serve };
