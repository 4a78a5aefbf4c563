/* VRPN's driver: a connection that is greeted, listened to, and asked whether it lives. */
#include "tracking/net.h"
#include "tracking/vrpn_link.h"

#include "base/log.h"
#include "base/result.h"

#include <arpa/inet.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAMES_NS (2 * GR_NS_PER_S)   /* for the server to name its devices */
#define PING_NS GR_NS_PER_S	     /* of silence, and between two pings */
#define WARN_NS (3 * GR_NS_PER_S)    /* of silence */
#define REST_NS (50 * GR_NS_PER_MS)  /* between two reports of a device that rests */
#define RECEIVES_MOST 16	     /* in one go: the thread must hear that it is to end */
#define DATAGRAMS_MOST 64	     /* likewise */
#define PING_TYPE 0		     /* our numbers of the two names that we give */
#define OUR_SENDER 0

struct vrpn {
	struct track_device device;
	char name[TRACK_VRPN_NAME];
	bool udp, is_open, warned;
	int64_t silence_ns;
	int64_t heard_ns, pinged_ns, said_ns; /* the server; to it; to the room */
	struct track_vrpn_link link;
	struct track_vrpn_state state;
	struct track_vrpn_reports reports;
	uint8_t datagram[TRACK_VRPN_MESSAGE_MOST];
};

static void close_vrpn(struct track_device *device)
{
	struct vrpn *v = (struct vrpn *)device;

	v->is_open = false;
	track_vrpn_link_close(&v->link);
}

static void ping(struct vrpn *v)
{
	const struct track_vrpn_message message = { .sender = OUR_SENDER,
						    .type = PING_TYPE,
						    .body = (const uint8_t *)"" };

	track_vrpn_link_send(&v->link, &message);
	v->pinged_ns = track_device_now(&v->device);
}

/* Names first: the server answers pings of a sender whose name it has, too. */
static void introduce(struct vrpn *v)
{
	char host[INET_ADDRSTRLEN] = "";

	track_vrpn_link_describe(&v->link, TRACK_VRPN_SENDER, OUR_SENDER, v->name);
	track_vrpn_link_describe(&v->link, TRACK_VRPN_TYPE, PING_TYPE, "vrpn_Base ping_message");
	if (v->udp) {
		(void)inet_ntop(AF_INET, &v->link.local.sin_addr, host, sizeof host);
		track_vrpn_link_send(&v->link, &(struct track_vrpn_message){
						       .sender = ntohs(v->link.local.sin_port),
						       .type = TRACK_VRPN_UDP,
						       .body = (const uint8_t *)host,
						       .len = strlen(host) + 1 });
	}
	ping(v);
}

/* ---- what comes in ---- */

static void publish(struct vrpn *v)
{
	/* Before it is open the clock is still that of the connection before. */
	if (!v->is_open)
		return;
	for (unsigned i = 0; i < v->reports.count; i++)
		(void)track_device_publish(&v->device, &v->reports.reports[i]);
	if (v->reports.count)
		v->said_ns = track_device_now(&v->device);
}

/* False: the server takes its leave. */
static bool take(struct vrpn *v, const struct track_vrpn_message *message, bool datagram)
{
	const int r = track_vrpn_take(&v->state, message, datagram, &v->reports);

	if (r < 0)
		track_device_fault(&v->device, (enum track_fault) - r);
	else
		publish(v);
	return r < 0 || !v->reports.ended;
}

static void heard(struct vrpn *v)
{
	v->heard_ns = track_device_now(&v->device);
	v->warned = false;
}

/* All whole messages in the link's buffer. */
static int take_stream(struct vrpn *v, char *why, size_t size)
{
	struct track_vrpn_message message;
	size_t at = 0, used;
	int r;

	while ((r = track_vrpn_decode(v->link.in + at, v->link.in_len - at, &message, &used)) ==
	       GR_OK) {
		at += used;
		if (!take(v, &message, false)) {
			snprintf(why, size, "the VRPN server has ended");
			return GR_ERR_IO;
		}
	}
	track_vrpn_link_pass(&v->link, at);
	if (r == GR_NOTHING)
		return GR_OK;
	/* Where the next message begins is not known any more. */
	track_device_fault(&v->device, (enum track_fault) - r);
	snprintf(why, size, "the VRPN server sent a message of a length that none has");
	return GR_ERR_FORMAT;
}

static int read_stream(struct vrpn *v, char *why, size_t size)
{
	for (int i = 0; i < RECEIVES_MOST; i++) {
		int r = track_vrpn_link_receive(&v->link, why, size);

		if (r != GR_OK)
			return r;
		heard(v);
		r = take_stream(v, why, size);
		if (r < 0)
			return r;
	}
	return GR_OK;
}

static void read_datagrams(struct vrpn *v)
{
	for (int i = 0; i < DATAGRAMS_MOST; i++) {
		const ssize_t n =
			track_vrpn_link_datagram(&v->link, v->datagram, sizeof v->datagram);
		struct track_vrpn_message message;
		size_t at = 0, used;
		int r;

		if (n < 0)
			return;
		heard(v);
		while ((r = track_vrpn_decode(v->datagram + at, (size_t)n - at, &message, &used)) ==
		       GR_OK) {
			at += used;
			(void)take(v, &message, true);
		}
		if (r < 0 || at < (size_t)n)
			track_device_fault(&v->device, TRACK_FAULT_LENGTH);
	}
}

/* ---- life ---- */

/* Until the server has named the device: it says all names at once. */
static enum track_state find_device(struct vrpn *v, char *why, size_t size)
{
	const int64_t until_ns = track_device_now(&v->device) + NAMES_NS;
	char text[TRACK_NET_TEXT];

	/* What came behind the cookie. */
	if (take_stream(v, why, size) < 0)
		return TRACK_FAILED;
	while (!v->state.there && track_device_now(&v->device) < until_ns) {
		const int r = track_net_wait(&v->device, v->link.tcp, POLLIN,
					     track_net_left_ms(&v->device, until_ns));
		if (r == GR_ERR_STATE)
			break;
		if (read_stream(v, why, size) < 0)
			return TRACK_ABSENT;
	}
	track_net_text(&v->link.server, text);
	if (v->state.there) {
		snprintf(why, size, "%s at %s by %s", v->name, text, v->udp ? "UDP" : "TCP");
		return TRACK_RUNNING;
	}
	snprintf(why, size, "the VRPN server at %s has no device \"%s\"%s%s", text, v->name,
		 v->state.others[0] ? "; it has " : ", nor any other", v->state.others);
	return TRACK_ABSENT;
}

static enum track_state open_vrpn(struct track_device *device, char *why, size_t size)
{
	struct vrpn *v = (struct vrpn *)device;
	enum track_state state;

	v->state = (struct track_vrpn_state){ 0 };
	memcpy(v->state.device, v->name, sizeof v->name);
	state = track_vrpn_link_open(&v->link, device, v->udp, why, size);
	if (state == TRACK_RUNNING) {
		introduce(v);
		heard(v);
		state = find_device(v, why, size);
	}
	v->is_open = state == TRACK_RUNNING;
	if (!v->is_open)
		close_vrpn(device);
	return state;
}

/* Asks a silent server whether it lives; false: it does not. */
static bool alive(struct vrpn *v, char *why, size_t size)
{
	const int64_t now_ns = track_device_now(&v->device);
	const int64_t silent_ns = now_ns - v->heard_ns;
	char text[TRACK_NET_TEXT];

	if (silent_ns > v->silence_ns) {
		snprintf(why, size, "the VRPN server at %s has not answered for %d s",
			 track_net_text(&v->link.server, text), (int)(silent_ns / GR_NS_PER_S));
		return false;
	}
	if (silent_ns > WARN_NS && !v->warned) {
		gr_warning("%s: the VRPN server at %s has not answered for %d s", v->name,
			   track_net_text(&v->link.server, text), (int)(silent_ns / GR_NS_PER_S));
		v->warned = true;
	}
	if (silent_ns > PING_NS && now_ns - v->pinged_ns > PING_NS)
		ping(v);
	return true;
}

/* A device of buttons alone says nothing until one is pressed; it is there nevertheless. */
static void rest(struct vrpn *v)
{
	if (track_device_now(&v->device) - v->said_ns < REST_NS)
		return;
	track_vrpn_rest(&v->state, &v->reports);
	publish(v);
}

static int read_vrpn(struct track_device *device, int timeout_ms, char *why, size_t size)
{
	struct vrpn *v = (struct vrpn *)device;
	const int rest_ms = (int)(REST_NS / GR_NS_PER_MS);
	int r;

	if (!v->state.seen && timeout_ms > rest_ms)
		timeout_ms = rest_ms;
	track_vrpn_link_wait(&v->link, device, timeout_ms);
	read_datagrams(v);
	r = read_stream(v, why, size);
	if (r < 0)
		return r;
	if (!alive(v, why, size))
		return GR_ERR_IO;
	rest(v);
	return r;
}

static void destroy_vrpn(struct track_device *device)
{
	free(device);
}

/* Of sensors, and of buttons. */
static const char *const numbers[] = {
	"0",  "1",  "2",  "3",	"4",  "5",  "6",  "7",	"8",  "9",  "10",
	"11", "12", "13", "14", "15", "16", "17", "18", "19", "20", "21",
	"22", "23", "24", "25", "26", "27", "28", "29", "30", "31", NULL
};
static const char *const axis_names[] = { "a0", "a1", "a2", "a3", "a4", "a5", "a6", "a7", NULL };

static const struct track_device_ops vrpn_ops = {
	.kind = "vrpn",
	.sensors = numbers,
	.buttons = numbers,
	.axes = axis_names,
	.open = open_vrpn,
	.read = read_vrpn,
	.close = close_vrpn,
	.destroy = destroy_vrpn,
};

int track_vrpn_create(struct track_device **out, const struct track_vrpn_params *params,
		      const struct gr_clock *clock)
{
	struct sockaddr_in server;
	struct vrpn *v;
	int r;

	if (!params->device || !params->device[0] || strlen(params->device) >= TRACK_VRPN_NAME ||
	    !params->address || !track_net_address(params->address, params->port, &server))
		return GR_ERR_RANGE;
	r = track_device_alloc(&v, sizeof *v, &vrpn_ops, clock);
	if (r < 0)
		return r;
	snprintf(v->name, sizeof v->name, "%s", params->device);
	v->udp = params->udp;
	v->silence_ns = params->silence_ns ? params->silence_ns : TRACK_VRPN_SILENCE_NS;
	v->link.patience_ns =
		params->patience_ns ? params->patience_ns : TRACK_VRPN_PATIENCE_NS;
	v->link.server = server;
	v->link.tcp = v->link.udp = -1;
	*out = &v->device;
	return GR_OK;
}
