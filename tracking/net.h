/*
 * What drivers of network devices share: numeric IPv4 addresses (both DTrack
 * and VRPN's connect-back are IPv4 alone), sockets, and waits that the end of
 * the device's thread cuts short.
 */
#ifndef GROTTO_TRACKING_NET_H
#define GROTTO_TRACKING_NET_H

#include "tracking/device.h"

#include <netinet/in.h>

#define TRACK_NET_TEXT 24 /* "255.255.255.255:65535" and a NUL */

/* Of "10.0.0.1"; NULL is any. False: no numeric IPv4 address. */
bool track_net_address(const char *text, uint16_t port, struct sockaddr_in *out);
/* As "10.0.0.1:3883", into out, which is returned. */
const char *track_net_text(const struct sockaddr_in *address, char out[TRACK_NET_TEXT]);
/*
 * Waits until fd has one of `events`, at most timeout_ms. GR_OK; GR_NOTHING:
 * not in that time; GR_ERR_STATE: the device's thread is to end.
 */
int track_net_wait(const struct track_device *device, int fd, short events, int timeout_ms);
/* Whole ms from now to a time, rounded up, 0 when it is past. */
int track_net_left_ms(const struct track_device *device, int64_t until_ns);
/*
 * A non-blocking socket (SOCK_DGRAM, SOCK_STREAM) bound to a local address,
 * port 0 for any. The descriptor, or -1 with errno.
 */
int track_net_socket(int type, const struct sockaddr_in *local);
/* The port that a socket is bound to; 0 when it is not. */
uint16_t track_net_port(int fd);
/* The state of a device whose socket was refused so. */
enum track_state track_net_state(int error);

#endif
