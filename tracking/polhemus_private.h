/* What polhemus_device.c and the two dialogues share. */
#ifndef GROTTO_TRACKING_POLHEMUS_PRIVATE_H
#define GROTTO_TRACKING_POLHEMUS_PRIVATE_H

#include "tracking/liberty.h"
#include "tracking/polhemus.h"
#include "tracking/polhemus_reports.h"
#include "tracking/polhemus_stream.h"
#include "tracking/usb.h"
#include "tracking/viper.h"

struct polhemus;

/* How a kind of them is spoken with. */
struct polhemus_talk {
	enum track_polhemus_style style;
	bool says_serial; /* another than its USB descriptor: only the start tells */
	/*
	 * Stops what it sends, sets it up, lets it send. TRACK_RUNNING with what it
	 * is in `why`; else the reason.
	 */
	enum track_state (*start)(struct polhemus *p, char *why, size_t size);
	void (*stop)(struct polhemus *p);
	/* A whole frame of the stream. */
	void (*frame)(struct polhemus *p, const uint8_t *bytes, size_t len);
};
extern const struct polhemus_talk polhemus_viper, polhemus_liberty;

#define POLHEMUS_PRODUCTS 4

struct polhemus_model {
	const char *kind, *name;
	const struct polhemus_talk *talk;
	double rate_hz; /* usual */
	/* bare: before its firmware is loaded; 0 ends both. */
	uint16_t products[POLHEMUS_PRODUCTS], bare[POLHEMUS_PRODUCTS];
};
extern const struct polhemus_model polhemus_models[TRACK_POLHEMUS_MODELS];

struct polhemus {
	struct track_device device;
	const struct polhemus_talk *talk;
	struct track_polhemus_params params; /* serial and path are below */
	char serial[64], path[40];
	double rate_hz; /* that it ought to have */
	struct track_usb usb;
	struct track_usb_node *node;
	struct track_polhemus_stream stream;
	struct track_polhemus_state state;
	bool running;	  /* what comes is published */
	int64_t heard_ns; /* when a frame came last, or it was started */
	/* What the dialogue waits for. */
	bool answered;
	struct track_viper_reply reply;	     /* VIPER's last */
	char said_serial[33];		     /* VIPER: what it says its serial number is */
	uint16_t detected, active;	     /* LIBERTY's stations */
	size_t body;			     /* LIBERTY: of the last pose that was asked for */
};

/*
 * Handles what comes until `answered` is set or the time is over. False: it
 * was not, the device is gone (with the reason), or the thread is to end.
 */
bool polhemus_await(struct polhemus *p, int timeout_ms, char *why, size_t size);
/* Until it has said nothing for quiet_ms; false when it still does after most_ms. */
bool polhemus_drain(struct polhemus *p, int quiet_ms, int most_ms);
/* Publishes what a frame's number says: lost sensors, frames that are missing. */
void polhemus_begin_frame(struct polhemus *p, uint32_t number);
void polhemus_publish(struct polhemus *p, const struct track_polhemus_sensor *sensor);

/* The driver's open: looks for the device, see struct track_device_ops. */
enum track_state polhemus_find(struct polhemus *p, char *why, size_t size);
/* Stops what it sends, sets it up and has it send; p->running is set when that was done. */
enum track_state polhemus_start(struct polhemus *p, char *why, size_t size);
void polhemus_be_silent(struct polhemus *p);
/* Bytes that have arrived; ctx: the struct polhemus. */
void polhemus_take(void *ctx, const uint8_t *bytes, size_t len);

#endif
