/*
 * A client of VRPN, the protocol by which most trackers of labs can be had: a
 * server names its devices, and each has tracker sensors "0" .. "31", buttons
 * "0" .. "31" and analog channels "a0" .. "a7". Buttons and channels belong to
 * the device as a whole, so they stand beside the pose of every sensor.
 *
 * What of this is known how. Connecting either way, the cookie, the messages'
 * frame, system messages, poses, ping and pong: checked byte by byte against
 * a running vrpn_server 07.38. Buttons, channels and what the server does with
 * names that come later: from its source (vrpn_Connection.C, vrpn_Tracker.C,
 * vrpn_Button.C, vrpn_Analog.C, vrpn_BaseClass.C). Other vendors' servers were
 * not tried.
 *
 * Frame and units are the server's; by convention metres. A server says
 * neither axes nor handedness: the layout's `base` turns them.
 */
#ifndef GROTTO_TRACKING_VRPN_H
#define GROTTO_TRACKING_VRPN_H

#include "tracking/device.h"

#define TRACK_VRPN_COOKIE 24
#define TRACK_VRPN_HEADER 24
#define TRACK_VRPN_BODY_MOST 65504 /* VRPN's own buffers hold 64,000 bytes */
#define TRACK_VRPN_MESSAGE_MOST (TRACK_VRPN_HEADER + TRACK_VRPN_BODY_MOST)
#define TRACK_VRPN_NAME 100 /* bytes of a name, with the NUL */
#define TRACK_VRPN_IDS 2000 /* of senders, and of types */
#define TRACK_VRPN_SENSORS 32
#define TRACK_VRPN_SILENCE_NS (10 * GR_NS_PER_S)
#define TRACK_VRPN_PATIENCE_NS (2 * GR_NS_PER_S)

/* ---- bytes: pure ---- */

/* Types of messages that need no name. */
enum track_vrpn_system {
	TRACK_VRPN_SENDER = -1,
	TRACK_VRPN_TYPE = -2,
	TRACK_VRPN_UDP = -3,
	TRACK_VRPN_LOG = -4,
	TRACK_VRPN_DISCONNECT = -5,
};

struct track_vrpn_message {
	int64_t time_ns; /* since 1970, by the sender's clock */
	int32_t sender, type;
	const uint8_t *body; /* within the bytes that were decoded */
	size_t len;
};

void track_vrpn_cookie(uint8_t out[TRACK_VRPN_COOKIE]);
/* GR_OK, GR_ERR_FORMAT (no VRPN), GR_ERR_VERSION (another one than 07). */
int track_vrpn_check_cookie(const uint8_t bytes[TRACK_VRPN_COOKIE]);
/*
 * The message that the bytes begin with, and how many it takes of them. GR_OK;
 * GR_NOTHING: there must be more bytes; -TRACK_FAULT_LENGTH: it says that it is
 * of a length that none has.
 */
int track_vrpn_decode(const uint8_t *bytes, size_t len, struct track_vrpn_message *out,
		      size_t *used);
/* Appends a message; false, and nothing is written, where there is no room. */
bool track_vrpn_encode(const struct track_vrpn_message *message, uint8_t *out, size_t room,
		       size_t *len);
/* Appends the description of a sender's or a type's name (TRACK_VRPN_SENDER, TRACK_VRPN_TYPE). */
bool track_vrpn_describe(int32_t what, int32_t id, const char *name, uint8_t *out, size_t room,
			 size_t *len);

/* ---- what a connection has said so far: pure ---- */

/* All zero but `device` at the start of a connection: names have other numbers in the next. */
struct track_vrpn_state {
	char device[TRACK_VRPN_NAME];
	bool there;	/* the server has named the device, */
	int32_t sender; /* so */
	char others[120]; /* names of its other devices, for messages; printable */
	uint8_t types[TRACK_VRPN_IDS]; /* what they are to us */
	uint32_t seen;		       /* sensors of which there was a pose */
	bool has_buttons, has_axes;
	uint32_t buttons;
	uint32_t axis_count;
	float axes[TRACK_AXES];
	bool has_zero;
	int64_t zero_ns, last_ns[TRACK_VRPN_SENSORS]; /* of the server's clock */
};

struct track_vrpn_reports {
	bool ended; /* the server takes its leave */
	unsigned count;
	struct track_report reports[TRACK_VRPN_SENSORS];
};

/*
 * Takes a message; datagram: it came as one, and may be a duplicate. GR_OK;
 * GR_NOTHING: it is none of ours; -enum track_fault.
 */
int track_vrpn_take(struct track_vrpn_state *state, const struct track_vrpn_message *message,
		    bool datagram, struct track_vrpn_reports *out);
/* What a device without poses said last, once more: it says nothing while it rests. */
void track_vrpn_rest(const struct track_vrpn_state *state, struct track_vrpn_reports *out);

/* ---- driver ---- */

/* Borrowed while the device is made. */
struct track_vrpn_params {
	const char *device;  /* the server's name for it, without "@host" */
	const char *address; /* of the server, numeric IPv4 */
	uint16_t port;
	bool udp; /* the server connects back, and poses come as datagrams; else all by one connection */
	int64_t silence_ns;  /* after which it is connected anew; 0: TRACK_VRPN_SILENCE_NS */
	int64_t patience_ns; /* with each step of connecting; 0: TRACK_VRPN_PATIENCE_NS */
};
/* GR_OK, GR_ERR_NOMEM, GR_ERR_IO, GR_ERR_RANGE (an address or a name that is none). */
int track_vrpn_create(struct track_device **out, const struct track_vrpn_params *params,
		      const struct gr_clock *clock);

#endif
