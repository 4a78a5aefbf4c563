/*
 * A VIPER, LIBERTY or PATRIOT on the mocked USB: takes the commands that its
 * maker's document has, answers them, and sends frames when told to.
 *
 * Thread: any.
 */
#ifndef GROTTO_TESTS_UNIT_MOCK_POLHEMUS_H
#define GROTTO_TESTS_UNIT_MOCK_POLHEMUS_H

#include "tests/unit/mock_usb.h"

#include <pthread.h>

#define MOCK_POLHEMUS_COMMANDS 64

struct mock_polhemus {
	/* Set before it is plugged in; zeroes: a LIBERTY of one station, at 1-2. */
	bool viper;
	uint16_t product; /* 0: VIPER's or LIBERTY's */
	int number;	  /* of the node and port; 0: 2 */
	uint16_t packet;  /* 0: 64 */
	const char *usb_serial, *serial; /* of the descriptor; as a VIPER says */
	uint32_t sensors; /* bit by sensor; 0: the first */
	bool no_sensors;
	bool sending;	  /* since before it was plugged in */
	bool mute;	  /* answers nothing */
	bool not_ready;	  /* VIPER: says so */
	bool no_button;	  /* LIBERTY: does not know that item */
	bool other_list;  /* LIBERTY: knows none of the lists */
	bool never_stops; /* LIBERTY: sends whatever it is told */
	bool busy, denied, unconfigured, no_endpoints;
	uint32_t refuses; /* VIPER: commands, bit by number */
	/* As it was told. */
	pthread_mutex_t lock;
	char commands[MOCK_POLHEMUS_COMMANDS][32]; /* LIBERTY's lines; VIPER's "number action" */
	unsigned command_count, empty_packets;
	uint32_t units[2], rate, hemisphere_bits, predicts, filter_level;
	float hemisphere[3];
	bool binary, centimetres;
	size_t body;
	uint32_t frame; /* the next one's number */
	/* Of a transfer that is not whole yet. */
	uint8_t pending[256];
	size_t pending_len;
	struct mock_usb *usb;
};

void mock_polhemus_plug(struct mock_polhemus *p, UMockdevTestbed *bed);
void mock_polhemus_unplug(struct mock_polhemus *p);
/* After unplug, once no client has it open; may be plugged in again. */
void mock_polhemus_finish(struct mock_polhemus *p);
/* The next frame, of all sensors, if it is to send. */
void mock_polhemus_tick(struct mock_polhemus *p);
bool mock_polhemus_sends(struct mock_polhemus *p);
/* How often it was told this; of a VIPER: "19 0". */
unsigned mock_polhemus_heard(struct mock_polhemus *p, const char *command);

#endif
