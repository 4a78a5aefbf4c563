/*
 * A connection to a VRPN server: sockets, and what is on its way in and out.
 * Private to the driver (vrpn_device.c); nothing here waits but the two that
 * open it.
 */
#ifndef GROTTO_TRACKING_VRPN_LINK_H
#define GROTTO_TRACKING_VRPN_LINK_H

#include "tracking/vrpn.h"

#include <netinet/in.h>

struct track_vrpn_link {
	int tcp, udp;		   /* -1: none */
	struct sockaddr_in server; /* as the layout says it */
	struct sockaddr_in local;  /* ours, as the server reaches us; port of the udp socket */
	int64_t patience_ns;	   /* for each of: connection, cookie */
	uint8_t in[TRACK_VRPN_MESSAGE_MOST];
	size_t in_len;
	uint8_t out[1024]; /* that the kernel has not taken yet */
	size_t out_len;
};

/*
 * Opens the connection, until the server's cookie is here and ours is on its
 * way: to the server's port (udp false), or from the server after a datagram
 * that asks for it. TRACK_RUNNING, or the state with a line in `why`; what was
 * opened is closed by track_vrpn_link_close in either case.
 */
enum track_state track_vrpn_link_open(struct track_vrpn_link *link, struct track_device *device,
				      bool udp, char *why, size_t size);
void track_vrpn_link_close(struct track_vrpn_link *link);

/* Waits for bytes of the server, at most timeout_ms or until the thread is to end. */
void track_vrpn_link_wait(const struct track_vrpn_link *link, const struct track_device *device,
			  int timeout_ms);
/*
 * Takes what the connection has, as far as there is room in `in`. GR_OK;
 * GR_NOTHING; GR_ERR_IO, with a line in `why`: it has ended.
 */
int track_vrpn_link_receive(struct track_vrpn_link *link, char *why, size_t size);
/* Takes `used` bytes off the front of `in`. */
void track_vrpn_link_pass(struct track_vrpn_link *link, size_t used);
/* A datagram of the server into bytes: its length, or -1 when there is none. */
ssize_t track_vrpn_link_datagram(struct track_vrpn_link *link, uint8_t *bytes, size_t size);
/*
 * Queues a message, and hands over what the kernel takes; one for which there
 * is no room (the server does not read) is left out.
 */
void track_vrpn_link_send(struct track_vrpn_link *link, const struct track_vrpn_message *message);
void track_vrpn_link_describe(struct track_vrpn_link *link, int32_t what, int32_t id,
			      const char *name);

#endif
