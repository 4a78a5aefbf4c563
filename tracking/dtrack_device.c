/* DTrack's socket. The controller sends; nothing is asked of it. */
#include "tracking/dtrack.h"
#include "tracking/net.h"

#include "base/result.h"

#include <arpa/inet.h>
#include <errno.h>
#include <net/if.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define LISTEN_NS GR_NS_PER_S	    /* for a first frame, before it is told that none comes */
#define BATCH 64		    /* datagrams at a time: the thread must hear that it is to end */
#define KNOCK_PORT 50107	    /* of the controller, for a firewall on the way */

struct dtrack {
	struct track_device device;
	struct track_dtrack_setup setup;
	struct sockaddr_in local, controller;
	struct ip_mreqn group;
	char interface_name[IF_NAMESIZE];
	bool has_controller, has_group, knock;
	int fd;
	int64_t heard_ns, silence_ns;
	struct sockaddr_in stranger; /* who sent last that was not the controller */
	struct track_dtrack_state state;
	struct track_dtrack_frame frame;
	struct track_dtrack_reports reports;
	uint8_t bytes[TRACK_DTRACK_BYTES];
};

static void close_dtrack(struct track_device *device)
{
	struct dtrack *d = (struct dtrack *)device;

	if (d->fd >= 0)
		close(d->fd);
	d->fd = -1;
}

static enum track_state refused(struct dtrack *d, const char *what, char *why, size_t size)
{
	const int error = errno;

	snprintf(why, size, "%s (UDP port %u): %s%s", what, (unsigned)ntohs(d->local.sin_port),
		 strerror(error),
		 error == EADDRINUSE ? "; another program, or another tracker of the layout, has it"
				     : "");
	close_dtrack(&d->device);
	return track_net_state(error);
}

static bool join(struct dtrack *d)
{
	if (d->interface_name[0]) {
		d->group.imr_ifindex = (int)if_nametoindex(d->interface_name);
		if (!d->group.imr_ifindex)
			return false;
	}
	return setsockopt(d->fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &d->group, sizeof d->group) == 0;
}

/*
 * A firewall that keeps states lets the controller's datagrams in after one has
 * gone out to it from the port that they come to.
 */
static void knock(struct dtrack *d)
{
	struct sockaddr_in to = d->controller;
	static const uint8_t nothing[1] = { 0 };

	to.sin_port = htons(KNOCK_PORT);
	if (d->knock && d->has_controller)
		(void)sendto(d->fd, nothing, sizeof nothing, 0, (struct sockaddr *)&to, sizeof to);
}

/*
 * A datagram of the controller into d->bytes, of *len bytes. GR_OK, GR_NOTHING
 * (none is there), GR_ERR_IO. Those of others are thrown away.
 */
static int receive(struct dtrack *d, int flags, size_t *len)
{
	for (int i = 0; i < BATCH; i++) {
		struct sockaddr_in from = { 0 };
		socklen_t from_len = sizeof from;
		const ssize_t n = recvfrom(d->fd, d->bytes, sizeof d->bytes, flags,
					   (struct sockaddr *)&from, &from_len);

		if (n < 0)
			return errno == EAGAIN || errno == EINTR ? GR_NOTHING : GR_ERR_IO;
		if (!d->has_controller || from.sin_addr.s_addr == d->controller.sin_addr.s_addr) {
			*len = (size_t)n;
			return GR_OK;
		}
		d->stranger = from;
		if (flags & MSG_PEEK)
			(void)recv(d->fd, d->bytes, 0, 0);
	}
	return GR_NOTHING;
}

/* Throws away what is no frame, and leaves the first one where it is. */
static bool first_frame(struct dtrack *d)
{
	size_t len;

	while (receive(d, MSG_PEEK, &len) == GR_OK) {
		const int r = track_dtrack_decode(d->bytes, len, &d->frame);

		if (r == GR_OK)
			return true;
		track_device_fault(&d->device, (enum track_fault) - r);
		(void)recv(d->fd, d->bytes, 0, 0);
	}
	return false;
}

static void say_silent(const struct dtrack *d, char *why, size_t size)
{
	char from[TRACK_NET_TEXT], to[TRACK_NET_TEXT];

	if (d->stranger.sin_port)
		snprintf(why, size, "nothing comes to UDP port %u from %s, but from %s",
			 (unsigned)ntohs(d->local.sin_port), track_net_text(&d->controller, to),
			 track_net_text(&d->stranger, from));
	else
		snprintf(why, size,
			 "nothing comes to UDP port %u: start the measurement, and have the "
			 "controller send its data to this machine and port",
			 (unsigned)ntohs(d->local.sin_port));
}

static enum track_state open_dtrack(struct track_device *device, char *why, size_t size)
{
	struct dtrack *d = (struct dtrack *)device;
	const int64_t until_ns = track_device_now(device) + LISTEN_NS;
	int left_ms = 1;

	d->stranger = (struct sockaddr_in){ 0 };
	d->fd = track_net_socket(SOCK_DGRAM, &d->local);
	if (d->fd < 0)
		return refused(d, "cannot listen", why, size);
	if (d->has_group && !join(d))
		return refused(d, "cannot join the multicast group", why, size);
	knock(d);
	while (left_ms > 0) {
		if (first_frame(d)) {
			d->state = (struct track_dtrack_state){ 0 };
			d->heard_ns = track_device_now(device);
			snprintf(why, size, "UDP port %u", (unsigned)ntohs(d->local.sin_port));
			return TRACK_RUNNING;
		}
		left_ms = track_net_left_ms(device, until_ns);
		if (track_net_wait(device, d->fd, POLLIN, left_ms) == GR_ERR_STATE)
			break;
	}
	say_silent(d, why, size);
	close_dtrack(device);
	return TRACK_ABSENT;
}

static void take(struct dtrack *d, size_t len)
{
	int r = track_dtrack_decode(d->bytes, len, &d->frame);

	if (r == GR_OK)
		r = track_dtrack_take(&d->state, &d->setup, &d->frame, track_device_now(&d->device),
				      &d->reports);
	if (r < 0) {
		track_device_fault(&d->device, (enum track_fault) - r);
		return;
	}
	d->heard_ns = track_device_now(&d->device);
	track_device_missed(&d->device, d->reports.missed);
	for (unsigned i = 0; i < d->frame.beyond; i++)
		track_device_fault(&d->device, TRACK_FAULT_SENSOR);
	for (unsigned i = 0; i < d->reports.bad_poses; i++)
		track_device_fault(&d->device, TRACK_FAULT_POSE);
	for (unsigned i = 0; i < d->reports.count; i++)
		(void)track_device_publish(&d->device, &d->reports.reports[i]);
}

static int read_dtrack(struct track_device *device, int timeout_ms, char *why, size_t size)
{
	struct dtrack *d = (struct dtrack *)device;
	int r = GR_NOTHING;
	size_t len;

	(void)track_net_wait(device, d->fd, POLLIN, timeout_ms);
	for (int i = 0; i < BATCH && (r = receive(d, 0, &len)) == GR_OK; i++)
		take(d, len);
	if (r == GR_ERR_IO) {
		snprintf(why, size, "UDP port %u: %s", (unsigned)ntohs(d->local.sin_port),
			 strerror(errno));
		return r;
	}
	if (track_device_now(device) - d->heard_ns > d->silence_ns) {
		say_silent(d, why, size);
		return GR_ERR_IO; /* as if it were not there */
	}
	return r;
}

static void destroy_dtrack(struct track_device *device)
{
	free(device);
}

static const char *const sensors[TRACK_DTRACK_SENSORS + 1] = {
	"body0",      "body1",	    "body2",	  "body3",	"body4",  "body5",  "body6",
	"body7",      "body8",	    "body9",	  "body10",	"body11", "flystick0",
	"flystick1",  "flystick2",  "flystick3",  "tool0",	"tool1",  "tool2",  "tool3",
	"joint0",     "joint1",	    "joint2",	  "joint3",	"joint4", "joint5", "joint6",
	"joint7",     "joint8",	    "joint9",	  "joint10",	"joint11",
};
/* As Flystick2 and 3 number them: the trigger, the back from right to left, the stick's click. */
static const char *const button_names[] = { "trigger", "1",  "2",  "3",	 "4",  "stick", "6",  "7",
					    "8",       "9",  "10", "11", "12", "13",	"14", "15",
					    NULL };
static const char *const axis_names[] = { "stick_x", "stick_y", "axis2", "axis3", "axis4",
					  "axis5",   "axis6",	"axis7", NULL };

static const struct track_device_ops dtrack_ops = {
	.kind = "dtrack",
	.sensors = sensors,
	.buttons = button_names,
	.axes = axis_names,
	.open = open_dtrack,
	.read = read_dtrack,
	.close = close_dtrack,
	.destroy = destroy_dtrack,
};

int track_dtrack_create(struct track_device **out, const struct track_dtrack_params *params,
			const struct gr_clock *clock)
{
	struct sockaddr_in local, controller, group;
	struct dtrack *d;
	int r;

	if (!track_net_address(NULL, params->port, &local) ||
	    !track_net_address(params->address, 0, &controller) ||
	    !track_net_address(params->group, 0, &group) ||
	    (params->interface_name && strlen(params->interface_name) >= IF_NAMESIZE))
		return GR_ERR_RANGE;
	r = track_device_alloc(&d, sizeof *d, &dtrack_ops, clock);
	if (r < 0)
		return r;
	d->fd = -1;
	d->setup = params->setup;
	d->local = local;
	d->controller = controller;
	d->has_controller = params->address != NULL;
	d->group.imr_multiaddr = group.sin_addr;
	d->has_group = params->group != NULL;
	d->knock = params->knock;
	d->silence_ns = params->silence_ns ? params->silence_ns : TRACK_DTRACK_SILENCE_NS;
	if (params->interface_name)
		snprintf(d->interface_name, sizeof d->interface_name, "%s", params->interface_name);
	*out = &d->device;
	return GR_OK;
}
