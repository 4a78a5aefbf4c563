/*
 * A DTrack controller over UDP on loopback, on a thread of its own: Flystick 0 of
 * a wand, whose tip is where a test puts it in a room.
 */
#ifndef GROTTO_TESTS_UNIT_MOCK_DTRACK_H
#define GROTTO_TESTS_UNIT_MOCK_DTRACK_H

#include "tests/unit/align_room.h"
#include "tests/unit/net_device.h"

#include <pthread.h>

#define PERIOD_NS (4 * GR_NS_PER_MS)

enum motion { MOTION_STILL, MOTION_SHAKE, MOTION_TURN };

/* What the controller sends, each 4 ms, until it is told otherwise. */
struct controller {
	int fd;
	uint16_t port;
	pthread_t thread;
	pthread_mutex_t lock;
	bool stop, button;
	enum motion motion;
	double at[3]; /* the wand's tip in the room */
	struct rotation turn;
	struct dmat3 R; /* R_room_base, and its origin there: the truth */
	double t[3];
	double arm[3]; /* from the sensor to the tip, sensor's frame */
	_Atomic unsigned sent;
};

static inline void send_frame(struct controller *c, unsigned number)
{
	/* By the clock: a machine that is slow sends less, and moves as fast. */
	const double phase = (double)(gr_clock_now(&gr_clock_monotonic) % (1000 * GR_NS_PER_S)) * 1e-9 * 12.5;
	struct rotation turn = c->turn;
	double at[3], to[3];
	struct dmat3 R;
	char text[500];
	int len;

	if (c->motion == MOTION_TURN)
		turn = rotation_by(&turn, (double[]){ 0.6 * sin(phase), 0.5 * sin(1.3 * phase), 0.6 * cos(0.7 * phase) });
	R = dmat3_from_rotation(&turn);
	dmat3_apply(&R, c->arm, to);
	for (int i = 0; i < 3; i++)
		at[i] = c->at[i] - c->t[i];
	if (c->motion == MOTION_SHAKE)
		at[1] += 0.05 * sin(phase);
	dmat3_apply_transposed(&c->R, at, at);
	for (int i = 0; i < 3; i++)
		at[i] = (at[i] - to[i]) * 1e3;
	len = snprintf(text, sizeof text,
		       "fr %u\r\n6df2 1 1 [0 1.000 4 2][%.3f %.3f %.3f][%.6f %.6f %.6f %.6f %.6f %.6f %.6f %.6f %.6f][%d 0 "
		       "0]\r\n",
		       number, at[0], at[1], at[2], R.m[0][0], R.m[1][0], R.m[2][0], R.m[0][1], R.m[1][1], R.m[2][1],
		       R.m[0][2], R.m[1][2], R.m[2][2], c->button);
	(void)sendto(c->fd, text, (size_t)len, 0,
		     (const struct sockaddr *)&(struct sockaddr_in){ .sin_family = AF_INET,
								     .sin_port = htons(c->port),
								     .sin_addr.s_addr = htonl(INADDR_LOOPBACK) },
		     sizeof(struct sockaddr_in));
}

static inline void *run_controller(void *ctx)
{
	struct controller *c = ctx;

	for (bool stop = false; !stop;) {
		pthread_mutex_lock(&c->lock);
		send_frame(c, ++c->sent);
		stop = c->stop;
		pthread_mutex_unlock(&c->lock);
		nanosleep(&(struct timespec){ 0, PERIOD_NS }, NULL);
	}
	return NULL;
}

/* The wand goes there; what was sent before is over. */
static inline void put_wand(struct controller *c, const double at[3], enum motion motion, struct unit_random *r)
{
	unsigned since;

	pthread_mutex_lock(&c->lock);
	memcpy(c->at, at, sizeof c->at);
	c->motion = motion;
	c->turn = align_turn(r);
	since = c->sent;
	pthread_mutex_unlock(&c->lock);
	while (c->sent < since + 5)
		nanosleep(&(struct timespec){ 0, PERIOD_NS }, NULL);
}

/* A socket and a port that nobody has; the lock. The thread is started by the test. */
static inline void controller_init(struct controller *c, struct unit_random *r, const double arm[3])
{
	const struct rotation turn = align_turn(r);

	pthread_mutex_init(&c->lock, NULL);
	c->fd = net_socket(SOCK_DGRAM, "127.0.0.1", 0);
	c->port = net_free_port(SOCK_DGRAM);
	c->R = dmat3_from_rotation(&turn);
	for (int i = 0; i < 3; i++)
		c->t[i] = unit_random_range(r, -2, 2);
	memcpy(c->arm, arm, sizeof c->arm);
	c->turn = ROTATION_NONE;
}

#endif
