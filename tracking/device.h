/*
 * A tracking device: a driver's I/O on a thread of its own, and what it says
 * handed to the master without locks. docs/trackers.md, "How to write a
 * driver".
 *
 * A driver gives four calls (struct track_device_ops), all made by the
 * device's thread alone; they may block, up to the time they are told. The
 * rest is here: opening again after a failure or an unplugged cable, checks of
 * what the driver publishes, times, counters, status.
 *
 * Thread: create, start, destroy and everything marked "any thread" from
 * outside; everything marked "driver" from inside the four calls.
 */
#ifndef GROTTO_TRACKING_DEVICE_H
#define GROTTO_TRACKING_DEVICE_H

#include "base/clock.h"
#include "tracking/device_clock.h"
#include "tracking/handover.h"
#include "tracking/report.h"

#include <pthread.h>
#include <stdarg.h>

/* What a device's life has come to. */
enum track_state {
	TRACK_OFF,     /* its thread does not run */
	TRACK_ABSENT,  /* nothing of the kind is plugged in, or the peer does not answer */
	TRACK_DENIED,  /* there, but this user may not open it */
	TRACK_BUSY,    /* there, but somebody else has it */
	TRACK_FAILED,  /* there, but it does not do what it should */
	TRACK_RUNNING, /* open */
	TRACK_STATES,
};
/* "off", "absent", ... Never NULL. */
const char *track_state_name(enum track_state state);

#define TRACK_WHY 232 /* bytes of a status' text, with the final NUL */

/* As the device's thread saw it last; since_ns by CLOCK_MONOTONIC. */
struct track_status {
	int64_t since_ns;    /* of this state */
	uint64_t state;	     /* enum track_state */
	char why[TRACK_WHY]; /* why it is not running, or what was opened */
};

/* Counters since start. Whole numbers that only grow; read one by one. */
struct track_counters {
	uint64_t reports; /* published */
	uint64_t missed;  /* that the device sent but nobody got, by its own numbering */
	uint64_t opened;  /* times that it was opened */
	uint64_t steps;	  /* times that its clock was set */
	uint64_t faults[TRACK_FAULTS];
};

struct track_device;

struct track_device_ops {
	const char *kind; /* the layout's word for it: "hydra" */
	/*
	 * udev subsystem whose new devices are worth another try at open:
	 * "hidraw", "usb"; NULL: there is nothing to plug in (sockets).
	 */
	const char *subsystem;
	/* Names as a layout says them, each list ended by NULL; at most TRACK_SENSORS, 32,
	 * TRACK_AXES. */
	const char *const *sensors, *const *buttons, *const *axes;
	/*
	 * Finds and opens the device. TRACK_RUNNING, or the state that it is in
	 * instead; both with a line in `why` (what was opened; what is missing
	 * and what a person can do). Must not leave anything open unless running.
	 */
	enum track_state (*open)(struct track_device *device, char *why, size_t size);
	/*
	 * Waits for the device, at most timeout_ms (100 where the library cannot
	 * be woken) or until track_device_wake_fd is readable, and publishes what
	 * there is. GR_OK; GR_NOTHING: it said nothing; GR_ERR_IO: it is gone;
	 * any other error: it is broken. Both with a line in `why`; close follows.
	 */
	int (*read)(struct track_device *device, int timeout_ms, char *why, size_t size);
	/* Of what open opened: leaves the device as it was found, as far as it still answers. */
	void (*close)(struct track_device *device);
	/* Frees the driver's struct; the device is closed. */
	void (*destroy)(struct track_device *device);
};

/* First member of every driver's own struct. Drivers touch none of it. */
struct track_device {
	const struct track_device_ops *ops;
	const struct gr_clock *clock;
	struct track_handover handover;
	_Atomic uint64_t status_sequence, status_words[GR_SEQLOCK_WORDS(struct track_status)];
	_Atomic uint64_t counters[GR_SEQLOCK_WORDS(struct track_counters)];
	/* Of the device's thread alone. */
	struct track_status status;
	struct track_clock times;
	int64_t device_ns[TRACK_SENSORS], time_ns[TRACK_SENSORS]; /* last of each sensor */
	uint32_t seen;						  /* sensors with a device_ns */
	unsigned stale;						  /* in a row */
	int64_t retry_ns, back_off_ns;
	struct track_hotplug *hotplug;
	uint64_t status_stamp;
	bool is_open;
	/* Life. */
	_Atomic bool stop;
	int wake_fd; /* eventfd */
	bool started;
	pthread_t thread;
};

/*
 * For the driver's create: makes its struct (size bytes, zeroed, `ops` set).
 * clock: CLOCK_MONOTONIC, or a test's. GR_OK, GR_ERR_NOMEM, GR_ERR_IO.
 */
int track_device_alloc(void *out, size_t size, const struct track_device_ops *ops,
		       const struct gr_clock *clock);
/* Starts the thread; after privileges were given up. GR_OK, GR_ERR_IO. */
int track_device_start(struct track_device *device);
/* Stops the thread, closes, frees. *device may be NULL; it is after. */
void track_device_destroy(struct track_device **device);

/* Any thread: status and counters of now; never waits. */
void track_device_status(const struct track_device *device, struct track_status *out);
void track_device_counters(const struct track_device *device, struct track_counters *out);
/* Any thread: the next reports, see handover.h. */
int track_device_take(const struct track_device *device, struct track_reader *reader,
		      struct track_report *out, int room);

/*
 * Driver: a report has arrived. Sets its times, normalises its quaternion and
 * hands it over. What is refused is counted and goes nowhere: a pose that is
 * none, a sensor out of range, a device time that is not after the sensor's
 * last (but a clock that was set is followed: off by a second, or late eight
 * times in a row). GR_OK, or -enum track_fault.
 */
int track_device_publish(struct track_device *device, struct track_report *report);
/* Driver: something arrived that was no report. */
void track_device_fault(struct track_device *device, enum track_fault fault);
/* Driver: so many reports are missing between the last one and this. */
void track_device_missed(struct track_device *device, uint64_t reports);
/* Driver: readable when the thread is to end; to be polled beside the driver's own descriptors. */
int track_device_wake_fd(const struct track_device *device);
/* Driver: the time, for counters that wrap. CLOCK_MONOTONIC. */
int64_t track_device_now(const struct track_device *device);

/*
 * One turn of the device's life, on the caller's thread: open, or read, or
 * wait for another try, at most timeout_ms. The thread does nothing else until
 * it is told to stop; tests call it themselves.
 */
void track_device_turn(struct track_device *device, int timeout_ms);

#endif
